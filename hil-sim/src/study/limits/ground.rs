//! What an arm can reach, and where it may start.

use controller_core::joint::{DOF, JointState, JointVector, Vector3};
use controller_core::{Axes, LinkPoint};

use super::case::{CaseLevel, is_lwr};
use super::parameters::{self, Draw, REACH_M};
use crate::arm_points::at_rest;
use crate::plant::PlantModel;
use cell::invalid::Invalid;
use cell::scenario::EquippedArm;

/// An arm as the runs see it.
pub struct Ground {
    /// Its tables.
    pub arm: EquippedArm,
    /// Its geometry.
    pub model: PlantModel,
    /// The point that the first level moves.
    pub flange: LinkPoint,
    /// Where the axes of joints 1 and 2 are nearest: origin of frame 1 \[m\].
    pub shoulder: Vector3<f64>,
    /// Axis of joint 1.
    pub axis: Vector3<f64>,
    /// Upwards.
    pub up: Vector3<f64>,
    /// Farthest that the flange comes from the shoulder \[m\].
    pub reach: f64,
    /// A posture in which it is there \[rad\].
    pub straight: JointVector<f64>,
}

/// Rounds over the joints, and places of each that are looked at, in the search for the reach.
const ROUNDS: usize = 4;
const PLACES: usize = 25;

/// A posture is not farther than another by less \[m\].
const NO_FARTHER: f64 = 1e-4;

/// Rounds of parabolas over the joints, and half their width \[rad\].
const PARABOLAS: usize = 200;
const PARABOLA: f64 = 1e-3;

impl Ground {
    /// Of an arm.
    #[must_use]
    pub fn new(arm: &EquippedArm) -> Self {
        let table = &arm.parameters;
        let model = PlantModel::new(table);
        let rest = JointState {
            q: JointVector::zeros(),
            dq: JointVector::zeros(),
        };
        let place = |link, offset| model.point(&rest, link, &Vector3::from(offset)).0;
        let (base, shoulder) = (place(0, [0.0; 3]), place(1, [0.0; 3]));
        let axis = place(0, [0.0, 0.0, 1.0]) - base;
        let up = -Vector3::from(table.gravity).normalize();
        let mut ground = Self {
            flange: table.flange_point(),
            arm: arm.clone(),
            model,
            shoulder,
            axis,
            up,
            reach: 0.0,
            straight: JointVector::zeros(),
        };
        ground.straight = ground.farthest();
        ground.reach = ground.distance(&ground.straight);
        ground
    }

    /// A posture with the farthest flange, from some others by a walk along one joint after the
    /// other in narrowing steps.
    fn farthest(&self) -> JointVector<f64> {
        let mut best = self.of_range(&[0.0; DOF]);
        for start in [0.0, -0.5, 0.5] {
            let mut q = self.of_range(&[start; DOF]);
            let mut width = 1.0;
            for _ in 0..ROUNDS {
                for joint in 1..DOF {
                    q = self.walked(&q, joint, width);
                }
                width *= 0.2;
            }
            if self.distance(&q) > self.distance(&best) + NO_FARTHER {
                best = q;
            }
        }
        self.stretched(best)
    }

    /// The same as exactly as can be: by parabolas along one joint after the other.
    fn stretched(&self, mut q: JointVector<f64>) -> JointVector<f64> {
        for joint in (1..DOF).cycle().take(PARABOLAS * DOF) {
            let [min, max] = self.arm.parameters.links[joint].position_range;
            let at = |by: f64| {
                let mut tried = q;
                tried[joint] += by;
                self.distance(&tried)
            };
            let [before, here, after] = [at(-PARABOLA), at(0.0), at(PARABOLA)];
            let bow = 2.0 * here - before - after;
            // Joints that only turn the straight arm have none.
            if bow > PARABOLA * PARABOLA * 1e-3 {
                let by = PARABOLA * (after - before) / (2.0 * bow);
                q[joint] = (q[joint] + by).clamp(min, max);
            }
        }
        q
    }

    /// The posture with one joint where the flange is farthest.
    fn walked(&self, q: &JointVector<f64>, joint: usize, width: f64) -> JointVector<f64> {
        let [min, max] = self.arm.parameters.links[joint].position_range;
        let mut best = *q;
        for place in 0..PLACES {
            let share = place as f64 / (PLACES - 1) as f64 - 0.5;
            let mut tried = *q;
            tried[joint] = (q[joint] + share * width * (max - min)).clamp(min, max);
            if self.distance(&tried) > self.distance(&best) {
                best = tried;
            }
        }
        best
    }

    fn distance(&self, q: &JointVector<f64>) -> f64 {
        self.from_shoulder(q).norm()
    }

    /// Flange from the shoulder \[m\].
    #[must_use]
    pub fn from_shoulder(&self, q: &JointVector<f64>) -> Vector3<f64> {
        at_rest(&self.model, q, &self.flange) - self.shoulder
    }

    /// Where joints are at these shares of half their ranges from the middle, -1 to 1 \[rad\].
    #[must_use]
    pub fn of_range(&self, shares: &[f64; DOF]) -> JointVector<f64> {
        JointVector::from_fn(|i, _| {
            let [min, max] = self.arm.parameters.links[i].position_range;
            (min + max) / 2.0 + shares[i] * (max - min) / 2.0
        })
    }

    /// A length of [`parameters`] \[m\] for this arm.
    #[must_use]
    pub fn scaled(&self, length: f64) -> f64 {
        length * self.reach / REACH_M
    }

    /// What of `x` is across the axis of joint 1.
    #[must_use]
    pub fn across(&self, x: &Vector3<f64>) -> Vector3<f64> {
        x - self.axis * self.axis.dot(x)
    }

    /// A posture to start from \[rad\].
    pub fn start(&self, draw: &mut Draw) -> JointVector<f64> {
        use parameters::{START_1, START_2, START_3, START_4, START_5, START_6, START_7};
        if is_lwr(&self.arm) {
            let joints = [
                START_1, START_2, START_3, START_4, START_5, START_6, START_7,
            ];
            return joints.map(|joint| draw.angle(&joint)).into();
        }
        // The middle of what an arm with other joints can do.
        self.of_range(&core::array::from_fn(|_| draw.within(-0.5, 0.5)))
    }

    /// The flange as a level.
    ///
    /// # Errors
    /// See [`CaseLevel::position`].
    pub fn flange_level(&self) -> Result<CaseLevel, Invalid> {
        CaseLevel::position(&self.arm, "flange", Axes::XYZ)
    }

    /// The wrist on two axes as a level.
    ///
    /// # Errors
    /// See [`CaseLevel::position`].
    pub fn wrist_level(&self) -> Result<CaseLevel, Invalid> {
        CaseLevel::position(&self.arm, "wrist", Axes::XY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Upper arm, forearm and flange of the LWR in a line.
    #[test]
    fn the_reach_of_a_straight_arm_is_the_sum_of_its_parts() {
        let ground = Ground::new(&EquippedArm::of(&arms::LWR_IV));
        assert!((ground.reach - REACH_M).abs() < 1e-9, "{}", ground.reach);
        assert!((ground.shoulder - Vector3::new(0.0, 0.0, 0.3105)).norm() < 1e-12);
        assert!((ground.axis - ground.up).norm() < 1e-12);
    }

    #[test]
    fn no_random_posture_reaches_farther() {
        let mut draw = Draw::new(1, 0);
        for arm in arms::ALL {
            let ground = Ground::new(&EquippedArm::of(arm));
            for _ in 0..2000 {
                let q = ground.of_range(&core::array::from_fn(|_| draw.within(-1.0, 1.0)));
                // The search ends within a step of 0.2^3 / 24 of a range.
                assert!(ground.distance(&q) < ground.reach + 1e-5, "{}", arm.name);
            }
        }
    }
}
