//! Arm files: what cannot be used gets a line that names key, value and range, and nothing panics.

use std::fs;

use cell::arm::robot::{Robot, parse};
use cell::arm::text::text;
use cell::scenario::Scenario;
use proptest::prelude::*;

fn good() -> String {
    text(&arms::LWR_IV, "LWR")
}

#[test]
fn errors_name_line_key_value_and_range() {
    let good = good();
    let six = good.rfind("[[joint]]").expect("joints");
    let flange = good.rfind("\n[flange]").expect("a flange");
    let six_joints = good[..six].to_string() + &good[flange..];
    let error = parse(&six_joints).expect_err("six").to_string();
    assert!(
        error.ends_with(": joint: 6 joints; allowed: 7 joints"),
        "{error}"
    );
    for (from, to, line) in [
        (
            "name = \"lwr_iv\"",
            "name = \"\"",
            "name: ; allowed: 1 to 64 letters, digits, '-' and '_'",
        ),
        (
            "name = \"lwr_iv\"",
            "nmae = \"x\"",
            "key: unknown 'nmae', did you mean 'name'? allowed: name, gravity_m_s2, base, flange, joint, point, joint_limits, damping_postures_deg",
        ),
        (
            "gravity_m_s2 = [0.0, 0.0, -9.81]",
            "gravity_m_s2 = [0.0, 0.0, -98.1]",
            "gravity_m_s2 length: 98.1; allowed: 0 to 30",
        ),
        (
            "mass_kg = 2.7197684562423485",
            "mass_kg = -1",
            "joint 1: mass_kg: -1; allowed: 0.000001 to 1000",
        ),
        (
            "mass_kg = 2.7197684562423485",
            "mass_kg = nan",
            "joint 1: mass_kg: NaN; allowed: 0.000001 to 1000",
        ),
        (
            "mass_kg = 2.7197684562423485",
            "mass_kg = \"2\"",
            "joint 1: mass_kg: string \"2\"; allowed: a number",
        ),
        (
            "mass_kg = 2.7197684562423485\n",
            "",
            "joint 1: missing key 'mass_kg'",
        ),
        (
            "d_m = 0.4",
            "d_m = 400",
            "joint 3: d_m: 400; allowed: -10 to 10",
        ),
        (
            "alpha_deg = 90.0",
            "alpha_deg = 900.0",
            "joint 1: alpha_deg: 900; allowed: -360 to 360",
        ),
        (
            "position_range_deg = [-120.0, 120.0]",
            "position_range_deg = [120.0, -120.0]",
            "joint 2: position_range_deg: -120; allowed: 120 to 35600",
        ),
        (
            "speed_limit_deg_s = 110.0",
            "speed_limit_deg_s = 0",
            "joint 1: speed_limit_deg_s: 0; allowed: above 0, at most 100000",
        ),
        (
            "torque_limit_nm = 176.0",
            "torque_limit_nm = inf",
            "joint 1: torque_limit_nm: inf; allowed: above 0, at most 100000",
        ),
        (
            "coulomb_nm = 1.0",
            "coulomb_nm = -1.0",
            "joint 1: friction: coulomb_nm: -1; allowed: 0 to 10000",
        ),
        (
            "inertia_kg_m2 = [0.009, 0.0, 0.0, 0.006600186160950106, 0.0, 0.009]",
            "inertia_kg_m2 = [0.009, 0.0, 0.0, 0.0066, 0.0, 0.9]",
            "joint 1: inertia_kg_m2: [0.009, 0.0, 0.0, 0.0066, 0.0, 0.9]; allowed: Ixx, Ixy, Ixz, Iyy, Iyz, Izz of a body: principal moments of at least 0, none above the sum of the other two",
        ),
        (
            "name = \"elbow\"",
            "name = \"flange\"",
            "point 2: name: flange; allowed: another name than other points have, and than flange and tool",
        ),
        ("link = 3", "link = 8", "point 1: link: 8; allowed: 1 to 7"),
        (
            "speed_share = 0.9",
            "speed_share = 2",
            "joint_limits: speed_share: 2; allowed: 0.1 to 1",
        ),
        (
            "speed_share = 0.9",
            "",
            "joint_limits: speed_share: missing; allowed: every key of joint_limits, or none",
        ),
        (
            "rpy_deg = [0.0, 0.0, 0.0]",
            "rpy_deg = [0.0, 0.0]",
            "base: rpy_deg: 2 values; allowed: 3",
        ),
    ] {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        let error = parse(&text).expect_err(to).to_string();
        let (place, said) = error.split_once(": ").expect("a place");
        assert_eq!(said, line);
        let number: usize = place
            .strip_prefix("line ")
            .and_then(|n| n.parse().ok())
            .expect("a line");
        let there = text.lines().nth(number - 1).expect("that line");
        // Where a key is missing, the line of its table.
        let is_table = there.starts_with('[') && line.contains("missing");
        assert!(
            is_table || !to.is_empty() && there.contains(to),
            "{number}: {there}"
        );
    }
}

/// Equal files are one table, however often they are read.
#[test]
fn equal_arms_are_kept_once() {
    let [one, other] = [parse(&good()), parse(&good())].map(|arm| arm.expect("an arm"));
    assert!(std::ptr::eq(one, other));
}

#[test]
fn a_scenario_finds_the_arm_file_beside_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = good().replacen("name = \"lwr_iv\"", "name = \"mine\"", 1);
    fs::create_dir(folder.path().join("arms")).expect("a folder");
    fs::write(folder.path().join("arms/mine.toml"), text).expect("a file");
    let scenario = Scenario::built_in_text("two-level").expect("built in");
    let scenario = scenario.replacen("\"lwr_iv\"", "\"arms/mine.toml\"", 1);
    let path = folder.path().join("scenario.toml");
    fs::write(&path, &scenario).expect("a file");
    let path = path.to_str().expect("text");

    let found = Scenario::find(path)
        .expect("the arm is there")
        .arm()
        .parameters;
    assert_eq!(found.name, "mine");
    assert_eq!(found.links, arms::LWR_IV.links);

    // Anything wrong with it is said with both places.
    fs::write(folder.path().join("arms/mine.toml"), "name = 1").expect("a file");
    let error = Scenario::find(path).expect_err("no arm").to_string();
    let (before, after) = error.split_once(": robot: ").expect("the key");
    assert!(before.ends_with("scenario.toml: line 8"), "{error}");
    assert!(
        after.ends_with("mine.toml: line 1: name: integer `1`; allowed: text in quotes"),
        "{error}"
    );
    fs::remove_file(folder.path().join("arms/mine.toml")).expect("a file");
    let error = Scenario::find(path).expect_err("no file").to_string();
    assert!(
        error.contains("mine.toml; allowed: a readable arm file ("),
        "{error}"
    );
}

#[test]
fn an_arm_that_is_neither_name_nor_file_is_refused() {
    let refused = |named: &str| Robot::found(named).expect_err(named).to_string();
    assert!(refused("lwr_vi").starts_with("robot: unknown 'lwr_vi', did you mean 'lwr_iv'?"));
    assert!(refused("/dev/zero").ends_with("(not a regular file)"));
    assert!(refused("no.toml").starts_with("robot: no.toml; allowed: a readable arm file ("));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let huge = folder.path().join("huge.toml");
    fs::write(&huge, " ".repeat(2 << 20)).expect("a file");
    assert!(refused(huge.to_str().expect("text")).ends_with("(more than 1024 KiB)"));
}

proptest! {
    /// Whatever is written, there is an arm or a line.
    #[test]
    fn random_bytes_do_not_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = parse(&String::from_utf8_lossy(&bytes));
    }

    /// A good file with a piece cut out, doubled or replaced.
    #[test]
    fn broken_files_do_not_panic(
        at in 0.0..1.0f64,
        length in 0usize..60,
        piece in "[ -~\n]{0,12}",
        doubled in any::<bool>(),
    ) {
        let good = good();
        let start = (at * good.len() as f64) as usize;
        let end = (start + length).min(good.len());
        let middle = if doubled { good[start..end].repeat(2) } else { piece };
        let text = format!("{}{middle}{}", &good[..start], &good[end..]);
        if let Err(error) = parse(&text) {
            let line = error.to_string();
            prop_assert!(!line.contains('\n') && line.chars().count() < 1300, "{line}");
        }
    }

    /// Any number in any place.
    #[test]
    fn wild_numbers_are_refused_or_kept(
        which in 0usize..400,
        number in prop_oneof![
            any::<f64>(),
            Just(0.0), Just(-1.0), Just(1e-320), Just(1e300), Just(f64::NAN), Just(f64::INFINITY),
        ],
    ) {
        let good = good();
        let is_part = |c: char| c.is_ascii_digit() || c == '.' || c == '-' || c == 'e';
        let starts: Vec<_> = good
            .char_indices()
            .filter(|&(i, c)| c.is_ascii_digit() && !good[..i].ends_with(|c: char| is_part(c) || c.is_ascii_alphanumeric() || c == '_'))
            .map(|(i, _)| i)
            .collect();
        let start = starts[which % starts.len()];
        let end = start + good[start..].find(|c| !is_part(c)).unwrap_or(0);
        let text = format!("{}{}{}", &good[..start], number, &good[end..]);
        if let Ok(arm) = parse(&text) {
            prop_assert!(controller_core::arm::ArmModel::<f64>::new(arm).is_ok());
        }
    }
}
