//! `hil-sim gains` as a user runs it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use cell::scenario::Scenario;

fn hil_sim(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hil-sim"))
        .args(arguments.split(' '))
        .current_dir(folder)
        .output()
        .expect("the program runs")
}

/// What is printed by a call that succeeds.
fn printed(folder: &Path, arguments: &str) -> String {
    let output = hil_sim(folder, arguments);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{arguments}: {stderr}");
    String::from_utf8(output.stdout).expect("text")
}

/// Tables behind the head of a scenario make one; so does `--scenario`, which runs as it is. Both
/// say the same, and again.
#[test]
fn what_is_printed_is_a_scenario() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let tables = printed(folder.path(), "gains fr3 --cycle-ms 1");
    let head = "name = \"mine\"\nrobot = \"fr3\"\nduration_s = 1.0\ncycle_ms = 1.0\n\
                start_deg = [0.0, -45.0, 0.0, -135.0, 0.0, 90.0, 45.0]\n";
    let scenario = Scenario::parse(&format!("{head}{tables}")).expect("a scenario");
    assert_eq!(scenario.levels.len(), 2);
    let whole = printed(folder.path(), "gains fr3 --cycle-ms 1 --scenario");
    assert!(whole.ends_with(&tables));
    insta::assert_snapshot!(whole);
}

/// From a URDF to a run on the realistic plant.
#[test]
fn an_imported_arm_runs_with_its_gains() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let urdf = format!(
        "{}/../tests/golden/urdf/skew.urdf",
        env!("CARGO_MANIFEST_DIR")
    );
    let arm = printed(folder.path(), &format!("model import {urdf}"));
    fs::write(folder.path().join("skew.toml"), arm).expect("a file");
    let gains = "gains skew.toml --cycle-ms 1 --scenario";
    let scenario = printed(folder.path(), gains);
    fs::write(folder.path().join("first.toml"), scenario).expect("a file");
    let run = printed(folder.path(), "run first.toml --out o");
    assert!(run.contains("no limit"), "{run}");
}

/// The bound, the value and what is allowed, in a line; exit code 1, nothing on standard output.
#[test]
fn what_cannot_be_had_is_said_in_a_line() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let arm = printed(folder.path(), "model show lwr_iv");
    let weak = arm.replacen("torque_limit_nm = 176.0", "torque_limit_nm = 17.6", 2);
    assert_ne!(weak, arm);
    fs::write(folder.path().join("weak.toml"), weak).expect("a file");
    let mut lines = String::new();
    for arguments in [
        "gains lwr_iv --cycle-ms 2 --bandwidth 9",
        "gains lwr_iv --cycle-ms 20 --bandwidth 8",
        "gains openarm_v20_right --cycle-ms 1 --bandwidth 3.18 --elasticity on",
        "gains lwr_iv --cycle-ms 20 --dead-cycles 8",
        "gains weak.toml --cycle-ms 2",
    ] {
        let output = hil_sim(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments}");
        assert!(output.stdout.is_empty(), "{arguments}");
        let said = String::from_utf8(output.stderr).expect("text");
        assert_eq!(said.lines().count(), 1, "{said}");
        lines += &format!("$ hil-sim {arguments}\n{said}\n");
    }
    insta::assert_snapshot!(lines);
}

/// What is allowed can be had: just below the bound of the line above.
#[test]
fn a_bandwidth_below_the_bound_can_be_had() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = printed(folder.path(), "gains lwr_iv --cycle-ms 2 --bandwidth 8.1");
    let tables: toml_like::Gains = toml_like::read(&text);
    // (2 pi 8.1)^2 and 4 pi 8.1, to three digits downwards.
    assert_eq!(tables.stiffness, [2590.0; 2]);
    assert_eq!(tables.damping, [101.0; 2]);
}

/// The gains of the levels, read line by line: what stands there, not what a scenario makes of it.
mod toml_like {
    pub struct Gains {
        pub stiffness: [f64; 2],
        pub damping: [f64; 2],
    }

    pub fn read(text: &str) -> Gains {
        let levels = text.split("[null_space]").next().expect("levels");
        let all = |key: &str| {
            let lines = levels.lines().filter_map(|line| line.strip_prefix(key));
            let numbers = lines.map(|line| line.split(' ').next().expect("a number"));
            let numbers: Vec<f64> = numbers.map(|n| n.parse().expect("a number")).collect();
            numbers.try_into().expect("two levels")
        };
        Gains {
            stiffness: all("stiffness = "),
            damping: all("damping = "),
        }
    }
}
