//! A joint of an arm file, with its link.

use controller_core::arm::{EndApproach, Friction, LinkParameters};

use crate::invalid::Invalid;
use crate::keys::allowed::{And, Said, Shown};
use crate::keys::keys;
use crate::ranges::{
    ANGLE_DEG, APPROACH_MARGIN_RAD_S, COULOMB_NM, DECELERATION_RAD_S2, INERTIA_KG_M2,
    JOINT_SPEED_DEG_S, LENGTH_M, LINK_MASS_KG, POSITION_DEG, ROTOR_KG_M2, Range, SMOOTHING_RAD_S,
    TORQUE_NM, TORQUE_RATE_NM_S, VISCOUS_NMS,
};

/// Largest change of the torque where a file says none \[Nm/s\]: a net, above what motion and
/// contact need.
pub const TORQUE_RATE: f64 = 10e3;

/// The same of braking: a full torque within a few milliseconds \[Nm/s\].
pub const BRAKE_RATE: f64 = 100e3;

keys! {
    /// A joint with its link.
    pub(crate) struct JointSpec {
        /// As faults and reports say it.
        pub name: String, "", Shown;
        /// DH length along the new x.
        a_m: f64 = 0.0, "m", LENGTH_M;
        /// DH twist.
        alpha_deg: f64 = 0.0, "deg", ANGLE_DEG;
        /// DH length along the axis of the joint.
        d_m: f64 = 0.0, "m", LENGTH_M;
        /// DH angle at q = 0.
        angle_offset_deg: f64 = 0.0, "deg", ANGLE_DEG;
        /// Mass of the link.
        mass_kg: f64, "kg", LINK_MASS_KG;
        /// Centre of mass in the link's own DH frame.
        center_of_mass_m: [f64; 3], "m", LENGTH_M;
        /// Ixx Ixy Ixz Iyy Iyz Izz about the centre of mass, axes of that frame.
        pub inertia_kg_m2: [f64; 6], "kg m2", And(INERTIA_KG_M2, "of a body that can be");
        /// Of the rotor as the joint feels it, gear ratio squared; added to M_ii.
        rotor_inertia_kg_m2: f64 = 0.0, "kg m2", ROTOR_KG_M2;
        /// Friction, of the realistic plant.
        friction: FrictionSpec = FrictionSpec::NONE => "none", "", Said("a table");
        /// Least and greatest q.
        position_range_deg: [f64; 2], "deg", And(POSITION_DEG, "the second at least the first");
        /// Largest speed of the data sheet.
        speed_limit_deg_s: f64, "deg/s", JOINT_SPEED_DEG_S;
        /// Speed limit that falls towards the ends of the range.
        end_approach: Option<EndApproachSpec> = None => "none", "", Said("a table");
        /// Largest torque.
        torque_limit_nm: f64, "Nm", TORQUE_NM;
        /// Largest change of the torque while the law runs.
        torque_rate_limit_nm_s: f64 = TORQUE_RATE, "Nm/s", TORQUE_RATE_NM_S;
        /// Largest change of the torque while the arm is braked.
        brake_rate_limit_nm_s: f64 = BRAKE_RATE, "Nm/s", TORQUE_RATE_NM_S;
    }
}

keys! {
    /// Friction of a joint.
    pub(crate) struct FrictionSpec {
        /// Coulomb friction.
        coulomb_nm: f64 = Self::NONE.coulomb_nm, "Nm", COULOMB_NM;
        /// Viscous friction.
        viscous_nms_rad: f64 = Self::NONE.viscous_nms_rad, "Nms/rad", VISCOUS_NMS;
        /// Speed within which Coulomb friction changes its sign.
        smoothing_rad_s: f64 = Self::NONE.smoothing_rad_s, "rad/s", SMOOTHING_RAD_S;
    }
}

keys! {
    /// A speed of at most -margin + sqrt(2 deceleration x way) towards an end.
    pub(crate) struct EndApproachSpec {
        /// Taken off the speed.
        margin_rad_s: f64, "rad/s", APPROACH_MARGIN_RAD_S;
        /// With which the way to the end counts.
        deceleration_rad_s2: f64, "rad/s2", DECELERATION_RAD_S2;
        /// Least and greatest q to which the way counts.
        ends_deg: [f64; 2], "deg", POSITION_DEG;
    }
}

impl JointSpec {
    /// The link without its name.
    ///
    /// # Errors
    /// The first key that cannot be used.
    pub fn link(&self) -> Result<LinkParameters, Invalid> {
        self.check_keys()?;
        let friction = self
            .friction
            .friction()
            .map_err(|error| error.in_table("friction"))?;
        let [least, greatest] = self.position_range_deg;
        Range::new(least, POSITION_DEG.max).check("position_range_deg", greatest)?;
        let end_approach = match &self.end_approach {
            Some(approach) => Some(
                approach
                    .end_approach()
                    .map_err(|e| e.in_table("end_approach"))?,
            ),
            None => None,
        };
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
    /// Of a joint without friction.
    const NONE: Self = Self {
        coulomb_nm: Friction::NONE.coulomb,
        viscous_nms_rad: Friction::NONE.viscous,
        smoothing_rad_s: Friction::NONE.smoothing,
    };

    fn friction(&self) -> Result<Friction, Invalid> {
        self.check_keys()?;
        Ok(Friction {
            coulomb: self.coulomb_nm,
            viscous: self.viscous_nms_rad,
            smoothing: self.smoothing_rad_s,
        })
    }
}

impl EndApproachSpec {
    fn end_approach(&self) -> Result<EndApproach, Invalid> {
        self.check_keys()?;
        Ok(EndApproach {
            margin: self.margin_rad_s,
            deceleration: self.deceleration_rad_s2,
            ends: self.ends_deg.map(f64::to_radians),
        })
    }
}
