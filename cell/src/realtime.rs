//! Scheduling, memory and processor of the thread that keeps the cycle, as far as the system
//! permits. What it does not permit is said, not hidden.

use serde::Serialize;

/// Priority of the thread that keeps the cycle, below that of the kernel's own threads.
#[cfg(unix)]
const PRIORITY: u8 = 80;

/// What was asked for and what was given.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Realtime {
    /// First-in-first-out scheduling above all ordinary threads.
    pub fifo: Grant,
    /// Memory that is never paged out.
    pub memory: Grant,
    /// A processor of its own.
    pub cpu: Grant,
}

/// Whether the system gave it.
#[derive(Clone, Debug, Default, Serialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Grant {
    /// Not asked for.
    #[default]
    NotAsked,
    /// Given.
    Given,
    /// Refused: why, and what to do about it.
    Refused(String),
}

impl std::fmt::Display for Grant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotAsked => write!(f, "not asked for"),
            Self::Given => write!(f, "yes"),
            Self::Refused(why) => write!(f, "no: {why}"),
        }
    }
}

impl Realtime {
    /// Asks for everything, for the calling thread; a processor only if one is named.
    #[must_use]
    pub fn ask(cpu: Option<usize>) -> Self {
        Self {
            fifo: fifo(),
            memory: lock_memory(),
            cpu: cpu.map_or(Grant::NotAsked, own_cpu),
        }
    }

    /// Asks for scheduling, and for a processor if one is named; for a program whose memory
    /// grows, which under a limit of locked memory would end it.
    #[must_use]
    pub fn ask_without_memory(cpu: Option<usize>) -> Self {
        Self {
            fifo: fifo(),
            memory: Grant::NotAsked,
            cpu: cpu.map_or(Grant::NotAsked, own_cpu),
        }
    }

    /// The calling thread becomes an ordinary one again: what follows needs no cycle and
    /// must not keep others from theirs.
    pub fn release(&self) {
        if self.fifo == Grant::Given {
            ordinary();
        }
    }

    /// One line.
    #[must_use]
    pub fn line(&self) -> String {
        format!(
            "real-time scheduling: {}; locked memory: {}; own processor: {}",
            self.fifo, self.memory, self.cpu
        )
    }
}

#[cfg(unix)]
fn fifo() -> Grant {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy,
        set_thread_priority_and_policy, thread_native_id,
    };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let priority = match PRIORITY.try_into() {
        Ok(priority) => ThreadPriority::Crossplatform(priority),
        Err(_) => ThreadPriority::Max,
    };
    match set_thread_priority_and_policy(thread_native_id(), priority, policy) {
        Ok(()) => Grant::Given,
        Err(error) => Grant::Refused(format!(
            "SCHED_FIFO was refused ({}); allow it with `ulimit -r 99`, a line \
             `@realtime - rtprio 99` in /etc/security/limits.conf, or CAP_SYS_NICE",
            reason(&error)
        )),
    }
}

#[cfg(unix)]
fn ordinary() {
    use thread_priority::{
        NormalThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy,
        set_thread_priority_and_policy, thread_native_id,
    };
    let policy = ThreadSchedulePolicy::Normal(NormalThreadSchedulePolicy::Other);
    // Giving a priority back is always allowed.
    let _ = set_thread_priority_and_policy(thread_native_id(), ThreadPriority::Min, policy);
}

#[cfg(unix)]
fn reason(error: &thread_priority::Error) -> String {
    match error {
        thread_priority::Error::OS(code) => std::io::Error::from_raw_os_error(*code).to_string(),
        other => format!("{other:?}"),
    }
}

#[cfg(target_os = "linux")]
fn lock_memory() -> Grant {
    use nix::sys::mman::{MlockAllFlags, mlockall};
    match mlockall(MlockAllFlags::MCL_CURRENT | MlockAllFlags::MCL_FUTURE) {
        Ok(()) => Grant::Given,
        Err(error) => Grant::Refused(format!(
            "mlockall was refused ({error}); allow it with `ulimit -l unlimited` or CAP_IPC_LOCK"
        )),
    }
}

#[cfg(target_os = "linux")]
fn own_cpu(cpu: usize) -> Grant {
    use nix::sched::{CpuSet, sched_setaffinity};
    use nix::unistd::Pid;
    let mut set = CpuSet::new();
    let set_result = set
        .set(cpu)
        .and_then(|()| sched_setaffinity(Pid::from_raw(0), &set));
    match set_result {
        Ok(()) => Grant::Given,
        Err(error) => Grant::Refused(format!(
            "processor {cpu} was refused ({error}); there are {}, counted from 0",
            std::thread::available_parallelism().map_or(1, usize::from)
        )),
    }
}

#[cfg(not(unix))]
fn fifo() -> Grant {
    Grant::Refused("SCHED_FIFO is not on this system; it needs Linux".into())
}

#[cfg(not(unix))]
fn ordinary() {}

#[cfg(not(target_os = "linux"))]
fn lock_memory() -> Grant {
    Grant::Refused("only on Linux".into())
}

#[cfg(not(target_os = "linux"))]
fn own_cpu(_: usize) -> Grant {
    Grant::Refused("only on Linux".into())
}
