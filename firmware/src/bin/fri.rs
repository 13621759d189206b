//! The controller for a robot that speaks FRI, without a PC: over Ethernet, or
//! over the serial port where the file `fri-serial` exists in the folder of the
//! emulator. The emergency stop is pulled while the file `e-stop` exists there.
//!
//! On the host it says how to run it.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    println!(
        "This image runs on the Cortex-M7: `cargo fri-m7`, and in another terminal\n\
         `cargo run --release -p hil-sim -- serve --scenario two-level --lockstep`."
    );
}

#[cfg(target_os = "none")]
mod target {
    use bridge::session::Phase;
    use bridge::transport::{DatagramLink, SerialLink};
    use cortex_m_rt::entry;
    use cortex_m_semihosting::hprintln;
    use embedded_hal::digital::InputPin;
    use firmware::interlock::Interlock;
    use firmware::interlocked_session::{self, Event, FixedScenarioSource, InterlockedSession};
    use firmware::mps2::{self, Counter, Ethernet, HostFile, HostSwitch, Led, Memory, Uart};
    use firmware::scenario::FixedScenario;

    /// After how long without a datagram the robot counts as gone \[s\].
    const SILENCE_S: f64 = 2.0;

    /// A tick of the counter \[s\].
    const TICK_S: f64 = 40e-9;

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
        mps2::panicked(info)
    }

    #[entry]
    fn main() -> ! {
        // `entry` hands the static out once, as a reference.
        static mut MEMORY: Memory = Memory::new();
        if HostFile::open(c"fri-serial").is_some() {
            hprintln!("fri: serial port");
            run(SerialLink::new(Uart::start()), |_, _| {})
        }
        let Some(link) = Ethernet::start(MEMORY) else {
            hprintln!("fri: no Ethernet controller");
            mps2::exit(false)
        };
        hprintln!("fri: UDP port {}", mps2::PORT);
        run(link, |link, time_s| link.set_time((time_s * 1e3) as i64))
    }

    fn run<L: DatagramLink>(link: L, set_time: impl Fn(&mut L, f64)) -> ! {
        let scenario = FixedScenario::TwoLevel;
        let (Ok(config), Ok(source)) = (
            interlocked_session::config(scenario),
            FixedScenarioSource::new(scenario),
        ) else {
            hprintln!("fri: refused");
            mps2::exit(false)
        };
        let interlock = Interlock::new(HostSwitch::new(c"e-stop"), Led::new(0), Led::new(1));
        let mut interlocked = InterlockedSession::new(config, source, link, interlock, SILENCE_S);
        let counter = Counter::start();
        let (mut last, mut time_s) = (counter.ticks(), 0.0);
        let (mut phase, mut stopped, mut answered) = (Phase::Waiting, None, 0u32);
        loop {
            let ticks = counter.ticks();
            let elapsed_s = f64::from(ticks.wrapping_sub(last)) * TICK_S;
            (last, time_s) = (ticks, time_s + elapsed_s);
            set_time(interlocked.link(), time_s);
            match interlocked.poll(elapsed_s) {
                Ok(Event::Quiet | Event::Refused) => {}
                Ok(Event::Answered {
                    phase: now,
                    stopped: cause,
                }) => {
                    answered += 1;
                    if now != phase || cause != stopped {
                        let t_s = interlocked.session().last().map_or(0.0, |cycle| cycle.t_s);
                        let (drives, heartbeat) = (Led::new(0).is_on(), Led::new(1).is_on());
                        hprintln!(
                            "cycle {} t {:.3} s {}: drives {} heartbeat {} {:?}",
                            answered,
                            t_s,
                            now.name(),
                            u8::from(drives),
                            u8::from(heartbeat),
                            cause
                        );
                        (phase, stopped) = (now, cause);
                    }
                }
                Ok(Event::Silent) => {
                    let (drives, heartbeat) = (Led::new(0).is_on(), Led::new(1).is_on());
                    hprintln!(
                        "silent for {} s: drives {} heartbeat {}",
                        SILENCE_S,
                        u8::from(drives),
                        u8::from(heartbeat)
                    );
                    finish(answered, phase == Phase::Stopping);
                }
                Err(_) => {
                    hprintln!("the link fails");
                    mps2::exit(false)
                }
            }
            if phase == Phase::Finished {
                let pulled = HostSwitch::new(c"e-stop").is_low() == Ok(true);
                finish(answered, !pulled && interlocked.session().fault().is_none());
            }
        }
    }

    fn finish(answered: u32, good: bool) -> ! {
        hprintln!(
            "fri: {} answers, {}",
            answered,
            if good { "done" } else { "stopped" }
        );
        mps2::exit(good)
    }
}
