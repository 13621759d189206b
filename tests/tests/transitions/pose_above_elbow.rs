//! Eight rows on seven joints: a pose above two axes of the elbow. What cannot be served is
//! released from below.

use arms::{FR3, LWR_IV};
use cell::names::PlantKind;
use controller_core::arm::ArmParameters;
use controller_core::joint::{DOF, JointVector};
use controller_core::law::null_space::NullDamping;
use controller_core::task::Tracked;
use controller_core::{
    Axes, ControllerConfig, Link, LinkFrame, LinkPoint, NullSpace, Target, Task, TaskGains, TaskSet,
};
use stratum_tests::config::{REFERENCE_STIFFNESS, two_level};
use stratum_tests::oracle::closed_loop::posture;

use super::run::{Run, on_circle};

/// Position and orientation of the flange above two axes of the elbow.
fn config(arm: &ArmParameters) -> ControllerConfig {
    let gains = TaskGains::uniform(400.0, 40.0);
    let flange: LinkPoint = arm.flange_point();
    let elbow = arm.points.iter().find(|point| point.name == "elbow");
    let elbow = elbow.expect("it has an elbow").point;
    ControllerConfig {
        tasks: TaskSet::new(&[
            Task::position(flange, Axes::XYZ, gains),
            Task::orientation(
                LinkFrame {
                    link: Link::L7,
                    ..Link::L7.frame()
                },
                Axes::XYZ,
                gains,
            ),
            Task::position(elbow, Axes::Y | Axes::Z, gains),
        ])
        .expect("eight rows"),
        null_space: NullSpace {
            damping: NullDamping::Inertia(10.0),
            ..NullSpace::diagonal(REFERENCE_STIFFNESS, [1.0; DOF])
        },
        ..two_level()
    }
}

/// Errors of the pose \[m, rad\] and of the elbow \[m\] in the end and at most, largest torque step.
struct Seen {
    position: f64,
    orientation: f64,
    elbow: f64,
    step: f64,
}

fn run(arm: &ArmParameters, start: JointVector<f64>, sink: f64) -> Seen {
    let mut run = Run::new(arm, &config(arm), PlantKind::Ideal, start, 1);
    let origin = run.controller.rest_reference(&start);
    let mut seen = Seen {
        position: 0.0,
        orientation: 0.0,
        elbow: 0.0,
        step: 0.0,
    };
    for _ in 0..4000 {
        let mut reference = origin.clone();
        let targets = reference.targets_mut();
        targets[0] = on_circle(&origin.targets()[0], run.t_s());
        if let (Target::Position { x, dx, ddx }, true) = (&mut targets[2], sink != 0.0) {
            let (share, rate) = ((0.25 * run.t_s()).sin(), 0.25 * (0.25 * run.t_s()).cos());
            x.z += sink * share;
            dx.z = sink * rate;
            ddx.z = -sink * 0.0625 * share;
        }
        let step = run.cycle(&reference);
        assert_eq!(step.status.fault, None);
        let rows = &run.state.data().rows;
        let norm = |range: core::ops::Range<usize>| {
            rows.error[range].iter().map(|e| e * e).sum::<f64>().sqrt()
        };
        seen.position = seen.position.max(norm(0..3));
        seen.orientation = seen.orientation.max(norm(3..6));
        seen.elbow = seen.elbow.max(norm(6..8));
        seen.step = run.step;
    }
    seen
}

#[test]
fn the_pose_is_kept_and_the_elbow_goes_where_it_can() {
    for (arm, start) in [
        (&LWR_IV, posture([0.0, 35.0, 0.0, -80.0, 20.0, 60.0, 0.0])),
        (&FR3, posture([0.0, -20.0, 0.0, -110.0, 0.0, 100.0, 45.0])),
    ] {
        let seen = run(arm, start, 0.05);
        println!(
            "{}: pose within {:.5} mm, {:.5} mrad, elbow off by {:.1} mm, step {:.3} Nm",
            arm.name,
            seen.position * 1e3,
            seen.orientation * 1e3,
            seen.elbow * 1e3,
            seen.step
        );
        assert!(
            seen.position < 1e-4 && seen.orientation < 1e-4,
            "{}",
            arm.name
        );
        assert!(seen.step < 3.0, "{}", arm.name);
    }
}

/// The wrist goes straight on the way: joint 6 of the LWR through 0.
#[test]
fn it_goes_through_a_wrist_singularity_without_a_step() {
    let start = posture([0.0, 35.0, 0.0, -80.0, 0.0, 20.0, 0.0]);
    let arm = &LWR_IV;
    let mut run = Run::new(arm, &config(arm), PlantKind::Ideal, start, 1);
    let origin = run.controller.rest_reference(&start);
    let mut least = f64::INFINITY;
    for _ in 0..4000 {
        let mut reference = origin.clone();
        // Forty degrees about y within 4 s: the hand bends to the other side.
        if let Target::Orientation { q, w, dw } = &mut reference.targets_mut()[1] {
            let turn = 40f64.to_radians();
            let s = (run.t_s() / 4.0).clamp(0.0, 1.0);
            let [share, rate, second] = controller_core::task::trajectory::quintic(s);
            let half = 0.5 * turn * share;
            let about_y = nalgebra_product([half.cos(), 0.0, half.sin(), 0.0], (*q).into());
            *q = about_y.into();
            w.y = turn * rate / 4.0;
            dw.y = turn * second / 16.0;
        }
        let step = run.cycle(&reference);
        assert_eq!(step.status.fault, None);
        least = least.min(run.plant.state().q[5].abs());
    }
    println!(
        "wrist: |q6| down to {least:.4} rad, largest step {:.3} Nm",
        run.step
    );
    assert!(least < 0.01, "it did not come there: {least}");
    assert!(run.step < 3.0, "{} Nm at {} s", run.step, run.stepped_at_s);
}

/// Of quaternions w, x, y, z.
fn nalgebra_product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    let [a0, a1, a2, a3] = a;
    let [b0, b1, b2, b3] = b;
    [
        a0 * b0 - a1 * b1 - a2 * b2 - a3 * b3,
        a0 * b1 + a1 * b0 + a2 * b3 - a3 * b2,
        a0 * b2 - a1 * b3 + a2 * b0 + a3 * b1,
        a0 * b3 + a1 * b2 - a2 * b1 + a3 * b0,
    ]
}

#[test]
fn eight_rows_are_not_for_the_exact_law() {
    let config = config(&LWR_IV);
    let rows: usize = config
        .tasks
        .tasks()
        .iter()
        .map(|task| task.axes.count())
        .sum();
    assert_eq!(rows, 8);
    assert!(matches!(
        config.tasks.tasks()[2].tracked,
        Tracked::Position(_)
    ));
    let refused = controller_core::Controller::<f64>::exact(&LWR_IV, &config);
    let text = refused.expect_err("too many").to_string();
    assert!(text.contains("8 rows") && text.contains("1 to 7"), "{text}");
}
