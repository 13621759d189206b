//! The application as a board would run it: a cycle of 2 ms, emergency stop, drive
//! enable and heartbeat, a log. There is no robot behind it: the arm rests in its
//! start posture, and a script presses the emergency stop, spoils a measurement and
//! asks for the drives again. Exit code 0 if each of them did what it should.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::cell::Cell;
use core::convert::Infallible;

use controller_core::Measurement;
use controller_core::joint::zeros;
use controller_core::real::Real;
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use firmware::interlock::{Cause, Interlock};
use firmware::interlocked_controller::{InterlockedController, Output};
use firmware::scenario::{CYCLE_S, FixedScenario, ReadyScenario};

/// Cycles of the script.
const CYCLES: u32 = 200;

/// Asked for the drives.
const ENABLED: [u32; 3] = [10, 90, 140];
/// Emergency stop pressed from, let go at.
const PRESSED: [u32; 2] = [60, 80];
/// A measurement with an infinite speed.
const SPOILT: u32 = 120;

/// What the script says about a cycle.
fn expected(cycle: u32) -> Option<Cause> {
    match cycle {
        60..80 => Some(Cause::EmergencyStop),
        120..140 => Some(Cause::Controller),
        0..10 | 80..90 => Some(Cause::NotEnabled),
        _ => None,
    }
}

/// The emergency stop, which the script presses: no button can be in QEMU.
struct Switch<'a> {
    pressed: &'a Cell<bool>,
}

impl ErrorType for Switch<'_> {
    type Error = Infallible;
}

impl InputPin for Switch<'_> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(!self.pressed.get())
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(self.pressed.get())
    }
}

/// Runs the script; `seen` is told every cycle. None if the constants are refused.
fn run<T: Real>(
    drives: impl OutputPin,
    heartbeat: impl OutputPin,
    mut delay: impl DelayNs,
    mut seen: impl FnMut(u32, &Output<T>),
) -> Option<bool> {
    let ready = ReadyScenario::<T>::new(FixedScenario::TwoLevel).ok()?;
    let pressed = Cell::new(false);
    let switch = Switch { pressed: &pressed };
    let interlock = Interlock::new(switch, drives, heartbeat);
    let mut interlocked = InterlockedController::new(ready.controller.clone(), interlock);
    let mut as_expected = true;
    for cycle in 0..CYCLES {
        if ENABLED.contains(&cycle) {
            interlocked.enable();
        }
        pressed.set((PRESSED[0]..PRESSED[1]).contains(&cycle));
        let mut measurement = Measurement {
            q: ready.origin.posture,
            dq: zeros(),
            interval_s: T::from_f64(CYCLE_S),
        };
        if cycle == SPOILT {
            measurement.dq[3] = T::ONE / T::ZERO;
        }
        let output = interlocked.cycle(&measurement, &ready.origin);
        as_expected &= output.stopped == expected(cycle)
            && (output.stopped.is_none() || output.torque.iter().all(|&torque| torque == T::ZERO));
        seen(cycle, &output);
        delay.delay_us((CYCLE_S * 1e6) as u32);
    }
    interlocked.release();
    Some(as_expected)
}

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    /// LEDs that nobody sees, no waiting.
    struct Nothing;

    impl ErrorType for Nothing {
        type Error = Infallible;
    }

    impl OutputPin for Nothing {
        fn set_low(&mut self) -> Result<(), Infallible> {
            Ok(())
        }
        fn set_high(&mut self) -> Result<(), Infallible> {
            Ok(())
        }
    }

    impl DelayNs for Nothing {
        fn delay_ns(&mut self, _: u32) {}
    }

    let mut last = None;
    let done = run::<f64>(Nothing, Nothing, Nothing, |cycle, output| {
        if last != Some(output.stopped) {
            last = Some(output.stopped);
            let torque = output.torque[1];
            match (output.stopped, output.step.status.fault) {
                (None, _) => println!("cycle {cycle}: drives on, joint 2 {torque:.3} Nm"),
                (Some(Cause::Controller), Some(fault)) => println!("cycle {cycle}: {fault}"),
                (Some(cause), _) => println!("cycle {cycle}: drives off, {cause:?}"),
            }
        }
    });
    std::process::ExitCode::from(u8::from(done != Some(true)))
}

#[cfg(target_os = "none")]
mod target {
    use core::sync::atomic::{AtomicU32, Ordering};

    use cortex_m_rt::entry;
    use defmt_semihosting as _;
    use embedded_hal::digital::OutputPin;
    use firmware::mps2::{self, Counter, Led};

    use super::{Cause, run};

    /// For the time stamps of the log.
    static CYCLE: AtomicU32 = AtomicU32::new(0);

    defmt::timestamp!("{=u32} ms", 2 * CYCLE.load(Ordering::Relaxed));

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
        // Safe levels first: whatever went wrong may not print.
        let (mut drives, mut heartbeat) = (Led::new(0), Led::new(1));
        let _ = (drives.set_low(), heartbeat.set_low());
        mps2::panicked(info)
    }

    #[entry]
    fn main() -> ! {
        let (drives, heartbeat) = (Led::new(0), Led::new(1));
        let mut last = None;
        let mut beats = (false, 0u32);
        let mut levels = true;
        let counter = Counter::start();
        let done = run::<f64>(drives, heartbeat, counter, |cycle, output| {
            CYCLE.store(cycle, Ordering::Relaxed);
            // The register itself, not what was meant to be written.
            let (drives, heartbeat) = (Led::new(0).is_on(), Led::new(1).is_on());
            levels &= drives == output.stopped.is_none();
            beats.1 += u32::from(heartbeat != beats.0);
            beats.0 = heartbeat;
            if last != Some(output.stopped) {
                last = Some(output.stopped);
                match (output.stopped, output.step.status.fault) {
                    (None, _) => defmt::info!("drives on, joint 2 {} Nm", output.torque[1]),
                    (Some(Cause::Controller), Some(fault)) => defmt::error!("{}", fault),
                    (Some(cause), _) => defmt::warn!("drives off, {}", cause),
                }
            }
        });
        let off = !Led::new(0).is_on() && !Led::new(1).is_on();
        defmt::info!("{} heartbeats, outputs safe at the end: {}", beats.1, off);
        mps2::exit(done == Some(true) && levels && off)
    }
}
