//! A proposal as TOML for a scenario file: each gain with what limits it.

use std::fmt::{self, Write as _};

use controller_core::joint::DOF;

use super::bounds::{Bound, Cause, NOISE_SHARE, TORQUE_SHARE};
use super::kind::Kind;
use super::link::{ANSWERS, Link};
use super::null_space;
use super::proposal::{LevelGains, Proposal, hertz};
use super::sampled::Reading;
use super::workspace;
use crate::model::figures::shown;

/// Tables of a scenario file: levels, null space, observer.
#[must_use]
pub fn tables(proposal: &Proposal<'_>) -> String {
    into_text(|f| write_tables(f, proposal))
}

/// A whole scenario for the arm as it is named in files, `robot`, from the posture `start`
/// \[rad\]: the flange on a small circle, its orientation held.
#[must_use]
pub fn scenario(proposal: &Proposal<'_>, robot: &str, start: &[f64; DOF]) -> String {
    into_text(|f| {
        // A tenth of a degree is near enough to the posture that was found.
        let start = start.map(|angle| (angle.to_degrees() * 10.0).trunc() / 10.0 + 0.0);
        writeln!(f, "name = \"gains-{}\"", proposal.arm.name)?;
        writeln!(f, "robot = {robot:?}")?;
        writeln!(f, "duration_s = 8.0")?;
        writeln!(f, "cycle_ms = {:?}", 1e3 * proposal.request.cycle_s)?;
        writeln!(
            f,
            "# Where position and orientation of the flange are most mobile."
        )?;
        writeln!(f, "start_deg = {start:?}\n")?;
        write_tables(f, proposal)
    })
}

/// Into memory: it cannot fail.
fn into_text(write: impl FnOnce(&mut String) -> fmt::Result) -> String {
    let mut text = String::new();
    let _ = write(&mut text);
    text
}

fn write_tables(f: &mut String, proposal: &Proposal<'_>) -> fmt::Result {
    let Proposal { arm, gains, .. } = proposal;
    let cycle_ms = 1e3 * proposal.request.cycle_s;
    writeln!(
        f,
        "# Gains for {} in cycles of {cycle_ms} ms; docs/gains.md says why.",
        arm.name
    )?;
    for link in &proposal.links {
        writeln!(f, "# {} plant: {}.", link.name, between(link))?;
    }
    let found = &proposal.found;
    writeln!(
        f,
        "# Spectral radius of the loop, the largest over {} postures and sets of levels: {:.5}; of an arm\n\
         # that answers a torque {} or {} times as much as believed: {:.5}.",
        workspace::POSTURES,
        found.radius,
        ANSWERS[2],
        ANSWERS[1],
        found.radius_off
    )?;
    for level in &proposal.levels {
        write_level(f, proposal, level)?;
    }

    let compliance = &gains.null_space;
    writeln!(f, "\n[null_space]")?;
    writeln!(
        f,
        "# K_q, Nm/rad: {} of the torque limit per rad{}.",
        null_space::TORQUE_SHARE,
        said(
            proposal,
            "less where the joint is light",
            &compliance.is_light
        )
    )?;
    if proposal.friction.iter().any(|friction| *friction > 0.0) {
        let held: [String; DOF] = std::array::from_fn(|joint| {
            let angle = proposal.friction[joint] / compliance.stiffness[joint];
            format!("{:.1}", angle.to_degrees())
        });
        writeln!(
            f,
            "# Friction holds a joint that far from q_d: {} deg.",
            held.join(", ")
        )?;
    }
    writeln!(f, "stiffness = {:?}", compliance.stiffness)?;
    writeln!(
        f,
        "# D, Nms/rad: critical in the median posture{}.",
        said(
            proposal,
            "less where the sampled loop bears less",
            &compliance.is_sampled
        )
    )?;
    writeln!(f, "damping = {:?}", compliance.damping)?;
    writeln!(
        f,
        "# c of D = c M, 1/s, where the loop has dead time: critical for the median mode."
    )?;
    writeln!(f, "damping_rate = {:?}", compliance.damping_rate)?;
    writeln!(f, "\n[observer]")?;
    writeln!(f, "# K_I, 1/s: as fast as the slower of the speed loops.")?;
    writeln!(f, "gain = {:?}", gains.observer_gain)
}

/// ", `what`: A1, A3".
fn said(proposal: &Proposal<'_>, what: &str, joints: &[bool; DOF]) -> String {
    let links = proposal.arm.links.iter().zip(joints);
    let names: Vec<_> = links
        .filter(|(_, is)| **is)
        .map(|(link, _)| link.name)
        .collect();
    match names.is_empty() {
        true => String::new(),
        false => format!(", {what}: {}", names.join(", ")),
    }
}

fn between(link: &Link) -> String {
    let reading = match link.timing.reading {
        Reading::Link => "true positions and speeds".to_string(),
        Reading::Motor => "positions and speeds of the motors".to_string(),
        Reading::Filtered { corner_hz } => {
            format!("speeds from positions through a pole at {corner_hz} Hz")
        }
    };
    let joints = if link.elastic { ", elastic joints" } else { "" };
    format!(
        "{reading}, {} cycles of dead time{joints}",
        link.timing.dead_cycles
    )
}

fn write_level(f: &mut String, proposal: &Proposal<'_>, level: &LevelGains) -> fmt::Result {
    let kind = level.kind;
    let [stiffness, damping] = proposal.gains.of(kind);
    writeln!(f, "\n[[level]]")?;
    if kind == Kind::Orientation {
        writeln!(f, "task = \"orientation\"")?;
    }
    writeln!(f, "point = \"flange\"\naxes = \"xyz\"")?;
    let by = match (proposal.request.bandwidth, level.is_lowered) {
        (Some(_), _) => "as asked for",
        (None, true) => Cause::Workspace.name(),
        (None, false) => level.bounds[0].cause.name(),
    };
    writeln!(
        f,
        "# Bandwidth {:.2} Hz: {by}. It is bounded by",
        hertz(level.bandwidth)
    )?;
    for bound in &level.bounds {
        writeln!(
            f,
            "#   {:>6.2} Hz, {}",
            hertz(bound.bandwidth),
            reason(proposal, kind, bound)
        )?;
    }
    if level.is_lowered {
        writeln!(
            f,
            "#   workspace: lowered until the loop is stable in all postures looked at"
        )?;
    }
    let (error, unit) = (
        1e3 * level.reversal_error,
        match kind {
            Kind::Position => "mm",
            Kind::Orientation => "mrad",
        },
    );
    if error > 0.0 {
        writeln!(
            f,
            "# Friction: {error:.2} {unit} for a moment where all joints turn back at once."
        )?;
    }
    writeln!(
        f,
        "stiffness = {stiffness:?} # K_p, 1/s2\ndamping = {damping:?} # K_d, 1/s"
    )?;
    let reference = match kind {
        Kind::Position => {
            "{ kind = \"circle\", plane = \"yz\", radius_m = 0.03, period_s = 6.0, growth_s = 2.0 }"
        }
        Kind::Orientation => "{ kind = \"hold\" }",
    };
    writeln!(f, "reference = {reference}")
}

fn reason(proposal: &Proposal<'_>, kind: Kind, bound: &Bound) -> String {
    let where_it_is = bound.place.map_or(String::new(), |(joint, posture)| {
        format!(
            " ({} at {})",
            proposal.arm.links[joint].name,
            shown(&posture)
        )
    });
    let why = match bound.cause {
        Cause::Sampling => {
            "a row of the level with twice these gains leaves the unit circle".to_string()
        }
        Cause::Torque => {
            let jump = match kind {
                Kind::Position => format!("{} mm", 1e3 * kind.jump()),
                Kind::Orientation => format!("{} rad", kind.jump()),
            };
            format!("an error of {jump} takes {TORQUE_SHARE} of the torque beside the weight")
        }
        Cause::Noise => format!("rounding of what is read makes {NOISE_SHARE} of the torque limit"),
        Cause::Workspace => String::new(),
    };
    format!("{}: {why}{where_it_is}", bound.cause.name())
}
