//! summary.json: what a run was, what it measured, and the verdict.

use serde::Serialize;

use cell::scenario::{LevelSpec, Metric, Scenario};

use crate::after_fault::{AfterFault, Ending};
use crate::limit_events::LimitEvents;
use crate::metrics::{
    self, ChangeFigures, FaultCounts, JointFigures, LevelFigures, LimitCounts, Metrics,
    ResidualFigures, TorqueFigures,
};
use crate::robot::{FciFigures, LinkFigures};
use crate::sample::Stop;
use cell::names::{MeasurementKind, Named, PlantKind};

/// Outcome of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Every limit was judged and kept, and every contact was there.
    Pass,
    /// No limit was exceeded, and something that was to be judged did not come.
    #[serde(rename = "not judged")]
    NotJudged,
    /// A limit was exceeded, a joint left its range, or a level is stuck at the end.
    Fail,
    /// Safety stopped the run, or someone.
    Stopped,
}

impl Verdict {
    /// Exit code of a run with this verdict.
    #[must_use]
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Pass | Self::NotJudged => 0,
            Self::Fail => 1,
            Self::Stopped => 3,
        }
    }

    /// "pass", "not judged", "fail" or "stopped".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::NotJudged => "not judged",
            Self::Fail => "fail",
            Self::Stopped => "stopped",
        }
    }
}

/// One acceptance limit and how the run stands to it.
#[derive(Clone, Debug, Serialize)]
pub struct Acceptance {
    /// Name of the metric.
    pub metric: String,
    /// It must be below this.
    pub limit: f64,
    /// What the run reached; null without samples.
    pub value: Option<f64>,
    /// Null where there is nothing to judge.
    pub pass: Option<bool>,
}

/// `controller` of a run that a client on the robot link controlled.
pub const CLIENT: &str = "client";

/// The summary of one run, field by field as in summary.json.
#[derive(Clone, Debug, Serialize)]
#[expect(
    missing_docs,
    reason = "the fields are those of the file, described in docs/files.md"
)]
pub struct Summary {
    pub scenario: String,
    pub controller: &'static str,
    pub plant: &'static str,
    pub contacts: bool,
    pub seed: u64,
    pub cycle_ms: f64,
    pub duration_s: f64,
    pub cycles: usize,
    pub verdict: Verdict,
    pub reason: Option<String>,
    pub acceptance: Vec<Acceptance>,
    pub levels: Vec<LevelFigures>,
    pub residual: ResidualFigures,
    pub torque: TorqueFigures,
    pub joints: JointFigures,
    pub hand_force_max_n: Option<f64>,
    pub limits: LimitCounts,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_events: Option<LimitEvents>,
    #[serde(skip)]
    pub limit_sentences: Vec<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<ChangeFigures>,
    pub faults: FaultCounts,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after_fault: Option<AfterFault>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub link: Option<LinkFigures>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fci: Option<FciFigures>,
}

impl Summary {
    /// What the figures say of a run of `scenario`, of a client on the robot link; a
    /// reason of its `ending` stands above every limit.
    pub(crate) fn of(
        scenario: &Scenario,
        conditions: &Conditions,
        seed: u64,
        metrics: &Metrics,
        ending: &Ending,
    ) -> Self {
        let levels = metrics.levels(&scenario.levels);
        let acceptance = judge(scenario, conditions, &levels);
        let mut faults = FaultCounts::default();
        if let Some(Stop::Fault(fault)) = ending.stop() {
            faults.add(fault.kind);
        }
        let (verdict, reason) = match ending.stop() {
            None => {
                let failures = failures(&acceptance, metrics, &scenario.levels);
                let missing = missing(scenario, &acceptance, metrics, &levels);
                verdict(&failures, &missing)
            }
            Some(stop) => (
                Verdict::Stopped,
                Some(stop.named(&scenario.arm().parameters)),
            ),
        };
        let has_hands = conditions.contacts && !scenario.hands.is_empty();
        Self {
            scenario: scenario.name.clone(),
            controller: CLIENT,
            plant: conditions.plant.name(),
            contacts: conditions.contacts,
            seed,
            cycle_ms: scenario.cycle_ms,
            duration_s: scenario.duration_s,
            cycles: metrics.cycles,
            verdict,
            reason,
            acceptance,
            levels,
            residual: metrics.residual(),
            torque: metrics.torque(),
            joints: metrics.joints(),
            hand_force_max_n: has_hands.then_some(metrics.hand_force),
            limits: metrics.limits,
            limit_events: metrics
                .limit_events
                .is_known()
                .then(|| metrics.limit_events.clone()),
            limit_sentences: metrics.limit_sentences(&scenario.levels),
            changes: metrics.changes.clone(),
            faults,
            after_fault: ending.seen(),
            link: None,
            fci: None,
        }
    }

    /// The verdict in a word for people: a run that no limit was held against is no
    /// pass, though it exits like one.
    #[must_use]
    pub fn verdict_word(&self) -> &'static str {
        match self.verdict {
            Verdict::Pass if self.acceptance.is_empty() => "no limit",
            other => other.name(),
        }
    }

    /// What the run had to do without, in sentences.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let LimitCounts {
            torque,
            rank,
            position,
        } = self.limits;
        [
            ("the torque of a joint was cut to its limit", torque),
            ("a row of a task could not be followed", rank),
            ("a joint was beyond its range", position),
        ]
        .into_iter()
        .filter(|(_, cycles)| *cycles > 0)
        .map(|(what, cycles)| format!("{what} in {cycles} of {} cycles", self.cycles))
        .chain(self.torque.step.map(|step| step.to_string()))
        .chain(self.changes.iter().map(ToString::to_string))
        .chain(self.limit_sentences.iter().cloned())
        .collect()
    }
}

/// What decides which limits apply to a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conditions {
    /// The arm.
    pub plant: PlantKind,
    /// Whether contacts act.
    pub contacts: bool,
    /// How the controller sees the arm.
    pub measurement: MeasurementKind,
    /// Cycles between a torque and its effect.
    pub dead_cycles: usize,
}

/// Holds the figures against the limits that the scenario sets for these
/// conditions.
fn judge(scenario: &Scenario, conditions: &Conditions, levels: &[LevelFigures]) -> Vec<Acceptance> {
    let arm = scenario.arm().parameters;
    let way = |name: &str| MeasurementKind::from_name(name).map(|kind| kind.of_arm(&arm));
    let applies = scenario.limits.iter().filter(|limit| {
        PlantKind::from_name(&limit.plant) == Ok(conditions.plant)
            && limit.contacts == conditions.contacts
            && way(&limit.measurement) == Ok(conditions.measurement)
            && limit.dead_cycles == conditions.dead_cycles
    });
    applies
        .filter_map(|limit| {
            let metric = Metric::parse(&limit.metric, &scenario.levels).ok()?;
            let value = metrics::value(metric, levels);
            Some(Acceptance {
                metric: limit.metric.clone(),
                limit: limit.below,
                value,
                pass: value.map(|value| value < limit.below),
            })
        })
        .collect()
}

/// Limits that were exceeded, joints that left their range, levels that are stuck.
fn failures(acceptance: &[Acceptance], metrics: &Metrics, levels: &[LevelSpec]) -> Vec<String> {
    let failed = acceptance.iter().filter(|limit| limit.pass == Some(false));
    failed
        .map(|limit| {
            let value = limit.value.unwrap_or(f64::NAN);
            format!(
                "{} = {value:.4}, must be below {}",
                limit.metric, limit.limit
            )
        })
        .chain(metrics.beyond().map(|joint| joint.to_string()))
        .chain(metrics.unreached(levels))
        .collect()
}

/// What was to be judged and did not come: contacts after the end, plateaus that a limit
/// is about, limits without samples.
fn missing(
    scenario: &Scenario,
    acceptance: &[Acceptance],
    metrics: &Metrics,
    levels: &[LevelFigures],
) -> Vec<String> {
    let end = scenario.duration_s;
    let on_plateaus = acceptance.iter().filter_map(|limit| {
        match Metric::parse(&limit.metric, &scenario.levels) {
            Ok(Metric::Plateau(level)) => Some(level),
            _ => None,
        }
    });
    let on_plateaus: Vec<_> = on_plateaus.collect();
    let (mut late, mut cut) = (Vec::new(), Vec::new());
    for (index, contact) in metrics.contacts().iter().enumerate() {
        let no_plateau = |level: &usize| levels[*level].plateaus().nth(index).flatten().is_none();
        let list = match contact.from_s >= end {
            true => &mut late,
            false if on_plateaus.iter().any(no_plateau) => &mut cut,
            false => continue,
        };
        let name = match index.checked_sub(scenario.pushes.len()) {
            None => format!("contact {}", index + 1),
            Some(hand) => format!("hand {}", hand + 1),
        };
        list.push(format!("{name} ({} to {} s)", contact.from_s, contact.to_s));
    }
    let contacts = [
        (late, "after the end"),
        (cut, "without plateau before the end"),
    ];
    let contacts = contacts.into_iter().filter(|(list, _)| !list.is_empty());
    let unjudged = acceptance.iter().filter(|limit| limit.pass.is_none());
    unjudged
        .map(|limit| format!("{} has no samples", limit.metric))
        .chain(contacts.map(|(list, what)| format!("{what} at {end} s: {}", list.join(", "))))
        .collect()
}

/// Verdict and reason of a run that nothing stopped.
fn verdict(failures: &[String], missing: &[String]) -> (Verdict, Option<String>) {
    match (failures, missing) {
        ([], []) => (Verdict::Pass, None),
        ([], missing) => (Verdict::NotJudged, Some(missing.join("; "))),
        (failures, _) => (Verdict::Fail, Some(failures.join("; "))),
    }
}
