//! An arm as the text of an arm file.

use std::fmt::{self, Write as _};

use controller_core::arm::{ArmParameters, Friction, JointLimits, LinkParameters, Pose};

use super::joint::{BRAKE_RATE, TORQUE_RATE};
use super::pose::roll_pitch_yaw;

/// The arm file of a table, behind `comment`, whose every line becomes a comment. Read again it
/// gives the table to the last bit, but for angles that no number of degrees gives: those to one
/// rounding.
#[must_use]
pub fn text(arm: &ArmParameters, comment: &str) -> String {
    let mut text = String::new();
    // Into memory: it cannot fail.
    let _ = write(&mut text, arm, comment);
    text
}

fn write(f: &mut String, arm: &ArmParameters, comment: &str) -> fmt::Result {
    for line in comment.lines() {
        writeln!(f, "{}", format!("# {line}").trim_end())?;
    }
    writeln!(f, "name = {}", quoted(arm.name))?;
    writeln!(f, "gravity_m_s2 = {}", list(&arm.gravity))?;
    if !arm.damping_postures.is_empty() {
        writeln!(
            f,
            "# Postures among which one is the worst for any damping of the null space."
        )?;
        writeln!(f, "damping_postures_deg = [")?;
        for posture in arm.damping_postures {
            writeln!(f, "  {},", angles(posture))?;
        }
        writeln!(f, "]")?;
    }
    writeln!(f, "\n# DH frame 0 in the base plate.")?;
    write_pose(f, "base", &arm.base)?;
    for link in &arm.links {
        write_joint(f, link)?;
    }
    writeln!(f, "\n# In DH frame 7.")?;
    write_pose(f, "flange", &arm.flange)?;
    for point in arm.points.iter().filter(|point| point.name != "flange") {
        writeln!(f, "\n[[point]]")?;
        writeln!(f, "name = {}", quoted(point.name))?;
        writeln!(f, "link = {}", point.point.link.number())?;
        writeln!(f, "offset_m = {}", list(&point.point.offset))?;
    }
    match &arm.limits {
        Some(limits) => write_limits(f, limits),
        None => Ok(()),
    }
}

fn write_pose(f: &mut String, table: &str, pose: &Pose) -> fmt::Result {
    writeln!(f, "[{table}]")?;
    writeln!(f, "shift_m = {}", list(&pose.shift))?;
    writeln!(f, "rpy_deg = {}", angles(&roll_pitch_yaw(&pose.rotation)))
}

fn write_joint(f: &mut String, link: &LinkParameters) -> fmt::Result {
    writeln!(f, "\n[[joint]]")?;
    writeln!(f, "name = {}", quoted(link.name))?;
    for (key, value) in [
        ("a_m", number(link.a)),
        ("alpha_deg", degrees(link.alpha)),
        ("d_m", number(link.d)),
        ("angle_offset_deg", degrees(link.angle_offset)),
        ("mass_kg", number(link.mass)),
        ("center_of_mass_m", list(&link.com)),
        ("inertia_kg_m2", list(&link.inertia)),
        ("rotor_inertia_kg_m2", number(link.rotor_inertia)),
        ("position_range_deg", angles(&link.position_range)),
        ("speed_limit_deg_s", degrees(link.speed_limit)),
        ("torque_limit_nm", number(link.torque_limit)),
    ] {
        writeln!(f, "{key} = {value}")?;
    }
    for (key, value, default) in [
        (
            "torque_rate_limit_nm_s",
            link.torque_rate_limit,
            TORQUE_RATE,
        ),
        ("brake_rate_limit_nm_s", link.brake_rate_limit, BRAKE_RATE),
    ] {
        if value != default {
            writeln!(f, "{key} = {}", number(value))?;
        }
    }
    let Friction {
        coulomb,
        viscous,
        smoothing,
    } = link.friction;
    if link.friction != Friction::NONE {
        let [coulomb, viscous, smoothing] = [coulomb, viscous, smoothing].map(number);
        writeln!(
            f,
            "friction = {{ coulomb_nm = {coulomb}, viscous_nms_rad = {viscous}, \
             smoothing_rad_s = {smoothing} }}"
        )?;
    }
    if let Some(approach) = &link.end_approach {
        let [margin, deceleration] = [approach.margin, approach.deceleration].map(number);
        let ends = angles(&approach.ends);
        writeln!(
            f,
            "end_approach = {{ margin_rad_s = {margin}, deceleration_rad_s2 = {deceleration}, \
             ends_deg = {ends} }}"
        )?;
    }
    Ok(())
}

fn write_limits(f: &mut String, limits: &JointLimits) -> fmt::Result {
    writeln!(f, "\n[joint_limits]")?;
    for (key, value) in [
        ("acceleration", list(&limits.acceleration)),
        ("braking", list(&limits.braking)),
        ("speed_gain", list(&limits.speed_gain)),
        ("position_gain", number(limits.position_gain)),
        ("margin_deg", degrees(limits.margin)),
        ("speed_share", number(limits.speed_share)),
    ] {
        writeln!(f, "{key} = {value}")?;
    }
    Ok(())
}

fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// The shortest text that reads as this number.
fn number(value: f64) -> String {
    // Never -0.
    format!("{:?}", value + 0.0)
}

fn list(values: &[f64]) -> String {
    listed(values, number)
}

fn angles(values: &[f64]) -> String {
    listed(values, degrees)
}

fn listed(values: &[f64], shown: fn(f64) -> String) -> String {
    let shown: Vec<_> = values.iter().map(|&value| shown(value)).collect();
    format!("[{}]", shown.join(", "))
}

/// The shortest number of degrees that gives this angle \[rad\], where one does.
fn degrees(angle: f64) -> String {
    let exact = angle.to_degrees();
    let short = (0..15).map(|digits| format!("{exact:.digits$}").parse().unwrap_or(exact));
    let near = [exact, exact.next_up(), exact.next_down()];
    let mut tried = short.chain(near);
    let found = tried.find(|degrees: &f64| degrees.to_radians() == angle);
    number(found.unwrap_or(exact))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::robot::parse;

    #[test]
    fn degrees_are_those_of_a_person() {
        for shown in [
            "0.0", "90.0", "-90.0", "180.0", "-170.0", "12.5", "0.03", "360.0",
        ] {
            let degrees: f64 = shown.parse().expect("a number");
            assert_eq!(super::degrees(degrees.to_radians()), shown);
        }
    }

    /// Every bit of every table, but for angles printed in rad: those may be a rounding away.
    #[test]
    fn every_table_is_the_same_as_a_file() {
        let close = |a: f64, b: f64| (a - b).abs() <= f64::EPSILON * a.abs();
        for arm in arms::ALL {
            let mut again = *parse(&text(arm, "of the crate")).expect(arm.name);
            for (link, table) in again.links.iter_mut().zip(&arm.links) {
                let angles = |link: &LinkParameters| {
                    let [min, max] = link.position_range;
                    [link.alpha, link.angle_offset, min, max, link.speed_limit]
                };
                for (one, other) in angles(link).into_iter().zip(angles(table)) {
                    assert!(close(one, other), "{}: {one} {other}", arm.name);
                }
                let ends = |link: &LinkParameters| link.end_approach.map(|approach| approach.ends);
                for (one, other) in
                    (ends(link).into_iter().flatten()).zip(ends(table).into_iter().flatten())
                {
                    assert!(close(one, other), "{}: {one} {other}", arm.name);
                }
                link.end_approach = table.end_approach;
                (link.alpha, link.angle_offset) = (table.alpha, table.angle_offset);
                (link.position_range, link.speed_limit) = (table.position_range, table.speed_limit);
            }
            let turned = |pose: &Pose| pose.rotation.as_flattened().to_vec();
            for (one, other) in [(&again.base, &arm.base), (&again.flange, &arm.flange)] {
                for (one, other) in turned(one).into_iter().zip(turned(other)) {
                    // Sines and cosines of three angles.
                    assert!((one - other).abs() < 1e-15, "{}: {one} {other}", arm.name);
                }
            }
            (again.base.rotation, again.flange.rotation) = (arm.base.rotation, arm.flange.rotation);
            assert_eq!(again, *arm);
        }
    }
}
