//! When contacts act.

use crate::invalid::Invalid;

/// How long after a contact its effect still counts as inside \[s\].
pub const AFTERMATH_S: f64 = 0.3;

/// Length of the stretch before the force goes down whose mean error is the plateau \[s\].
pub const PLATEAU_S: f64 = 0.2;

/// What the start of a contact has to be.
pub(super) const BEFORE_END: &str = "before `to_s`";

/// What the end of a contact has to be.
pub(super) const AFTER_START: &str = "after `from_s`";

/// What a ramp of a contact has to be.
pub(super) const HALF_INTERVAL: &str = "above 0, at most half the interval";

/// When a contact acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Start \[s\].
    pub from_s: f64,
    /// End \[s\].
    pub to_s: f64,
    /// Time in which the force goes up and in which it goes down \[s\].
    pub ramp_s: f64,
}

impl Interval {
    /// Whether `t_s` belongs to the contact or its aftermath.
    #[must_use]
    pub fn inside(&self, t_s: f64) -> bool {
        t_s >= self.from_s && t_s <= self.to_s + AFTERMATH_S
    }

    /// Whether `t_s` belongs to the plateau.
    #[must_use]
    pub fn plateau(&self, t_s: f64) -> bool {
        let end = self.to_s - self.ramp_s;
        t_s >= end - PLATEAU_S && t_s <= end
    }
}

/// The length \[s\] of a contact, which must not end before it starts.
pub(super) fn length(from_s: f64, to_s: f64) -> Result<f64, Invalid> {
    if to_s <= from_s {
        return Err(Invalid::new(
            "to_s",
            to_s,
            format_args!("above from_s = {from_s}"),
        ));
    }
    Ok(to_s - from_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_has_a_plateau_and_an_aftermath() {
        let interval = Interval {
            from_s: 3.0,
            to_s: 6.0,
            ramp_s: 0.3,
        };
        assert!(interval.plateau(5.6) && !interval.plateau(5.4) && !interval.plateau(5.8));
        assert!(interval.inside(6.2) && !interval.inside(6.4) && !interval.inside(2.9));
    }
}
