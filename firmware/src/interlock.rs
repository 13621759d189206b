//! What stands between the controller and the drives: emergency stop in, drive
//! enable and heartbeat out.
//!
//! Levels. Emergency stop: high is released, as with a normally closed contact,
//! so that a broken wire stops the arm. Drive enable: high lets the drives run.
//! Heartbeat: changes with every good cycle; an external watchdog takes the
//! power away when it stands still. Safe is low for both outputs.

use embedded_hal::digital::{InputPin, OutputPin};

/// Why the drives are off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Cause {
    /// Nobody has asked for them since the start or since the last stop.
    NotEnabled,
    /// The emergency stop is pressed, or cannot be read.
    EmergencyStop,
    /// The control cycle reported a fault.
    Controller,
    /// An output could not be set.
    Output,
}

/// Emergency stop and the two outputs that depend on it.
#[derive(Debug)]
pub struct Interlock<E, D, H> {
    emergency_stop: E,
    drives: D,
    heartbeat: H,
    requested: bool,
    beat: bool,
}

impl<E: InputPin, D: OutputPin, H: OutputPin> Interlock<E, D, H> {
    /// Both outputs safe at once. What cannot be set now is tried again every
    /// cycle.
    #[must_use]
    pub fn new(emergency_stop: E, drives: D, heartbeat: H) -> Self {
        let mut interlock = Self {
            emergency_stop,
            drives,
            heartbeat,
            requested: false,
            beat: false,
        };
        interlock.make_safe();
        interlock
    }

    /// Asks for the drives: they run from the next good cycle on. Needed again
    /// after every stop; letting go of the emergency stop never moves the arm.
    pub fn enable(&mut self) {
        self.requested = true;
    }

    /// Once per control cycle, before its torque is sent. `clean` says that the
    /// cycle has no fault. Ok means that the drives run and the torque may act.
    ///
    /// # Errors
    /// The reason why the drives are off; the outputs are safe already.
    pub fn cycle(&mut self, clean: bool) -> Result<(), Cause> {
        let outcome = match self.emergency_stop.is_high() {
            Ok(true) if clean => self.good(),
            Ok(true) => Err(Cause::Controller),
            Ok(false) | Err(_) => Err(Cause::EmergencyStop),
        };
        if let Err(cause) = outcome
            && cause != Cause::NotEnabled
        {
            self.make_safe();
        }
        outcome
    }

    /// Both outputs safe, whatever the cycle says: for panics and shutdown.
    pub fn make_safe(&mut self) {
        self.requested = false;
        self.beat = false;
        // Each is tried even where the other fails.
        let drives = self.drives.set_low();
        let heartbeat = self.heartbeat.set_low();
        let _ = (drives, heartbeat);
    }

    /// Ends it with safe outputs and gives the pins back.
    pub fn release(mut self) -> (E, D, H) {
        self.make_safe();
        (self.emergency_stop, self.drives, self.heartbeat)
    }

    fn good(&mut self) -> Result<(), Cause> {
        self.beat = !self.beat;
        let beat = self.heartbeat.set_state(self.beat.into());
        let drives = self.drives.set_state(self.requested.into());
        if beat.is_err() || drives.is_err() {
            return Err(Cause::Output);
        }
        if self.requested {
            Ok(())
        } else {
            Err(Cause::NotEnabled)
        }
    }
}
