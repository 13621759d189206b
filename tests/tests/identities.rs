//! The core's kinematics and dynamics against identities that any correct
//! model obeys, and against the independent plant.

use arms::LWR_IV;
use cell::scenario::{BUILT_IN, Scenario};
use controller_core::arm::{ArmModel, Link};
use controller_core::joint::{JointState, JointVector, Vector3};
use hil_sim::contact::Contacts;
use hil_sim::plant::PlantModel;
use stratum_tests::random::States;
use stratum_tests::{JOINTS, evaluate, lwr, relative, unit};

const STATES: usize = 500;

/// A central difference with this step errs by about 1e-12 / 1e-5 = 1e-7 from
/// rounding and 1e-10 from the third derivative, relative to terms of order 1.
const STEP: f64 = 1e-5;

fn moved(state: &JointState<f64>, direction: &JointVector<f64>, by: f64) -> JointState<f64> {
    JointState {
        q: state.q + direction * by,
        dq: state.dq,
    }
}

/// M from unit accelerations of the plant: ddq of a unit torque is a column of
/// M^-1. Independent algorithm, so only conditioning (1.6e4) limits agreement.
/// Covers M of eq (6).
#[test]
fn mass_matrix_inverts_the_plants_response_to_unit_torques() {
    let (model, plant) = (lwr(), PlantModel::new(&LWR_IV));
    let mut states = States::new(1);
    for _ in 0..STATES {
        let state = JointState {
            dq: JointVector::zeros(),
            ..states.state()
        };
        let (_, dynamics) = evaluate(&model, &state);
        let rest = plant.articulated_bodies(
            &state.q,
            &state.dq,
            &dynamics.gravity,
            &JointVector::zeros(),
        );
        assert!(rest.amax() < 1e-9, "gravity torque holds the plant: {rest}");
        for i in JOINTS {
            let torque = dynamics.gravity + dynamics.mass_matrix * unit(i);
            let ddq = plant.articulated_bodies(&state.q, &state.dq, &torque, &JointVector::zeros());
            assert!(relative(&ddq, &unit(i), 1.0) < 1e-9);
        }
    }
}

/// dM/dt = C + C^T, which eq (30) takes for granted.
#[test]
fn mass_matrix_rate_is_coriolis_plus_its_transpose() {
    let model = lwr();
    let mut states = States::new(2);
    for _ in 0..STATES {
        let state = states.state();
        let (_, dynamics) = evaluate(&model, &state);
        let [ahead, behind] = [STEP, -STEP].map(|step| {
            evaluate(&model, &moved(&state, &state.dq, step))
                .1
                .mass_matrix
        });
        let rate = (ahead - behind) / (2.0 * STEP);
        let c = dynamics.coriolis_matrix;
        let sum = c + c.transpose();
        assert!(relative(&rate, &sum, 1.0) < 1e-6);
        let skew = rate - c * 2.0;
        assert!(relative(&skew, &-skew.transpose(), 1.0) < 1e-6);
    }
}

/// C_ij = sum_k (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) dq_k / 2, entry by entry:
/// the factorisation of the paper and no other. Covers C of eq (6).
#[test]
fn coriolis_matrix_is_the_christoffel_one() {
    let model = lwr();
    let mut states = States::new(3);
    for _ in 0..100 {
        let state = states.state();
        let (_, dynamics) = evaluate(&model, &state);
        let gradient: Vec<_> = JOINTS
            .map(|k| {
                let [ahead, behind] = [STEP, -STEP].map(|step| {
                    evaluate(&model, &moved(&state, &unit(k), step))
                        .1
                        .mass_matrix
                });
                (ahead - behind) / (2.0 * STEP)
            })
            .collect();
        let mut expected = dynamics.coriolis_matrix * 0.0;
        for (i, j, k) in
            JOINTS.flat_map(|i| JOINTS.flat_map(move |j| JOINTS.map(move |k| (i, j, k))))
        {
            expected[(i, j)] += 0.5
                * (gradient[k][(i, j)] + gradient[j][(i, k)] - gradient[i][(j, k)])
                * state.dq[k];
        }
        assert!(relative(&dynamics.coriolis_matrix, &expected, 1.0) < 1e-6);
    }
}

/// Covers g of eq (6).
#[test]
fn gravity_is_the_gradient_of_the_plants_potential_energy() {
    let (model, plant) = (lwr(), PlantModel::new(&LWR_IV));
    let mut states = States::new(4);
    for _ in 0..STATES {
        let state = states.state();
        let (_, dynamics) = evaluate(&model, &state);
        let gradient = JointVector::from_fn(|k, _| {
            let [ahead, behind] =
                [STEP, -STEP].map(|step| plant.potential_energy(&(state.q + unit(k) * step)));
            (ahead - behind) / (2.0 * STEP)
        });
        // Potential energies are tens of joules: rounding 1e-14 / 1e-5.
        assert!(relative(&dynamics.gravity, &gradient, 1.0) < 1e-7);
    }
}

/// The whole equation of motion: the torque that eq (6) gives for an acceleration
/// makes the plant accelerate just so.
#[test]
fn plant_follows_the_cores_equation_of_motion() {
    let (model, plant) = (lwr(), PlantModel::new(&LWR_IV));
    let mut states = States::new(5);
    for _ in 0..STATES {
        let state = states.state();
        let wanted = states.vector() * 20.0;
        let (_, dynamics) = evaluate(&model, &state);
        let torque = dynamics.mass_matrix * wanted + dynamics.coriolis + dynamics.gravity;
        let ddq = plant.articulated_bodies(&state.q, &state.dq, &torque, &JointVector::zeros());
        assert!(
            relative(&ddq, &wanted, 1.0) < 1e-8,
            "{}",
            relative(&ddq, &wanted, 1.0)
        );
    }
}

/// x, dx = J dq and dJ/dt of the tasks. Covers eq (1), eq (2).
#[test]
fn points_jacobians_and_their_rates_agree_with_the_plant_and_with_differences() {
    let (model, plant) = (lwr(), PlantModel::new(&LWR_IV));
    let mut states = States::new(6);
    for n in 0..STATES {
        let state = states.state();
        let (link, offset) = (Link::ALL[n % 7], states.vector().fixed_rows::<3>(0) * 0.3);
        let (kinematics, _) = evaluate(&model, &state);
        let motion = kinematics.point(link, &offset);
        let (x, dx) = plant.point(&state, link.number(), &offset);
        assert!(relative(&motion.x, &x, 1.0) < 1e-13);
        assert!(relative(&motion.dx, &dx, 1.0) < 1e-13);

        let rows = kinematics.point_jacobian(link, &motion);
        let jacobian_at = |step: f64| {
            let (k, _) = evaluate(&model, &moved(&state, &state.dq, step));
            k.point_jacobian(link, &k.point(link, &offset)).jacobian
        };
        let (ahead, behind) = (jacobian_at(STEP), jacobian_at(-STEP));
        for axis in 0..3 {
            let mut force = nalgebra::Vector3::zeros();
            force[axis] = 1.0;
            let torque = plant.point_torque(&state.q, link.number(), &offset, &force);
            assert!(relative(&rows.jacobian[axis], &torque, 1.0) < 1e-13);
            assert!((rows.jacobian[axis].dot(&state.dq) - motion.dx[axis]).abs() < 1e-12);
            let rate = (ahead[axis] - behind[axis]) / (2.0 * STEP);
            assert!(relative(&rows.jacobian_dot[axis], &rate, 1.0) < 1e-7);
        }
    }
}

/// No stale workspace: the same input gives the same bits, whatever came before.
#[test]
fn evaluating_twice_gives_the_same_bits() {
    let model = lwr();
    let mut states = States::new(8);
    let (first, other) = (states.state(), states.state());
    let before = evaluate(&model, &first).1;
    let _ = evaluate(&model, &other);
    let after = evaluate(&model, &first).1;
    assert_eq!(before.mass_matrix, after.mass_matrix);
    assert_eq!(before.coriolis_matrix, after.coriolis_matrix);
    assert_eq!(before.gravity, after.gravity);
}

/// A push is J^T F at the point that the scenario names, with J of the core.
/// Two ways of adding the same ten products: rounding only.
#[test]
fn contacts_act_on_the_point_that_they_name() {
    let mut states = States::new(9);
    let mut pushes = 0;
    for (name, _) in BUILT_IN {
        let scenario = Scenario::find(name).expect("built in");
        let arm = scenario.arm().parameters;
        let model = ArmModel::<f64>::new(&arm).expect("a table");
        let plant = PlantModel::new(&arm);
        let contacts = Contacts::of(&scenario);
        for push in &scenario.pushes {
            let (middle, point) = (
                (push.from_s + push.to_s) / 2.0,
                push.point.resolve(&scenario.arm()),
            );
            for _ in 0..20 {
                let state = states.state();
                let (kinematics, _) = evaluate(&model, &state);
                let motion = kinematics.point(point.link, &point.offset.into());
                let rows = kinematics.point_jacobian(point.link, &motion).jacobian;
                let force = Vector3::from(push.force_n);
                let expected = rows[0] * force.x + rows[1] * force.y + rows[2] * force.z;
                let (torque, _) = contacts.joint_torque(middle, &plant, &state);
                assert!((torque - expected).amax() < 1e-12, "{name}: {torque}");
                let mut beyond = torque.iter().skip(point.link.number());
                assert!(beyond.all(|&torque| torque == 0.0));
            }
            pushes += 1;
        }
    }
    assert!(pushes >= 22, "{pushes}");
}
