//! Figures of orientation levels are angles: of trace and summary, against the closed
//! form of the motion and against formulas that share nothing with the program's.

use cell::names::PlantKind;
use cell::names::{MeasurementKind, NullStiffness};
use cell::scenario::Scenario;
use controller_core::joint::{JointState, JointVector, Matrix3, Vector3};
use hil_sim::controllers::TorqueLaw;
use hil_sim::experiment::Experiment;
use hil_sim::plant::{PlantModel, PlantOptions};
use hil_sim::summary::Summary;
use hil_sim::trace::Trace;
use std::f64::consts::{PI, TAU};

/// Two levels with the same frame: the second one is left no motion and stays where
/// the first one is, whatever it is asked for.
fn scenario(axes: &str, first: &str, second: &str) -> Scenario {
    let level = |axes: &str, reference: &str| {
        format!(
            "[[level]]\ntask = \"orientation\"\npoint = \"flange\"\naxes = \"{axes}\"\n\
             stiffness = 400.0\ndamping = 40.0\n[level.reference]\n{reference}\n"
        )
    };
    let text = format!(
        "name = \"swing\"\nrobot = \"lwr_iv\"\nlaw = \"exact\"\nduration_s = 6.0\ncycle_ms = 2.0\n\
         start_deg = [10.0, 30.0, 5.0, -85.0, 25.0, 50.0, 0.0]\n{}{}\
         [null_space]\nstiffness = [20.0, 20.0, 15.0, 15.0, 3.0, 2.0, 0.2]\n\
         damping = [4.0, 4.0, 3.0, 3.0, 0.4, 0.3, 0.03]\n[observer]\ngain = 50.0\n",
        level("xyz", first),
        level(axes, second),
    );
    Scenario::parse(&text).expect("a good scenario")
}

const HOLD: &str = "kind = \"hold\"";
const GROWTH_S: f64 = 2.0;
const PERIOD_S: f64 = 8.0;

fn swing(axis: [f64; 3], angle_deg: f64) -> String {
    format!(
        "kind = \"swing\"\naxis = {axis:?}\nangle_deg = {angle_deg:?}\n\
         period_s = {PERIOD_S:?}\ngrowth_s = {GROWTH_S:?}"
    )
}

/// The angle \[rad\] that the swing has reached at `t` \[s\].
fn swung(angle_deg: f64, t: f64) -> f64 {
    let s = (t / GROWTH_S).min(1.0);
    let blend = 10.0 * s.powi(3) - 15.0 * s.powi(4) + 6.0 * s.powi(5);
    angle_deg.to_radians() * blend * libm::sin(TAU * t / PERIOD_S)
}

/// The short way round.
fn short(angle: f64) -> f64 {
    (angle.abs() + PI).rem_euclid(TAU) - PI
}

/// One row of the trace: time, joint positions, desired and actual quaternion and
/// error of the second level, error of the first.
struct Row {
    t: f64,
    q: JointVector<f64>,
    desired: [f64; 4],
    actual: [f64; 4],
    error: f64,
    error_above: f64,
}

fn run(scenario: Scenario, plant: PlantKind) -> (Summary, Vec<Row>) {
    let experiment = Experiment {
        scenario,
        plant,
        contacts: false,
        controller: TorqueLaw::Hierarchical.into(),
        null_stiffness: NullStiffness::Normal,
        measurement: MeasurementKind::Direct,
        seed: 1,
        options: PlantOptions::default(),
    };
    let controller = experiment.controller().expect("a valid configuration");
    let mut trace = Trace::new(Vec::new(), &experiment.scenario).expect("writing to memory");
    let summary = experiment
        .run(&controller, |instant| trace.push(instant), |_| ())
        .expect("writing to memory");
    let text = String::from_utf8(trace.finish()).expect("plain text");
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let place = |name: &str| header.iter().position(|title| *title == name);
    let place = |name: &str| place(name).expect("a column");
    let row = |line: &str| {
        let numbers: Vec<f64> = line
            .split(',')
            .map(|cell| {
                if cell.is_empty() {
                    f64::NAN
                } else {
                    cell.parse().expect(cell)
                }
            })
            .collect();
        let from = |name: &str, i: usize| numbers[place(name) + i];
        Row {
            t: numbers[0],
            q: JointVector::from_fn(|i, _| from("q1", i)),
            desired: std::array::from_fn(|i| from("x2_des_qw", i)),
            actual: std::array::from_fn(|i| from("x2_qw", i)),
            error: from("e2", 0),
            error_above: from("e1", 0),
        }
    };
    let rows: Vec<Row> = lines.map(row).collect();
    assert_eq!(rows.len(), summary.cycles);
    assert_eq!((rows.len(), summary.limits.torque), (3000, 0));
    (summary, rows)
}

/// The angle between two unit quaternions from their distance and the distance of
/// their sum: |a - b| is 2 sin(theta / 4), |a + b| is 2 cos(theta / 4), or the other
/// way round. Exact at every angle.
fn angle(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    let norm = |sign: f64| {
        let squares = a.iter().zip(b).map(|(a, b)| (a + sign * b).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let (less, sum) = (norm(-1.0), norm(1.0));
    4.0 * libm::atan2(less.min(sum), less.max(sum))
}

/// The frame of the flange by the plant's points.
fn frame(q: &JointVector<f64>) -> Matrix3<f64> {
    let plant = PlantModel::new(&arms::LWR_IV);
    let state = JointState {
        q: *q,
        dq: JointVector::zeros(),
    };
    let at = |offset: Vector3<f64>| plant.point(&state, 7, &offset).0;
    let origin = at(Vector3::zeros());
    Matrix3::from_columns(&[0, 1, 2].map(|axis| {
        let mut unit = Vector3::zeros();
        unit[axis] = 1.0;
        at(unit) - origin
    }))
}

/// rms and largest of the rows' errors are those of the summary.
fn assert_summary(summary: &Summary, rows: &[Row]) {
    let level = &summary.levels[1];
    let squares: f64 = rows.iter().map(|row| row.error * row.error).sum();
    let rms = 1e3 * (squares / rows.len() as f64).sqrt();
    let max = 1e3 * rows.iter().map(|row| row.error).fold(0.0, f64::max);
    let [given_rms, given_max] = [level.rms_mrad, level.max_mrad].map(|x| x.expect("mrad"));
    // Sums in another order.
    assert!((rms / given_rms - 1.0).abs() < 1e-12, "{rms} {given_rms}");
    assert_eq!(max, given_max);
    assert_eq!((level.rms_mm, level.max_mm), (None, None));
}

/// An offset that is known at every instant: the first level keeps the frame, the
/// second one is asked to swing by up to 250 deg, more than half a turn. Its figure is
/// the angle the short way, not the chord, which would never exceed 2.
#[test]
fn the_figure_of_a_known_offset_is_its_angle() {
    for angle_deg in [10.0, 140.0, 179.0, -250.0] {
        let second = swing([0.6, 0.0, -0.8], angle_deg);
        let (summary, rows) = run(scenario("xyz", HOLD, &second), PlantKind::Ideal);
        let (mut largest, mut worst) = (0.0f64, 0.0f64);
        for row in &rows {
            let expected = short(swung(angle_deg, row.t)).abs();
            largest = largest.max(expected);
            let error = (row.error - expected).abs();
            // The arc sine loses half the digits near half a turn; the frame is kept to
            // the rounding of torques.
            let tolerance = if expected > 3.0 { 1e-7 } else { 1e-12 };
            worst = worst.max(error / tolerance);
            assert!(error < tolerance, "{angle_deg} at {} s: {error:e}", row.t);
            assert!((angle(&row.desired, &row.actual) - row.error).abs() < tolerance);
        }
        println!("{angle_deg} deg: up to {largest:.3} rad, {worst:.1e} of the tolerance");
        assert_summary(&summary, &rows);
        let max = summary.levels[1].max_mrad.expect("an orientation");
        let peak = 1e3 * angle_deg.abs().to_radians().min(PI);
        // The swing is at its end at 2 s, in a cycle instant; near half a turn it is
        // passed between two of them, at up to 3.5 rad/s.
        let step = if angle_deg.abs() > 180.0 { 7.0 } else { 1e-4 };
        assert!((max - peak).abs() < step, "{max} {peak}");
        // Without motion for its rows.
        assert_eq!(summary.limits.rank, rows.len());
    }
}

/// About some axes only: the part of the rotation vector along them.
#[test]
fn the_figure_about_some_axes_is_the_part_of_the_angle_about_them() {
    for (axes, share) in [
        ("x", 0.48),
        ("z", 0.64),
        ("xy", 0.768_374_908_491_941_8),
        ("y", 0.6),
    ] {
        let second = swing([0.48, -0.6, 0.64], 120.0);
        let (_, rows) = run(scenario(axes, HOLD, &second), PlantKind::Ideal);
        for row in &rows {
            let expected = share * swung(120.0, row.t).abs();
            let error = (row.error - expected).abs();
            assert!(error < 1e-10, "{axes} at {} s: {error:e}", row.t);
        }
    }
}

/// The other way round: the arm swings by 70 deg, on the realistic plant as well, and
/// the second level, which would hold, shows by how much. Against the frame that the
/// joint positions of the trace give.
#[test]
fn the_figure_of_a_moving_arm_is_the_angle_of_its_frame() {
    for (plant, tracked) in [(PlantKind::Ideal, 1e-4), (PlantKind::Realistic, 0.2)] {
        let first = swing([0.0, 0.0, 1.0], 70.0);
        let (summary, rows) = run(scenario("xyz", &first, HOLD), plant);
        let start = frame(&rows[0].q);
        let (mut largest, mut above) = (0.0f64, 0.0f64);
        for row in &rows {
            // |R - R'| is 2 sqrt(2) sin(theta / 2).
            let chord = (frame(&row.q) - start).norm() / 8.0_f64.sqrt();
            let by_frame = 2.0 * libm::asin(chord);
            // Rounding of a frame, and of a quaternion.
            assert!((row.error - by_frame).abs() < 1e-12, "{}", row.t);
            assert!((angle(&row.desired, &row.actual) - row.error).abs() < 1e-12);
            // Angles obey the triangle inequality: off the swing by no more than the
            // level that swings is off its reference.
            let off = (row.error - swung(70.0, row.t).abs()).abs();
            assert!(off <= row.error_above + 1e-12, "{}: {off:e}", row.t);
            largest = largest.max(row.error);
            above = above.max(row.error_above);
        }
        println!("{plant:?}: up to {largest:.4} rad, {above:.1e} off");
        assert!(above < tracked, "{above}");
        assert!((largest - 70.0_f64.to_radians()).abs() < tracked);
        assert_summary(&summary, &rows);
    }
}
