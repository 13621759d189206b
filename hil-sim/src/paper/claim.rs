//! What a claim is, and how it is held against its number.

use serde::Serialize;

use super::results::Worst;
use crate::report::ticks;

/// What became of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Verdict {
    /// The number says so.
    #[serde(rename = "confirmed")]
    Confirmed,
    /// A claim of the paper that the number refutes: a result.
    #[serde(rename = "not confirmed")]
    NotConfirmed,
    /// A limit of this project that the number exceeds: a failure.
    #[serde(rename = "out of limit")]
    OutOfLimit,
}

impl Verdict {
    /// As in verdicts.json.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Confirmed => "confirmed",
            Self::NotConfirmed => "not confirmed",
            Self::OutOfLimit => "out of limit",
        }
    }
}

/// A claim with its number.
#[derive(Clone, Debug, Serialize)]
pub struct Claim {
    /// Short name.
    pub id: String,
    /// Section of the paper, or "attribution", "velocity", "stability", "errata".
    pub section: String,
    /// The claim as a sentence.
    pub claim: String,
    /// The number.
    pub measured: f64,
    /// Its unit.
    pub unit: &'static str,
    /// What it is held against; see `sense`.
    pub limit: f64,
    /// "below", "at least".
    pub sense: &'static str,
    /// Verdict.
    pub verdict: Verdict,
    /// The run it is from.
    pub run: String,
}

impl Claim {
    /// "0.459 mm, below 0.55".
    #[must_use]
    pub fn figure(&self) -> String {
        let (measured, unit) = (ticks::figure(self.measured), self.unit);
        format!("{measured} {unit}, {} {}", self.sense, shown(self.limit))
    }
}

/// A limit as text: plain, or by powers of ten where it is tiny.
#[must_use]
pub fn shown(limit: f64) -> String {
    if limit < 1e-5 {
        ticks::figure(limit)
    } else {
        ticks::plain(limit)
    }
}

/// How a number is held against its limit.
#[derive(Clone, Copy)]
pub(super) enum Sense {
    Below(f64),
    AtLeast(f64),
}

/// Whose claim it is: one of the paper may be refuted, a limit of ours not.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Whose {
    Paper,
    Ours,
}

/// Collects claims, those of a section together.
#[derive(Default)]
pub(super) struct Claims(pub Vec<Claim>);

impl Claims {
    /// Holds what was `found` against `sense`. `id` begins with the section and a dash.
    pub fn add(
        &mut self,
        whose: Whose,
        id: &str,
        claim: &str,
        found: Worst,
        unit: &'static str,
        sense: Sense,
    ) {
        let (holds, limit, word) = match sense {
            Sense::Below(limit) => (found.value < limit, limit, "below"),
            Sense::AtLeast(limit) => (found.value >= limit, limit, "at least"),
        };
        let verdict = match (holds, whose) {
            (true, _) => Verdict::Confirmed,
            (false, Whose::Paper) => Verdict::NotConfirmed,
            (false, Whose::Ours) => Verdict::OutOfLimit,
        };
        let (section, _) = id.split_once('-').unwrap_or((id, ""));
        self.0.push(Claim {
            section: section.to_string(),
            id: id.to_string(),
            claim: claim.to_string(),
            measured: found.value,
            unit,
            limit,
            sense: word,
            verdict,
            run: found.run,
        });
    }
}

/// How many claims have this verdict.
#[must_use]
pub fn count(claims: &[Claim], verdict: Verdict) -> usize {
    let with = claims.iter().filter(|claim| claim.verdict == verdict);
    with.count()
}

/// "30 confirmed, 11 not confirmed, 0 out of limit".
#[must_use]
pub fn tally(claims: &[Claim]) -> String {
    let verdicts = [
        Verdict::Confirmed,
        Verdict::NotConfirmed,
        Verdict::OutOfLimit,
    ];
    let counts = verdicts.map(|verdict| format!("{} {}", count(claims, verdict), verdict.name()));
    counts.join(", ")
}
