//! A table as a constant in C, of the struct that `controller-capi` has for it.

use std::fmt::{self, Write as _};

use controller_core::arm::{ArmParameters, Friction, LinkParameters, Pose};

/// Bytes of a name in `stratum.h`, its end included.
const NAME_SIZE: usize = 24;

/// The constant of an arm, behind `comment`: to be included after `stratum.h`.
#[must_use]
pub fn c(arm: &ArmParameters, comment: &str) -> String {
    let mut text = String::new();
    // Into memory: it cannot fail.
    let _ = write_arm(&mut text, arm, comment);
    text
}

fn write_arm(f: &mut String, arm: &ArmParameters, comment: &str) -> fmt::Result {
    for line in comment.lines() {
        // What ends a comment ends none here.
        writeln!(f, "// {}", line.replace('\\', "/"))?;
    }
    let digit = if arm.name.starts_with(|c: char| c.is_ascii_digit()) {
        "_"
    } else {
        ""
    };
    let name = arm.name.replace('-', "_");
    writeln!(f, "#include \"stratum.h\"\n")?;
    writeln!(f, "static const StratumArm {digit}{name} = {{")?;
    writeln!(f, "    .name = {},", quoted(arm.name))?;
    write_pose(f, "base", &arm.base)?;
    write_pose(f, "flange", &arm.flange)?;
    writeln!(f, "    .gravity = {},", list(&arm.gravity))?;
    writeln!(f, "    .links = {{")?;
    for link in &arm.links {
        write_link(f, link)?;
    }
    writeln!(f, "    }},")?;
    // All zeros: the rule makes them.
    if let Some(limits) = &arm.limits {
        writeln!(f, "    .limits = {{")?;
        for (field, values) in [
            ("acceleration", &limits.acceleration),
            ("braking", &limits.braking),
            ("speed_gain", &limits.speed_gain),
        ] {
            writeln!(f, "        .{field} = {},", list(values))?;
        }
        for (field, value) in [
            ("position_gain", limits.position_gain),
            ("margin", limits.margin),
            ("speed_share", limits.speed_share),
        ] {
            writeln!(f, "        .{field} = {value:?},")?;
        }
        writeln!(f, "    }},")?;
    }
    writeln!(f, "}};")
}

fn write_pose(f: &mut String, field: &str, pose: &Pose) -> fmt::Result {
    let rows: Vec<_> = pose.rotation.iter().map(|row| list(row)).collect();
    let (rows, shift) = (rows.join(", "), list(&pose.shift));
    writeln!(
        f,
        "    .{field} = {{.rotation = {{{rows}}}, .shift = {shift}}},"
    )
}

fn write_link(f: &mut String, link: &LinkParameters) -> fmt::Result {
    let Friction {
        coulomb,
        viscous,
        smoothing,
    } = link.friction;
    writeln!(f, "        {{")?;
    writeln!(f, "            .name = {},", quoted(link.name))?;
    for (field, value) in [
        ("a", link.a),
        ("alpha", link.alpha),
        ("d", link.d),
        ("angle_offset", link.angle_offset),
        ("mass", link.mass),
    ] {
        writeln!(f, "            .{field} = {value:?},")?;
    }
    writeln!(f, "            .com = {},", list(&link.com))?;
    writeln!(f, "            .inertia = {},", list(&link.inertia))?;
    writeln!(f, "            .rotor_inertia = {:?},", link.rotor_inertia)?;
    writeln!(
        f,
        "            .friction = {{{coulomb:?}, {viscous:?}, {smoothing:?}}},"
    )?;
    writeln!(
        f,
        "            .position_range = {},",
        list(&link.position_range)
    )?;
    writeln!(f, "            .speed_limit = {:?},", link.speed_limit)?;
    if let Some(approach) = &link.end_approach {
        let (margin, deceleration) = (approach.margin, approach.deceleration);
        let ends = list(&approach.ends);
        writeln!(
            f,
            "            .end_approach = {{.margin = {margin:?}, .deceleration = {deceleration:?}, \
             .ends = {ends}}},"
        )?;
    }
    for (field, value) in [
        ("torque_limit", link.torque_limit),
        ("torque_rate_limit", link.torque_rate_limit),
        ("brake_rate_limit", link.brake_rate_limit),
    ] {
        writeln!(f, "            .{field} = {value:?},")?;
    }
    writeln!(f, "        }},")
}

fn list(values: &[f64]) -> String {
    let shown: Vec<_> = values.iter().map(|value| format!("{value:?}")).collect();
    format!("{{{}}}", shown.join(", "))
}

/// As much of a name as there is place for, as a literal.
fn quoted(name: &str) -> String {
    let bytes = name.bytes().take(NAME_SIZE - 1);
    let shown: String = bytes
        .map(|byte| match byte {
            b'"' | b'\\' => format!("\\{}", byte as char),
            b' '..=b'~' => (byte as char).to_string(),
            // Three digits: a fourth would not be part of it.
            other => format!("\\{other:03o}"),
        })
        .collect();
    format!("\"{shown}\"")
}
