//! Friction that holds: Coulomb friction as a set-valued law.
//!
//! A joint that slides feels F_c against its motion. A joint at rest feels
//! whatever torque keeps it there, up to the break-away level F_s > F_c. So the
//! friction of a step is not a function of the speed before it; it is found
//! together with the speed after it:
//!
//! ```text
//! v+ = v_free - W f,   |f_i| <= F_i,
//! v+_i > 0: f_i = F_i,   v+_i < 0: f_i = -F_i,   v+_i = 0: f_i in between
//! ```
//!
//! with W the speed gained over the step per torque, and F_i = F_s for joints
//! that were at rest when the step began, F_c for the others. W is symmetric
//! and positive definite, so there is exactly one such f: the minimum of a
//! convex function in a box, which projected Gauss-Seidel sweeps descend to.
//!
//! Viscous friction is linear and stays outside, on the diagonal of the inertia.

use controller_core::joint::{DOF, JointMatrix, JointVector};

use super::friction::{Friction, FrictionLaw};

/// Break-away level over sliding level, F_s / F_c. Chosen: it stands for no
/// particular drive.
pub const BREAK_AWAY: f64 = 1.25;

/// Gauss-Seidel sweeps per step; a fixed number, so that a run does not depend
/// on a stopping rule. The previous step's friction is the start.
pub const SWEEPS: usize = 60;

/// Set-valued friction and what it remembers from step to step.
#[derive(Clone, Debug)]
pub(super) struct Stiction {
    law: FrictionLaw,
    /// Friction torque of the last step \[Nm\], of the sign of the motion that it
    /// opposes.
    pub torque: JointVector<f64>,
    /// How far `torque` was from the solution: the largest correction \[Nm\] that
    /// one more sweep would make if it took all joints at once.
    pub residual: f64,
}

/// What joints have besides friction that grows with the speed.
#[derive(Clone, Debug)]
pub(super) enum DryFriction {
    /// They turn freely, without any friction.
    None,
    /// Friction that passes smoothly through zero speed.
    Smooth(FrictionLaw),
    /// Friction that holds.
    Sticking(Stiction),
}

impl DryFriction {
    /// The friction that is a function of the speed \[rad/s\]: where it holds, the
    /// viscous part alone.
    pub fn explicit(&self, speed: &JointVector<f64>) -> Friction {
        match self {
            Self::None => Friction::NONE,
            Self::Smooth(law) => law.at(speed),
            Self::Sticking(Stiction { law, .. }) => {
                let slope = law.viscous;
                Friction {
                    torque: slope.component_mul(speed),
                    slope,
                }
            }
        }
    }
}

impl Stiction {
    pub fn new(law: FrictionLaw) -> Self {
        Self {
            law,
            torque: JointVector::zeros(),
            residual: 0.0,
        }
    }

    /// Speeds \[rad/s\] after a step that starts with the speeds `before` and
    /// without dry friction would end with `free`; `response` is W
    /// \[rad/s per Nm\]. Joints that stick come out with exactly 0.
    pub fn solve(
        &mut self,
        response: &JointMatrix<f64>,
        before: &JointVector<f64>,
        free: &JointVector<f64>,
    ) -> JointVector<f64> {
        let bound = JointVector::from_fn(|i, _| {
            self.law.coulomb[i] * if before[i] == 0.0 { BREAK_AWAY } else { 1.0 }
        });
        let mut torque = self.torque;
        for _ in 0..SWEEPS {
            for i in 0..DOF {
                let speed = free[i] - response.column(i).dot(&torque);
                torque[i] = (torque[i] + speed / response[(i, i)]).clamp(-bound[i], bound[i]);
            }
        }
        let mut speed = free - response * torque;
        self.residual = 0.0;
        for i in 0..DOF {
            let wanted = (torque[i] + speed[i] / response[(i, i)]).clamp(-bound[i], bound[i]);
            self.residual = self.residual.max((wanted - torque[i]).abs());
            // Friction inside its bounds means rest; what is left of the speed
            // is the error of the sweeps.
            if torque[i].abs() < bound[i] {
                speed[i] = 0.0;
            }
        }
        self.torque = torque;
        speed
    }
}

#[cfg(test)]
mod tests {
    use super::super::noise::{Rng, stream};
    use super::*;
    use arms::LWR_IV;

    #[test]
    fn friction_obeys_its_law() {
        let mut rng = Rng::new(3, stream::TORQUE);
        let law = FrictionLaw::of(&LWR_IV);
        for _ in 0..1000 {
            let mut random = || 2.0 * rng.uniform() - 1.0;
            let root = JointMatrix::from_fn(|_, _| random());
            let response = root * root.transpose() + JointMatrix::identity();
            let free = JointVector::from_fn(|_, _| 3.0 * random());
            // Every other joint starts from rest.
            let before = JointVector::from_fn(|i, _| (i % 2) as f64);
            let mut stiction = Stiction::new(law);
            let speed = stiction.solve(&response, &before, &free);
            // Well-conditioned: the sweeps converge to rounding.
            assert!(stiction.residual < 1e-9, "{}", stiction.residual);
            assert!((free - response * stiction.torque - speed).amax() < 1e-8);
            for i in 0..DOF {
                let bound = law.coulomb[i] * if i % 2 == 0 { BREAK_AWAY } else { 1.0 };
                let torque = stiction.torque[i];
                if speed[i] == 0.0 {
                    assert!(torque.abs() < bound);
                } else {
                    assert_eq!(torque, bound * speed[i].signum());
                }
            }
        }
    }
}
