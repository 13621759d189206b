//! One control cycle: measure, compute, ask the interlock, send; and how long it took.

use core::sync::atomic::{AtomicU32, Ordering};

use controller_core::joint::{JointState, zeros};
use controller_core::{Measurement, Reference};
use cortex_m::peripheral::DWT;
use embedded_hal::digital::{InputPin, OutputPin};
use firmware::interlocked_controller::InterlockedController;

use crate::joints::Joints;

/// Processor cycles of the shortest cycle of control so far, from the measurement to
/// the torque; for a debugger to read.
pub static SHORTEST: AtomicU32 = AtomicU32::new(u32::MAX);

/// Of the longest one.
pub static LONGEST: AtomicU32 = AtomicU32::new(0);

/// Controller with interlock, bus, and what is remembered from cycle to cycle.
pub struct Loop<J, E, D, H, S> {
    interlocked: InterlockedController<f64, E, D, H>,
    joints: J,
    /// High while the operator asks for the drives.
    start: S,
    asked: bool,
    /// Every level holds where it is when the drives are asked for, and the posture is
    /// the one of that moment. Before it no torque is sent.
    hold: Reference<f64>,
    /// Processor cycle of the last measurement.
    last: Option<u32>,
    clock_hz: f64,
    cycle_s: f64,
}

impl<J: Joints, E: InputPin, D: OutputPin, H: OutputPin, S: InputPin> Loop<J, E, D, H, S> {
    /// Drives off. The processor runs at `clock_hz` \[Hz\]; the controller is made for
    /// cycles of `cycle_s` \[s\].
    pub fn new(
        interlocked: InterlockedController<f64, E, D, H>,
        joints: J,
        start: S,
        clock_hz: f64,
        cycle_s: f64,
    ) -> Self {
        Self {
            hold: Reference::hold(interlocked.controller().level_count(), zeros()),
            interlocked,
            joints,
            start,
            asked: false,
            last: None,
            clock_hz,
            cycle_s,
        }
    }

    /// To be called once per cycle, by the timer's interrupt.
    #[inline(never)]
    #[allow(unsafe_code)] // the section, which start-up fills
    #[unsafe(link_section = ".itcm.cycle")]
    pub fn run(&mut self) {
        let begin = DWT::cycle_count();
        let Some(joints) = self.joints.measure() else {
            self.interlocked.blind();
            self.joints.send(&zeros(), &zeros());
            self.last = None;
            return;
        };
        // The measured time, not the timer's period: the counter does not stop and
        // wraps around after nine seconds.
        let interval_s = match self.last.replace(begin) {
            Some(last) => f64::from(begin.wrapping_sub(last)) / self.clock_hz,
            None => self.cycle_s,
        };
        self.listen(&joints);
        let measurement = Measurement {
            q: joints.q,
            dq: joints.dq,
            interval_s,
        };
        let output = self.interlocked.cycle(&measurement, &self.hold);
        self.joints.send(&output.torque, &output.step.gravity);

        let taken = DWT::cycle_count().wrapping_sub(begin);
        SHORTEST.fetch_min(taken, Ordering::Relaxed);
        LONGEST.fetch_max(taken, Ordering::Relaxed);
    }

    /// Asks for the drives where the operator begins to: the arm stays where it is.
    fn listen(&mut self, joints: &JointState<f64>) {
        let asks = matches!(self.start.is_high(), Ok(true));
        if asks && !self.asked {
            self.hold.posture = joints.q;
            // Forgets also where levels have held so far.
            self.interlocked.enable();
        }
        self.asked = asks;
    }
}
