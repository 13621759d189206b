//! One control cycle, from measurement to torque.

use heapless::Vec;

use crate::config::{ConfigError, ControllerConfig};
use crate::damping::DampingRate;
use crate::dynamics::Dynamics;
use crate::fault::{Fault, Status};
use crate::hierarchy::Hierarchy;
use crate::joint::{JointState, JointVector, zeros};
use crate::kinematics::Kinematics;
use crate::law::{Command, Cycle, NullSpace, PostureState, TaskMotion, TorqueDemand, posture_rate};
use crate::limits::TorqueCommand;
use crate::measurement::{Measurement, Reference, plausible, usable};
use crate::model::ArmModel;
use crate::observer::{DeadTime, Observer};
use crate::real::Real;
use crate::task::{MAX_LEVELS, Task, TaskRows};

/// The immutable part: arm, tasks, gains and limits, validated once. One
/// controller can drive any number of [`ControllerState`]s.
#[derive(Clone, Debug)]
pub struct Controller<T: Real> {
    model: ArmModel<T>,
    tasks: Vec<Task<T>, MAX_LEVELS>,
    null_space: NullSpace<T>,
    observer_gain: JointVector<T>,
    cycle_s: T,
    dead_cycles: u8,
    fastest_mode: DampingRate,
}

/// The part that changes from cycle to cycle. Const-constructed, so that it can
/// be a `static`.
#[derive(Clone, Debug)]
pub struct ControllerState<T: Real> {
    observer: Observer<T>,
    dead_time: DeadTime<T>,
    posture: PostureState<T>,
    /// Limited gravity torque of the last plausible posture \[Nm\].
    hold: JointVector<T>,
    fault: Option<Fault>,
}

/// The result of one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<T: Real> {
    /// Joint torque to apply until the next cycle \[Nm\]: always finite and
    /// within the limits of the arm.
    pub torque: JointVector<T>,
    /// r \[Nm\], tends to -tau_ext; zero while a fault is latched.
    pub residual: JointVector<T>,
    /// g(q) \[Nm\], contained in the torque: what a robot that compensates
    /// gravity itself must not be sent. While a fault is latched the torque itself.
    pub gravity: JointVector<T>,
    /// C dq \[Nm\], contained in the torque; zero while a fault is latched.
    pub coriolis: JointVector<T>,
    /// What limited or degraded the cycle.
    pub status: Status,
}

impl<T: Real> ControllerState<T> {
    /// Before the first cycle: nothing observed, no fault, zero torque held.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            observer: Observer::new(),
            dead_time: DeadTime::new(),
            posture: PostureState::new(),
            hold: zeros(),
            fault: None,
        }
    }

    /// The latched fault, if any.
    #[must_use]
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Tells the observer that `torque` \[Nm\] has acted on the joints since the
    /// last cycle instead of the one it assumes: the torque of that cycle, or
    /// with dead time of so many cycles before. For links that round, scale or
    /// lose torques; to be called before the next cycle.
    pub fn applied(&mut self, torque: &JointVector<T>) {
        self.observer.correct(torque);
    }

    /// The next cycle comes after a gap that is too long to be an interval: the
    /// observer keeps its residual and takes the momentum anew.
    pub fn skip(&mut self) {
        self.observer.started = false;
    }

    /// Clears a latched fault. The observer and an integrated posture start anew.
    pub fn reset(&mut self) {
        *self = Self {
            hold: self.hold,
            ..Self::new()
        };
    }

    fn held(&mut self, fault: Fault) -> Step<T> {
        self.fault = Some(fault);
        Step {
            torque: self.hold,
            residual: zeros(),
            gravity: self.hold,
            coriolis: zeros(),
            status: Status {
                fault: Some(fault),
                ..Status::default()
            },
        }
    }
}

impl<T: Real> Default for ControllerState<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real> Controller<T> {
    /// Validates and copies the configuration.
    ///
    /// # Errors
    /// [`ConfigError`] names the first thing that cannot be.
    pub fn new(model: &ArmModel<T>, config: &ControllerConfig<T>) -> Result<Self, ConfigError> {
        match config.validate(model) {
            Ok(fastest_mode) => Ok(Self::assembled(model, config, fastest_mode)),
            Err(error) => Err(error),
        }
    }

    /// Behind a call, so that the parts are copied into the place of the result
    /// and nowhere else.
    #[inline(never)]
    fn assembled(
        model: &ArmModel<T>,
        config: &ControllerConfig<T>,
        fastest_mode: DampingRate,
    ) -> Self {
        Self {
            model: *model,
            tasks: config.tasks.clone(),
            null_space: config.null_space,
            observer_gain: config.observer_gain,
            cycle_s: config.cycle_s,
            dead_cycles: config.dead_cycles,
            fastest_mode,
        }
    }

    /// The arm.
    #[must_use]
    pub fn model(&self) -> &ArmModel<T> {
        &self.model
    }

    /// The tasks, highest priority first.
    #[must_use]
    pub fn tasks(&self) -> &[Task<T>] {
        &self.tasks
    }

    /// Compliance of what the tasks leave.
    #[must_use]
    pub fn null_space(&self) -> &NullSpace<T> {
        &self.null_space
    }

    /// The fastest null-space mode that the damping makes anywhere.
    #[must_use]
    pub fn fastest_mode(&self) -> DampingRate {
        self.fastest_mode
    }

    /// The reference that keeps the arm in the posture `q` \[rad\]: every level
    /// where it is, q_d = q. What motions start from.
    #[must_use]
    pub fn rest(&self, q: &JointVector<T>) -> Reference<T> {
        let dq = zeros();
        self.place(&JointState { q: *q, dq })
    }

    /// The reference that moves as the arm does at this instant: position and
    /// velocity of every level, no acceleration, q_d = q.
    #[must_use]
    pub fn place(&self, joints: &JointState<T>) -> Reference<T> {
        let kinematics = Kinematics::new(&self.model, joints);
        let mut reference = Reference {
            tasks: Vec::new(),
            posture: joints.q,
        };
        for task in &self.tasks {
            // Never full: as many places as levels. Collecting would carry a panic.
            let _ = reference.tasks.push(task.place(&kinematics));
        }
        reference
    }

    /// One cycle. Never fails and never panics: with a measurement or reference
    /// that cannot be true it latches a fault and holds the arm by the gravity
    /// torque of the last plausible posture (zero torque if there was none).
    #[must_use]
    pub fn step(
        &self,
        state: &mut ControllerState<T>,
        measurement: &Measurement<T>,
        reference: &Reference<T>,
    ) -> Step<T> {
        self.step_with(state, measurement, reference, TorqueDemand::hierarchical)
    }

    /// One cycle with another law in the place of
    /// [`TorqueDemand::hierarchical`], everything around it unchanged. For
    /// experiments that compare laws on equal terms.
    #[must_use]
    pub fn step_with(
        &self,
        state: &mut ControllerState<T>,
        measurement: &Measurement<T>,
        reference: &Reference<T>,
        law: impl FnOnce(&Cycle<'_, T>) -> TorqueDemand<T>,
    ) -> Step<T> {
        let entry = match state.fault {
            Some(fault) => Err(fault),
            None => plausible(&self.model, self.cycle_s, measurement),
        };
        let checked = entry.and_then(|joints| usable(reference, self.tasks.len()).map(|()| joints));
        match checked {
            Ok(joints) => self.cycle(state, &joints, measurement.interval_s, reference, law),
            Err(fault) => state.held(fault),
        }
    }

    /// The pipeline, one direction.
    #[inline]
    fn cycle(
        &self,
        state: &mut ControllerState<T>,
        joints: &JointState<T>,
        interval_s: T,
        reference: &Reference<T>,
        law: impl FnOnce(&Cycle<'_, T>) -> TorqueDemand<T>,
    ) -> Step<T> {
        let kinematics = Kinematics::new(&self.model, joints);
        let mut dynamics = Dynamics::empty();
        dynamics.update(&self.model, &kinematics, joints);
        let limit = self.model.torque_limit();
        state.hold = match TorqueCommand::new(&TorqueDemand(dynamics.gravity), limit) {
            Ok(command) => command.torque,
            Err(fault) => return state.held(fault),
        };

        let residual = state
            .observer
            .update(&self.observer_gain, interval_s, &dynamics.momentum);

        let mut rows = TaskRows::empty();
        rows.stack(&self.tasks, &reference.tasks, &kinematics, joints);
        let hierarchy = Hierarchy::new(&rows, &dynamics.cholesky);
        let motion = TaskMotion::new(&dynamics, &hierarchy, joints);
        let posture = state.posture.update(
            self.null_space.posture,
            &reference.posture,
            interval_s,
            |kind| posture_rate(kind, &dynamics, &rows, &hierarchy, &motion, joints),
        );
        let command = Command::new(
            &self.null_space,
            &dynamics,
            &rows,
            &hierarchy,
            &motion,
            joints,
            &posture,
        );
        let demand = law(&Cycle {
            state: joints,
            kinematics: &kinematics,
            dynamics: &dynamics,
            rows: &rows,
            hierarchy: &hierarchy,
            motion: &motion,
            posture: &posture,
            command: &command,
            residual: &residual,
        });
        let TorqueCommand { torque, saturated } = match TorqueCommand::new(&demand, limit) {
            Ok(command) => command,
            Err(fault) => return state.held(fault),
        };

        let acting = state.dead_time.send(self.dead_cycles, &torque, &state.hold);
        state.observer.apply(&dynamics, joints, &acting);
        Step {
            torque,
            residual,
            gravity: dynamics.gravity,
            coriolis: dynamics.coriolis,
            status: Status {
                fault: None,
                saturated,
                rank: hierarchy.deficient(),
            },
        }
    }
}
