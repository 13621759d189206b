//! The controller with everything a board needs around it: one call per cycle.

use controller_core::cycle::record::Recorder;
use controller_core::fault::Mode;
use controller_core::joint::{JointVector, zeros};
use controller_core::real::Real;
use controller_core::{Controller, Measurement, Reference, State, Step};
use embedded_hal::digital::{InputPin, OutputPin};

use crate::interlock::{Cause, Interlock};

/// Cycles kept for after a stop.
pub const RECORDED: usize = 64;

/// Controller, its state, interlock and recorder.
pub struct InterlockedController<T: Real, E, D, H> {
    controller: Controller<T>,
    state: State<T>,
    recorder: Recorder<T, RECORDED>,
    interlock: Interlock<E, D, H>,
    /// Whether the drives ran in the last cycle.
    on: bool,
}

/// What goes to the drives this cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output<T: Real> {
    /// Torque to send \[Nm\]: the controller's while the drives run, zero otherwise.
    pub torque: JointVector<T>,
    /// Why the drives are off, if they are.
    pub stopped: Option<Cause>,
    /// The control cycle, whether its torque is sent or not.
    pub step: Step<T>,
}

impl<T: Real, E: InputPin, D: OutputPin, H: OutputPin> InterlockedController<T, E, D, H> {
    /// Drives off, nothing observed.
    #[must_use]
    pub fn new(controller: Controller<T>, interlock: Interlock<E, D, H>) -> Self {
        let mut state = State::new();
        // The drives are off: the first torque starts from none.
        state.set_applied_torque(&zeros());
        Self {
            controller,
            state,
            recorder: Recorder::new(),
            interlock,
            on: false,
        }
    }

    /// Clears a fault and asks for the drives: deliberate, never by itself.
    pub fn enable(&mut self) {
        self.state.reset();
        self.interlock.enable();
    }

    /// One cycle: law, record, interlock. Where the drives are off the observer is told
    /// that no torque acted.
    pub fn cycle(&mut self, measurement: &Measurement<T>, reference: &Reference<T>) -> Output<T> {
        let step = self
            .controller
            .step(&mut self.state, measurement, reference);
        self.recorder.push(measurement, &step);
        // A fault brakes by the drives, unless they are off; blind, only their own brakes
        // are left.
        let brakes = self.on && matches!(step.status.mode, Mode::Braking | Mode::Resting);
        let answer = self.interlock.cycle(step.status.fault.is_none() || brakes);
        self.on = answer.is_ok();
        match answer {
            Ok(()) => Output {
                torque: step.torque,
                stopped: None,
                step,
            },
            Err(cause) => {
                self.state.set_applied_torque(&zeros());
                Output {
                    torque: zeros(),
                    stopped: Some(cause),
                    step,
                }
            }
        }
    }

    /// A cycle without a measurement: the drives go off, the observer takes the momentum
    /// anew with the next one.
    pub fn blind(&mut self) {
        self.state.resume_after_gap();
        self.state.set_applied_torque(&zeros());
        self.on = false;
        // Not clean: an error whatever the emergency stop says, and the outputs safe.
        let _ = self.interlock.cycle(false);
    }

    /// The controller.
    #[must_use]
    pub fn controller(&self) -> &Controller<T> {
        &self.controller
    }

    /// The last cycles, oldest first.
    #[must_use]
    pub fn recorder(&self) -> &Recorder<T, RECORDED> {
        &self.recorder
    }

    /// Ends with safe outputs and gives the pins back.
    pub fn release(self) -> (E, D, H) {
        self.interlock.release()
    }
}
