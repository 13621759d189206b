//! Elastic joints: a spring and a damper between each motor and its link.
//!
//! ```text
//! motor:  B ddtheta         = tau - F(dtheta) - s
//! link:   M ddq + C dq + g  = s + J^T F_contact
//! spring: s                 = K (theta - q) + D (dtheta - dq)
//! ```
//!
//! theta is the motor's angle behind the gear, tau the commanded torque plus
//! noise, F the friction, which sits in motor and gear. B is what the drive's
//! own torque loop leaves of the motor's inertia; that loop is much faster than
//! the control cycle and has no other part in the model.
//!
//! The arm measures q: an arm with motor encoders and joint torque sensors
//! knows s and can correct the motor's angle by the spring's deflection. This is
//! taken to be exact, up to the encoder step.
//!
//! All values but rotor inertias of a table are chosen ([`Actuators`]): springs stiff enough
//! to hold the arm within a few milliradians, motors and dampers such that the resonances lie
//! far above the bandwidth of the control loop. They describe no particular drive.

use controller_core::joint::{JointState, JointVector};

use super::actuators::Actuators;
use super::friction::Friction;

/// Motors and springs.
#[derive(Clone, Debug)]
pub(super) struct Elastic {
    /// K \[Nm/rad\].
    pub stiffness: JointVector<f64>,
    /// D \[Nms/rad\].
    pub damping: JointVector<f64>,
    /// B \[kg m2\].
    pub inertia: JointVector<f64>,
    /// theta \[rad\] and dtheta \[rad/s\].
    pub motor: JointState<f64>,
}

/// One step of the motors, solved for what the links do not know yet: the link
/// feels `torque - armature ddq`, the motor's speed follows from the link's.
pub(super) struct Elimination {
    /// Torque on the link that keeps its speed \[Nm\].
    pub torque: JointVector<f64>,
    /// What the link feels of the motor's inertia \[kg m2\].
    pub armature: JointVector<f64>,
    /// Speed of the motor per speed of the link; also torque on the link per
    /// torque on the motor.
    pub share: JointVector<f64>,
    /// Speed of the motor per torque on it, with the link held \[rad/s per Nm\].
    pub mobility: JointVector<f64>,
    /// Speed of the motor with the link at rest \[rad/s\].
    pub offset: JointVector<f64>,
}

impl Elimination {
    /// Speed of the motors \[rad/s\] when the links move with `dq` \[rad/s\].
    pub fn motor_speed(&self, dq: &JointVector<f64>) -> JointVector<f64> {
        self.offset + self.share.component_mul(dq)
    }
}

impl Elastic {
    /// Motors at rest, springs drawn so that they carry `load` \[Nm\] at the link
    /// posture `q` \[rad\].
    pub fn new(drives: &Actuators, q: &JointVector<f64>, load: &JointVector<f64>) -> Self {
        Self {
            stiffness: drives.stiffness,
            damping: drives.damping,
            inertia: drives.motor_inertia,
            motor: JointState {
                q: q + load.component_div(&drives.stiffness),
                dq: JointVector::zeros(),
            },
        }
    }

    /// The motors' part of a step of `h` \[s\], under the torque `torque` \[Nm\].
    ///
    /// Spring and damper act with the mean deflection and mean speed of the
    /// step, which depend on the speeds after it. This midpoint rule neither
    /// feeds nor damps an oscillation, however stiff the spring: what damping
    /// there is, is D's. With u = dtheta - dq and the deflection x before the
    /// step, and + for after it,
    ///
    /// s = K x + k (u + u+), k = h K / 4 + D / 2.
    pub fn eliminate(
        &self,
        link: &JointState<f64>,
        h: f64,
        torque: &JointVector<f64>,
        friction: &Friction,
    ) -> Elimination {
        let k = (self.stiffness * (0.5 * h) + self.damping) * 0.5;
        // Torque that one rad/s more after the step takes.
        let inertia = self.inertia / h + friction.slope;
        let mobility = (inertia + k).map(|sum| 1.0 / sum);
        let share = k.component_mul(&mobility);
        // Spring torque if both speeds after the step were zero.
        let known = self.stiffness.component_mul(&(self.motor.q - link.q))
            + k.component_mul(&(self.motor.dq - link.dq));
        let drive = inertia.component_mul(&self.motor.dq) + torque - friction.torque;
        let coupling = share.component_mul(&inertia);
        Elimination {
            torque: known + share.component_mul(&(drive - known))
                - coupling.component_mul(&link.dq),
            armature: coupling * h,
            share,
            mobility,
            offset: mobility.component_mul(&(drive - known)),
        }
    }

    /// Ends a step of `h` \[s\] with the motors at `dtheta` \[rad/s\].
    pub fn accept(&mut self, h: f64, dtheta: JointVector<f64>) {
        self.motor.q += (self.motor.dq + dtheta) * (0.5 * h);
        self.motor.dq = dtheta;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arms::LWR_IV;
    use controller_core::joint::DOF;

    /// Link and motor of every joint, free in space: the motor's swing against
    /// the link after `time` \[s\] in steps of about `h` \[s\], of a start with 1 rad/s.
    fn swing(link: &JointVector<f64>, time: &JointVector<f64>, h: f64) -> JointVector<f64> {
        let none = JointVector::zeros();
        let frictionless = Friction {
            torque: none,
            slope: none,
        };
        JointVector::from_fn(|joint, _| {
            let mut elastic = Elastic::new(&Actuators::of(&LWR_IV), &none, &none);
            elastic.motor.dq.fill(1.0);
            let mut state = JointState { q: none, dq: none };
            let steps = (time[joint] / h).ceil();
            let h = time[joint] / steps;
            for _ in 0..steps as u32 {
                let motors = elastic.eliminate(&state, h, &none, &frictionless);
                let ddq = motors.torque.component_div(&(link + motors.armature));
                let dq = state.dq + ddq * h;
                state.q += (state.dq + dq) * (0.5 * h);
                state.dq = dq;
                elastic.accept(h, motors.motor_speed(&dq));
            }
            elastic.motor.dq[joint] - state.dq[joint]
        })
    }

    #[test]
    fn a_spring_swings_and_settles_as_in_closed_form() {
        let link = JointVector::from([1.0, 1.2, 0.3, 0.3, 0.02, 0.01, 0.001]);
        let Actuators {
            stiffness: k,
            damping: d,
            motor_inertia,
            ..
        } = Actuators::of(&LWR_IV);
        // Two masses swing against each other like one of their reduced mass.
        let reduced = link.map(|m| 1.0 / m) + motor_inertia.map(|b| 1.0 / b);
        let decay = d.component_mul(&reduced) * 0.5;
        let rate = (k.component_mul(&reduced) - decay.component_mul(&decay)).map(f64::sqrt);
        // Whole periods: the speed is at its start value, less the decay.
        let time = rate.map(|rate| 3.0 * core::f64::consts::TAU / rate);
        let expected = JointVector::from_fn(|i, _| libm::exp(-decay[i] * time[i]));
        let error = |h| (swing(&link, &time, h) - expected).amax();
        let (coarse, fine) = (error(4e-5), error(2e-5));
        // Second order: a quarter of the error with half the step.
        assert!(fine < 1e-3, "{fine:e}");
        assert!((3.5..4.5).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
        // All swings are seen to decay, none dies out within a period.
        for i in 0..DOF {
            assert!((0.01..0.5).contains(&expected[i]), "{expected}");
        }
    }
}
