//! Seven turning joints of a URDF in a row, with everything that rides along: every joint a line,
//! every body where it is at q = 0, all in axes of the base link.

use std::f64::consts::FRAC_PI_2;

use controller_core::joint::{DOF, Matrix3, Vector3};

use super::body::{Body, Moved};
use super::frame::Frame;
use super::tree::Tree;
use super::urdf::{Joint, Kind, Urdf};
use crate::arm::pose::rotation_of;
use crate::invalid::Invalid;
use crate::ranges::{JOINT_SPEED_DEG_S, LINK_MASS_KG, POSITION_DEG, Range, TORQUE_NM};

/// How far from a right angle \[rad\] one that is meant may be printed: 1.5708 is 3.7e-6 away.
pub const RIGHT_ANGLE_ERROR: f64 = 2e-5;

/// Where a chain starts and ends, and what is made of what a URDF leaves open.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The link that stands still; without it the root.
    pub base: Option<String>,
    /// The link at the end; without it the only end there is.
    pub tip: Option<String>,
    /// Range to either side of continuous joints \[rad\].
    pub continuous: f64,
    /// What becomes of bodies that cannot be.
    pub impossible: Impossible,
}

/// What becomes of angles near a right one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Angles {
    /// They are right ones.
    Exact,
    /// They stay as they are printed.
    AsPrinted,
}

/// What becomes of a body that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Impossible {
    /// It is refused.
    Refused,
    /// The nearest possible one takes its place.
    Nearest,
    /// It stays as it is printed.
    Kept,
}

/// Seven joints and what they move.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Name of the link that stands still.
    pub base: String,
    /// Name of the link at the end.
    pub end: String,
    /// Base to end.
    pub joints: [Turn; DOF],
    /// What moves with each joint and not with the next, at q = 0, axes of the base.
    pub bodies: [Body; DOF],
    /// The last link at q = 0, in the base.
    pub tip: Frame,
    /// What was made of what the file leaves open.
    pub notes: Vec<String>,
    /// How far printed right angles of joints below the base are from right ones \[rad\].
    pub snapped: Vec<f64>,
}

/// A joint: a line at q = 0, axes of the base.
#[derive(Clone, Debug)]
pub struct Turn {
    /// Its name.
    pub name: String,
    /// Unit vector.
    pub axis: Vector3<f64>,
    /// A point of the line \[m\].
    pub point: Vector3<f64>,
    /// \[rad\].
    pub range: [f64; 2],
    /// \[rad/s\].
    pub speed: f64,
    /// \[Nm\].
    pub torque: f64,
    /// Coulomb friction \[Nm\], viscous friction \[Nms/rad\].
    pub friction: [f64; 2],
}

impl Chain {
    /// Finds the chain.
    ///
    /// # Errors
    /// There is none, or not one alone; a number that no arm has.
    pub fn new(urdf: &Urdf<'_>, choice: &Choice, angles: Angles) -> Result<Self, Invalid> {
        let tree = Tree::new(urdf)?;
        let base = match &choice.base {
            Some(name) => urdf.link("--base", name)?,
            None => tree.root,
        };
        let end = match &choice.tip {
            Some(name) => urdf.link("--tip", name)?,
            None => tree.only_end(base)?,
        };
        let path = tree.path(base, end)?;
        let turning: Vec<usize> = path
            .iter()
            .copied()
            .filter(|&joint| urdf.joints[joint].kind != Kind::Fixed)
            .collect();
        for &joint in &turning {
            refuse_other_kinds(urdf, &urdf.joints[joint])?;
        }
        let turning: [usize; DOF] = turning.try_into().map_err(|turning: Vec<usize>| {
            let from_to = (&urdf.links[base].name, &urdf.links[end].name);
            let given = format!("{} from '{}' to '{}'", turning.len(), from_to.0, from_to.1);
            Invalid::new("turning joints", given, DOF)
        })?;

        let mut walk = Walk {
            urdf,
            choice,
            angles,
            notes: Vec::new(),
            snapped: Vec::new(),
        };
        let frames = walk.frames(&tree, base);
        let at = |link: usize| frames[link].unwrap_or(Frame::identity());
        let mut bodies = [Body::none(); DOF];
        for (link, carrier) in tree.carriers(base, &turning).into_iter().enumerate() {
            let Some(number) = carrier else { continue };
            if let Some(body) = walk.body(link)? {
                bodies[number] = bodies[number].with(&body.carried(&at(link)));
            }
        }
        for (body, &joint) in bodies.iter().zip(&turning) {
            let thing = "mass of what it moves [kg]";
            let checked = LINK_MASS_KG.check(thing, body.mass);
            checked.map_err(|error| urdf.at_joint(&urdf.joints[joint], error))?;
        }
        walk.tell_of_locked(&tree, base, &turning);
        let mut joints = Vec::with_capacity(DOF);
        for joint in turning {
            joints.push(walk.turn(joint, &at(urdf.joints[joint].child))?);
        }
        let Ok(joints) = joints.try_into() else {
            return Err(Invalid::new("turning joints", "some", DOF));
        };
        Ok(Self {
            base: urdf.links[base].name.clone(),
            end: urdf.links[end].name.clone(),
            joints,
            bodies,
            tip: at(end),
            notes: walk.notes,
            snapped: walk.snapped,
        })
    }
}

fn refuse_other_kinds(urdf: &Urdf<'_>, joint: &Joint) -> Result<(), Invalid> {
    let refusal = |given: &str| {
        let error = Invalid::new(
            "type",
            given,
            "revolute, continuous or fixed from base to tip",
        );
        Err(urdf.at_joint(joint, error))
    };
    match joint.kind {
        Kind::Other => refusal("prismatic, planar or floating"),
        _ if joint.is_mimic => refusal("mimic"),
        _ => Ok(()),
    }
}

/// What is read on the way, with what is said of it.
struct Walk<'a> {
    urdf: &'a Urdf<'a>,
    choice: &'a Choice,
    angles: Angles,
    notes: Vec<String>,
    snapped: Vec<f64>,
}

impl Walk<'_> {
    /// The nearest right angle, where it is near and is to be exact.
    fn angle(&mut self, angle: f64) -> f64 {
        let right = (angle / FRAC_PI_2).round() * FRAC_PI_2;
        let off = (angle - right).abs();
        if off > RIGHT_ANGLE_ERROR {
            return angle;
        }
        if off > 0.0 {
            self.snapped.push(off);
        }
        if self.angles == Angles::Exact {
            right
        } else {
            angle
        }
    }

    /// The same of an axis: one of the coordinates, where it is near.
    fn axis(&mut self, axis: [f64; 3]) -> Vector3<f64> {
        let unit = Vector3::from(axis).normalize();
        let coordinate = unit.map(f64::round);
        let off = unit.cross(&coordinate).norm();
        if coordinate.norm_squared() != 1.0 || off > RIGHT_ANGLE_ERROR {
            return unit;
        }
        if off > 0.0 {
            self.snapped.push(off);
        }
        if self.angles == Angles::Exact {
            coordinate
        } else {
            unit
        }
    }

    /// Every link below the base at q = 0, in the base; joints that are not in the chain are
    /// at 0.
    fn frames(&mut self, tree: &Tree<'_>, base: usize) -> Vec<Option<Frame>> {
        let mut frames = vec![None; self.urdf.links.len()];
        frames[base] = Some(Frame::identity());
        for &joint in &tree.outward {
            let joint = &self.urdf.joints[joint];
            let Some(parent) = frames[joint.parent] else {
                continue;
            };
            let [shift, rpy] = joint.origin;
            let rpy = rpy.map(|angle| self.angle(angle));
            let own = Frame {
                rotation: Matrix3::from(rotation_of(rpy)).transpose(),
                shift: shift.into(),
            };
            // What is above the base stands still and moves nothing.
            if frames[joint.child].is_none() {
                frames[joint.child] = Some(parent.carrying(&own));
            }
        }
        frames
    }

    /// The body of a link, possible or made so.
    fn body(&mut self, link: usize) -> Result<Option<Body>, Invalid> {
        let link = &self.urdf.links[link];
        let Some(body) = link.body else {
            return Ok(None);
        };
        let error = match (body.check(), self.choice.impossible) {
            (Ok(()), _) | (Err(_), Impossible::Kept) => return Ok(Some(body)),
            (Err(error), Impossible::Nearest) => error,
            (Err(error), Impossible::Refused) => {
                let error = self.urdf.at_link(link, error);
                let way_out = "--nearest takes the nearest body that can be";
                return Err(Invalid::line(format_args!("{error}; {way_out}")));
            }
        };
        let (near, Moved { mass, inertia }) = body.nearest();
        let [change, size] = inertia;
        let share = 100.0 * change / size.max(f64::MIN_POSITIVE);
        self.notes.push(format!(
            "link '{}': {error}; the nearest body is {change:.2e} kg m2 away, \
             {share:.2} % of its inertia, and {mass:e} kg",
            link.name
        ));
        Ok(Some(near))
    }

    /// Says which joints beside the chain do not move any more.
    fn tell_of_locked(&mut self, tree: &Tree<'_>, base: usize, turning: &[usize; DOF]) {
        let carriers = tree.carriers(base, turning);
        for (number, joint) in self.urdf.joints.iter().enumerate() {
            let Some(carrier) = carriers[joint.child] else {
                continue;
            };
            if joint.kind != Kind::Fixed && !turning.contains(&number) {
                let with = &self.urdf.joints[turning[carrier]].name;
                let note = format!(
                    "joint '{}' is not in the chain: it stays at 0, and what it \
                                    carries rides with joint '{with}'",
                    joint.name
                );
                self.notes.push(note);
            }
        }
    }

    fn turn(&mut self, joint: usize, frame: &Frame) -> Result<Turn, Invalid> {
        let joint = &self.urdf.joints[joint];
        let place = |error: Invalid| self.urdf.at_joint(joint, error);
        let degrees = |range: Range<f64>, thing: &str, value: Option<f64>| {
            let radians = range.in_radians();
            let value = value.ok_or_else(|| Invalid::new(thing, "missing", radians));
            value
                .and_then(|value| radians.check(thing, value))
                .map_err(place)
        };
        let limit = joint.limit;
        let speed = degrees(JOINT_SPEED_DEG_S, "limit velocity [rad/s]", limit.velocity)?;
        let effort = "limit effort [Nm]";
        let torque = limit
            .effort
            .ok_or_else(|| Invalid::new(effort, "missing", TORQUE_NM));
        let torque = torque
            .and_then(|torque| TORQUE_NM.check(effort, torque))
            .map_err(place)?;
        let range = if joint.kind == Kind::Continuous {
            let own = self.choice.continuous;
            let degrees = own.to_degrees();
            self.notes.push(format!(
                "joint '{}' is continuous: its range is -{degrees} to {degrees} deg",
                joint.name
            ));
            [-own, own]
        } else {
            let lower = degrees(POSITION_DEG, "limit lower [rad]", limit.lower)?;
            let upper = degrees(POSITION_DEG, "limit upper [rad]", limit.upper)?;
            let above = Range::above(lower, POSITION_DEG.in_radians().max);
            [
                lower,
                above.check("limit upper [rad]", upper).map_err(place)?,
            ]
        };
        let axis = self.axis(joint.axis);
        Ok(Turn {
            name: joint.name.clone(),
            axis: frame.rotation * axis,
            point: frame.shift,
            range,
            speed,
            torque,
            friction: [joint.friction, joint.damping],
        })
    }
}
