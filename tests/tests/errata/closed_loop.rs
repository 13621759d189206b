//! Errata that show when the loop is closed around the ideal plant.

use arms::LWR_IV;
use controller_core::Controller;
use controller_core::cycle::observer::Observer;
use controller_core::cycle::{Data, Input};
use controller_core::joint::{JointState, JointVector, Vector3};
use controller_core::law::control::TorqueDemand;
use controller_core::law::null_space::Posture;
use controller_core::task::trajectory::Trajectory;
use hil_sim::plant::PlantModel;
use stratum_tests::config::{three_level, two_level};
use stratum_tests::oracle::closed_loop::{
    CASE_START, ClosedLoop, TWO_LEVEL_START, circle, no_contact, posture, rms_mm,
};
use stratum_tests::oracle::matrix::Matrix;
use stratum_tests::oracle::sample::{Sample, Wish, configuration, terms};
use stratum_tests::oracle::{Oracle, Variant};
use stratum_tests::random::States;
use stratum_tests::{controller, evaluate, lwr};

use super::{STATES, split, states};

/// The oracle's torque as a law of the core's cycle.
fn printed(variant: Variant) -> impl Fn(&Controller<f64>, &Input<'_, f64>, &mut Data<f64>) {
    move |controller, _, data| {
        let torque = Oracle::new(terms(controller.compliance(), data)).torque(variant);
        data.demand = TorqueDemand(JointVector::from_fn(|i, _| torque.at(i, 0)));
    }
}

/// Erratum 1, eq (33): from an offset of 1 mrad in the null space, the sign as
/// printed is at 0.5 rad within about a second; with the plus the offset is gone
/// to less than a tenth after 3 s. The task rests in both.
#[test]
fn erratum_1_the_stiffness_of_eq_33_needs_a_plus() {
    let start = posture(TWO_LEVEL_START);
    let hold = ClosedLoop::<f64>::new(&two_level(), start, &[Trajectory::Hold]);
    // The self-motion of the arm: what a unit speed of joint 3 leaves to N.
    let mut first = hold.clone();
    let _ = first.step();
    let data = first.state.data();
    let projector = data.hierarchy.null_projector(&data.dynamics.cholesky);
    let offset = projector.column(2).normalize() * 1e-3;
    let run = |sign: f64, duration_s: f64| {
        let mut moved = hold.clone().from(start + offset);
        let variant = Variant {
            stiffness_sign: sign,
            ..Variant::EXACT
        };
        let law = printed(variant);
        loop {
            let seen = moved.step_with(&law, no_contact);
            let away = (seen.state.q - start).amax();
            let stopped = seen.step.status.fault.is_some() || away > 0.5;
            if stopped || seen.t_s >= duration_s {
                return (seen.t_s, away, seen.errors[0]);
            }
        }
    };
    let (time, away, _) = run(-1.0, 3.0);
    println!("minus: {away:.2} rad away after {time:.2} s");
    assert!(away > 0.5 && (0.3..2.0).contains(&time), "{time} {away}");
    let (time, away, error) = run(1.0, 3.0);
    println!("plus: {away:.1e} rad away after {time:.2} s, task error {error:.1e} m");
    assert!(away < 1e-4 && error < 1e-6, "{away} {error}");
}

/// Erratum 1, eq (39), eq (45), eq (46), eq (47): where the tasks rest (w = 0) the
/// storage V = v^T Lambda_l v / 2 + q~^T K_q q~ / 2 loses exactly n^T D n with the plus.
/// As printed it gains -2 n^T K_q q~ besides, which has either sign: no storage
/// function. Rates are central differences along the plant's motion.
#[test]
fn erratum_1_the_storage_function_is_dissipated_only_with_the_plus() {
    const STEP: f64 = 1e-6;
    let plant = PlantModel::new(&LWR_IV);
    let controller = controller(&configuration(split("3+2")));
    let mut growing = 0;
    states("3+2", 1, |sample, oracle, _| {
        let (q, dq) = (sample.data.joints.q, sample.data.motion.null_velocity);
        let wish = Wish::rest(&controller, sample.data.posture);
        let at = |q, dq| Sample::new(&controller, JointState { q, dq }, &wish);
        let storage = |sample: &Sample| {
            let Sample { data, .. } = sample;
            let (n, stretch) = (data.motion.null_velocity, data.posture - data.joints.q);
            let spring = stretch.dot(&(controller.compliance().stiffness * stretch));
            (n.dot(&(data.dynamics.mass_matrix * n)) + spring) / 2.0
        };
        let resting = at(q, dq);
        let terms = resting.terms();
        let dissipated = (terms.dq.t() * &terms.damping * &terms.dq).at(0, 0);
        let spring = (terms.dq.t() * &terms.stiffness * &terms.posture_error).at(0, 0);
        let resting_oracle = Oracle::new(terms);
        for (sign, expected) in [(1.0, -dissipated), (-1.0, -dissipated - 2.0 * spring)] {
            let variant = Variant {
                stiffness_sign: sign,
                ..Variant::EXACT
            };
            let torque = resting_oracle.torque(variant);
            let torque = JointVector::from_fn(|i, _| torque.at(i, 0));
            let ddq = plant.articulated_bodies(&q, &dq, &torque, &JointVector::zeros());
            let [ahead, behind] =
                [STEP, -STEP].map(|t| storage(&at(q + dq * t + ddq * (t * t / 2.0), dq + ddq * t)));
            let rate = (ahead - behind) / (2.0 * STEP);
            // Rounding of some joules / 1e-6 s, and the step squared times the
            // next derivative.
            let power = 1e-7 + STEP * STEP * (ddq.amax() + dq.amax().powi(2)).powi(3);
            let tolerance = power * (1.0 + storage(&resting)) * oracle.conditioning().sqrt();
            assert!(
                (rate - expected).abs() < tolerance,
                "{rate} {expected} {tolerance:e}"
            );
            growing += u32::from(sign < 0.0 && rate > 0.0);
        }
    });
    println!("as printed the storage grows in {growing} of {STATES} states");
    assert!(growing > STATES as u32 / 10);
}

/// Erratum 3 in closed loop: on a circle of level 1 of 0.04 m in 5 s the printed
/// law leaves the second level some tenths of a mm, in 1.5 s more; the exact one
/// some 1e-4 mm.
#[test]
fn erratum_3_uncoupled_the_second_level_lags_in_closed_loop() {
    let start = posture(CASE_START);
    let level_2 = |variant: Variant, period_s: f64| {
        let motions = [circle(0.04, period_s), Trajectory::Hold];
        let mut closed = ClosedLoop::<f64>::new(&three_level(), start, &motions);
        let law = printed(variant);
        let mut errors = Vec::new();
        for _ in 0..3500 {
            let seen = closed.step_with(&law, no_contact);
            assert!(seen.step.status.fault.is_none(), "{:?}", seen.step.status);
            errors.push(seen.errors[1]);
        }
        rms_mm(&errors)
    };
    let [slow, fast] = [5.0, 1.5].map(|period| level_2(Variant::UNCOUPLED, period));
    let [exact, exact_fast] = [5.0, 1.5].map(|period| level_2(Variant::EXACT, period));
    println!("uncoupled {slow:.3}, {fast:.3} mm; exact {exact:.5}, {exact_fast:.5} mm");
    assert!(slow > 0.05 && fast > 0.3, "{slow} {fast}");
    assert!(exact < 0.002 && exact_fast < 0.005, "{exact} {exact_fast}");
}

/// Erratum 5, eq (30): p(0) = 0 assumes an arm at rest. Started on an arm that
/// moves, with p(0) = 0, the observer's first innovation is p / h: r jumps to
/// (1 - e^(-K_I h)) p / h, hundreds of Nm; from the present p it is exactly zero.
#[test]
fn erratum_5_eq_30_starts_from_the_present_momentum() {
    let mut random = States::new(5);
    let state = random.state();
    let dynamics = evaluate(&lwr(), &state).1;
    let gain = JointVector::repeat(50.0);
    let mut from_present = Observer::new();
    let mut from_zero = Observer {
        started: true,
        ..from_present
    };
    from_present.update(&gain, 0.002, &dynamics.momentum);
    assert_eq!(from_present.residual.amax(), 0.0);
    from_zero.update(&gain, 0.002, &dynamics.momentum);
    let jump = from_zero.residual.amax();
    let expected = -libm::expm1(-0.1) * dynamics.momentum.amax() / 0.002;
    println!("from p = 0 the residual starts with {jump:.0} Nm");
    // Rounding of p / h.
    assert!(
        (jump / expected - 1.0).abs() < 1e-12 && jump > 50.0,
        "{jump}"
    );
}

/// Erratum 8, eq (51): the integral drifts even with the coupling, on the
/// two-level circle (0.1 m in 6 s, 20 s). A constant q_d does not. The arm here has
/// no position limits.
#[test]
fn erratum_8_the_integrated_posture_of_eq_51_drifts() {
    let mut free = LWR_IV;
    for link in &mut free.links {
        link.position_range = [-12.0, 12.0];
    }
    let travel = |posture_kind| {
        let mut config = two_level();
        config.null_space.posture = posture_kind;
        let start = posture(TWO_LEVEL_START);
        let mut closed = ClosedLoop::<f64>::with_arm(&free, &config, start, &[circle(0.1, 6.0)]);
        let (mut low, mut high, mut error) = (start, start, 0.0f64);
        for _ in 0..10_000 {
            let seen = closed.step();
            assert!(seen.step.status.fault.is_none(), "{:?}", seen.step.status);
            low = low.inf(&seen.state.q);
            high = high.sup(&seen.state.q);
            error = error.max(seen.errors[0]);
        }
        assert!(error < 1e-4, "the task is kept: {error}");
        (high - low).map(f64::to_degrees)
    };
    let drifting = travel(Posture::IntegralCoupled);
    let constant = travel(Posture::Constant);
    println!("travel of the joints [deg]: {drifting:.0} {constant:.0}");
    assert!((drifting[4] - 468.0).abs() < 3.0, "{}", drifting[4]);
    assert!(constant.amax() < 60.0);
}

/// Erratum 9, eq (54), eq (55): under a constant push q~ does not vanish, nor can
/// it; what vanishes is Z (K_q q~ - tau_ext). 35 N at the elbow, tasks at rest.
#[test]
fn erratum_9_a_constant_push_leaves_the_posture_where_it_balances() {
    let start = posture(TWO_LEVEL_START);
    let force = Vector3::from([0.0, 35.0, 0.0]);
    let elbow = Vector3::zeros();
    let mut closed = ClosedLoop::<f64>::new(&two_level(), start, &[Trajectory::Hold]);
    let (mut left, mut pushed, mut away) = (0.0, 0.0, 0.0f64);
    for _ in 0..5_000 {
        let reference = closed.reference();
        let seen = closed.step_towards(&reference, |_, model, state| {
            model.point_torque(&state.q, 3, &elbow, &force)
        });
        assert!(seen.step.status.fault.is_none(), "{:?}", seen.step.status);
        let compliance = closed.controller.compliance();
        let oracle = Oracle::new(terms(compliance, closed.state.data()));
        let model = closed.plant.model();
        let tau_ext = -model.point_torque(&seen.state.q, 3, &elbow, &force);
        let tau_ext = Matrix::of(&tau_ext);
        let z = &oracle.basis.z;
        let spring = &oracle.terms.stiffness * &oracle.terms.posture_error;
        left = (z * &(spring - &tau_ext)).amax();
        pushed = (z * &tau_ext).amax();
        away = oracle.terms.posture_error.amax();
    }
    println!("q~ {away:.2} rad; Z (K_q q~ - tau_ext) {left:.1e} of {pushed:.1} Nm");
    // Ten seconds are thirty time constants D / K_q of the slowest joints.
    assert!(away > 0.1 && left < 1e-4 * pushed, "{away} {left}");
}
