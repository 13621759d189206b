//! A joint of an arm file, with its link.

use controller_core::arm::{EndApproach, Friction, LinkParameters};
use serde::Deserialize;

use super::pose::each;
use crate::invalid::Invalid;
use crate::ranges::{
    ANGLE_DEG, APPROACH_MARGIN_RAD_S, COULOMB_NM, DECELERATION_RAD_S2, INERTIA_KG_M2,
    JOINT_SPEED_DEG_S, LENGTH_M, LINK_MASS_KG, NAME_LETTERS, POSITION_DEG, ROTOR_KG_M2, Range,
    SMOOTHING_RAD_S, TORQUE_NM, TORQUE_RATE_NM_S, VISCOUS_NMS,
};

/// Largest change of the torque where a file says none \[Nm/s\]: a net, above what motion and
/// contact need.
pub const TORQUE_RATE: f64 = 10e3;

/// The same of braking: a full torque within a few milliseconds \[Nm/s\].
pub const BRAKE_RATE: f64 = 100e3;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct JointSpec {
    pub name: String,
    #[serde(default)]
    a_m: f64,
    #[serde(default)]
    alpha_deg: f64,
    #[serde(default)]
    d_m: f64,
    #[serde(default)]
    angle_offset_deg: f64,
    mass_kg: f64,
    center_of_mass_m: [f64; 3],
    pub inertia_kg_m2: [f64; 6],
    #[serde(default)]
    rotor_inertia_kg_m2: f64,
    #[serde(default)]
    friction: FrictionSpec,
    position_range_deg: [f64; 2],
    speed_limit_deg_s: f64,
    end_approach: Option<EndApproachSpec>,
    torque_limit_nm: f64,
    #[serde(default = "torque_rate")]
    torque_rate_limit_nm_s: f64,
    #[serde(default = "brake_rate")]
    brake_rate_limit_nm_s: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
struct FrictionSpec {
    coulomb_nm: f64,
    viscous_nms_rad: f64,
    smoothing_rad_s: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EndApproachSpec {
    margin_rad_s: f64,
    deceleration_rad_s2: f64,
    ends_deg: [f64; 2],
}

fn torque_rate() -> f64 {
    TORQUE_RATE
}

fn brake_rate() -> f64 {
    BRAKE_RATE
}

impl Default for FrictionSpec {
    fn default() -> Self {
        let Friction {
            coulomb,
            viscous,
            smoothing,
        } = Friction::NONE;
        Self {
            coulomb_nm: coulomb,
            viscous_nms_rad: viscous,
            smoothing_rad_s: smoothing,
        }
    }
}

impl JointSpec {
    /// The link without its name.
    ///
    /// # Errors
    /// The first key that cannot be used.
    pub fn link(&self) -> Result<LinkParameters, Invalid> {
        let letters = self.name.chars();
        if !NAME_LETTERS.contains(letters.clone().count()) || letters.clone().any(char::is_control)
        {
            let allowed = format!("{NAME_LETTERS} letters that print");
            return Err(Invalid::new("name", &self.name, allowed));
        }
        LENGTH_M.check("a_m", self.a_m)?;
        ANGLE_DEG.check("alpha_deg", self.alpha_deg)?;
        LENGTH_M.check("d_m", self.d_m)?;
        ANGLE_DEG.check("angle_offset_deg", self.angle_offset_deg)?;
        LINK_MASS_KG.check("mass_kg", self.mass_kg)?;
        each(LENGTH_M, "center_of_mass_m", &self.center_of_mass_m)?;
        each(INERTIA_KG_M2, "inertia_kg_m2", &self.inertia_kg_m2)?;
        ROTOR_KG_M2.check("rotor_inertia_kg_m2", self.rotor_inertia_kg_m2)?;
        let friction = self
            .friction
            .friction()
            .map_err(|error| error.in_table("friction"))?;
        let [least, greatest] = self.position_range_deg;
        each(POSITION_DEG, "position_range_deg", &self.position_range_deg)?;
        Range::new(least, POSITION_DEG.max).check("position_range_deg", greatest)?;
        JOINT_SPEED_DEG_S.check("speed_limit_deg_s", self.speed_limit_deg_s)?;
        let end_approach = match &self.end_approach {
            Some(approach) => Some(
                approach
                    .end_approach()
                    .map_err(|e| e.in_table("end_approach"))?,
            ),
            None => None,
        };
        TORQUE_NM.check("torque_limit_nm", self.torque_limit_nm)?;
        TORQUE_RATE_NM_S.check("torque_rate_limit_nm_s", self.torque_rate_limit_nm_s)?;
        TORQUE_RATE_NM_S.check("brake_rate_limit_nm_s", self.brake_rate_limit_nm_s)?;
        Ok(LinkParameters {
            name: "",
            a: self.a_m,
            alpha: self.alpha_deg.to_radians(),
            d: self.d_m,
            angle_offset: self.angle_offset_deg.to_radians(),
            mass: self.mass_kg,
            com: self.center_of_mass_m,
            inertia: self.inertia_kg_m2,
            rotor_inertia: self.rotor_inertia_kg_m2,
            friction,
            position_range: self.position_range_deg.map(f64::to_radians),
            speed_limit: self.speed_limit_deg_s.to_radians(),
            end_approach,
            torque_limit: self.torque_limit_nm,
            torque_rate_limit: self.torque_rate_limit_nm_s,
            brake_rate_limit: self.brake_rate_limit_nm_s,
        })
    }
}

impl FrictionSpec {
    fn friction(&self) -> Result<Friction, Invalid> {
        Ok(Friction {
            coulomb: COULOMB_NM.check("coulomb_nm", self.coulomb_nm)?,
            viscous: VISCOUS_NMS.check("viscous_nms_rad", self.viscous_nms_rad)?,
            smoothing: SMOOTHING_RAD_S.check("smoothing_rad_s", self.smoothing_rad_s)?,
        })
    }
}

impl EndApproachSpec {
    fn end_approach(&self) -> Result<EndApproach, Invalid> {
        each(POSITION_DEG, "ends_deg", &self.ends_deg)?;
        Ok(EndApproach {
            margin: APPROACH_MARGIN_RAD_S.check("margin_rad_s", self.margin_rad_s)?,
            deceleration: DECELERATION_RAD_S2
                .check("deceleration_rad_s2", self.deceleration_rad_s2)?,
            ends: self.ends_deg.map(f64::to_radians),
        })
    }
}
