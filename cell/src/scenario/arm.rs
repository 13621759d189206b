//! The arm of a scenario: a table, mounted, with a tool.

use controller_core::arm::{ArmError, ArmModel, ArmParameters, Pose, Tool};
use controller_core::joint::{DOF, Vector3};
use controller_core::{LinkFrame, LinkPoint};

use crate::arm::file::POSSIBLE;
use crate::arm::pose::rotation;
use crate::arm::robot::Robot;
use crate::invalid::Invalid;
use crate::keys::allowed::And;
use crate::keys::keys;
use crate::ranges::{ANGLE_DEG, INERTIA_KG_M2, OFFSET_M, Range, TOOL_MASS_KG};

/// Name of the point in which the frame of a tool has its origin.
pub const TOOL_POINT: &str = "tool";

keys! {
    /// How the base plate stands in a room whose z axis points up. The base-plate frame stands
    /// with it: gravity is turned into that frame, and all else there stays what it is.
    #[derive(Clone, Debug)]
    pub struct Mount {
        /// Roll, pitch, yaw of the base-plate frame in the room: turns about x, then y, then z of
        /// the room, Rz(yaw) Ry(pitch) Rx(roll), as in URDF and ROS; KUKA's A, B, C are yaw,
        /// pitch, roll.
        pub rpy_deg: [f64; 3], "deg", ANGLE_DEG;
    }
}

keys! {
    /// What is fixed to the flange, as one body.
    #[derive(Clone, Debug)]
    pub struct ToolSpec {
        /// Origin of the tool frame in the flange.
        pub shift_m: [f64; 3] = [0.0; 3], "m", OFFSET_M;
        /// Roll, pitch, yaw of the tool frame in the flange, as of a mount.
        pub rpy_deg: [f64; 3] = [0.0; 3], "deg", ANGLE_DEG;
        /// Mass.
        pub mass_kg: f64, "kg", TOOL_MASS_KG;
        /// Centre of mass, tool frame.
        pub center_of_mass_m: [f64; 3], "m", OFFSET_M;
        /// Ixx Ixy Ixz Iyy Iyz Izz about the centre of mass, axes of the tool frame.
        pub inertia_kg_m2: [f64; 6], "kg m2", And(INERTIA_KG_M2, "of a body that can be");
    }
}

/// An arm as it stands: the table with gravity as it is mounted and with its tool.
#[derive(Clone, Debug)]
pub struct EquippedArm {
    /// What plant and controller are made from.
    pub parameters: ArmParameters,
    tool: Option<Tool>,
}

impl EquippedArm {
    /// As in the table, without a tool.
    #[must_use]
    pub fn of(table: &ArmParameters) -> Self {
        Self {
            parameters: *table,
            tool: None,
        }
    }

    /// The arm of this name, or of this arm file, with what a file says of it.
    ///
    /// # Errors
    /// Those of [`Robot::find`] and [`EquippedArm::equipped`].
    pub fn new(
        robot: &str,
        mount: Option<&Mount>,
        tool: Option<&ToolSpec>,
    ) -> Result<Self, Invalid> {
        Self::equipped(Robot::found(robot)?.table()?, mount, tool)
    }

    /// A table with what a file says of it.
    ///
    /// # Errors
    /// Angles, masses, lengths outside their ranges; a body that cannot be.
    pub fn equipped(
        table: &ArmParameters,
        mount: Option<&Mount>,
        tool: Option<&ToolSpec>,
    ) -> Result<Self, Invalid> {
        let mut arm = Self::of(table);
        if let Some(mount) = mount {
            mount
                .check_keys()
                .map_err(|error| error.in_table("mount"))?;
            arm.parameters.gravity = mount.gravity(&table.gravity);
        }
        if let Some(spec) = tool {
            let tool = spec.tool(table).map_err(|error| error.in_table("tool"))?;
            arm.parameters = arm.parameters.with_tool(&tool);
            arm.tool = Some(tool);
        }
        Ok(arm)
    }

    /// The point with this name: one of the table, or that of the tool.
    #[must_use]
    pub fn point(&self, name: &str) -> Option<LinkPoint> {
        let tool = self.tool.as_ref().filter(|_| name == TOOL_POINT);
        let point = tool.map(|tool| self.parameters.tool_point(tool));
        point.or_else(|| self.parameters.point(name))
    }

    /// The tool; none without one.
    #[must_use]
    pub fn tool(&self) -> Option<&Tool> {
        self.tool.as_ref()
    }

    /// The frame of the tool; none without one.
    #[must_use]
    pub fn tool_frame(&self) -> Option<LinkFrame> {
        let tool = self.tool.as_ref();
        tool.map(|tool| self.parameters.tool_frame(tool))
    }

    /// The names of all points, base to tool.
    #[must_use]
    pub fn point_names(&self) -> Vec<&'static str> {
        let tool = self.tool.as_ref().map(|_| TOOL_POINT);
        let named = self.parameters.points.iter().map(|point| point.name);
        named.chain(tool).collect()
    }

    /// The name of a point; none of one without.
    #[must_use]
    pub fn name_of(&self, point: &LinkPoint) -> Option<&'static str> {
        let mut names = self.point_names().into_iter();
        names.find(|name| self.point(name).as_ref() == Some(point))
    }

    /// The maker's name of the joint with this index, from 0.
    #[must_use]
    pub fn joint(&self, index: usize) -> &'static str {
        self.parameters.links[index].name
    }

    /// The maker's names of the joints, base to flange.
    #[must_use]
    pub fn joints(&self) -> [&'static str; DOF] {
        self.parameters.links.map(|link| link.name)
    }

    /// Where the joints may be \[deg\], base to flange: the numbers of the data sheet.
    #[must_use]
    pub fn ranges_deg(&self) -> [Range<f64>; DOF] {
        self.parameters.links.map(|link| {
            // Back from radians.
            let [min, max] = link
                .position_range
                .map(|end| (end.to_degrees() * 1e9).round() / 1e9);
            Range::new(min, max)
        })
    }
}

impl Mount {
    /// Gravity in base-plate axes \[m/s2\], as strong as `of_table`.
    fn gravity(&self, of_table: &[f64; 3]) -> [f64; 3] {
        let strength = Vector3::from(*of_table).norm();
        let [_, _, up] = rotation(self.rpy_deg);
        // R^T (0, 0, -g); never -0.
        up.map(|share| 0.0 - strength * share)
    }
}

impl ToolSpec {
    /// The tool, which must be one that a body can be.
    fn tool(&self, arm: &ArmParameters) -> Result<Tool, Invalid> {
        self.check_keys()?;
        let tool = Tool {
            pose: Pose {
                rotation: rotation(self.rpy_deg),
                shift: self.shift_m,
            },
            mass: self.mass_kg,
            com: self.center_of_mass_m,
            inertia: self.inertia_kg_m2,
        };
        // An arm whose last link is the tool alone is checked as any: joined with that link
        // an impossible body could pass.
        let mut alone = *arm;
        let [.., link] = &mut alone.links;
        (link.mass, link.com, link.inertia) = (tool.mass, tool.com, tool.inertia);
        match ArmModel::<f64>::new(&alone) {
            Ok(_) => Ok(tool),
            Err(ArmError::ImpossibleInertia { .. }) => Err(Invalid::new(
                "inertia_kg_m2",
                format_args!("{:?}", self.inertia_kg_m2),
                POSSIBLE,
            )),
            Err(error) => Err(Invalid::line(error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller_core::Link;

    fn mounted(robot: &str, rpy_deg: [f64; 3]) -> ArmParameters {
        let mount = Mount { rpy_deg };
        let arm = EquippedArm::new(robot, Some(&mount), None);
        arm.expect("angles within their range").parameters
    }

    #[test]
    fn gravity_is_what_a_plumb_line_shows_in_the_plate() {
        for (rpy, gravity) in [
            ([0.0, 0.0, 0.0], [0.0, 0.0, -9.81]),
            // Down is where the plate of a ceiling looks.
            ([180.0, 0.0, 0.0], [0.0, 0.0, 9.81]),
            ([0.0, 180.0, 0.0], [0.0, 0.0, 9.81]),
            // z of the plate along x of the room: its x points down.
            ([0.0, 90.0, 0.0], [9.81, 0.0, 0.0]),
            // z of the plate along -y of the room: its y points up.
            ([90.0, 0.0, 0.0], [0.0, -9.81, 0.0]),
            // Where the wall looks makes no difference.
            ([90.0, 0.0, 137.0], [0.0, -9.81, 0.0]),
        ] {
            assert_eq!(mounted("lwr_iv", rpy).gravity, gravity, "{rpy:?}");
        }
        // Tilted by 30 deg about y: closed form.
        let [x, y, z] = mounted("fr3", [0.0, 30.0, 0.0]).gravity;
        let off = (x - 4.905).abs() + y.abs() + (z + 9.81 * 0.75_f64.sqrt()).abs();
        assert!(off < 1e-14, "{x} {y} {z}");
    }

    #[test]
    fn a_mount_says_where_down_is_whatever_the_table_says() {
        // Its table has it at the side of a torso.
        let table = arms::by_name("openarm_v10_right").expect("a table");
        assert_eq!(table.gravity, [0.0, -9.81, 0.0]);
        assert_eq!(mounted(table.name, [0.0; 3]).gravity, [0.0, 0.0, -9.81]);
        assert_eq!(mounted(table.name, [90.0, 0.0, 0.0]).gravity, table.gravity);
    }

    #[test]
    fn the_tool_is_a_point_of_the_arm_and_part_of_its_last_link() {
        let spec = ToolSpec {
            shift_m: [0.0, 0.0, 0.1],
            rpy_deg: [0.0, 0.0, 90.0],
            mass_kg: 0.5,
            center_of_mass_m: [0.02, 0.0, 0.0],
            inertia_kg_m2: [1e-3, 0.0, 0.0, 1e-3, 0.0, 1e-3],
        };
        let bare = EquippedArm::new("lwr_iv", None, None).expect("a table");
        let arm = EquippedArm::new("lwr_iv", None, Some(&spec)).expect("a tool");
        assert_eq!(bare.point(TOOL_POINT), None);
        let point = arm.point(TOOL_POINT).expect("the tool");
        assert_eq!(point.link, Link::L7);
        assert!((point.offset[2] - 0.178).abs() < 1e-15);
        assert_eq!(arm.name_of(&point), Some(TOOL_POINT));
        assert_eq!(arm.point("elbow"), bare.point("elbow"));
        let [last, before] = [&arm, &bare].map(|arm| arm.parameters.links[DOF - 1]);
        assert!((last.mass - before.mass - 0.5).abs() < 1e-15);
        // The tool's x axis is y of the flange: 0.5 kg at 0.02 m.
        assert!((last.com[1] * last.mass - 0.01).abs() < 1e-15);
    }
}
