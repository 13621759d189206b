//! Contacts: forces of the environment on points of the arm.

use cell::scenario::{EquippedArm, Hand, Interval, Push, Scenario};
use controller_core::LinkPoint;
use controller_core::joint::{JointState, JointVector, Vector3};

use crate::plant::PlantModel;

/// All contacts of a run, and what they remember: where a hand took hold.
#[derive(Clone, Debug)]
pub struct Contacts {
    pushes: Vec<PlacedPush>,
    hands: Vec<PlacedHand>,
}

/// A push on a point of an arm.
#[derive(Clone, Debug)]
pub(crate) struct PlacedPush {
    pub push: Push,
    point: LinkPoint,
}

/// A hand on a point of an arm.
#[derive(Clone, Debug)]
struct PlacedHand {
    hand: Hand,
    point: LinkPoint,
    /// Coordinate of the point where the hand took hold \[m\].
    origin: Option<f64>,
}

impl Contacts {
    /// Those of a scenario, before the run.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        let arm = scenario.arm();
        let hand = |hand: &Hand| PlacedHand {
            hand: hand.clone(),
            point: hand.point.resolve(&arm),
            origin: None,
        };
        let pushes = scenario.pushes.iter().cloned();
        Self {
            pushes: pushes.map(|push| PlacedPush::new(push, &arm)).collect(),
            hands: scenario.hands.iter().map(hand).collect(),
        }
    }

    /// No contact at all.
    #[must_use]
    pub fn none() -> Self {
        Self {
            pushes: Vec::new(),
            hands: Vec::new(),
        }
    }

    /// The intervals, in the order of the scenario: pushes, then hands.
    #[must_use]
    pub fn intervals(&self) -> Vec<Interval> {
        let pushes = self.pushes.iter().map(|placed| placed.push.interval());
        pushes
            .chain(self.hands.iter().map(|placed| placed.hand.interval()))
            .collect()
    }

    /// At a cycle instant: hands whose time has come take hold where the point is.
    pub fn take_hold(&mut self, t_s: f64, plant: &PlantModel, state: &JointState<f64>) {
        for placed in &mut self.hands {
            if placed.origin.is_none() && t_s >= placed.hand.from_s {
                let (x, _) = motion(plant, state, &placed.point);
                placed.origin = Some(placed.hand.along(&x));
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
            torque += push.torque(t_s, plant, state);
        }
        for PlacedHand {
            hand,
            point,
            origin,
        } in &self.hands
        {
            let Some(origin) = *origin else { continue };
            let (x, dx) = motion(plant, state, point);
            let size = hand.size(t_s, origin, &x, &dx);
            if size > 0.0 {
                let force = hand.vector(size);
                torque += self::torque(plant, state, point, &force);
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
    point: &LinkPoint,
) -> (Vector3<f64>, Vector3<f64>) {
    let LinkPoint { link, offset } = *point;
    plant.point(state, link.number(), &offset.into())
}

/// Joint torque J^T F \[Nm\] of a force \[N\] on a point.
fn torque(
    plant: &PlantModel,
    state: &JointState<f64>,
    point: &LinkPoint,
    force: &Vector3<f64>,
) -> JointVector<f64> {
    let LinkPoint { link, offset } = *point;
    plant.point_torque(&state.q, link.number(), &offset.into(), force)
}

impl PlacedPush {
    /// On the point of `arm` that the push names.
    pub fn new(push: Push, arm: &EquippedArm) -> Self {
        let point = push.point.resolve(arm);
        Self { push, point }
    }

    /// Joint torque J^T F \[Nm\] at time `t_s` \[s\].
    pub fn torque(
        &self,
        t_s: f64,
        plant: &PlantModel,
        state: &JointState<f64>,
    ) -> JointVector<f64> {
        if !(self.push.from_s..=self.push.to_s).contains(&t_s) {
            return JointVector::zeros();
        }
        let force = self.push.force(t_s);
        if force == Vector3::zeros() {
            return JointVector::zeros();
        }
        torque(plant, state, &self.point, &force)
    }
}
