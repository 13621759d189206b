//! A cycle of a run as a state to explain.

use controller_core::cycle::observer::Observer;
use controller_core::joint::{DOF, JointVector, Vector3};
use controller_core::law::limits::memory::LimitMemory;
use controller_core::law::null_space::NullDamping;
use controller_core::{Axes, Measurement, Target, Task};
use serde_json::{Map, Value, json};

use crate::controllers::TorqueLaw;
use crate::experiment::{Experiment, Watched};
use cell::invalid::Invalid;
use cell::names::MeasurementKind;
use cell::ranges::Range;
use cell::scenario::{Event, LawSpec, LevelLimitsSpec, PointSpec, Scenario, TaskSpec};

/// What a cycle starts from.
struct Start {
    measurement: Measurement<f64>,
    observer: Observer<f64>,
    /// None before the first torque.
    torque: Option<JointVector<f64>>,
    memory: LimitMemory<f64>,
}

/// The cycle at `t_s` \[s\] of a run, or the first behind it, as a state that
/// [`explain`](super::explain) takes, JSON: with it the torque of that cycle comes again, bit by
/// bit. The run is made again up to there.
///
/// # Errors
/// A run without such a cycle, or not of the product with direct measurements.
pub fn state_at(experiment: &Experiment, t_s: f64) -> Result<String, Invalid> {
    if experiment.controller != TorqueLaw::Hierarchical.into()
        || experiment.measurement != MeasurementKind::Direct
    {
        let allowed = "with --controller hierarchical and --measurement direct";
        return Err(Invalid::new("--state-at", t_s, allowed));
    }
    // A state has the tasks as they are at the start.
    let scenario = &experiment.scenario;
    let first_event = scenario.events.iter().map(Event::at_s).reduce(f64::min);
    if scenario.levels.iter().any(|level| level.absent) {
        let allowed = "of a scenario without absent levels";
        return Err(Invalid::new("--state-at", t_s, allowed));
    }
    if let Some(at_s) = first_event.filter(|at_s| t_s >= *at_s) {
        let allowed = format!("before the first event, {at_s}");
        return Err(Invalid::new("--state-at", t_s, allowed));
    }
    let cycle_s = scenario.cycle_s();
    let mut until = experiment.clone();
    until.scenario.duration_s = experiment.scenario.duration_s.min(t_s + 2.0 * cycle_s);
    let controller = until.controller()?;
    let (mut start, mut state) = (None, None);
    // Times are sums of cycles.
    let due = t_s - 1e-6 * cycle_s;
    let watch = |watched: &Watched<'_>| {
        if watched.t_s < due || state.is_some() {
            return;
        }
        let data = watched.state.data();
        if !watched.decided {
            start = Some(Start {
                measurement: *watched.measurement,
                observer: data.observer,
                torque: data.observer.started.then_some(data.allocation.torque),
                memory: LimitMemory::of(&data.projection, &data.way_out),
            });
        } else if let Some(start) = &start {
            let reference = controller.followed_reference(watched.state);
            let targets = reference.targets();
            state = Some(as_json(&until, start, targets, &data.posture));
        }
    };
    let run = until.run_watched(&controller, |_| Ok(()), |_| (), watch);
    run.map_err(Invalid::line)?;
    let end_s = experiment.scenario.duration_s;
    let state = state.ok_or_else(|| {
        let allowed = format!("a cycle of the run: {}", Range::new(0.0, end_s));
        Invalid::new("--state-at", t_s, allowed)
    })?;
    let text = serde_json::to_string_pretty(&state?).map_err(Invalid::line)?;
    Ok(text + "\n")
}

fn as_json(
    experiment: &Experiment,
    start: &Start,
    targets: &[Target<f64>],
    posture: &JointVector<f64>,
) -> Result<Value, Invalid> {
    let scenario = &experiment.scenario;
    let config = experiment.controller_config()?;
    let levels = scenario
        .levels
        .iter()
        .zip(config.tasks.tasks())
        .zip(targets);
    let levels: Vec<_> = levels
        .map(|((level, task), target)| {
            let mut state = level_as_json(&level.point, level.task, task, target);
            state.extend(
                level
                    .limits
                    .iter()
                    .map(|limits| ("limits".into(), limits_as_json(limits))),
            );
            Value::Object(state)
        })
        .collect();
    let mut null_space = json!({
        "q_d": list(posture),
        "stiffness": diagonal(&config.null_space.stiffness),
        "damping": vec![0.0; DOF],
    });
    match &config.null_space.damping {
        NullDamping::Joint(damping) => null_space["damping"] = json!(diagonal(damping)),
        NullDamping::Inertia(rate) => null_space["damping_rate"] = json!(rate),
    }
    let mut state = json!({
        "robot": scenario.robot.to_string(),
        "q": list(&start.measurement.q),
        "dq": list(&start.measurement.dq),
        "levels": levels,
        "null_space": null_space,
        "cycle_ms": scenario.cycle_ms,
        "dead_cycles": config.dead_cycles,
        "law": match scenario.law {
            LawSpec::WithinLimits => "within-limits",
            LawSpec::Exact => "exact",
        },
    });
    equip(&mut state, scenario);
    let observer = &start.observer;
    if observer.started {
        state["observer"] = json!({
            "momentum_prev": list(&observer.momentum),
            "input_prev": list(&observer.input),
            "residual_prev": list(&observer.residual),
            "gain": config.observer_gain,
            "h": start.measurement.interval_s,
        });
    }
    if scenario.law == LawSpec::WithinLimits {
        let LimitMemory {
            disturbance,
            way_out,
        } = &start.memory;
        let mut before = json!({ "disturbance": disturbance[..scenario.levels.len()] });
        if let Some(motion) = way_out {
            before["way_out"] = json!(list(motion));
        }
        if let Some(torque) = &start.torque {
            before["torque"] = json!(list(torque));
        }
        state["before"] = before;
    }
    Ok(state)
}

/// Mount, tool and limits of the joints as in the scenario.
fn equip(state: &mut Value, scenario: &Scenario) {
    if let Some(mount) = &scenario.mount {
        state["mount"] = json!({ "rpy_deg": mount.rpy_deg });
    }
    if let Some(tool) = &scenario.tool {
        state["tool"] = json!({
            "shift_m": tool.shift_m,
            "rpy_deg": tool.rpy_deg,
            "mass_kg": tool.mass_kg,
            "center_of_mass_m": tool.center_of_mass_m,
            "inertia_kg_m2": tool.inertia_kg_m2,
        });
    }
    if let Some(limits) = &scenario.joint_limits {
        state["joint_limits"] = given([
            (
                "acceleration",
                limits.acceleration.map(|values| json!(values)),
            ),
            ("braking", limits.braking.map(|values| json!(values))),
            ("speed_gain", limits.speed_gain.map(|values| json!(values))),
            (
                "position_gain",
                limits.position_gain.map(|value| json!(value)),
            ),
            ("margin_deg", limits.margin_deg.map(|value| json!(value))),
            ("speed_share", limits.speed_share.map(|value| json!(value))),
        ]);
    }
}

fn level_as_json(
    point: &PointSpec,
    kind: TaskSpec,
    task: &Task,
    target: &Target<f64>,
) -> Map<String, Value> {
    let point = match point {
        PointSpec::Name(name) => json!(name),
        PointSpec::OnLink(point) => json!({ "link": point.link, "offset_m": point.offset_m }),
    };
    let axes: Vec<_> = (0..3).filter(|&axis| task.axes.contains(axis)).collect();
    let along = |v: &Vector3<f64>| -> Vec<f64> { axes.iter().map(|&axis| v[axis]).collect() };
    let gains =
        |gain: &[[f64; 3]; 3]| -> Vec<f64> { axes.iter().map(|&axis| gain[axis][axis]).collect() };
    let (x, dx, ddx) = match target {
        Target::Position { x, dx, ddx } => (along(x), along(dx), along(ddx)),
        Target::Orientation { q, w, dw } => (q.as_slice().to_vec(), along(w), along(dw)),
        Target::Hold => Default::default(),
    };
    let level = json!({
        "task": match kind {
            TaskSpec::Position => "position",
            TaskSpec::Orientation => "orientation",
        },
        "point": point,
        "axes": name(task.axes),
        "x": x,
        "dx": dx,
        "ddx": ddx,
        "kp": gains(&task.gains.stiffness),
        "kd": gains(&task.gains.damping),
    });
    match level {
        Value::Object(level) => level,
        _ => Map::new(),
    }
}

fn name(axes: Axes) -> String {
    let letters = "xyz".chars().enumerate();
    let letters = letters.filter(|(axis, _)| axes.contains(*axis));
    letters.map(|(_, letter)| letter).collect()
}

fn limits_as_json(limits: &LevelLimitsSpec) -> Value {
    given([
        (
            "drive_mobility",
            limits.drive_mobility.map(|value| json!(value)),
        ),
        (
            "release_mobility",
            limits.release_mobility.map(|value| json!(value)),
        ),
        (
            "error_speed_m_s",
            limits.error_speed_m_s.map(|value| json!(value)),
        ),
        (
            "lost_speed_m_s",
            limits.lost_speed_m_s.map(|value| json!(value)),
        ),
        (
            "stiff_mobility",
            limits.stiff_mobility.map(|value| json!(value)),
        ),
    ])
}

/// The keys that have a value.
fn given<const N: usize>(keys: [(&str, Option<Value>); N]) -> Value {
    let given = keys.into_iter();
    given
        .filter_map(|(key, value)| Some((key.to_string(), value?)))
        .collect::<Map<_, _>>()
        .into()
}

fn list(vector: &JointVector<f64>) -> Vec<f64> {
    vector.iter().copied().collect()
}

fn diagonal(gain: &[[f64; DOF]; DOF]) -> [f64; DOF] {
    std::array::from_fn(|joint| gain[joint][joint])
}
