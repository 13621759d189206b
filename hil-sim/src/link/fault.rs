//! Faults as they are written: `DIR:KIND=VALUE[@FROM-TO]`.

use std::str::FromStr;

use cell::invalid::Invalid;
use cell::ranges::Range;

/// Probabilities and other shares.
pub const SHARE: Range<f64> = Range::new(0.0, 1.0);

/// Delay and jitter \[ms\].
pub const DELAY_MS: Range<f64> = Range::new(0.0, 10_000.0);

/// Datagrams of a burst.
pub const BURST: Range<u32> = Range::new(1, 10_000);

/// Which way a datagram goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Measurements.
    ToClient,
    /// Answers.
    ToRobot,
}

/// What happens. Probabilities count per datagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// Lost with this probability.
    Drop(f64),
    /// Comes twice with this probability.
    Duplicate(f64),
    /// Overtaken by the next with this probability: one and a half cycles late.
    Reorder(f64),
    /// Late by this time \[s\].
    Delay(f64),
    /// Late by a random time between 0 and this \[s\], evenly distributed.
    Jitter(f64),
    /// One to four random bytes changed with this probability.
    Corrupt(f64),
    /// With this probability so many in a row are lost.
    Burst(f64, u32),
    /// Nothing comes through; all that was sent arrives at the end of the window.
    Freeze,
}

/// Scenario time in which a fault acts \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Start.
    pub from_s: f64,
    /// End.
    pub to_s: f64,
}

impl Window {
    /// Reads "FROM-TO"; none unless both are times from 0 on and FROM is below TO.
    #[must_use]
    pub fn read(text: &str) -> Option<Self> {
        let (from, to) = text.split_once('-')?;
        let number = |text: &str| text.parse::<f64>().ok().filter(|t| *t >= 0.0 && *t < 1e6);
        let (from_s, to_s) = (number(from)?, number(to)?);
        (from_s < to_s).then_some(Self { from_s, to_s })
    }
}

/// A fault of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// One direction; none: both.
    pub direction: Option<Direction>,
    /// What happens.
    pub kind: FaultKind,
    /// When; none: from the first datagram on.
    pub window: Option<Window>,
}

impl Fault {
    /// Whether it acts on a datagram of `direction` sent at scenario time `t_s` \[s\],
    /// none before that runs.
    #[must_use]
    pub fn acts(&self, direction: Direction, t_s: Option<f64>) -> bool {
        let there = self.direction.is_none_or(|only| only == direction);
        let then = match (self.window, t_s) {
            (None, _) => true,
            (Some(_), None) => false,
            (Some(window), Some(t)) => t >= window.from_s && t < window.to_s,
        };
        there && then
    }
}

const KINDS: &[&str] = &[
    "drop",
    "duplicate",
    "reorder",
    "delay",
    "jitter",
    "corrupt",
    "burst",
    "freeze",
];

impl FromStr for Fault {
    type Err = Invalid;

    fn from_str(spec: &str) -> Result<Self, Invalid> {
        let within = |error: Invalid| error.within(format_args!("--fault {spec}"));
        let shape = || {
            let allowed = "DIR:KIND=VALUE[@FROM-TO], such as to-client:drop=0.01@5-10";
            Invalid::new("--fault", spec, allowed)
        };
        let (direction, rest) = spec.split_once(':').ok_or_else(shape)?;
        let direction = match direction {
            "to-client" => Some(Direction::ToClient),
            "to-robot" => Some(Direction::ToRobot),
            "both" => None,
            other => {
                let known = ["to-client", "to-robot", "both"];
                return Err(within(Invalid::name("direction", other, &known)));
            }
        };
        let (what, window) = match rest.split_once('@') {
            None => (rest, None),
            Some((what, window)) => (what, Some(window_of(window).map_err(within)?)),
        };
        let (kind, value) = match what.split_once('=') {
            None => (what, None),
            Some((kind, value)) => (kind, Some(value)),
        };
        let kind = read_kind(kind, value).map_err(within)?;
        if kind == FaultKind::Freeze && window.is_none() {
            let error = Invalid::new("freeze", "no window", "freeze@FROM-TO");
            return Err(within(error));
        }
        Ok(Self {
            direction,
            kind,
            window,
        })
    }
}

fn read_kind(kind: &str, value: Option<&str>) -> Result<FaultKind, Invalid> {
    if !KINDS.contains(&kind) {
        return Err(Invalid::name("fault", kind, KINDS));
    }
    if kind == "freeze" {
        return match value {
            None => Ok(FaultKind::Freeze),
            Some(value) => Err(Invalid::new("freeze", value, "no value")),
        };
    }
    let allowed = match kind {
        "delay" | "jitter" => "a time in ms",
        "burst" => "PxN, such as 0.001x20",
        _ => "a probability, 0 to 1",
    };
    let bad = |value: &str| Invalid::new(kind, value, allowed);
    let value = value.ok_or_else(|| bad("no value"))?;
    let number = |text: &str| text.parse::<f64>().map_err(|_| bad(value));
    let share = |text: &str| number(text).and_then(|p| SHARE.check(kind, p));
    let time = |text: &str| {
        let ms = number(text).and_then(|ms| DELAY_MS.check(kind, ms));
        ms.map(|ms| ms * 1e-3)
    };
    Ok(match kind {
        "drop" => FaultKind::Drop(share(value)?),
        "duplicate" => FaultKind::Duplicate(share(value)?),
        "reorder" => FaultKind::Reorder(share(value)?),
        "delay" => FaultKind::Delay(time(value)?),
        "jitter" => FaultKind::Jitter(time(value)?),
        "corrupt" => FaultKind::Corrupt(share(value)?),
        _ => {
            let (p, count) = value.split_once('x').ok_or_else(|| bad(value))?;
            let count = count.parse().map_err(|_| bad(value))?;
            BURST.check("burst length", count)?;
            FaultKind::Burst(share(p)?, count)
        }
    })
}

fn window_of(text: &str) -> Result<Window, Invalid> {
    let allowed = "FROM-TO in s of the scenario, FROM below TO";
    Window::read(text).ok_or_else(|| Invalid::new("window", text, allowed))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn specs_are_read() {
        let fault: Fault = "to-client:drop=0.25@5-7.5".parse().expect("a spec");
        assert_eq!(fault.kind, FaultKind::Drop(0.25));
        assert!(fault.acts(Direction::ToClient, Some(5.0)));
        assert!(!fault.acts(Direction::ToRobot, Some(5.0)));
        assert!(!fault.acts(Direction::ToClient, Some(7.5)));
        assert!(!fault.acts(Direction::ToClient, None));
        let fault: Fault = "both:burst=0.001x20".parse().expect("a spec");
        assert_eq!(fault.kind, FaultKind::Burst(0.001, 20));
        assert!(fault.acts(Direction::ToRobot, None));
        let fault: Fault = "to-robot:delay=1.5".parse().expect("a spec");
        assert_eq!(fault.kind, FaultKind::Delay(1.5e-3));
        assert!("to-robot:freeze@1-2".parse::<Fault>().is_ok());
    }

    #[test]
    fn wrong_specs_name_thing_value_and_what_is_allowed() {
        for spec in [
            "",
            "drop=1",
            "up:drop=1",
            "both:dorp=1",
            "both:drop",
            "both:drop=2",
            "both:drop=x",
            "both:drop=NaN",
            "both:delay=-1",
            "both:burst=0.1",
            "both:burst=0.1x0",
            "both:freeze",
            "both:freeze=1@1-2",
            "both:drop=1@3",
            "both:drop=1@4-3",
            "both:drop=1@a-b",
        ] {
            let error = spec.parse::<Fault>().expect_err(spec).to_string();
            assert!(error.contains("allowed"), "{error}");
            assert_eq!(error.lines().count(), 1);
        }
    }
}
