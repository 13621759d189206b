//! Joint springs and dampers of the robot itself: an impedance controller that
//! runs inside the drives, far faster than the control cycle.
//!
//! It gives the motor torque K (target - q) - D dq. Stiff springs on light joints
//! have time constants below any step, so spring and damper are taken linearly
//! implicitly, as friction is: the spring at the position that the step reaches,
//! q + h dq+, the damper at the speed that it reaches. This puts h D + h^2 K on
//! the diagonal of M and is stable for every K, D >= 0: with w = h^2 K / M, the
//! step of one joint has the determinant (2 + w) / (2 + 2 w) < 1 and both its
//! eigenvalues inside the unit circle.

use controller_core::joint::{JointMatrix, JointState, JointVector, zeros};

use super::friction::Friction;

/// A spring and a damper per joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impedance {
    /// K \[Nm/rad\], 0 or more.
    pub stiffness: JointVector<f64>,
    /// D \[Nms/rad\], 0 or more; damps the absolute speed.
    pub damping: JointVector<f64>,
    /// Position in which the springs are at rest at the start of a cycle \[rad\].
    pub target: JointVector<f64>,
    /// Speed at which that position moves during the cycle \[rad/s\]. The damper
    /// does not know of it.
    pub rate: JointVector<f64>,
}

impl Impedance {
    /// No spring and no damper.
    pub const NONE: Self = Self {
        stiffness: zeros(),
        damping: zeros(),
        target: zeros(),
        rate: zeros(),
    };

    /// Springs of `stiffness` \[Nm/rad\] to a position that moves evenly from `from` to
    /// `to` \[rad\] during a cycle, with D_i = 2 d_i sqrt(K_i M_ii) for the damping
    /// ratios d = `ratio` and the mass matrix M \[kg m2\].
    #[must_use]
    pub fn moving(
        stiffness: &JointVector<f64>,
        ratio: &JointVector<f64>,
        mass_matrix: &JointMatrix<f64>,
        [from, to]: [&JointVector<f64>; 2],
        cycle_s: f64,
    ) -> Self {
        Self {
            stiffness: *stiffness,
            damping: JointVector::from_fn(|i, _| {
                2.0 * ratio[i] * (stiffness[i] * mass_matrix[(i, i)]).sqrt()
            }),
            target: *from,
            rate: (to - from) / cycle_s,
        }
    }

    /// The same, `time_s` \[s\] later.
    #[must_use]
    pub fn after(&self, time_s: f64) -> Self {
        Self {
            target: self.target + self.rate * time_s,
            ..*self
        }
    }

    /// Whether it does nothing, wherever the arm is.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.stiffness.amax() == 0.0 && self.damping.amax() == 0.0
    }

    /// Torque on the motors \[Nm\], positive along +q, at `state`.
    #[must_use]
    pub fn torque(&self, state: &JointState<f64>) -> JointVector<f64> {
        self.stiffness.component_mul(&(self.target - state.q))
            - self.damping.component_mul(&state.dq)
    }

    /// `friction` and this impedance as one resistance of the joints, for a step
    /// of `h` \[s\] that starts at `state`: torque against the motion, and by how much
    /// it grows with the speed after the step.
    pub(super) fn resist(&self, friction: Friction, state: &JointState<f64>, h: f64) -> Friction {
        let reached = JointState {
            q: state.q + state.dq * h,
            dq: state.dq,
        };
        Friction {
            torque: friction.torque - self.torque(&reached),
            slope: friction.slope + self.damping + self.stiffness * h,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Plant, PlantKind, PlantOptions};
    use super::*;
    use arms::LWR_IV;

    const POSTURE: [f64; 7] = [0.2, 0.6, -0.3, -1.4, 0.4, 0.9, 0.1];
    const NONE: JointVector<f64> = zeros();

    /// Every plant there is: kind, stiction, elasticity.
    fn plants() -> impl Iterator<Item = Plant> {
        let kinds = [
            (PlantKind::Ideal, false, false),
            (PlantKind::Realistic, false, false),
            (PlantKind::Realistic, true, false),
            (PlantKind::Realistic, false, true),
            (PlantKind::Realistic, true, true),
        ];
        kinds.into_iter().map(|(kind, stiction, elasticity)| {
            let options = PlantOptions {
                stiction,
                elasticity,
                ..PlantOptions::default()
            };
            Plant::with_options(kind, &LWR_IV, POSTURE.into(), 0.002, 3, options)
        })
    }

    fn spring(stiffness: f64, damping: f64) -> Impedance {
        Impedance {
            stiffness: JointVector::repeat(stiffness),
            damping: JointVector::repeat(damping),
            target: POSTURE.into(),
            rate: NONE,
        }
    }

    #[test]
    fn no_impedance_changes_no_bit() {
        for plant in plants() {
            let (mut with, mut without) = (plant.clone(), plant);
            let torque = JointVector::from([1.0, -20.0, 2.0, 9.0, 0.3, -0.2, 0.01]);
            for cycle in 0..200 {
                let t = f64::from(cycle) * 0.002;
                let push = |_: f64, _: &_, _: &_| JointVector::repeat(0.1);
                with.advance_with(t, &torque, &Impedance::NONE, push);
                without.advance(t, &torque, push);
            }
            assert_eq!(with.state(), without.state());
        }
    }

    #[test]
    fn static_deflection_is_load_over_stiffness() {
        // The ideal plant alone has no friction that keeps a part of the load.
        let mut plant = plants().next().expect("the ideal one");
        let load = JointVector::from([3.0, -4.0, 2.0, 5.0, 1.0, -1.0, 0.3]);
        let impedance = spring(800.0, 20.0);
        for cycle in 0..3000 {
            let weight = plant.model().gravity_torque(&plant.state().q);
            let t = f64::from(cycle) * 0.002;
            plant.advance_with(t, &weight, &impedance, |_, _, _| load);
        }
        let deflection = plant.state().q - JointVector::from(POSTURE);
        // Gravity is held per cycle and settles with the arm.
        assert!((deflection - load / 800.0).amax() < 1e-9, "{deflection}");
        assert!((impedance.torque(plant.state()) + load).amax() < 1e-6);
    }

    #[test]
    fn joints_follow_a_moving_target_within_the_cycle() {
        let mut plant = plants().next().expect("the ideal one");
        let mut impedance = spring(20_000.0, 0.0);
        // Critical for M = 1; for the light joints far beyond.
        impedance.damping.fill(2.0 * 20_000.0_f64.sqrt());
        impedance.rate.fill(0.2);
        for cycle in 0..500 {
            let weight = plant.model().gravity_torque(&plant.state().q);
            plant.advance_with(f64::from(cycle) * 0.002, &weight, &impedance, |_, _, _| {
                NONE
            });
            impedance = impedance.after(0.002);
        }
        let off = plant.state().dq - impedance.rate;
        assert!(off.amax() < 2e-3, "{off}");
    }

    #[test]
    fn stiff_springs_are_stable_on_every_joint_of_every_plant() {
        for mut plant in plants() {
            let impedance = spring(2000.0, 1.0);
            let mut kick = JointVector::from([20.0, 20.0, 10.0, 10.0, 3.0, 2.0, 0.5]);
            let (mut most, mut last) = (0.0f64, 0.0f64);
            for cycle in 0..2000 {
                let weight = plant.model().gravity_torque(&plant.state().q);
                let t = f64::from(cycle) * 0.002;
                plant.advance_with(t, &(weight + kick), &impedance, |_, _, _| NONE);
                if cycle == 50 {
                    kick = NONE;
                }
                let off = (plant.state().q - JointVector::from(POSTURE)).amax();
                most = most.max(off);
                if cycle > 1900 {
                    last = last.max(off);
                }
            }
            // 20 Nm on 2000 Nm/rad, overshooting to twice that and coupled. The
            // heaviest joint loses half of a swing in 1.4 M / D = 3 s.
            assert!(most < 0.05 && last < 0.5 * most, "{most} {last}");
        }
    }
}
