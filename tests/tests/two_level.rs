//! The two-level experiment in closed loop: figures are the worst over seeds 1
//! to 10, as the README states them.

use cell::names::{MeasurementKind, NullStiffness, PlantKind};
use cell::scenario::Scenario;
use hil_sim::controllers::{ControllerKind, TorqueLaw};
use hil_sim::experiment::Experiment;
use hil_sim::plant::PlantOptions;
use hil_sim::summary::{Summary, Verdict};
use hil_sim::trace::Trace;

fn run(
    plant: PlantKind,
    contacts: bool,
    controller: impl Into<ControllerKind>,
    seed: u64,
) -> (Summary, Vec<u8>) {
    let experiment = Experiment {
        scenario: Scenario::find("two-level").expect("built in"),
        plant,
        contacts,
        controller: controller.into(),
        null_stiffness: NullStiffness::Normal,
        measurement: MeasurementKind::Direct,
        seed,
        options: PlantOptions::default(),
    };
    let controller = experiment.controller().expect("a valid configuration");
    let mut trace = Trace::new(Vec::new(), &experiment.scenario).expect("writing to memory");
    let summary = experiment
        .run(&controller, |instant| trace.push(instant), |_| ())
        .expect("writing to memory");
    (summary, trace.finish())
}

fn rms(summary: &Summary) -> f64 {
    summary.levels[0].rms_mm.expect("cycles")
}

fn max(summary: &Summary) -> f64 {
    summary.levels[0].max_mm.expect("cycles")
}

#[test]
fn the_ideal_arm_keeps_the_circle_and_its_pushes_leave_no_trace() {
    let free = run(PlantKind::Ideal, false, TorqueLaw::Hierarchical, 1).0;
    assert!(rms(&free) < 0.001 && max(&free) < 0.003, "{free:?}");
    assert_eq!(free.verdict, Verdict::Pass);
    assert_eq!(free.levels[0].rms_inside_mm, None);

    let pushed = run(PlantKind::Ideal, true, TorqueLaw::Hierarchical, 1).0;
    let plateau = pushed.levels[0].worst_plateau().expect("contacts");
    assert!(plateau < 0.05 && max(&pushed) < 0.9, "{pushed:?}");
    // The observer has found the push: it is far below that of the pushes, 8 Nm.
    assert!(pushed.residual.rms_error_nm.expect("cycles") < 0.1);
}

/// The seed has no influence on an ideal plant: one stands for all ten.
#[test]
fn the_ideal_plant_does_not_depend_on_the_seed() {
    let [one, two] =
        [1, 2].map(|seed| run(PlantKind::Ideal, true, TorqueLaw::Hierarchical, seed).1);
    assert!(one == two);
}

#[test]
fn the_realistic_arm_is_pushed_and_stays_within_its_limits_for_ten_seeds() {
    let mut least_gain = f64::INFINITY;
    for seed in 1..=10 {
        let [product, no_observer, acceleration_level] = [
            TorqueLaw::Hierarchical,
            TorqueLaw::NoObserver,
            TorqueLaw::AccelerationLevel,
        ]
        .map(|controller| run(PlantKind::Realistic, true, controller, seed).0);
        assert!(
            rms(&product) < 0.55 && max(&product) < 1.8,
            "seed {seed}: {product:?}"
        );
        assert_eq!(product.verdict, Verdict::Pass);
        for other in [no_observer, acceleration_level] {
            least_gain = least_gain.min(rms(&other) / rms(&product));
            assert_eq!(other.verdict, Verdict::Fail);
        }
    }
    assert!(least_gain >= 8.0, "{least_gain}");
}

/// The springs of the robot's position controller keep the circle, and the body in its
/// place: 35 N at the elbow are less than a mrad of 2e4 Nm/rad.
#[test]
fn positions_track_and_do_not_give_way() {
    let travel = |summary: &Summary| summary.joints.range_deg[2];
    for plant in [PlantKind::Ideal, PlantKind::Realistic] {
        let controller = ControllerKind::VelocityLevel;
        let [pushed, free] = [true, false].map(|contacts| run(plant, contacts, controller, 1).0);
        assert!(rms(&pushed) < 0.25 && max(&pushed) < 0.6, "{pushed:?}");
        assert!((travel(&pushed) - travel(&free)).abs() < 0.06);
        let soft = run(plant, true, TorqueLaw::Hierarchical, 1).0;
        assert!(travel(&soft) - travel(&free) > 5.0);
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_does_not() {
    let [one, again, other] =
        [1, 1, 2].map(|seed| run(PlantKind::Realistic, true, TorqueLaw::Hierarchical, seed).1);
    assert!(one == again);
    assert!(one != other);
}

/// The trace is what the summary was computed from.
#[test]
fn the_trace_holds_what_the_summary_says() {
    let (summary, trace) = run(PlantKind::Realistic, true, TorqueLaw::Hierarchical, 3);
    let text = String::from_utf8(trace).expect("plain text");
    let mut lines = text.lines();
    let header: Vec<_> = lines.next().expect("header").split(',').collect();
    // t; joint vectors; position, reference and error of the level's point; mode and error; bounds
    // of the joints and exchanges.
    assert_eq!(header.len(), 1 + 5 * 7 + 3 + 3 + 2 + 7 + 1);
    let column = |name: &str| {
        header
            .iter()
            .position(|title| *title == name)
            .expect("a column")
    };
    let (error, residual, tau_ext) = (column("e1"), column("r1"), column("tau_ext1"));
    let (mut squares, mut residual_squares, mut rows) = (0.0, 0.0, 0);
    for line in lines {
        let row: Vec<f64> = line
            .split(',')
            .map(|cell| cell.parse().expect("a number"))
            .collect();
        squares += (row[error] * 1e3).powi(2);
        residual_squares += (0..7)
            .map(|i| (row[residual + i] + row[tau_ext + i]).powi(2))
            .sum::<f64>();
        rows += 1;
    }
    assert_eq!(rows, summary.cycles);
    // Sums in another order: some 1e-12 of rounding over 10,000 rows.
    let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-10;
    assert!(close(
        (squares / f64::from(rows as u32)).sqrt(),
        rms(&summary)
    ));
    let residual_rms = (residual_squares / f64::from(7 * rows as u32)).sqrt();
    assert!(close(
        residual_rms,
        summary.residual.rms_error_nm.expect("cycles")
    ));
}
