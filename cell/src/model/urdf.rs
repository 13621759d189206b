//! A URDF as data: links and joints, every number in its range. What they are good for is
//! decided in [`super::chain`].

use std::collections::HashMap;

use controller_core::joint::{Matrix3, Vector3};
use roxmltree::{Document, Node};

use super::body::Body;
use super::frame::Frame;
use crate::arm::pose::rotation_of;
use crate::invalid::Invalid;
use crate::ranges::{
    AXIS_LENGTH, COULOMB_NM, INERTIA_KG_M2, LENGTH_M, LINK_MASS_KG, Range, VISCOUS_NMS,
};

/// Roll, pitch, yaw \[rad\]: two turns. Degrees are beyond.
const RPY_RAD: Range<f64> = Range::new(-12.6, 12.6);

/// A mass as it is written: whether a body can have it is asked of the body \[kg\].
const WRITTEN_MASS_KG: Range<f64> = Range::new(-1000.0, 1000.0);

/// A limit as it is written: whether a joint can have it is asked of joints of the chain.
const WRITTEN_LIMIT: Range<f64> = Range::new(-1e6, 1e6);

/// Links and joints of a robot.
pub struct Urdf<'a> {
    text: &'a str,
    /// Name of the robot.
    pub name: String,
    /// In the order of the file.
    pub links: Vec<Link>,
    /// In the order of the file.
    pub joints: Vec<Joint>,
}

/// A link.
pub struct Link {
    /// Its name.
    pub name: String,
    /// Where in the text it is.
    at: usize,
    /// In the axes of the link; none where the file gives none, or no mass and no inertia.
    pub body: Option<Body>,
}

/// A joint: from `parent` to `child`, both indices of links.
pub struct Joint {
    /// Its name.
    pub name: String,
    /// Where in the text it is.
    at: usize,
    /// How it moves.
    pub kind: Kind,
    /// The link it is on.
    pub parent: usize,
    /// The link it moves.
    pub child: usize,
    /// Origin of the child in the parent \[m\], roll, pitch and yaw \[rad\].
    pub origin: [[f64; 3]; 2],
    /// Axis, axes of the child; not of length 1.
    pub axis: [f64; 3],
    /// `lower`, `upper` \[rad\], `effort` \[Nm\], `velocity` \[rad/s\], as far as given.
    pub limit: Limit,
    /// `damping` \[Nms/rad\].
    pub damping: f64,
    /// `friction` \[Nm\].
    pub friction: f64,
    /// Whether it follows another joint.
    pub is_mimic: bool,
}

/// The limits of a joint, as far as they are given.
#[derive(Clone, Copy, Default)]
pub struct Limit {
    /// \[rad\].
    pub lower: Option<f64>,
    /// \[rad\].
    pub upper: Option<f64>,
    /// \[Nm\].
    pub effort: Option<f64>,
    /// \[rad/s\].
    pub velocity: Option<f64>,
}

/// How a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Not at all.
    Fixed,
    /// Turns within limits.
    Revolute,
    /// Turns without end.
    Continuous,
    /// Prismatic, planar or floating: it does more than turn.
    Other,
}

/// What a file that is none is told.
const ALLOWED: &str = "a URDF: XML with a root element <robot>; xacro and MJCF have to be \
                       converted to it first";

impl<'a> Urdf<'a> {
    /// Reads the text of a URDF.
    ///
    /// # Errors
    /// The first line and element that cannot be used.
    pub fn parse(text: &'a str) -> Result<Self, Invalid> {
        let document = Document::parse(text).map_err(|error| {
            let line = format!("line {}", error.pos().row);
            Invalid::new("XML", error, ALLOWED).within(line)
        })?;
        let root = document.root_element();
        if root.tag_name().name() != "robot" {
            let given = format!("root element <{}>", root.tag_name().name());
            return Err(Invalid::new("XML", given, ALLOWED));
        }
        let mut urdf = Self {
            text,
            name: root.attribute("name").unwrap_or_default().to_string(),
            links: Vec::new(),
            joints: Vec::new(),
        };
        let mut by_name = HashMap::new();
        for node in root.children().filter(Node::is_element) {
            if node.tag_name().namespace().is_some() {
                let given = format!("element <{}> of xacro", node.tag_name().name());
                let error = Invalid::new("XML", given, ALLOWED);
                return Err(urdf.on_line(node.range().start, error));
            }
            if node.has_tag_name("link") {
                let link = urdf.named(&node, link)?;
                if by_name
                    .insert(link.name.clone(), urdf.links.len())
                    .is_some()
                {
                    let given = format!("'{}' twice", link.name);
                    return Err(urdf.on_line(link.at, Invalid::new("link", given, "once")));
                }
                urdf.links.push(link);
            }
        }
        let known: Vec<&str> = urdf.links.iter().map(|link| link.name.as_str()).collect();
        let mut joints = Vec::new();
        for node in root.children().filter(|node| node.has_tag_name("joint")) {
            joints.push(urdf.named(&node, |node, name| joint(node, name, &by_name, &known))?);
        }
        urdf.joints = joints;
        Ok(urdf)
    }

    fn named<T>(
        &self,
        node: &Node<'_, '_>,
        read: impl Fn(&Node<'_, '_>, &str) -> Result<T, Invalid>,
    ) -> Result<T, Invalid> {
        let thing = node.tag_name().name();
        let at = node.range().start;
        let name = node.attribute("name").unwrap_or_default();
        if name.is_empty() || name.chars().count() > 64 || name.chars().any(char::is_control) {
            let error = Invalid::new(format!("{thing} name"), name, "1 to 64 letters that print");
            return Err(self.on_line(at, error));
        }
        read(node, name)
            .map_err(|error| self.on_line(at, error.within(format_args!("{thing} '{name}'"))))
    }

    /// The same error, of what starts at this place of the text.
    fn on_line(&self, at: usize, error: Invalid) -> Invalid {
        let line = self.text[..at].matches('\n').count() + 1;
        error.within(format_args!("line {line}"))
    }

    /// The same error, of a joint.
    #[must_use]
    pub fn at_joint(&self, joint: &Joint, error: Invalid) -> Invalid {
        self.on_line(
            joint.at,
            error.within(format_args!("joint '{}'", joint.name)),
        )
    }

    /// The same error, of a link.
    #[must_use]
    pub fn at_link(&self, link: &Link, error: Invalid) -> Invalid {
        self.on_line(link.at, error.within(format_args!("link '{}'", link.name)))
    }

    /// The link with this name.
    ///
    /// # Errors
    /// As of `option`: the names that there are.
    pub fn link(&self, option: &str, name: &str) -> Result<usize, Invalid> {
        let found = self.links.iter().position(|link| link.name == name);
        found.ok_or_else(|| {
            let known: Vec<&str> = self.links.iter().map(|link| link.name.as_str()).collect();
            Invalid::name(option, name, &known)
        })
    }
}

fn child<'a, 'i>(node: &Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// The number in an attribute; none where it is not there.
fn number(
    node: Option<&Node<'_, '_>>,
    attribute: &str,
    range: Range<f64>,
) -> Result<Option<f64>, Invalid> {
    let Some((node, text)) = node.and_then(|node| Some((node, node.attribute(attribute)?))) else {
        return Ok(None);
    };
    let thing = format!("{} {attribute}", node.tag_name().name());
    match text.trim().parse() {
        Ok(value) => range.check(thing, value).map(Some),
        Err(_) => Err(Invalid::new(thing, format_args!("'{text}'"), range)),
    }
}

/// The three numbers in an attribute; `default` where it is not there.
fn three(
    node: Option<&Node<'_, '_>>,
    attribute: &str,
    range: Range<f64>,
    default: [f64; 3],
) -> Result<[f64; 3], Invalid> {
    let Some((node, text)) = node.and_then(|node| Some((node, node.attribute(attribute)?))) else {
        return Ok(default);
    };
    let thing = format!("{} {attribute}", node.tag_name().name());
    let numbers: Option<Vec<f64>> = text
        .split_whitespace()
        .map(|word| word.parse().ok())
        .collect();
    let numbers: Option<[f64; 3]> = numbers.and_then(|numbers| numbers.try_into().ok());
    let Some(numbers) = numbers else {
        let allowed = format!("three numbers, each {range}");
        return Err(Invalid::new(thing, format_args!("'{text}'"), allowed));
    };
    for value in numbers {
        range.check(&thing, value)?;
    }
    Ok(numbers)
}

fn origin(node: &Node<'_, '_>) -> Result<[[f64; 3]; 2], Invalid> {
    let origin = child(node, "origin");
    Ok([
        three(origin.as_ref(), "xyz", LENGTH_M, [0.0; 3])?,
        three(origin.as_ref(), "rpy", RPY_RAD, [0.0; 3])?,
    ])
}

fn link(node: &Node<'_, '_>, name: &str) -> Result<Link, Invalid> {
    let body = match child(node, "inertial") {
        Some(inertial) => body(&inertial)?,
        None => None,
    };
    Ok(Link {
        name: name.to_string(),
        at: node.range().start,
        body,
    })
}

/// None of a link that is only a frame: mass and inertia 0.
fn body(inertial: &Node<'_, '_>) -> Result<Option<Body>, Invalid> {
    let needed = |element: &str, attribute: &str, range: Range<f64>, allowed: Range<f64>| {
        let node = child(inertial, element);
        let missing = || Invalid::new(format!("{element} {attribute}"), "missing", allowed);
        number(node.as_ref(), attribute, range)?.ok_or_else(missing)
    };
    let mass = needed("mass", "value", WRITTEN_MASS_KG, LINK_MASS_KG)?;
    let names = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
    let mut entries = [0.0; 6];
    for (entry, name) in entries.iter_mut().zip(names) {
        *entry = needed("inertia", name, INERTIA_KG_M2, INERTIA_KG_M2)?;
    }
    if mass == 0.0 && entries == [0.0; 6] {
        return Ok(None);
    }
    let [xx, xy, xz, yy, yz, zz] = entries;
    let [shift, rpy] = origin(inertial)?;
    let frame = Frame {
        rotation: Matrix3::from(rotation_of(rpy)).transpose(),
        shift: shift.into(),
    };
    let own = Body {
        mass,
        com: Vector3::zeros(),
        inertia: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
    };
    Ok(Some(own.carried(&frame)))
}

fn joint(
    node: &Node<'_, '_>,
    name: &str,
    links: &HashMap<String, usize>,
    known: &[&str],
) -> Result<Joint, Invalid> {
    let linked = |element: &str| {
        let node = child(node, element);
        let link = node
            .and_then(|node| node.attribute("link"))
            .unwrap_or_default();
        let found = links.get(link).copied();
        found.ok_or_else(|| Invalid::name(element, link, known))
    };
    let kind = match node.attribute("type").unwrap_or_default() {
        "fixed" => Kind::Fixed,
        "revolute" => Kind::Revolute,
        "continuous" => Kind::Continuous,
        "prismatic" | "planar" | "floating" => Kind::Other,
        other => {
            let known = [
                "fixed",
                "revolute",
                "continuous",
                "prismatic",
                "planar",
                "floating",
            ];
            return Err(Invalid::name("type", other, &known));
        }
    };
    let (limit, dynamics) = (child(node, "limit"), child(node, "dynamics"));
    // Of joints beside the chain they may be anything.
    let limit = |attribute| number(limit.as_ref(), attribute, WRITTEN_LIMIT);
    let coordinate = Range::new(-AXIS_LENGTH.max, AXIS_LENGTH.max);
    let axis = three(
        child(node, "axis").as_ref(),
        "xyz",
        coordinate,
        [1.0, 0.0, 0.0],
    )?;
    if kind != Kind::Fixed {
        AXIS_LENGTH.check("axis xyz of length", Vector3::from(axis).norm())?;
    }
    Ok(Joint {
        name: name.to_string(),
        at: node.range().start,
        kind,
        parent: linked("parent")?,
        child: linked("child")?,
        origin: origin(node)?,
        axis,
        limit: Limit {
            lower: limit("lower")?,
            upper: limit("upper")?,
            effort: limit("effort")?,
            velocity: limit("velocity")?,
        },
        damping: number(dynamics.as_ref(), "damping", VISCOUS_NMS)?.unwrap_or(0.0),
        friction: number(dynamics.as_ref(), "friction", COULOMB_NM)?.unwrap_or(0.0),
        is_mimic: child(node, "mimic").is_some(),
    })
}
