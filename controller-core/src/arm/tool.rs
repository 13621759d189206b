//! What an arm carries at its flange.

use nalgebra::{Matrix3, Vector3};

use crate::arm::check::{ArmError, Checks};
use crate::arm::link::{Link, LinkFrame, LinkPoint};
use crate::arm::parameters::ArmParameters;
use crate::arm::pose::Pose;
use crate::ranges::MASS_MIN;

/// A tool, gripper or load fixed to the flange. Plain `f64` data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tool {
    /// Pose of the tool frame in the flange.
    pub pose: Pose,
    /// Mass \[kg\].
    pub mass: f64,
    /// Centre of mass \[m\], in the tool frame.
    pub com: [f64; 3],
    /// Inertia about the centre of mass \[kg m2\], axes of the tool frame, in the order
    /// Ixx Ixy Ixz Iyy Iyz Izz.
    pub inertia: [f64; 6],
}

impl Tool {
    /// Whether a body can have these numbers, or without mass a frame.
    ///
    /// # Errors
    /// [`ArmError`] names the first number that cannot be, with link 0.
    pub fn validate(&self) -> Result<(), ArmError> {
        let mut checks = Checks::NONE;
        checks.pose(&self.pose, ["tool.rotation", "tool.shift"]);
        checks.finite("tool.mass", &[self.mass]);
        checks.finite("tool.com", &self.com);
        checks.finite("tool.inertia", &self.inertia);
        checks.within("tool.mass [kg]", self.mass, [0.0, f64::INFINITY]);
        let is_frame = self.mass == 0.0 && self.inertia == [0.0; 6];
        if !is_frame {
            checks.within("tool.mass [kg]", self.mass, [MASS_MIN, f64::INFINITY]);
            checks.possible(&self.inertia);
        }
        checks.result()
    }
}

impl ArmParameters {
    /// The same arm with a tool: the body of link 7 is that of both together. The tables are
    /// checked where a model is made from them.
    ///
    /// A controller of the new tables takes over a running arm with the old state after
    /// [`State::resume_after_gap`](crate::State::resume_after_gap): the observer keeps its
    /// residual and takes the momentum anew.
    #[must_use]
    pub fn with_tool(&self, tool: &Tool) -> Self {
        let mut arm = *self;
        // They are those of the bare arm.
        arm.damping_postures = &[];
        arm.limits = None;
        let [.., link] = &mut arm.links;
        // nalgebra takes columns.
        let turn = Matrix3::from(self.tool_frame(tool).rotation).transpose();
        let own_com = Vector3::from(link.com);
        let tool_com = Vector3::from(self.tool_point(tool).offset) + turn * Vector3::from(tool.com);
        let own = Body {
            mass: link.mass,
            com: own_com,
            inertia: matrix(&link.inertia),
        };
        let carried = Body {
            mass: tool.mass,
            com: tool_com,
            inertia: turn * matrix(&tool.inertia) * turn.transpose(),
        };
        let both = own.joined(&carried);
        link.mass = both.mass;
        link.com = both.com.into();
        let i = both.inertia;
        link.inertia = [i.m11, i.m12, i.m13, i.m22, i.m23, i.m33];
        arm
    }

    /// The origin of a tool's frame, which moves with link 7.
    #[must_use]
    pub fn tool_point(&self, tool: &Tool) -> LinkPoint {
        LinkPoint {
            link: Link::L7,
            offset: self.flange.place(tool.pose.shift),
        }
    }

    /// A tool's frame, which turns with link 7.
    #[must_use]
    pub fn tool_frame(&self, tool: &Tool) -> LinkFrame {
        LinkFrame {
            link: Link::L7,
            rotation: self.flange.turned(&tool.pose.rotation),
        }
    }
}

/// A body in some frame: mass \[kg\], centre of mass \[m\], inertia about it \[kg m2\].
struct Body {
    mass: f64,
    com: Vector3<f64>,
    inertia: Matrix3<f64>,
}

impl Body {
    /// Both as one. Without any mass it is at the first one's place.
    fn joined(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        let way = other.com - self.com;
        let share = if mass > 0.0 { other.mass / mass } else { 0.0 };
        // Steiner for both, with the reduced mass.
        let reduced = self.mass * share;
        let apart = Matrix3::identity() * way.dot(&way) - way * way.transpose();
        Self {
            mass,
            com: self.com + way * share,
            inertia: self.inertia + other.inertia + apart * reduced,
        }
    }
}

fn matrix(&[xx, xy, xz, yy, yz, zz]: &[f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}
