//! Arms imported from URDFs: the core on the imported table against Pinocchio on the very file,
//! and against the table of the crate that has the same numbers.

use std::collections::BTreeMap;

use cell::model::chain::{Choice, Impossible};
use controller_core::arm::{ArmModel, ArmParameters, Link};
use controller_core::joint::{DOF, JointState, Matrix3};
use hil_sim::model::import::{Import, Request, import};
use serde::Deserialize;
use stratum_tests::golden::{Worst, file};
use stratum_tests::{evaluate, relative};

/// One state of `urdf.json`.
#[derive(Deserialize)]
struct Seen {
    q: [f64; DOF],
    dq: [f64; DOF],
    /// Lower triangle by rows.
    mass_matrix: Vec<f64>,
    coriolis: [f64; DOF],
    gravity: [f64; DOF],
    /// Of the tip in the base.
    position: [f64; 3],
    /// By rows.
    rotation: Vec<f64>,
    /// Rows x, y, z.
    jacobian: Vec<f64>,
    angular_jacobian: Vec<f64>,
}

/// File, base, tip: as in `urdf.py`.
const FILES: [(&str, &str, &str); 3] = [
    ("iiwa_14", "base_link", "tool0"),
    ("skew", "plate", "l7"),
    ("two_arms", "torso", "tcp"),
];

fn imported(name: &str, base: &str, tip: &str) -> Import {
    let text = file(&format!("urdf/{name}.urdf"));
    let request = Request {
        source: name,
        name: None,
        choice: Choice {
            base: Some(base.to_string()),
            tip: Some(tip.to_string()),
            continuous: std::f64::consts::TAU,
            impossible: Impossible::Refused,
        },
        has_postures: false,
    };
    import(&text, &request).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A thousand roundings of the largest entry, as for the arms of the crate (`arms.rs`): on the way
/// there are the conversion and the degrees of the arm file, of some roundings each.
const TOLERANCE: f64 = 1e-12;

#[test]
fn the_core_agrees_with_pinocchio_on_the_file() {
    let golden: BTreeMap<String, Vec<Seen>> =
        serde_json::from_str(&file("urdf.json")).expect("layout of urdf.json");
    assert_eq!(golden.len(), FILES.len());
    for (name, base, tip) in FILES {
        let arm = imported(name, base, tip).arm;
        let model = ArmModel::<f64>::new(arm).expect(name);
        let states = &golden[name];
        assert!(states.len() >= 20);
        println!("{name}");
        hold(arm, &model, states);
    }
}

fn hold(arm: &ArmParameters, model: &ArmModel<f64>, states: &[Seen]) {
    let mut mass = Worst::new("M");
    let mut coriolis = Worst::new("C dq");
    let mut gravity = Worst::new("g");
    let mut pose = Worst::new("tip");
    let mut jacobian = Worst::new("J");
    for seen in states {
        let state = JointState {
            q: seen.q.into(),
            dq: seen.dq.into(),
        };
        let (kinematics, dynamics) = evaluate(model, &state);
        let lower = (0..DOF).flat_map(|i| (0..=i).map(move |j| (i, j)));
        let lower: Vec<f64> = lower.map(|at| dynamics.mass_matrix[at]).collect();
        mass.add(relative(&lower, &seen.mass_matrix, 1e-3));
        // Pinocchio gives C dq + g and g: their difference has the rounding of g.
        let weight = seen.gravity.iter().fold(1.0f64, |a, g| a.max(g.abs()));
        coriolis.add(relative(&dynamics.coriolis, &seen.coriolis, weight));
        gravity.add(relative(&dynamics.gravity, &seen.gravity, 1.0));

        let flange = arm.flange_point();
        let motion = kinematics.point(flange.link, &flange.offset.into());
        pose.add(relative(&motion.x, &seen.position, 1.0));
        let own = Matrix3::from(arm.flange.rotation).transpose();
        let turned = kinematics.link(Link::L7).rotation * own;
        pose.add(relative(&turned.transpose(), &seen.rotation, 1.0));

        let rows = kinematics.point_jacobian(flange.link, &motion);
        let angular = kinematics.angular_jacobian(Link::L7);
        for axis in 0..3 {
            let expected = DOF * axis..DOF * (axis + 1);
            let linear = &seen.jacobian[expected.clone()];
            jacobian.add(relative(&rows.jacobian[axis], linear, 1.0));
            let turning = &seen.angular_jacobian[expected];
            jacobian.add(relative(&angular.jacobian[axis], turning, 1.0));
        }
    }
    for worst in [mass, coriolis, gravity, pose, jacobian] {
        worst.within(TOLERANCE);
    }
}

/// The file has the numbers of the crate's table and prints right angles as 1.5708: the table comes
/// back, with bodies to the rounding of their turn there and back.
#[test]
fn the_table_of_the_crate_comes_back() {
    let (arm, table) = (
        imported("iiwa_14", "base_link", "tool0").arm,
        &arms::IIWA_14,
    );
    assert_eq!(arm.name, table.name);
    assert_eq!(arm.gravity, table.gravity);
    assert_eq!(arm.points, table.points);
    assert_eq!((arm.base, arm.flange), (table.base, table.flange));
    let close = |one: f64, other: f64, what: &str| {
        assert!((one - other).abs() < 1e-15, "{what}: {one} {other}");
    };
    for (link, own) in arm.links.iter().zip(&table.links) {
        assert_eq!(link.name, own.name);
        assert_eq!((link.a, link.alpha, link.d), (own.a, own.alpha, own.d));
        assert_eq!((link.angle_offset, link.mass), (own.angle_offset, own.mass));
        assert_eq!(link.torque_limit, own.torque_limit);
        assert_eq!(link.torque_rate_limit, own.torque_rate_limit);
        assert_eq!(link.brake_rate_limit, own.brake_rate_limit);
        for (one, other) in link.com.into_iter().zip(own.com) {
            close(one, other, "com");
        }
        for (one, other) in link.inertia.into_iter().zip(own.inertia) {
            close(one, other, "inertia");
        }
        for (one, other) in link.position_range.into_iter().zip(own.position_range) {
            close(one, other, "range");
        }
        close(link.speed_limit, own.speed_limit, "speed");
    }
}

/// What the notes say of right angles is what they are: 3.67e-6 rad of 1.5708, 7.35e-6 of 3.1416.
#[test]
fn what_exact_right_angles_change_is_said() {
    let notes = imported("iiwa_14", "base_link", "tool0").notes.join("\n");
    assert!(
        notes.contains("6 right angles of the file, up to 3.7e-6 rad away"),
        "{notes}"
    );
    let notes = imported("two_arms", "torso", "tcp").notes.join("\n");
    assert!(
        notes.contains("9 right angles of the file, up to 7.3e-6 rad away"),
        "{notes}"
    );
    assert!(
        notes.contains("joint 'finger_1' is not in the chain"),
        "{notes}"
    );
}
