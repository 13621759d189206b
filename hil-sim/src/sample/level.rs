//! What a level's point or frame really does, seen by the plant.

use controller_core::joint::{JointState, JointVector, Vector3};
use controller_core::task::orientation;
use controller_core::{Axes, LinkFrame, LinkPoint, Reference, Target};

use crate::arm_points;
use crate::plant::PlantModel;
use record::run::LevelSample;

use cell::scenario::{LevelSpec, Scenario, TaskSpec};

/// What is looked at of a scenario's levels: their points and axes.
pub(crate) struct LevelProbes(pub Vec<LevelProbe>);

pub(crate) struct LevelProbe {
    task: TaskSpec,
    point: LinkPoint,
    /// Turns with the point.
    frame: LinkFrame,
    axes: Axes,
}

impl LevelProbes {
    pub fn new(scenario: &Scenario) -> Self {
        let arm = scenario.arm();
        let probe = |level: &LevelSpec| LevelProbe {
            task: level.task,
            point: level.point.resolve(&arm),
            frame: level.point.frame(&arm),
            axes: Axes::from_name(&level.axes).unwrap_or(Axes::XYZ),
        };
        Self(scenario.levels.iter().map(probe).collect())
    }

    /// Every level at the plant's true state.
    pub fn levels(
        &self,
        plant: &PlantModel,
        truth: &JointState<f64>,
        reference: &Reference<f64>,
    ) -> Vec<LevelSample> {
        let levels = self.0.iter().zip(reference.targets());
        levels
            .map(|(probe, target)| probe.sample(plant, truth, target))
            .collect()
    }
}

impl LevelProbe {
    /// The level at the plant's true state. A level that holds has no desired
    /// coordinates but its own.
    fn sample(
        &self,
        plant: &PlantModel,
        truth: &JointState<f64>,
        target: &Target<f64>,
    ) -> LevelSample {
        let (x, _) = self.point(plant, truth);
        let mut shown = LevelSample {
            desired_point: x.into(),
            actual_point: x.into(),
            leak: f64::NAN,
            share: f64::NAN,
            disturbance: f64::NAN,
            ..LevelSample::default()
        };
        if self.task == TaskSpec::Orientation {
            let actual = arm_points::orientation(plant, &truth.q, &self.frame);
            let desired = match target {
                Target::Orientation { q, .. } => *q,
                _ => actual,
            };
            let chord = orientation::chord(&desired, &actual);
            shown.desired = desired.as_slice().to_vec();
            shown.actual = actual.as_slice().to_vec();
            shown.error = self.norm(&orientation::rotation_vector(&chord));
            return shown;
        }
        let desired = match target {
            Target::Position { x, .. } => *x,
            _ => x,
        };
        shown.desired = self.pick(&desired).collect();
        shown.actual = self.pick(&x).collect();
        shown.error = self.norm(&(desired - x));
        shown.desired_point = desired.into();
        shown
    }

    /// Position and velocity of the point, or of the link's frame.
    fn point(&self, plant: &PlantModel, state: &JointState<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let LinkPoint { link, offset } = self.point;
        plant.point(state, link.number(), &offset.into())
    }

    fn pick<'a>(&'a self, v: &'a Vector3<f64>) -> impl Iterator<Item = f64> + 'a {
        (0..3)
            .filter(|&axis| self.axes.contains(axis))
            .map(|axis| v[axis])
    }

    fn norm(&self, v: &Vector3<f64>) -> f64 {
        self.pick(v).map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Norm of J M^-1 below \[m/s2\]: what its acceleration loses when a torque `below` is taken
    /// off the arm's, given the joint accelerations `caused` = M^-1 below \[rad/s2\] of the plant.
    pub fn leak(
        &self,
        plant: &PlantModel,
        truth: &JointState<f64>,
        caused: JointVector<f64>,
    ) -> f64 {
        // J caused is the velocity of the point for joint speeds `caused`.
        let moving = JointState {
            q: truth.q,
            dq: caused,
        };
        match self.task {
            TaskSpec::Position => {
                let (_, acceleration) = self.point(plant, &moving);
                self.norm(&acceleration)
            }
            TaskSpec::Orientation => self.norm(&arm_points::angular_velocity(
                plant,
                &moving,
                self.point.link.number(),
            )),
        }
    }
}
