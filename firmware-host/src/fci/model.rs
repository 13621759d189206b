//! The URDF that the robot gives (GetRobotModel, from version 8), against the arm of the scenario:
//! the numbers with which the robot computes the gravity that it adds.

use std::fmt;

use bridge::audit::{GRAVITY_TOLERANCE_NM, JACOBIAN_TOLERANCE, MASS_TOLERANCE};
use cell::invalid::Invalid;
use cell::model::agreement::Agreement;
use cell::model::chain::{Angles, Chain, Choice, Impossible};
use cell::model::urdf::Urdf;
use controller_core::arm::{ArmModel, ArmParameters};
use controller_core::joint::{DOF, JointState};
use serde::Serialize;

/// States in which the two are compared.
const STATES: u16 = 200;

/// Range to either side of continuous joints \[rad\], which no Franka arm has.
const CONTINUOUS: f64 = std::f64::consts::PI;

/// How far the robot's model is from the table: largest differences.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UrdfAudit {
    /// Name of the robot in the URDF.
    pub name: String,
    /// Gravity torque \[Nm\].
    pub gravity_nm: f64,
    /// Entry of the mass matrix over the largest entry.
    pub mass_share: f64,
    /// Position of the flange \[m\].
    pub flange_m: f64,
    /// Mass of what a joint moves and the next one does not \[kg\].
    pub mass_kg: f64,
    /// That joint, from 1.
    pub mass_joint: usize,
}

impl UrdfAudit {
    /// Compares the text of a URDF with the table of an arm without its tool.
    ///
    /// # Errors
    /// No URDF of seven joints in a row; no arm.
    pub fn of(urdf: &[u8], arm: &ArmParameters) -> Result<Self, Invalid> {
        let text = std::str::from_utf8(urdf).map_err(Invalid::line)?;
        let urdf = Urdf::parse(text)?;
        let choice = Choice {
            base: named(&urdf, "link0"),
            tip: named(&urdf, "link8"),
            continuous: CONTINUOUS,
            impossible: Impossible::Kept,
        };
        let chain = Chain::new(&urdf, &choice, Angles::AsPrinted)?;
        let model = ArmModel::new(arm).map_err(Invalid::line)?;
        let agreement = Agreement::of(arm, &model, &chain, states(arm));
        let masses = chain.bodies.iter().zip(&arm.links);
        let apart = masses.map(|(body, link)| (body.mass - link.mass).abs());
        let worst = (1..).zip(apart);
        let (mass_joint, mass_kg) = worst
            .max_by(|(_, one), (_, other)| one.total_cmp(other))
            .unwrap_or((1, 0.0));
        Ok(Self {
            name: urdf.name.clone(),
            gravity_nm: agreement.gravity.most,
            mass_share: agreement.mass_matrix.share(),
            flange_m: agreement.position.most,
            mass_kg,
            mass_joint,
        })
    }

    /// Whether nothing contradicts the table, by the tolerances of the audit of other robots.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.gravity_nm <= GRAVITY_TOLERANCE_NM
            && self.mass_share <= MASS_TOLERANCE
            && self.flange_m <= JACOBIAN_TOLERANCE
    }
}

impl fmt::Display for UrdfAudit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "URDF '{}' {}: gravity {:.2} Nm, mass matrix {:.1} %, flange {:.1} mm, mass at joint {} {:.3} kg",
            self.name,
            if self.passes() { "agrees" } else { "differs" },
            self.gravity_nm,
            100.0 * self.mass_share,
            1e3 * self.flange_m,
            self.mass_joint,
            self.mass_kg
        )
    }
}

/// The only link whose name ends so: the vendor's have the arm's name in front.
fn named(urdf: &Urdf<'_>, end: &str) -> Option<String> {
    let mut found = urdf.links.iter().filter(|link| link.name.ends_with(end));
    let link = found.next()?;
    found.next().is_none().then(|| link.name.clone())
}

/// States that fill the ranges and speeds of the arm evenly: multiples of numbers without a
/// common measure.
fn states(arm: &ArmParameters) -> impl Iterator<Item = JointState<f64>> {
    const PRIMES: [f64; 2 * DOF] = [
        2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0, 41.0, 43.0,
    ];
    (1..=STATES).map(move |number| {
        let share = |i: usize| (f64::from(number) * PRIMES[i].sqrt()).fract();
        let q: [f64; DOF] = std::array::from_fn(|i| {
            let [min, max] = arm.links[i].position_range;
            min + (max - min) * share(i)
        });
        let dq: [f64; DOF] =
            std::array::from_fn(|i| arm.links[i].speed_limit * (2.0 * share(DOF + i) - 1.0));
        JointState {
            q: q.into(),
            dq: dq.into(),
        }
    })
}
