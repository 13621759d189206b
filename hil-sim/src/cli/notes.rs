//! What is said before a run of a scenario that is allowed and may not be meant.

use std::io;

use controller_core::Controller;

use crate::controllers::{ControllerKind, TorqueLaw};
use crate::experiment::Experiment;
use crate::plant::{PlantOptions, want_of_data};
use cell::names::PlantKind;
use cell::scenario::{PostureSpec, Scenario};
use cell::terminal::tell;
use record::run::Sample;

/// How far a run is looked ahead \[s\].
const AHEAD_S: f64 = 20.0;

/// Every note on this run.
pub fn tell_all(experiment: &Experiment, controller: &Controller<f64>) {
    warn_of_damping(experiment, controller);
    say_what_is_unknown(&experiment.scenario, experiment.plant);
    if let Ok(Some(note)) = drift(experiment, controller) {
        tell(format_args!("note: {note}"));
    }
}

/// A damping above half its bound works, but says so.
fn warn_of_damping(experiment: &Experiment, controller: &Controller<f64>) {
    let Ok(config) = experiment.controller_config() else {
        return;
    };
    let bound = config.damping_bound();
    let mode = controller.fastest_mode();
    let arm = experiment.scenario.arm();
    let value = mode.rate * experiment.scenario.cycle_s();
    if value > bound / 2.0 && experiment.controller == TorqueLaw::Hierarchical.into() {
        tell(format_args!(
            "note: the null-space damping uses {value:.2} of the {bound} that the cycle carries \
             ({}, stretched postures)",
            arm.joint(mode.joint - 1)
        ));
    }
}

/// A realistic plant is less so where nobody knows how its arm departs from the table.
pub fn say_what_is_unknown(scenario: &Scenario, plant: PlantKind) {
    if plant == PlantKind::Realistic
        && let Some(note) = want_of_data(&scenario.arm().parameters)
    {
        tell(format_args!("note: {note}"));
    }
}

/// An integrated posture drifts; how far, without pushes and on an ideal arm, is tried out.
fn drift(experiment: &Experiment, controller: &Controller<f64>) -> io::Result<Option<String>> {
    let posture = match experiment.scenario.null_space.posture {
        PostureSpec::Constant => return Ok(None),
        PostureSpec::IntegralCoupled => "integral-coupled",
        PostureSpec::IntegralUncoupled => "integral-uncoupled",
    };
    if experiment.controller == ControllerKind::VelocityLevel {
        return Ok(None);
    }
    let mut free = Experiment {
        plant: PlantKind::Ideal,
        contacts: false,
        options: PlantOptions {
            dead_cycles: experiment.options.dead_cycles,
            ..PlantOptions::default()
        },
        ..experiment.clone()
    };
    free.scenario.duration_s = free.scenario.duration_s.min(AHEAD_S);
    let arm = experiment.scenario.arm();
    let [least, greatest] = controller.arm().position_range();
    let mut beyond = None;
    let look = |sample: &Sample| {
        let q = &sample.state.q;
        let left = (0..q.len()).find(|&i| q[i] < least[i] || q[i] > greatest[i]);
        beyond = beyond.or(left.map(|index| (arm.joint(index), sample.t_s)));
        Ok(())
    };
    let summary = free.run(controller, look, |_| ())?;
    let travel = summary.joints.range_deg;
    // The last cycle that counts.
    let end_s = summary.cycles.saturating_sub(1) as f64 * free.scenario.cycle_s();
    let most = (0..travel.len()).max_by(|&a, &b| travel[a].total_cmp(&travel[b]));
    let most = most.unwrap_or_default();
    let range = beyond.map_or(String::new(), |(joint, t_s)| {
        format!("; {joint} leaves its range at {t_s:.1} s")
    });
    Ok(Some(format!(
        "posture {posture} drifts: on an ideal arm without contacts {} travels {:.0} deg in \
         {end_s:.1} s{range}",
        arm.joint(most),
        travel[most],
    )))
}
