//! A table as a constant in Rust, as the crate `arms` has them.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::{self, Write as _};

use controller_core::arm::{ArmParameters, JointLimits, LinkParameters, NamedPoint, Pose};

/// The module of an arm, behind `comment`.
#[must_use]
pub fn rust(arm: &ArmParameters, comment: &str) -> String {
    let mut text = String::new();
    // Into memory: it cannot fail.
    let _ = write_arm(&mut text, arm, comment);
    text
}

fn write_arm(f: &mut String, arm: &ArmParameters, comment: &str) -> fmt::Result {
    for line in comment.lines() {
        writeln!(f, "{}", format!("//! {line}").trim_end())?;
    }
    let mut body = String::new();
    write_constant(&mut body, arm)?;
    writeln!(f, "\nuse controller_core::arm::{{")?;
    let used =
        |name: &&str| body.contains(&format!("{name} {{")) || body.contains(&format!("{name}::"));
    let names = [
        "ArmParameters",
        "EndApproach",
        "Friction",
        "JointLimits",
        "Link",
        "LinkParameters",
        "LinkPoint",
        "NamedPoint",
        "Pose",
    ];
    let names: Vec<_> = names.into_iter().filter(used).collect();
    writeln!(f, "    {},\n}};\n", names.join(", "))?;
    f.push_str(&body);
    Ok(())
}

fn write_constant(f: &mut String, arm: &ArmParameters) -> fmt::Result {
    let constant: String = (arm.name.chars())
        .map(|c| {
            if c == '-' {
                '_'
            } else {
                c.to_ascii_uppercase()
            }
        })
        .collect();
    // A name may begin with a digit, a constant may not.
    let digit = if constant.starts_with(|c: char| c.is_ascii_digit()) {
        "_"
    } else {
        ""
    };
    writeln!(f, "/// The arm `{}`.", arm.name)?;
    writeln!(
        f,
        "#[allow(clippy::approx_constant, reason = \"numbers as they were given\")]"
    )?;
    writeln!(
        f,
        "pub const {digit}{constant}: ArmParameters = ArmParameters {{"
    )?;
    writeln!(f, "    name: {:?},", arm.name)?;
    write_pose(f, "base", &arm.base)?;
    writeln!(f, "    gravity: {:?},", arm.gravity)?;
    writeln!(f, "    links: [")?;
    for link in &arm.links {
        write_link(f, link)?;
    }
    writeln!(f, "    ],")?;
    write_pose(f, "flange", &arm.flange)?;
    writeln!(f, "    points: &[")?;
    for NamedPoint { name, point } in arm.points {
        let (link, offset) = (point.link.number(), point.offset);
        writeln!(f, "        NamedPoint {{")?;
        writeln!(f, "            name: {name:?},")?;
        writeln!(f, "            point: LinkPoint {{")?;
        writeln!(f, "                link: Link::L{link},")?;
        writeln!(f, "                offset: {offset:?},")?;
        writeln!(f, "            }},\n        }},")?;
    }
    writeln!(f, "    ],")?;
    match &arm.limits {
        None => writeln!(f, "    limits: None,")?,
        Some(limits) => write_limits(f, limits)?,
    }
    writeln!(f, "    damping_postures: &[")?;
    for posture in arm.damping_postures {
        writeln!(f, "        {posture:?},")?;
    }
    writeln!(f, "    ],\n}};")
}

fn write_pose(f: &mut String, field: &str, pose: &Pose) -> fmt::Result {
    writeln!(f, "    {field}: Pose {{")?;
    writeln!(f, "        rotation: {:?},", pose.rotation)?;
    writeln!(f, "        shift: {:?},\n    }},", pose.shift)
}

fn write_link(f: &mut String, link: &LinkParameters) -> fmt::Result {
    let [min, max] = link.position_range.map(angle);
    let friction = format!("{:?}", link.friction).replace("Friction", "Friction ");
    let friction = friction.replace("  ", " ");
    let approach = format!("{:?}", link.end_approach);
    writeln!(f, "        LinkParameters {{")?;
    for (field, value) in [
        ("name", format!("{:?}", link.name)),
        ("a", format!("{:?}", link.a)),
        ("alpha", angle(link.alpha)),
        ("d", format!("{:?}", link.d)),
        ("angle_offset", angle(link.angle_offset)),
        ("mass", format!("{:?}", link.mass)),
        ("com", format!("{:?}", link.com)),
        ("inertia", format!("{:?}", link.inertia)),
        ("rotor_inertia", format!("{:?}", link.rotor_inertia)),
        ("friction", friction),
        ("position_range", format!("[{min}, {max}]")),
        ("speed_limit", format!("{:?}", link.speed_limit)),
        ("end_approach", approach),
        ("torque_limit", format!("{:?}", link.torque_limit)),
        ("torque_rate_limit", format!("{:?}", link.torque_rate_limit)),
        ("brake_rate_limit", format!("{:?}", link.brake_rate_limit)),
    ] {
        writeln!(f, "            {field}: {value},")?;
    }
    writeln!(f, "        }},")
}

fn write_limits(f: &mut String, limits: &JointLimits) -> fmt::Result {
    // Its fields are numbers and lists of numbers: as Rust writes them.
    writeln!(f, "    limits: Some({limits:?}),")
}

/// Right angles by their name.
fn angle(value: f64) -> String {
    let named = [(FRAC_PI_2, "FRAC_PI_2"), (PI, "PI"), (TAU, "TAU")];
    let found = named.iter().find(|(size, _)| value.abs() == *size);
    let sign = if value < 0.0 { "-" } else { "" };
    match found {
        Some((_, name)) => format!("{sign}core::f64::consts::{name}"),
        None => format!("{value:?}"),
    }
}
