//! Contacts: forces of the environment on points of the arm.

use cell::scenario::{Hand, Interval, PointSpec, Push, Scenario};
use controller_core::LinkPoint;
use controller_core::joint::{JointState, JointVector, Vector3};

use crate::plant::PlantModel;

/// All contacts of a run, and what they remember: where a hand took hold.
#[derive(Clone, Debug)]
pub struct Contacts {
    pushes: Vec<Push>,
    hands: Vec<(Hand, Option<f64>)>,
}

impl Contacts {
    /// Before the run.
    #[must_use]
    pub fn new(pushes: &[Push], hands: &[Hand]) -> Self {
        Self {
            pushes: pushes.to_vec(),
            hands: hands.iter().map(|hand| (hand.clone(), None)).collect(),
        }
    }

    /// Those of a scenario, before the run.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        Self::new(&scenario.pushes, &scenario.hands)
    }

    /// No contact at all.
    #[must_use]
    pub fn none() -> Self {
        Self::new(&[], &[])
    }

    /// The intervals, in the order of the scenario: pushes, then hands.
    #[must_use]
    pub fn intervals(&self) -> Vec<Interval> {
        let pushes = self.pushes.iter().map(Push::interval);
        pushes
            .chain(self.hands.iter().map(|(hand, _)| hand.interval()))
            .collect()
    }

    /// At a cycle instant: hands whose time has come take hold where the point is.
    pub fn take_hold(&mut self, t_s: f64, plant: &PlantModel, state: &JointState<f64>) {
        for (hand, origin) in &mut self.hands {
            if origin.is_none() && t_s >= hand.from_s {
                let (x, _) = motion(plant, state, &hand.point);
                *origin = Some(hand.along(&x));
            }
        }
    }

    /// Joint torque of all contacts \[Nm\]: the sum of J^T F, which is -tau_ext of
    /// (6); and the largest force of a hand \[N\].
    #[must_use]
    pub fn joint_torque(
        &self,
        t_s: f64,
        plant: &PlantModel,
        state: &JointState<f64>,
    ) -> (JointVector<f64>, f64) {
        let mut torque = JointVector::zeros();
        let mut hand_force = 0.0f64;
        for push in &self.pushes {
            torque += push_torque(push, t_s, plant, state);
        }
        for (hand, origin) in &self.hands {
            let Some(origin) = *origin else { continue };
            let (x, dx) = motion(plant, state, &hand.point);
            let size = hand.size(t_s, origin, &x, &dx);
            if size > 0.0 {
                let force = hand.vector(size);
                torque += self::torque(plant, state, &hand.point, &force);
                hand_force = hand_force.max(size);
            }
        }
        (torque, hand_force)
    }
}

/// Position \[m\] and velocity \[m/s\] of a point.
fn motion(
    plant: &PlantModel,
    state: &JointState<f64>,
    point: &PointSpec,
) -> (Vector3<f64>, Vector3<f64>) {
    let LinkPoint { link, offset } = point.resolve();
    plant.point(state, link.number(), &offset.into())
}

/// Joint torque J^T F \[Nm\] of a force \[N\] on a point.
fn torque(
    plant: &PlantModel,
    state: &JointState<f64>,
    point: &PointSpec,
    force: &Vector3<f64>,
) -> JointVector<f64> {
    let LinkPoint { link, offset } = point.resolve();
    plant.point_torque(&state.q, link.number(), &offset.into(), force)
}

/// Joint torque J^T F \[Nm\] of a push at time `t_s` \[s\].
#[must_use]
pub fn push_torque(
    push: &Push,
    t_s: f64,
    plant: &PlantModel,
    state: &JointState<f64>,
) -> JointVector<f64> {
    let force = push.force(t_s);
    if force == Vector3::zeros() {
        return JointVector::zeros();
    }
    torque(plant, state, &push.point, &force)
}
