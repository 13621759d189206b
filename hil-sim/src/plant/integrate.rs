//! Integration over one control cycle, with the motor torque held constant.

use controller_core::joint::{JointState, JointVector};

use super::drive::Drive;
use super::factor::Equations;
use super::impedance::Impedance;
use super::model::PlantModel;

/// Longest Runge-Kutta step of the ideal plant \[s\].
pub const IDEAL_STEP_MAX: f64 = 0.5e-3;

/// Least number of integration steps per cycle of the realistic plant: 8 in a
/// cycle of 2 ms.
pub const REALISTIC_SUBSTEPS: u32 = 8;

/// Longest step of the realistic plant \[s\]; longer cycles take more steps.
pub const REALISTIC_STEP_MAX: f64 = 0.25e-3;

/// A control cycle as equal steps.
#[derive(Clone, Copy)]
pub(super) struct Span {
    pub t_s: f64,
    pub cycle_s: f64,
    pub substeps: u32,
}

/// Where a cycle starts.
pub(super) struct Start<'a> {
    pub state: &'a JointState<f64>,
    /// Equations of motion in this state, where they are there.
    pub equations: Option<Equations>,
}

impl<'a> From<&'a JointState<f64>> for Start<'a> {
    fn from(state: &'a JointState<f64>) -> Self {
        let equations = None;
        Self { state, equations }
    }
}

impl Span {
    /// Length of a step \[s\].
    fn h(&self) -> f64 {
        self.cycle_s / f64::from(self.substeps)
    }
}

/// Number of equal Runge-Kutta steps for a cycle \[s\].
pub(super) fn ideal_substeps(cycle_s: f64) -> u32 {
    steps_within(cycle_s, IDEAL_STEP_MAX)
}

/// Number of equal steps of the realistic plant for a cycle \[s\].
pub(super) fn realistic_substeps(cycle_s: f64) -> u32 {
    steps_within(cycle_s, REALISTIC_STEP_MAX).max(REALISTIC_SUBSTEPS)
}

/// Least number of equal steps, none longer than `longest`, that fill a cycle.
fn steps_within(cycle_s: f64, longest: f64) -> u32 {
    // 2 ms / 0.5 ms must be 4, also where the division rounds up.
    ((cycle_s / longest - 1e-9).ceil() as u32).max(1)
}

/// One cycle without friction, by steps of the classic Runge-Kutta method of order 4.
/// `contact(t, state)` is the joint torque +J^T F \[Nm\].
pub(super) fn explicit(
    model: &PlantModel,
    start: Start<'_>,
    span: &Span,
    torque: &JointVector<f64>,
    mut contact: impl FnMut(f64, &JointState<f64>) -> JointVector<f64>,
) -> JointState<f64> {
    let h = span.h();
    let none = JointVector::zeros();
    let mut known = start.equations.is_some();
    let mut equations = start.equations.unwrap_or(Equations::NONE);
    let mut acceleration = |t: f64, state: &JointState<f64>| {
        let total = torque + contact(t, state);
        if !known {
            model.write_equations(&state.q, &state.dq, &mut equations);
        }
        known = false;
        equations.solve_in_place(&total, &none).0
    };
    let mut state = *start.state;
    for step in 0..span.substeps {
        let t = span.t_s + h * f64::from(step);
        // The state reached from the start of the step with given slopes.
        let stage = |share: f64, dq: &JointVector<f64>, ddq: &JointVector<f64>| JointState {
            q: state.q + dq * (share * h),
            dq: state.dq + ddq * (share * h),
        };
        let k1 = acceleration(t, &state);
        let s2 = stage(0.5, &state.dq, &k1);
        let k2 = acceleration(t + 0.5 * h, &s2);
        let s3 = stage(0.5, &s2.dq, &k2);
        let k3 = acceleration(t + 0.5 * h, &s3);
        let s4 = stage(1.0, &s3.dq, &k3);
        let k4 = acceleration(t + h, &s4);
        let mean_dq = state.dq + (s2.dq + s3.dq) * 2.0 + s4.dq;
        let mean_ddq = k1 + (k2 + k3) * 2.0 + k4;
        state = stage(1.0 / 6.0, &mean_dq, &mean_ddq);
    }
    state
}

/// One cycle of an arm with a drive and springs on the motors, by linearly implicit
/// steps.
///
/// Around zero speed friction is steep: on joint 7 it has a time constant of
/// 60 us, which an explicit method would have to resolve. F(dq + h ddq) is
/// replaced by F + h F' ddq, which puts h F' on the diagonal of M. A step may
/// carry a joint through zero speed, since F' is taken where the step starts,
/// but it slows it down all the same while h F_c / (M v) < 5.7 with v the
/// transition speed of friction. Joint 7, the lightest, sets the longest step.
pub(super) fn implicit(
    model: &PlantModel,
    drive: &mut Drive,
    start: Start<'_>,
    span: &Span,
    torque: &JointVector<f64>,
    impedance: &Impedance,
    mut contact: impl FnMut(f64, &JointState<f64>) -> JointVector<f64>,
) -> JointState<f64> {
    let h = span.h();
    let mut state = *start.state;
    let mut known = start.equations.is_some();
    let mut equations = start.equations.unwrap_or(Equations::NONE);
    for step in 0..span.substeps {
        let elapsed = h * f64::from(step);
        let pushed = contact(span.t_s + elapsed, &state);
        let springs = impedance.after(elapsed);
        if !known {
            model.write_equations(&state.q, &state.dq, &mut equations);
        }
        known = false;
        state = drive.step(&mut equations, &state, h, torque, &springs, &pushed);
    }
    state
}

#[cfg(test)]
mod tests {
    use super::super::options::PlantOptions;
    use super::*;
    use arms::LWR_IV;

    /// One cycle of rigid joints with smooth friction.
    fn rough(
        model: &PlantModel,
        state: &JointState<f64>,
        span: &Span,
        torque: &JointVector<f64>,
    ) -> JointState<f64> {
        let mut drive = Drive::realistic(&LWR_IV, model, &state.q, &PlantOptions::default());
        let none = |_: f64, _: &_| JointVector::zeros();
        implicit(
            model,
            &mut drive,
            state.into(),
            span,
            torque,
            &Impedance::NONE,
            none,
        )
    }

    fn start() -> JointState<f64> {
        JointState {
            q: JointVector::from([0.2, 0.6, -0.3, -1.4, 0.4, 0.9, 0.1]),
            dq: JointVector::from([0.5, -0.3, 0.4, 0.2, -0.6, 0.8, 0.3]),
        }
    }

    /// A torque that moves the arm for the 0.32 s of a run.
    fn torque(t: f64) -> JointVector<f64> {
        let (s, c) = (libm::sin(9.0 * t), libm::cos(7.0 * t));
        JointVector::from([
            4.0 * s,
            -20.0 + 3.0 * c,
            s,
            12.0 * c,
            0.2 * s,
            0.1 * c,
            1e-3 * s,
        ])
    }

    #[test]
    fn number_of_substeps() {
        for (cycle, ideal, realistic) in [
            (0.0001, 1, 8),
            (0.0005, 1, 8),
            (0.0011, 3, 8),
            (0.002, 4, 8),
            (0.004, 8, 16),
            (0.02, 40, 80),
        ] {
            assert_eq!(ideal_substeps(cycle), ideal);
            assert_eq!(realistic_substeps(cycle), realistic);
        }
    }

    #[test]
    fn the_ideal_plant_converges_with_order_four() {
        // The torque enters as the contact, which is asked for within a step.
        let model = PlantModel::new(&LWR_IV);
        let end = |substeps: u32| {
            let span = Span {
                t_s: 0.0,
                cycle_s: 0.32,
                substeps,
            };
            explicit(
                &model,
                (&start()).into(),
                &span,
                &JointVector::zeros(),
                |t, _| torque(t),
            )
        };
        let best = end(5120);
        let error = |substeps| (end(substeps).q - best.q).amax();
        let (coarse, middle, fine) = (error(80), error(160), error(320));
        for ratio in [coarse / middle, middle / fine] {
            assert!((12.0..20.0).contains(&ratio), "{ratio} {coarse:e} {fine:e}");
        }
    }

    #[test]
    fn halving_the_realistic_step_changes_little() {
        let model = PlantModel::new(&LWR_IV);
        let cycle = 0.002;
        let end = |substeps: u32| {
            (0..160).fold(start(), |state, n| {
                let t_s = f64::from(n) * cycle;
                let span = Span {
                    t_s,
                    cycle_s: cycle,
                    substeps,
                };
                rough(&model, &state, &span, &torque(t_s))
            })
        };
        let best = end(1024);
        let error = |substeps| (end(substeps).q - best.q).amax();
        let (used, halved) = (error(REALISTIC_SUBSTEPS), error(2 * REALISTIC_SUBSTEPS));
        // First order in the speed: the error halves.
        assert!((1.6..2.4).contains(&(used / halved)), "{used:e} {halved:e}");
        assert!(used < 1e-3, "{used:e}");
    }

    /// Weightless and unforced, joint 7 at speed `dq7`: speeds after `steps`
    /// steps of `h`, and whether the kinetic energy fell all the way.
    fn slowed_down(dq7: f64, h: f64, steps: u32) -> (JointVector<f64>, bool) {
        let mut arm = LWR_IV;
        arm.gravity = [0.0; 3];
        let model = PlantModel::new(&arm);
        let none = JointVector::zeros();
        let mut state = JointState {
            q: start().q,
            dq: none,
        };
        state.dq[6] = dq7;
        let mut energy = model.kinetic_energy(&state);
        let mut falling = true;
        for _ in 0..steps {
            let span = Span {
                t_s: 0.0,
                cycle_s: h,
                substeps: 1,
            };
            state = rough(&model, &state, &span, &none);
            let now = model.kinetic_energy(&state);
            falling &= now <= energy;
            energy = now;
        }
        (state.dq, falling)
    }

    #[test]
    fn friction_takes_energy_out_in_every_step() {
        // Speeds all over the steep part of friction.
        for i in 1..=100 {
            let (dq, falling) = slowed_down(f64::from(i) * 2e-3, REALISTIC_STEP_MAX, 1000);
            assert!(falling && dq.amax() < 1e-6, "{i} {dq}");
        }
    }

    #[test]
    fn longer_steps_would_let_friction_chatter() {
        let (dq, falling) = slowed_down(0.05, 4.0 * REALISTIC_STEP_MAX, 1000);
        assert!(!falling && dq[6].abs() > 0.05, "{dq}");
    }
}
