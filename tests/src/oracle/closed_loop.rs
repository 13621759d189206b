//! A controller of either precision around the ideal plant.

use controller_core::config::ControllerConfig;
use controller_core::controller::{Controller, ControllerState, Step};
use controller_core::joint::{JointState, JointVector, Vector3};
use controller_core::law::{Cycle, TorqueDemand};
use controller_core::measurement::{Measurement, Reference};
use controller_core::model::{ArmModel, ArmParameters, LWR_IV};
use controller_core::real::Real;
use controller_core::task::{TaskKind, TaskReference};
use controller_core::trajectory::Trajectory;
use hil_sim::plant::{Plant, PlantKind, PlantModel};

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
        plane: controller_core::trajectory::Plane::Yz,
        radius_m,
        period_s,
        growth_s: 2.0,
    }
}

/// Controller, plant and references.
#[derive(Clone, Debug)]
pub struct ClosedLoop<T: Real> {
    /// Of the core.
    pub controller: Controller<T>,
    /// Of the core.
    pub state: ControllerState<T>,
    /// The ideal arm.
    pub plant: Plant,
    /// q_d \[rad\].
    pub posture: JointVector<f64>,
    config: ControllerConfig<T>,
    motions: Vec<Trajectory<f64>>,
    origins: Vec<Vector3<f64>>,
    cycle_s: f64,
    cycle: u32,
}

/// One cycle of a closed loop.
#[derive(Clone, Debug)]
pub struct Seen<T: Real> {
    /// Time of the measurement \[s\].
    pub t_s: f64,
    /// True state at that time.
    pub state: JointState<f64>,
    /// |x_d - x| per level \[m\], over its axes; position levels only.
    pub errors: Vec<f64>,
    /// Answer of the controller.
    pub step: Step<T>,
}

impl<T: Real> ClosedLoop<T> {
    /// At rest in `start` \[rad\], which is q_d too; one motion per level about
    /// where its point is then.
    #[must_use]
    pub fn new(
        config: &ControllerConfig<T>,
        start: JointVector<f64>,
        motions: &[Trajectory<f64>],
    ) -> Self {
        Self::with_arm(&LWR_IV, config, start, motions)
    }

    /// The same with another arm.
    #[must_use]
    pub fn with_arm(
        arm: &ArmParameters,
        config: &ControllerConfig<T>,
        start: JointVector<f64>,
        motions: &[Trajectory<f64>],
    ) -> Self {
        let model = ArmModel::new(arm).expect("a valid arm");
        let controller = Controller::new(&model, config).expect("a valid configuration");
        let cycle_s = config.cycle_s.to_f64();
        let plant = Plant::new(PlantKind::Ideal, arm, start, cycle_s, 1);
        let origins = config.tasks.iter().map(|task| {
            let point = task.point.cast::<f64>();
            plant
                .model()
                .point(plant.state(), point.link, &point.offset)
                .0
        });
        Self {
            controller,
            state: ControllerState::new(),
            origins: origins.collect(),
            plant,
            posture: start,
            config: config.clone(),
            motions: motions.to_vec(),
            cycle_s,
            cycle: 0,
        }
    }

    /// Starts elsewhere \[rad\] at rest; references and q_d stay.
    #[must_use]
    pub fn from(mut self, start: JointVector<f64>) -> Self {
        let arm = self.controller.model().parameters();
        self.plant = Plant::new(PlantKind::Ideal, arm, start, self.cycle_s, 1);
        self
    }

    /// One cycle with the product's law and no contact.
    pub fn step(&mut self) -> Seen<T> {
        self.step_with(TorqueDemand::hierarchical, |_, _, _| JointVector::zeros())
    }

    /// One cycle with any law; `external` as in [`Plant::advance`].
    pub fn step_with(
        &mut self,
        law: impl FnOnce(&Cycle<'_, T>) -> TorqueDemand<T>,
        external: impl FnMut(f64, &PlantModel, &JointState<f64>) -> JointVector<f64>,
    ) -> Seen<T> {
        let t_s = f64::from(self.cycle) * self.cycle_s;
        let state = *self.plant.state();
        let references: Vec<_> = (self.motions.iter().zip(&self.origins))
            .map(|(motion, origin)| motion.sample(origin, t_s))
            .collect();
        let levels = self.config.tasks.iter().zip(&references);
        let errors = levels
            .filter(|(task, _)| task.kind == TaskKind::Position)
            .map(|(task, reference)| {
                let point = task.point.cast::<f64>();
                let model = self.plant.model();
                let error = reference.x - model.point(&state, point.link, &point.offset).0;
                let axes = (0..3).filter(|&axis| task.axes.xyz[axis]);
                axes.map(|axis| error[axis].powi(2)).sum::<f64>().sqrt()
            })
            .collect();
        let reference = Reference {
            tasks: references.iter().map(cast).collect(),
            posture: self.posture.map(T::from_f64),
        };
        let measurement = Measurement {
            q: state.q.map(T::from_f64),
            dq: state.dq.map(T::from_f64),
            interval_s: T::from_f64(self.cycle_s),
        };
        let step = self
            .controller
            .step_with(&mut self.state, &measurement, &reference, law);
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
}

/// A reference in another precision.
#[must_use]
pub fn cast<T: Real>(reference: &TaskReference<f64>) -> TaskReference<T> {
    TaskReference {
        x: reference.x.map(T::from_f64),
        orientation: reference.orientation.map(T::from_f64),
        dx: reference.dx.map(T::from_f64),
        ddx: reference.ddx.map(T::from_f64),
    }
}

/// Root of the mean square, of values in metres, in millimetres.
#[must_use]
pub fn rms_mm(values: &[f64]) -> f64 {
    1e3 * (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}
