//! Every arm of the crate `arms`: the core against Pinocchio and against the plant, as it
//! stands and mounted elsewhere with a load.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use arms::ALL;
use controller_core::arm::{ArmModel, ArmParameters, EndApproach, Pose, Tool};
use controller_core::joint::{DOF, JointMatrix, JointState, JointVector, Matrix3, Vector3};
use controller_core::law::null_space::{NullDamping, NullSpace};
use controller_core::ranges::{ANGLE_MAX, POSITION_MARGIN};
use controller_core::{Controller, ControllerConfig};
use hil_sim::plant::PlantModel;
use serde::Deserialize;
use stratum_tests::config::two_level;
use stratum_tests::golden::{Worst, file};
use stratum_tests::{evaluate, relative, unit};

/// One state of `arms.json`.
#[derive(Deserialize)]
struct Seen {
    q: [f64; DOF],
    dq: [f64; DOF],
    /// Lower triangle by rows.
    mass_matrix: Vec<f64>,
    coriolis: [f64; DOF],
    gravity: [f64; DOF],
    elbow: [f64; 3],
    wrist: [f64; 3],
    flange: [f64; 3],
    /// Of the flange, rows x, y, z.
    jacobian: Vec<f64>,
    jacobian_dot_dq: [f64; 3],
}

impl Seen {
    fn state(&self) -> JointState<f64> {
        JointState {
            q: self.q.into(),
            dq: self.dq.into(),
        }
    }
}

fn golden() -> BTreeMap<String, Vec<Seen>> {
    serde_json::from_str(&file("arms.json")).expect("layout of arms.json")
}

/// The mounting and the load of the odd states, as in `arms.py`.
fn mounted(arm: &ArmParameters) -> ArmParameters {
    let turn = [[0.6, 0.0, 0.8], [0.64, 0.6, -0.48], [-0.48, 0.8, 0.36]];
    let columns = Matrix3::from(turn).transpose();
    let base = columns * Matrix3::from(arm.base.rotation).transpose();
    let shift = columns * Vector3::from(arm.base.shift) + Vector3::new(0.3, -0.2, 0.7);
    let tool = Tool {
        pose: Pose {
            rotation: [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
            shift: [0.01, -0.02, 0.05],
        },
        mass: 2.0,
        com: [0.02, 0.01, 0.06],
        inertia: [0.004, 0.0, 0.0, 0.005, 0.0, 0.003],
    };
    ArmParameters {
        base: Pose {
            rotation: base.transpose().into(),
            shift: shift.into(),
        },
        ..arm.with_tool(&tool)
    }
}

/// An arm as it stands and mounted.
fn both(arm: &ArmParameters) -> [ArmParameters; 2] {
    [*arm, mounted(arm)]
}

/// A thousand roundings of the largest entry: sums of a hundred terms, some of which are ten
/// times their sum.
const TOLERANCE: f64 = 1e-12;

#[test]
fn the_core_agrees_with_pinocchio_on_every_arm() {
    let golden = golden();
    assert_eq!(golden.len(), ALL.len());
    for arm in ALL {
        let states = &golden[arm.name];
        assert!(states.len() >= 20);
        let models = both(arm).map(|arm| ArmModel::<f64>::new(&arm).expect(arm.name));
        let mut mass = Worst::new("M");
        let mut coriolis = Worst::new("C dq");
        let mut gravity = Worst::new("g");
        let mut points = Worst::new("points");
        let mut jacobian = Worst::new("J, dJ/dt dq");
        for (seen, model) in states.iter().zip(models.iter().cycle()) {
            let state = seen.state();
            let (kinematics, dynamics) = evaluate(model, &state);
            let lower = (0..DOF).flat_map(|i| (0..=i).map(move |j| (i, j)));
            let lower: Vec<f64> = lower.map(|at| dynamics.mass_matrix[at]).collect();
            mass.add(relative(&lower, &seen.mass_matrix, 1e-3));
            // Pinocchio gives C dq + g and g: their difference has the rounding of g.
            let weight = seen.gravity.iter().fold(1.0f64, |a, g| a.max(g.abs()));
            coriolis.add(relative(&dynamics.coriolis, &seen.coriolis, weight));
            gravity.add(relative(&dynamics.gravity, &seen.gravity, 1.0));
            for (name, place) in [
                ("elbow", &seen.elbow),
                ("wrist", &seen.wrist),
                ("flange", &seen.flange),
            ] {
                let point = arm.point(name).expect("every arm has it");
                let motion = kinematics.point(point.link, &point.offset.into());
                points.add(relative(&motion.x, place, 1.0));
            }
            let flange = arm.flange_point();
            let motion = kinematics.point(flange.link, &flange.offset.into());
            let rows = kinematics.point_jacobian(flange.link, &motion);
            for axis in 0..3 {
                let expected = &seen.jacobian[DOF * axis..][..DOF];
                jacobian.add(relative(&rows.jacobian[axis], expected, 1.0));
                let bias = rows.jacobian_dot[axis].dot(&state.dq);
                // Of the size of the speeds' square.
                let size = seen.jacobian_dot_dq[axis]
                    .abs()
                    .max(state.dq.norm_squared());
                jacobian.add((bias - seen.jacobian_dot_dq[axis]).abs() / size);
            }
        }
        println!("{}", arm.name);
        for worst in [mass, coriolis, gravity, points, jacobian] {
            worst.within(TOLERANCE);
        }
    }
}

#[test]
fn the_plant_agrees_with_pinocchio_on_every_arm() {
    let golden = golden();
    for arm in ALL {
        let plants = both(arm).map(|arm| PlantModel::new(&arm));
        let mut motion = Worst::new("M ddq + C dq + g - tau");
        let mut energy = Worst::new("kinetic energy");
        let mut gravity = Worst::new("g");
        let mut points = Worst::new("points");
        let mut jacobian = Worst::new("J");
        for (seen, plant) in golden[arm.name].iter().zip(plants.iter().cycle()) {
            let state = seen.state();
            let mut mass = JointMatrix::zeros();
            let lower = (0..DOF).flat_map(|i| (0..=i).map(move |j| (i, j)));
            for ((i, j), &entry) in lower.zip(&seen.mass_matrix) {
                (mass[(i, j)], mass[(j, i)]) = (entry, entry);
            }
            let torque = JointVector::from([5.0, -9.0, 3.0, 4.0, 1.0, -0.5, 0.1]);
            let none = JointVector::zeros();
            let ddq = plant.articulated_bodies(&state.q, &state.dq, &torque, &none);
            let known = JointVector::from(seen.coriolis) + JointVector::from(seen.gravity);
            let sum = mass * ddq + known - torque;
            // Rounding of accelerations of up to 1e5 rad/s2 of light wrists.
            let size = (mass.abs() * ddq.abs()).amax().max(known.amax());
            motion.add(sum.amax() / size);
            let expected = 0.5 * state.dq.dot(&(mass * state.dq));
            energy.add((plant.kinetic_energy(&state) - expected).abs() / expected);
            gravity.add(relative(
                &plant.gravity_torque(&state.q),
                &seen.gravity,
                1.0,
            ));
            for (name, place) in [
                ("elbow", &seen.elbow),
                ("wrist", &seen.wrist),
                ("flange", &seen.flange),
            ] {
                let point = arm.point(name).expect("every arm has it");
                let (x, _) = plant.point(&state, point.link.number(), &point.offset.into());
                points.add(relative(&x, place, 1.0));
            }
            for joint in 0..DOF {
                let mut alone = state;
                alone.dq = unit(joint);
                let (_, column) = plant.point(&alone, DOF, &arm.flange.shift.into());
                for axis in 0..3 {
                    let expected = seen.jacobian[DOF * axis + joint];
                    jacobian.add((column[axis] - expected).abs());
                }
            }
        }
        println!("{}", arm.name);
        for worst in [motion, energy, gravity, points, jacobian] {
            worst.within(TOLERANCE);
        }
    }
}

/// Whole turns of a continuous joint are reduced in one place, the sine and cosine of the angle:
/// up to 100 turns the arm is the same, up to the rounding of the angle. What is beyond the range
/// of the table is refused as any position is.
#[test]
fn whole_turns_of_continuous_joints_change_nothing() {
    const CONTINUOUS: [usize; 4] = [0, 2, 4, 6];
    let mut arm = arms::GEN3;
    for joint in CONTINUOUS {
        let link = &mut arm.links[joint];
        let [least, greatest] = link.position_range;
        assert!(greatest - least >= TAU, "{}: not continuous", link.name);
        let farthest = ANGLE_MAX - POSITION_MARGIN - link.angle_offset.abs();
        link.position_range = [-farthest, farthest];
    }
    let model = ArmModel::<f64>::new(&arm).expect("a hundred turns are allowed");
    let (mut worst, golden) = (Worst::new("rounding of 100 turns"), golden());
    for (k, seen) in golden[arm.name].iter().step_by(2).enumerate() {
        let state = seen.state();
        let (_, dynamics) = evaluate(&model, &state);
        for turns in [1.0, -10.0, 98.0, -98.0] {
            let mut turned = state;
            turned.q[CONTINUOUS[k % 4]] += turns * TAU;
            let (_, other) = evaluate(&model, &turned);
            worst.add(relative(
                other.mass_matrix.iter(),
                dynamics.mass_matrix.iter(),
                1e-3,
            ));
            worst.add(relative(other.gravity.iter(), dynamics.gravity.iter(), 1.0));
            worst.add(relative(
                other.coriolis.iter(),
                dynamics.coriolis.iter(),
                1.0,
            ));
        }
    }
    // An angle of 628 rad is rounded by up to 5.7e-14 rad, and so is the turn added to it;
    // nothing above changes by more than some ten times its size per rad.
    worst.within(2e-12);

    let config = two_level();
    let controller = Controller::<f64>::new(
        &arms::GEN3,
        &ControllerConfig {
            null_space: NullSpace {
                damping: NullDamping::Inertia(20.0),
                ..config.null_space
            },
            ..config
        },
    );
    let controller = controller.expect("the table as it is");
    let q = |angle: f64| JointVector::from([angle, 0.3, 0.0, -1.2, 0.0, -0.9, 0.0]);
    assert!(controller.believe_posture(&q(TAU + 0.19)).is_ok());
    let refusal = controller
        .believe_posture(&q(TAU + 0.21))
        .expect_err("beyond the range");
    assert_eq!((refusal.index, refusal.max), (1, TAU + POSITION_MARGIN));
}

#[test]
fn every_arm_is_found_by_its_name() {
    for arm in ALL {
        assert_eq!(
            arms::by_name(arm.name).map(|found| found.name),
            Some(arm.name)
        );
        assert!(ArmModel::<f32>::new(arm).is_ok(), "{}", arm.name);
    }
    assert!(arms::by_name("lwr").is_none());
}

#[test]
fn the_speed_of_the_fr3_is_bounded_near_its_ends() {
    for link in &arms::FR3.links {
        let EndApproach {
            margin,
            deceleration,
            ends: [start, end],
        } = link.end_approach.expect("the FR3 has it");
        // Beyond the ends: towards the middle only.
        let [low, high] = link.speed_range(end + 0.1);
        assert_eq!(high, 0.0);
        assert_eq!(low, -link.speed_limit);
        assert_eq!(link.speed_range(start - 0.1)[0], 0.0);
        // Braked with the deceleration from the bound plus margin it stops at the end.
        let way = 0.1;
        let [_, high] = link.speed_range(end - way);
        assert!(high < link.speed_limit);
        let stop = (high + margin).powi(2) / (2.0 * deceleration);
        assert!((stop - way).abs() < 1e-12);
    }
    let lwr = &arms::LWR_IV.links[0];
    assert_eq!(lwr.speed_range(2.9), [-lwr.speed_limit, lwr.speed_limit]);
}
