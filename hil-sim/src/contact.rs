//! Contacts: forces of the environment on points of the arm.

use controller_core::joint::{JointState, JointVector, Vector3};
use serde::Deserialize;

use crate::invalid::{Invalid, in_range, positive};
use crate::plant::PlantModel;
use crate::scenario::PointSpec;

/// How long after a contact its effect still counts as inside \[s\].
pub const AFTERMATH_S: f64 = 0.3;

/// Length of the stretch before the force ramps down whose mean error is the plateau \[s\].
pub const PLATEAU_S: f64 = 0.2;

/// A scripted push: constant force between two linear ramps.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Where the force acts.
    pub point: PointSpec,
    /// Start \[s\].
    pub from_s: f64,
    /// End \[s\].
    pub to_s: f64,
    /// Length of each ramp, inside the interval \[s\].
    pub ramp_s: f64,
    /// Force on the arm \[N\], base-plate axes.
    pub force_n: [f64; 3],
}

impl Contact {
    /// Checks point, times and force.
    ///
    /// # Errors
    /// What cannot be used.
    pub fn validate(&self) -> Result<(), Invalid> {
        self.point.validate()?;
        in_range("from_s", self.from_s, 0.0, 3600.0)?;
        in_range("to_s", self.to_s, 0.0, 3600.0)?;
        if self.to_s <= self.from_s {
            return Err(Invalid::new(
                "to_s",
                self.to_s,
                format_args!("above from_s = {}", self.from_s),
            ));
        }
        let half = (self.to_s - self.from_s) / 2.0;
        positive("ramp_s", self.ramp_s, half)?;
        self.force_n
            .iter()
            .try_for_each(|&force| in_range("force_n", force, -1e4, 1e4).map(drop))
    }

    /// Force on the arm at time `t_s` \[N\].
    #[must_use]
    pub fn force(&self, t_s: f64) -> Vector3<f64> {
        let ramp = ((t_s - self.from_s) / self.ramp_s).min((self.to_s - t_s) / self.ramp_s);
        Vector3::from(self.force_n) * ramp.clamp(0.0, 1.0)
    }

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

/// Joint torque of all contacts \[Nm\]: the sum of J^T F, which is -tau_ext of (6).
#[must_use]
pub fn joint_torque(
    contacts: &[Contact],
    t_s: f64,
    plant: &PlantModel,
    state: &JointState<f64>,
) -> JointVector<f64> {
    let mut torque = JointVector::zeros();
    for contact in contacts {
        let force = contact.force(t_s);
        if force != Vector3::zeros() {
            let point = contact.point.resolve();
            torque += plant.point_torque(&state.q, point.link, &point.offset, &force);
        }
    }
    torque
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_force_ramps_inside_its_interval() {
        let contact = Contact {
            point: PointSpec::Name("elbow".into()),
            from_s: 3.0,
            to_s: 6.0,
            ramp_s: 0.3,
            force_n: [0.0, 35.0, 0.0],
        };
        for (t, share) in [
            (2.9, 0.0),
            (3.0, 0.0),
            (3.15, 0.5),
            (3.3, 1.0),
            (5.7, 1.0),
            (5.85, 0.5),
            (6.0, 0.0),
            (7.0, 0.0),
        ] {
            assert!((contact.force(t).y - 35.0 * share).abs() < 1e-9, "{t}");
        }
        assert!(contact.plateau(5.6) && !contact.plateau(5.4) && !contact.plateau(5.8));
        assert!(contact.inside(6.2) && !contact.inside(6.4));
    }
}
