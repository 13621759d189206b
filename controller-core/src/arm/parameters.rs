//! The tables of an arm as plain data.

use crate::arm::limits::JointLimits;
use crate::arm::link::{Link, LinkFrame, LinkPoint, NamedPoint};
use crate::arm::pose::Pose;
use crate::joint::DOF;

/// Tables of one link and of the joint that moves it. Plain `f64` data.
///
/// From DH frame i - 1 to frame i: a turn by q + `offset` about z, a shift `d` along z, a
/// shift `a` along the new x, a twist `alpha` about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkParameters {
    /// The maker's name of the joint, as faults and reports say it.
    pub name: &'static str,
    /// DH length a \[m\], along the new x axis.
    pub a: f64,
    /// DH twist alpha \[rad\], about the new x axis.
    pub alpha: f64,
    /// DH offset d \[m\], along the joint axis.
    pub d: f64,
    /// DH angle at q = 0 \[rad\].
    pub angle_offset: f64,
    /// Mass \[kg\].
    pub mass: f64,
    /// Centre of mass \[m\], in the link's own DH frame.
    pub com: [f64; 3],
    /// Inertia about the centre of mass \[kg m2\], axes of the link's own DH
    /// frame, in the order Ixx Ixy Ixz Iyy Iyz Izz.
    pub inertia: [f64; 6],
    /// Inertia of the rotor as the joint feels it, gear ratio squared \[kg m2\]: added to the
    /// diagonal of M. 0 where unknown or contained in the bodies.
    pub rotor_inertia: f64,
    /// Friction of the joint.
    pub friction: Friction,
    /// Smallest and largest q \[rad\].
    pub position_range: [f64; 2],
    /// Largest |dq| of the data sheet \[rad/s\].
    pub speed_limit: f64,
    /// What the data sheet allows near the ends of the range, where it says so.
    pub end_approach: Option<EndApproach>,
    /// Largest |torque| \[Nm\].
    pub torque_limit: f64,
    /// Largest change of the torque while the law runs \[Nm/s\]: a net below what the drives
    /// and gears can take, above what motion and contact need.
    pub torque_rate_limit: f64,
    /// The same while the arm is braked after a fault \[Nm/s\].
    pub brake_rate_limit: f64,
}

/// Friction torque of a joint, against its speed:
/// `coulomb` tanh(dq / `smoothing`) + `viscous` dq.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// \[Nm\].
    pub coulomb: f64,
    /// \[Nms/rad\].
    pub viscous: f64,
    /// Speed \[rad/s\] within which the Coulomb part changes its sign; above 0.
    pub smoothing: f64,
}

impl Friction {
    /// None, or none known.
    pub const NONE: Self = Self {
        coulomb: 0.0,
        viscous: 0.0,
        smoothing: 0.02,
    };
}

/// A bound of the speed that depends on the position, as the FR3 has it: towards an end at
/// most -`margin` + sqrt(2 `deceleration` x the way to that end). The law within limits brakes
/// early enough for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndApproach {
    /// Speed that is taken off \[rad/s\].
    pub margin: f64,
    /// \[rad/s2\].
    pub deceleration: f64,
    /// The ends \[rad\]; they need not be those of the range.
    pub ends: [f64; 2],
}

impl LinkParameters {
    /// Smallest and largest dq \[rad/s\] at the position `q` \[rad\].
    #[must_use]
    pub fn speed_range(&self, q: f64) -> [f64; 2] {
        let Some(approach) = self.end_approach else {
            return [-self.speed_limit, self.speed_limit];
        };
        let towards = |way: f64| {
            let braked = libm::sqrt((2.0 * approach.deceleration * way).max(0.0));
            (braked - approach.margin).clamp(0.0, self.speed_limit)
        };
        let [start, end] = approach.ends;
        [-towards(q - start), towards(end - q)]
    }
}

/// Tables of a 7-joint arm. Plain `f64` data, usable as a constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmParameters {
    /// Short name, as in scenario files.
    pub name: &'static str,
    /// Pose of DH frame 0 in the base-plate frame: how the arm is mounted.
    pub base: Pose,
    /// Gravitational acceleration \[m/s2\], base-plate axes.
    pub gravity: [f64; 3],
    /// The links, base to flange.
    pub links: [LinkParameters; DOF],
    /// Pose of the flange in DH frame 7.
    pub flange: Pose,
    /// Points that have a name.
    pub points: &'static [NamedPoint],
    /// How the law keeps joints within their ranges and speeds; none: a rule makes it from the
    /// rest of the tables.
    pub limits: Option<JointLimits>,
    /// Postures \[rad\] among which one is the worst for any diagonal null-space damping, of
    /// these very tables. Empty: a search when a controller is made takes their place
    /// ([`crate::law::sampling`]).
    pub damping_postures: &'static [[f64; DOF]],
}

impl ArmParameters {
    /// The origin of the flange, which moves with link 7.
    #[must_use]
    pub const fn flange_point(&self) -> LinkPoint {
        LinkPoint {
            link: Link::L7,
            offset: self.flange.shift,
        }
    }

    /// The frame of the flange, which turns with link 7.
    #[must_use]
    pub const fn flange_frame(&self) -> LinkFrame {
        LinkFrame {
            link: Link::L7,
            rotation: self.flange.rotation,
        }
    }

    /// The point with this name.
    #[must_use]
    pub fn point(&self, name: &str) -> Option<LinkPoint> {
        let mut named = self.points.iter();
        named
            .find(|named| named.name == name)
            .map(|named| named.point)
    }
}
