//! An arm file as TOML: keys, ranges, defaults, and the table that they make.
//! `docs/keys.md` describes every key.

use controller_core::arm::{
    ArmError, ArmModel, ArmParameters, JointLimits, Link, LinkParameters, LinkPoint, NamedPoint,
    Pose,
};
use controller_core::joint::DOF;

use super::joint::JointSpec;
use super::joint_limits::JointLimitsSpec;
use super::pose::PoseSpec;
use crate::invalid::Invalid;
use crate::keys::allowed::{And, Count, Length, Lists, Said, Simple};
use crate::keys::keys;
use crate::ranges::{DAMPING_POSTURES, GRAVITY_M_S2, LENGTH_M, LINK, POINTS, POSITION_DEG, Range};
use crate::reader;

/// Gravity where a file says none: upright, \[m/s2\].
pub const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Names that the flange and a tool have.
const TAKEN: [&str; 2] = ["flange", "tool"];

/// An arm as read: what the core's table borrows it owns.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnArm {
    /// The table without what is borrowed: name, names of joints, points, postures.
    numbers: ArmParameters,
    name: String,
    joints: [String; DOF],
    points: Vec<(String, LinkPoint)>,
    damping_postures: Vec<[f64; DOF]>,
}

keys! {
    /// An arm, as in its file.
    pub(crate) struct ArmSpec {
        /// Its name in reports.
        name: String, "", Simple;
        /// Gravitational acceleration, base-plate axes.
        gravity_m_s2: [f64; 3] = GRAVITY, "m/s2", Length(GRAVITY_M_S2);
        /// DH frame 0 in the base plate.
        base: PoseSpec = PoseSpec::default() => "the base plate", "", Said("a table");
        /// The flange in DH frame 7.
        flange: PoseSpec = PoseSpec::default() => "DH frame 7", "", Said("a table");
        /// Joints with their links, base to flange.
        joints as "joint": Vec<JointSpec>, "", Count(Range::new(DOF, DOF), "joints");
        /// Points that have a name, beside `flange`, which every arm has; import writes `elbow`
        /// and `wrist`, origins of DH frames 3 and 5.
        points as "point": Vec<Point> = Vec::new() => "none", "", Count(POINTS, "points");
        /// What the law may do with the joints.
        joint_limits: Option<JointLimitsSpec> = None => "by a [rule](limits.md)", "",
            Said("a table with all keys of [`[joint_limits]`](#joint_limits)");
        /// Postures of the sampling bound.
        damping_postures_deg: Vec<[f64; DOF]> = Vec::new() => "searched when a controller is made",
            "deg", Lists(Count(DAMPING_POSTURES, "postures"), POSITION_DEG);
    }
}

keys! {
    /// A point that has a name.
    pub(crate) struct Point {
        /// Its name in scenarios.
        name: String, "", And(Simple, "none that another point has, nor `flange` or `tool`");
        /// Number of the link that it is on, base to flange.
        link: usize, "", LINK;
        /// Where it is in the DH frame of the link.
        offset_m: [f64; 3], "m", LENGTH_M;
    }
}

/// Reads and checks an arm file.
///
/// # Errors
/// The first line and key that cannot be used.
pub fn parse(text: &str) -> Result<OwnArm, Invalid> {
    let mut arm = None;
    reader::toml(text, |spec: &mut ArmSpec| {
        arm = Some(spec.arm()?);
        Ok(())
    })?;
    arm.ok_or_else(|| Invalid::line("an arm file that was not checked"))
}

impl OwnArm {
    /// Of the numbers of a table, whose own names and postures count for nothing.
    #[must_use]
    pub fn new(
        numbers: &ArmParameters,
        name: &str,
        joints: [String; DOF],
        damping_postures: Vec<[f64; DOF]>,
    ) -> Self {
        let points = numbers.points.iter();
        Self {
            numbers: unnamed(numbers),
            name: name.to_string(),
            joints,
            points: points
                .map(|named| (named.name.to_string(), named.point))
                .collect(),
            damping_postures,
        }
    }

    /// The table, with what it borrows. It is for the whole life of the program: whoever calls
    /// this has to see that equal arms are not made again and again, as
    /// [`Robot`](super::robot::Robot) does.
    pub(super) fn leak(self) -> &'static ArmParameters {
        let mut arm = self.numbers;
        arm.name = self.name.leak();
        for (link, name) in arm.links.iter_mut().zip(self.joints) {
            link.name = name.leak();
        }
        let named = |(name, point): (String, LinkPoint)| NamedPoint {
            name: name.leak(),
            point,
        };
        arm.points = self
            .points
            .into_iter()
            .map(named)
            .collect::<Vec<_>>()
            .leak();
        arm.damping_postures = self.damping_postures.leak();
        Box::leak(Box::new(arm))
    }

    /// Whether `arm` is this table.
    pub(super) fn is(&self, arm: &ArmParameters) -> bool {
        let same = |((name, point), other): (&(String, LinkPoint), &NamedPoint)| {
            name == other.name && *point == other.point
        };
        unnamed(arm) == self.numbers
            && self.name == arm.name
            && self
                .joints
                .iter()
                .zip(&arm.links)
                .all(|(name, link)| name == link.name)
            && self.points.len() == arm.points.len()
            && self.points.iter().zip(arm.points).all(same)
            && self.damping_postures == arm.damping_postures
    }
}

/// Without what a table borrows.
fn unnamed(arm: &ArmParameters) -> ArmParameters {
    let mut links = arm.links;
    for link in &mut links {
        link.name = "";
    }
    ArmParameters {
        name: "",
        links,
        points: &[],
        damping_postures: &[],
        ..*arm
    }
}

impl ArmSpec {
    fn arm(&self) -> Result<OwnArm, Invalid> {
        self.check_keys()?;
        let base = self.base.pose().map_err(|error| error.in_table("base"))?;
        let flange = self
            .flange
            .pose()
            .map_err(|error| error.in_table("flange"))?;
        let links = self.links()?;
        let limits = match &self.joint_limits {
            Some(limits) => Some(complete(limits).map_err(|error| error.in_table("joint_limits"))?),
            None => None,
        };
        let numbers = ArmParameters {
            name: "",
            base,
            gravity: self.gravity_m_s2,
            links,
            flange,
            points: &[],
            limits,
            damping_postures: &[],
        };
        ArmModel::<f64>::new(&numbers).map_err(|error| self.impossible(&error))?;
        Ok(OwnArm {
            numbers,
            name: self.name.clone(),
            joints: std::array::from_fn(|i| self.joints[i].name.clone()),
            points: self.points(&flange)?,
            damping_postures: (self.damping_postures_deg.iter())
                .map(|posture| posture.map(f64::to_radians))
                .collect(),
        })
    }

    fn links(&self) -> Result<[LinkParameters; DOF], Invalid> {
        let joints: &[JointSpec; DOF] = self.joints.as_slice().try_into().map_err(|_| {
            let given = format!("{} joints", self.joints.len());
            Invalid::new("joint", given, DOF)
        })?;
        let mut links = Vec::with_capacity(DOF);
        for (number, joint) in joints.iter().enumerate() {
            let link = joint
                .link()
                .map_err(|error| error.in_list("joint", number))?;
            links.push(link);
        }
        links
            .try_into()
            .map_err(|_| Invalid::new("joint", "some", DOF))
    }

    /// What of a table whose numbers are in their ranges makes no model.
    fn impossible(&self, error: &ArmError) -> Invalid {
        match *error {
            ArmError::ImpossibleInertia {
                link: number @ 1.., ..
            } => {
                let given = format!("{:?}", self.joints[number - 1].inertia_kg_m2);
                Invalid::new("inertia_kg_m2", given, POSSIBLE).in_list("joint", number - 1)
            }
            ref error => Invalid::line(error),
        }
    }

    /// The named points, and the flange.
    fn points(&self, flange: &Pose) -> Result<Vec<(String, LinkPoint)>, Invalid> {
        let mut points: Vec<(String, LinkPoint)> = Vec::with_capacity(self.points.len() + 1);
        for (number, point) in self.points.iter().enumerate() {
            let place = |error: Invalid| error.in_list("point", number);
            point.check_keys().map_err(place)?;
            let twice = points.iter().any(|(name, _)| *name == point.name);
            if twice || TAKEN.contains(&point.name.as_str()) {
                let allowed = "another name than other points have, and than flange and tool";
                return Err(place(Invalid::new("name", &point.name, allowed)));
            }
            let point_of_link = LinkPoint {
                link: Link::from_number(point.link).unwrap_or(Link::L7),
                offset: point.offset_m,
            };
            points.push((point.name.clone(), point_of_link));
        }
        let flange = LinkPoint {
            link: Link::L7,
            offset: flange.shift,
        };
        points.push((TAKEN[0].to_string(), flange));
        Ok(points)
    }
}

/// What bodies have.
pub const POSSIBLE: &str = "Ixx, Ixy, Ixz, Iyy, Iyz, Izz of a body: principal moments of at least \
                            0, none above the sum of the other two";

fn complete(limits: &JointLimitsSpec) -> Result<JointLimits, Invalid> {
    limits.validate()?;
    limits.complete()
}
