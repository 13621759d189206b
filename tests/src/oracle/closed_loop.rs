//! A controller of either precision around the ideal plant.

use arms::LWR_IV;
use cell::names::PlantKind;
use controller_core::arm::ArmParameters;
use controller_core::cycle::{Data, Input};
use controller_core::joint::{JointState, JointVector, Vector3};
use controller_core::real::Real;
use controller_core::task::Tracked;
use controller_core::task::trajectory::{Plane, Trajectory};
use controller_core::{
    Controller, ControllerConfig, LinkPoint, Measurement, Reference, State, Step, Target, Task,
};
use hil_sim::plant::{Plant, PlantModel};

/// The posture \[deg\] from which the two-level circle starts.
pub const TWO_LEVEL_START: [f64; 7] = [0.0, 35.0, 0.0, -80.0, 20.0, 60.0, 0.0];

/// The posture \[deg\] from which the three-level motions start.
pub const CASE_START: [f64; 7] = [10.0, 30.0, 5.0, -85.0, 25.0, 50.0, 0.0];

/// A posture in rad.
#[must_use]
pub fn posture(degrees: [f64; 7]) -> JointVector<f64> {
    degrees.map(f64::to_radians).into()
}

/// A circle in the YZ plane, blended in over 2 s.
#[must_use]
pub fn circle(radius_m: f64, period_s: f64) -> Trajectory<f64> {
    Trajectory::Turn {
        plane: Plane::Yz,
        radius_m,
        period_s,
        growth_s: 2.0,
    }
}

/// No force from outside, as in [`Plant::advance`].
#[must_use]
pub fn no_contact(_: f64, _: &PlantModel, _: &JointState<f64>) -> JointVector<f64> {
    JointVector::zeros()
}

/// Controller, plant and references.
#[derive(Clone, Debug)]
pub struct ClosedLoop<T: Real> {
    arm: ArmParameters,
    /// Of the core.
    pub controller: Controller<T>,
    /// Of the core.
    pub state: State<T>,
    /// The ideal arm.
    pub plant: Plant,
    /// q_d \[rad\].
    pub posture: JointVector<f64>,
    config: ControllerConfig,
    motions: Vec<Trajectory<f64>>,
    origins: Vec<Target<f64>>,
    cycle: u32,
}

/// One cycle of a closed loop.
#[derive(Clone, Debug)]
pub struct Seen<T: Real> {
    /// Time of the measurement \[s\].
    pub t_s: f64,
    /// True state at that time.
    pub state: JointState<f64>,
    /// |x_d - x| per level \[m\], over its axes; levels with a position as target only.
    pub errors: Vec<f64>,
    /// Answer of the controller.
    pub step: Step<T>,
}

impl<T: Real> ClosedLoop<T> {
    /// At rest in `start` \[rad\], which is q_d too; one motion per level about
    /// where its point is then. A level without a motion rests there.
    #[must_use]
    pub fn new(
        config: &ControllerConfig,
        start: JointVector<f64>,
        motions: &[Trajectory<f64>],
    ) -> Self {
        Self::with_arm(&LWR_IV, config, start, motions)
    }

    /// The same with another arm.
    #[must_use]
    pub fn with_arm(
        arm: &ArmParameters,
        config: &ControllerConfig,
        start: JointVector<f64>,
        motions: &[Trajectory<f64>],
    ) -> Self {
        let controller = Controller::exact(arm, config).expect("a valid configuration");
        let origins = controller.rest_reference(&start.map(T::from_f64));
        let mut origins: Vec<_> = origins.targets().iter().map(Target::cast).collect();
        let plant = Plant::new(PlantKind::Ideal, arm, start, config.cycle_s, 1);
        // Points by the plant, so that no error of the core's hides in the reference.
        for (task, origin) in config.tasks.tasks().iter().zip(&mut origins) {
            if let (Tracked::Position(point), Target::Position { x, .. }) = (task.tracked, origin) {
                *x = true_point(&plant, point);
            }
        }
        Self {
            arm: *arm,
            controller,
            state: State::new(),
            origins,
            plant,
            posture: start,
            config: config.clone(),
            motions: motions.to_vec(),
            cycle: 0,
        }
    }

    /// Starts elsewhere \[rad\] at rest; references and q_d stay.
    #[must_use]
    pub fn from(mut self, start: JointVector<f64>) -> Self {
        self.plant = Plant::new(PlantKind::Ideal, &self.arm, start, self.config.cycle_s, 1);
        self
    }

    /// What the motions ask for now.
    #[must_use]
    pub fn reference(&self) -> Reference<f64> {
        let mut targets = self.origins.clone();
        for (target, motion) in targets.iter_mut().zip(&self.motions) {
            if let Target::Position { x, .. } = target {
                *target = motion.sample(x, self.time());
            }
        }
        Reference::from_targets(&targets, self.posture).expect("as many as levels")
    }

    /// One cycle with the product's law and no contact.
    pub fn step(&mut self) -> Seen<T> {
        let reference = self.reference();
        self.step_towards(&reference, no_contact)
    }

    /// The same with a reference of its own; `external` as in [`Plant::advance`].
    pub fn step_towards(
        &mut self,
        reference: &Reference<f64>,
        external: impl FnMut(f64, &PlantModel, &JointState<f64>) -> JointVector<f64>,
    ) -> Seen<T> {
        self.cycle(reference, external, |controller, state, input| {
            controller.step(state, input.measurement, input.reference)
        })
    }

    /// One cycle with any law in the place of the stage that demands the torque;
    /// `external` as in [`Plant::advance`].
    pub fn step_with(
        &mut self,
        law: impl FnOnce(&Controller<T>, &Input<'_, T>, &mut Data<T>),
        external: impl FnMut(f64, &PlantModel, &JointState<f64>) -> JointVector<f64>,
    ) -> Seen<T> {
        let reference = self.reference();
        self.cycle(&reference, external, |controller, state, input| {
            controller.step_with(state, input.measurement, input.reference, law)
        })
    }

    fn cycle(
        &mut self,
        reference: &Reference<f64>,
        external: impl FnMut(f64, &PlantModel, &JointState<f64>) -> JointVector<f64>,
        step: impl FnOnce(&Controller<T>, &mut State<T>, &Input<'_, T>) -> Step<T>,
    ) -> Seen<T> {
        let (t_s, state) = (self.time(), *self.plant.state());
        let errors = self.errors(reference);
        let input = Input {
            measurement: &Measurement {
                q: state.q.map(T::from_f64),
                dq: state.dq.map(T::from_f64),
                interval_s: T::from_f64(self.config.cycle_s),
            },
            reference: &cast(reference),
        };
        let step = step(&self.controller, &mut self.state, &input);
        self.plant
            .advance(t_s, &step.torque.map(T::to_f64), external);
        self.cycle += 1;
        Seen {
            t_s,
            state,
            errors,
            step,
        }
    }

    fn time(&self) -> f64 {
        f64::from(self.cycle) * self.config.cycle_s
    }

    fn errors(&self, reference: &Reference<f64>) -> Vec<f64> {
        let levels = self.config.tasks.tasks().iter().zip(reference.targets());
        let error = |(task, target): (&Task, &Target<f64>)| {
            let (Tracked::Position(point), Target::Position { x, .. }) = (task.tracked, target)
            else {
                return None;
            };
            let error = x - true_point(&self.plant, point);
            Some(task.axes.select(&error).norm())
        };
        levels.filter_map(error).collect()
    }
}

/// Where a point of the plant is \[m\].
#[must_use]
pub fn true_point(plant: &Plant, point: LinkPoint) -> Vector3<f64> {
    let LinkPoint { link, offset } = point;
    let (model, state) = (plant.model(), plant.state());
    model.point(state, link.number(), &offset.into()).0
}

/// A reference in another precision.
///
/// # Panics
/// Never.
#[must_use]
pub fn cast<T: Real>(reference: &Reference<f64>) -> Reference<T> {
    let targets: Vec<_> = reference.targets().iter().map(Target::cast).collect();
    let posture = reference.posture.map(T::from_f64);
    Reference::from_targets(&targets, posture).expect("as many as before")
}

/// Root of the mean square, of values in metres, in millimetres.
#[must_use]
pub fn rms_mm(values: &[f64]) -> f64 {
    1e3 * (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}
