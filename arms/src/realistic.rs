//! How a true arm departs from its table, where that is known: what a simulated arm is made of.
//!
//! The controller's tables say what is believed. The plant of a simulator adds what is found on the
//! arm: other bodies, the friction that acts on the links, what passes between controller and
//! motors. Each arm's file says where its numbers come from.

use controller_core::arm::{ArmParameters, Friction};
use controller_core::joint::DOF;

/// Encoder step \[rad\] of arms of which it is not known. Chosen.
pub const ENCODER_STEP: f64 = 2e-5;

/// A true arm beside its table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Realistic {
    /// Its bodies.
    pub bodies: Bodies,
    /// Friction that acts on the links, base to flange: where a robot compensates that of its
    /// motors, what is left.
    pub friction: [Friction; DOF],
    /// What passes between controller and joints.
    pub interface: Interface,
    /// Cycles between a torque command and its effect.
    pub dead_cycles: u8,
}

/// How far the bodies are from those of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bodies {
    /// Nobody knows: a simulator draws errors, other ones for every seed.
    Drawn,
    /// As identified, base to flange, in place of those of the table.
    Known(&'static [Body; DOF]),
}

/// The body of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Mass \[kg\].
    pub mass: f64,
    /// Centre of mass \[m\], in the link's own DH frame.
    pub com: [f64; 3],
    /// Inertia about the centre of mass \[kg m2\], axes of the link's own DH frame, in the order
    /// Ixx Ixy Ixz Iyy Iyz Izz.
    pub inertia: [f64; 6],
}

/// What passes between controller and joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interface {
    /// Positions by encoders, of which speeds are made; torques as they are.
    Encoders {
        /// Of all joints \[rad\].
        step: f64,
    },
    /// Frames of a motor bus, base to flange: positions, speeds and torques in a few bits.
    Frames([MotorRanges; DOF]),
}

/// What the frames of a motor carry: from minus these to plus these.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorRanges {
    /// \[rad\].
    pub position: f64,
    /// \[rad/s\].
    pub speed: f64,
    /// \[Nm\].
    pub torque: f64,
}

impl Realistic {
    /// Of an arm of which nothing is known but its table: errors are drawn, friction is the
    /// table's, which may have none.
    #[must_use]
    pub const fn of_table(table: &ArmParameters) -> Self {
        let mut friction = [Friction::NONE; DOF];
        let mut joint = 0;
        while joint < DOF {
            friction[joint] = table.links[joint].friction;
            joint += 1;
        }
        Self {
            bodies: Bodies::Drawn,
            friction,
            interface: Interface::Encoders { step: ENCODER_STEP },
            dead_cycles: 0,
        }
    }

    /// Whether no joint has friction: then it is not known.
    #[must_use]
    pub fn is_frictionless(&self) -> bool {
        let mut joints = self.friction.iter();
        joints.all(|friction| friction.coulomb == 0.0 && friction.viscous == 0.0)
    }
}
