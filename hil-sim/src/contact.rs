//! Contacts: forces of the environment on points of the arm.

mod hand;
mod push;

use controller_core::joint::{JointState, JointVector, Vector3};

use crate::invalid::{Invalid, in_range};
use crate::plant::PlantModel;

pub use hand::{Direction, Hand};
pub use push::Push;

/// How long after a contact its effect still counts as inside \[s\].
pub const AFTERMATH_S: f64 = 0.3;

/// Length of the stretch before the force goes down whose mean error is the plateau \[s\].
pub const PLATEAU_S: f64 = 0.2;

/// When a contact acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Start \[s\].
    pub from_s: f64,
    /// End \[s\].
    pub to_s: f64,
    /// Time in which the force goes up and in which it goes down \[s\].
    pub ramp_s: f64,
}

impl Interval {
    /// Whether `t_s` belongs to the contact or its aftermath.
    #[must_use]
    pub fn inside(&self, t_s: f64) -> bool {
        t_s >= self.from_s && t_s <= self.to_s + AFTERMATH_S
    }

    /// Whether `t_s` belongs to the plateau.
    #[must_use]
    pub fn plateau(&self, t_s: f64) -> bool {
        let end = self.to_s - self.ramp_s;
        t_s >= end - PLATEAU_S && t_s <= end
    }
}

/// Checks start and end, gives the length \[s\].
fn validate_times(from_s: f64, to_s: f64) -> Result<f64, Invalid> {
    in_range("from_s", from_s, 0.0, 3600.0)?;
    in_range("to_s", to_s, 0.0, 3600.0)?;
    if to_s <= from_s {
        return Err(Invalid::new(
            "to_s",
            to_s,
            format_args!("above from_s = {from_s}"),
        ));
    }
    Ok(to_s - from_s)
}

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

    /// Whether hands take part.
    #[must_use]
    pub fn has_hands(&self) -> bool {
        !self.hands.is_empty()
    }

    /// At a cycle instant: hands whose time has come take hold where the point is.
    pub fn take_hold(&mut self, t_s: f64, plant: &PlantModel, state: &JointState<f64>) {
        for (hand, origin) in &mut self.hands {
            if origin.is_none() && t_s >= hand.from_s {
                let point = hand.point.resolve();
                let (x, _) = plant.point(state, point.link.number(), &point.offset.into());
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
            let force = push.force(t_s);
            if force != Vector3::zeros() {
                let point = push.point.resolve();
                torque +=
                    plant.point_torque(&state.q, point.link.number(), &point.offset.into(), &force);
            }
        }
        for (hand, origin) in &self.hands {
            let Some(origin) = *origin else { continue };
            let point = hand.point.resolve();
            let (x, dx) = plant.point(state, point.link.number(), &point.offset.into());
            let size = hand.size(t_s, origin, &x, &dx);
            if size > 0.0 {
                let force = hand.vector(size);
                torque +=
                    plant.point_torque(&state.q, point.link.number(), &point.offset.into(), &force);
                hand_force = hand_force.max(size);
            }
        }
        (torque, hand_force)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_has_a_plateau_and_an_aftermath() {
        let interval = Interval {
            from_s: 3.0,
            to_s: 6.0,
            ramp_s: 0.3,
        };
        assert!(interval.plateau(5.6) && !interval.plateau(5.4) && !interval.plateau(5.8));
        assert!(interval.inside(6.2) && !interval.inside(6.4) && !interval.inside(2.9));
    }
}
