//! An arm with a tool: plant and controller have it, levels and contacts know its frame.

use cell::names::PlantKind;
use cell::scenario::Scenario;
use controller_core::joint::{JointState, JointVector, Matrix3, Vector3};
use hil_sim::plant::PlantModel;
use hil_sim::summary::Verdict;

use super::{arms, experiment, run};

/// A gripper off the axis, turned in the flange.
const TOOL: &str = "
[tool]
shift_m = [0.02, 0.0, 0.1]
rpy_deg = [0.0, 35.0, 90.0]
mass_kg = 0.8
center_of_mass_m = [0.0, 0.03, -0.02]
inertia_kg_m2 = [0.002, 0.0, 0.0003, 0.003, 0.0, 0.0015]
";

/// `text` with a tool, whose point takes the place of the flange.
fn equipped(text: &str) -> String {
    text.replace("point = \"flange\"", "point = \"tool\"") + TOOL
}

/// Rz(yaw) Ry(pitch) of the tool, written out.
fn turn() -> Matrix3<f64> {
    let (s, c) = 35_f64.to_radians().sin_cos();
    Matrix3::new(0.0, -1.0, 0.0, c, 0.0, s, -s, 0.0, c)
}

/// The weight of the tool is J^T of a force at its centre of mass, wherever the arm is.
#[test]
fn the_plant_carries_what_the_file_says() {
    for text in arms() {
        let bare = Scenario::parse(text).expect("a valid scenario");
        let scenario = Scenario::parse(&equipped(text)).expect("a valid scenario");
        let [bare, arm] = [bare.arm(), scenario.arm()].map(|arm| arm.parameters);
        let [without, with] = [bare, arm].map(|arm| PlantModel::new(&arm));
        let flange = Matrix3::from(bare.flange.rotation).transpose();
        let in_flange = Vector3::new(0.02, 0.0, 0.1) + turn() * Vector3::new(0.0, 0.03, -0.02);
        let centre = Vector3::from(bare.flange.shift) + flange * in_flange;
        let weight = Vector3::from(bare.gravity) * 0.8;
        let q = scenario.start();
        let carried = without.gravity_torque(&q) - without.point_torque(&q, 7, &centre, &weight);
        let difference = (with.gravity_torque(&q) - carried).amax();
        assert!(difference < 1e-13, "{}: {difference:e}", bare.name);
        // The last joint alone feels the inertia about its axis.
        let mut turning = JointState {
            q,
            dq: JointVector::zeros(),
        };
        turning.dq[6] = 1.0;
        let own = turn()
            * Matrix3::new(0.002, 0.0, 0.0003, 0.0, 0.003, 0.0, 0.0003, 0.0, 0.0015)
            * turn().transpose();
        let about = flange * own * flange.transpose();
        // The axis of joint 7 in its frame: that of its DH table, through the frame's foot.
        let link = &bare.links[6];
        let axis = Vector3::new(0.0, link.alpha.sin(), link.alpha.cos());
        let foot = -Vector3::new(link.a, 0.0, 0.0) - axis * link.d;
        let arm = axis.cross(&(centre - foot));
        let expected = axis.dot(&(about * axis)) + 0.8 * arm.dot(&arm);
        let energy = with.kinetic_energy(&turning) - without.kinetic_energy(&turning);
        assert!((2.0 * energy - expected).abs() < 1e-13, "{}", bare.name);
    }
}

/// The tool's point follows the circle of the flange while the body is pushed.
#[test]
fn a_tool_is_tracked_as_a_flange_is() {
    for text in arms() {
        for plant in [PlantKind::Ideal, PlantKind::Realistic] {
            let experiment = experiment(&equipped(text), plant);
            let summary = run(&experiment);
            assert_eq!(summary.verdict, Verdict::Pass, "{:?}", summary.reason);
            assert_eq!(summary.levels[0].name, "tool xyz");
            let limits = summary.limits;
            assert_eq!([limits.torque, limits.rank, limits.position], [0; 3]);
            let rms = summary.levels[0].rms().expect("samples");
            assert!(rms < 0.55, "{} {plant:?}: {rms}", summary.scenario);
        }
    }
}

/// A second level turns the tool about an axis of its own, of which the point stays.
#[test]
fn a_tool_swings_about_its_own_axis() {
    let level = "[[level]]\ntask = \"orientation\"\npoint = \"tool\"\naxes = \"xyz\"\n\
                 stiffness = 400.0\ndamping = 40.0\n[level.reference]\nkind = \"swing\"\n\
                 axis = [0, 0, 1]\naxis_of = \"own\"\nangle_deg = 10.0\nperiod_s = 4.0\n\
                 growth_s = 1.0\n\n[null_space]";
    let text = equipped(arms()[0]).replacen("[null_space]", level, 1);
    let mut experiment = experiment(&text, PlantKind::Ideal);
    experiment.contacts = false;
    let controller = experiment.controller().expect("a controller");
    let (mut first, mut farthest) = (None, 0.0_f64);
    let summary = experiment.run(
        &controller,
        |sample| {
            // The tool's own z axis in the base plate, by the quaternion that is shown.
            let q = &sample.levels[1].actual;
            let (w, x, y, z) = (q[0], q[1], q[2], q[3]);
            let axis = Vector3::new(
                2.0 * (x * z + w * y),
                2.0 * (y * z - w * x),
                1.0 - 2.0 * (x * x + y * y),
            );
            let start: Vector3<f64> = *first.get_or_insert(axis);
            farthest = farthest.max((axis - start).norm());
            Ok(())
        },
        |_| (),
    );
    let summary = summary.expect("nothing is written");
    assert_eq!(summary.verdict, Verdict::Pass, "{:?}", summary.reason);
    // The error of tracking, against a swing of 0.17 rad.
    let worst = summary.levels[1].max().expect("samples") * 1e-3;
    assert!(worst < 2e-3, "{worst} rad");
    assert!(farthest <= worst + 1e-9, "{farthest} {worst}");
    assert!(
        summary.joints.range_deg[6] > 5.0,
        "{:?}",
        summary.joints.range_deg
    );
}
