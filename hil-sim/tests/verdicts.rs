//! A verdict is never better than what happened, and says what it is about.

use std::fs;
use std::path::Path;
use std::process::Command;

use cell::scenario::BUILT_IN;
use serde_json::Value;

/// What a run said: exit code, standard output, summary.
struct Said {
    code: Option<i32>,
    text: String,
    notes: String,
    summary: Value,
    report: String,
}

fn run(scenario: &str, options: &str) -> Said {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("own.toml");
    fs::write(&file, scenario).expect("a file");
    let output = Command::new(env!("CARGO_BIN_EXE_hil-sim"))
        .args(["run", "own.toml", "--plant", "ideal", "--out", "o"])
        .args(options.split_whitespace())
        .current_dir(folder.path())
        .output()
        .expect("the program runs");
    let read = |name: &str| {
        let text = fs::read_to_string(folder.path().join(Path::new("o")).join(name));
        text.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)))
    };
    Said {
        code: output.status.code(),
        text: String::from_utf8(output.stdout.clone()).expect("text"),
        notes: String::from_utf8(output.stderr.clone()).expect("text"),
        summary: serde_json::from_str(&read("summary.json")).expect("JSON"),
        report: read("report.html"),
    }
}

/// An arm that starts at `start` and holds `task` under a `reference`, by the law that goes on
/// beyond every limit.
fn scenario(start: [f64; 7], task: &str, reference: &str, rest: &str) -> String {
    format!(
        "name = 'own'\nrobot = 'lwr_iv'\nlaw = 'exact'\nduration_s = 2.0\ncycle_ms = 2.0\nstart_deg = {start:?}\n\
         [[level]]\ntask = '{task}'\npoint = 'flange'\naxes = 'xyz'\n\
         stiffness = 400.0\ndamping = 40.0\n[level.reference]\n{reference}\n\
         [null_space]\nstiffness = [20.0, 20.0, 15.0, 15.0, 3.0, 2.0, 0.2]\n\
         damping = [4.0, 4.0, 3.0, 3.0, 0.4, 0.3, 0.03]\n[observer]\ngain = 50.0\n{rest}"
    )
}

const BENT: [f64; 7] = [0.0, 35.0, 0.0, -80.0, 20.0, 60.0, 0.0];

fn limit(metric: &str, below: f64) -> String {
    format!(
        "[[limit]]\nplant = 'ideal'\ncontacts = true\nmetric = '{metric}'\nbelow = {below}\n\
         [[limit]]\nplant = 'ideal'\ncontacts = true\nmeasurement = 'fri'\nmetric = '{metric}'\n\
         below = {below}\n"
    )
}

fn push(from_s: f64, to_s: f64) -> String {
    format!(
        "[[contact]]\npoint = 'elbow'\nfrom_s = {from_s}\nto_s = {to_s}\nramp_s = 0.2\n\
         force_n = [0.0, 10.0, 0.0]\n"
    )
}

/// The task is followed to the end, by a wrist that no LWR has.
#[test]
fn a_joint_beyond_its_range_fails_however_the_arm_is_seen() {
    let mut start = BENT;
    start[6] = 165.0;
    let turn = "kind = 'swing'\naxis = [0.3, 0.0, -1.0]\nangle_deg = 10.0\nperiod_s = 4.0\n\
                growth_s = 0.5";
    let own = scenario(
        start,
        "orientation",
        turn,
        &limit("level1_max_mrad", 1000.0),
    );
    for measurement in ["direct", "fri"] {
        let said = run(&own, &format!("--measurement {measurement}"));
        assert_eq!(said.code, Some(1), "{measurement}: {}", said.text);
        assert_eq!(said.summary["verdict"], "fail");
        assert_eq!(said.summary["acceptance"][0]["pass"], true);
        let reason = said.summary["reason"].as_str().expect("a reason");
        assert!(reason.starts_with("joint 7 reached 1"), "{reason}");
        assert!(reason.ends_with("its range is -170 to 170"), "{reason}");
        let cycles = said.summary["limits"]["position"].as_u64().expect("cycles");
        let remark = format!("a joint was beyond its range in {cycles} of 1000 cycles");
        for text in [&said.text, &said.report] {
            assert!(text.contains(reason) && text.contains(&remark), "{text}");
        }
    }
}

/// A joint may start at its end.
#[test]
fn the_end_of_a_range_is_within_it() {
    let mut start = BENT;
    start[5] = 120.0;
    let own = scenario(start, "position", "kind = 'hold'", "");
    let said = run(&own, "--duration 0.1 --contacts off");
    assert_eq!(said.code, Some(0), "{}", said.text);
}

#[test]
fn torques_that_are_cut_and_rows_that_are_lost_are_said() {
    let stretched = scenario([0.0; 7], "position", "kind = 'hold'", "");
    let said = run(&stretched, "--duration 0.1");
    let cycles = said.summary["limits"]["rank"].as_u64().expect("cycles");
    assert!(cycles > 0);
    let remark = format!("a row of a task could not be followed in {cycles} of 50 cycles");
    assert!(said.text.contains(&remark), "{}", said.text);

    let jerk = "kind = 'move'\nby_m = [0.0, 0.3, 0.3]\nduration_s = 0.05";
    let said = run(&scenario(BENT, "position", jerk, ""), "--duration 0.2");
    let cycles = said.summary["limits"]["torque"].as_u64().expect("cycles");
    assert!(cycles > 0, "{}", said.text);
    let remark = format!("the torque of a joint was cut to its limit in {cycles} of ");
    for text in [&said.text, &said.report] {
        assert!(text.contains(&remark), "{text}");
    }
}

#[test]
fn what_did_not_come_is_not_judged() {
    let rms = limit("level1_rms_mm", 100.0);
    let plateau = limit("level1_plateau_mm", 100.0);
    for (rest, reason) in [
        (
            format!("{rms}{}{}", push(0.5, 1.5), push(7.0, 8.0)),
            "after the end at 2 s: contact 2 (7 to 8 s)",
        ),
        (
            format!("{rms}{plateau}{}{}", push(0.5, 1.5), push(1.0, 8.0)),
            "without plateau before the end at 2 s: contact 2 (1 to 8 s)",
        ),
        (plateau, "level1_plateau_mm has no samples"),
    ] {
        let said = run(&scenario(BENT, "position", "kind = 'hold'", &rest), "");
        assert_eq!(said.code, Some(0), "{}", said.text);
        assert_eq!(said.summary["verdict"], "not judged", "{}", said.text);
        assert_eq!(said.summary["reason"], reason);
        assert!(said.text.contains("not judged") && said.text.contains(reason));
        assert!(said.report.contains("NOT JUDGED") && !said.report.contains("PASS"));
    }
    // What is not judged does not hide what failed.
    let strict = format!("{}{}", limit("level1_max_mm", 1e-9), push(7.0, 8.0));
    let moved = "kind = 'move'\nby_m = [0.0, 0.1, 0.0]\nduration_s = 1.0";
    let said = run(&scenario(BENT, "position", moved, &strict), "");
    assert_eq!(said.code, Some(1), "{}", said.text);
}

/// The finding of docs/errata.md, 8, is said before it costs a run.
#[test]
fn a_posture_that_drifts_is_announced_with_how_far() {
    let circle = "kind = 'circle'\nplane = 'yz'\nradius_m = 0.1\nperiod_s = 6.0\ngrowth_s = 2.0";
    let own = scenario(BENT, "position", circle, "");
    let said = run(&own, "--duration 1");
    assert!(!said.notes.contains("drifts"), "{}", said.notes);
    let own = own.replace("[observer]", "posture = 'integral-coupled'\n[observer]");
    let said = run(&own, "--duration 20");
    assert_eq!(said.code, Some(3), "{}", said.text);
    let note = "note: posture integral-coupled drifts: on an ideal arm without contacts joint 5 \
                travels 233 deg in 7.6 s; joint 6 leaves its range at 7.0 s";
    assert!(said.notes.contains(note), "{}", said.notes);
    let said = run(&own, "--duration 1 --controller velocity-level");
    assert!(!said.notes.contains("drifts"), "{}", said.notes);
}

/// A fault is the verdict however the controller is linked, and the arm is brought to rest.
#[test]
fn a_fault_is_not_lost_over_the_link() {
    let text = std::fs::read_to_string("../cell/scenarios/two-level.toml").expect("built in");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("beyond.toml");
    // A tenth of a turn beyond the reach of joint 1.
    let far = text
        .replace("name = \"two-level\"", "name = \"beyond\"\nlaw = \"exact\"")
        .replace("start_deg = [0.0,", "start_deg = [169.0,")
        .replace("radius_m = 0.1", "radius_m = 0.3");
    std::fs::write(&file, far).expect("a file");
    let mut times = Vec::new();
    for measurement in ["direct", "fri"] {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_hil-sim"))
            .args([
                "run",
                "beyond.toml",
                "--plant",
                "ideal",
                "--contacts",
                "off",
            ])
            .args(["--measurement", measurement, "--out", measurement])
            .current_dir(folder.path())
            .output()
            .expect("runs");
        let text = std::fs::read_to_string(folder.path().join(measurement).join("summary.json"));
        let summary: serde_json::Value =
            serde_json::from_str(&text.expect("a summary")).expect("JSON");
        assert_eq!(output.status.code(), Some(3), "{measurement}: {summary}");
        assert_eq!(summary["verdict"], "stopped");
        assert_eq!(summary["faults"]["implausible"], 1);
        let reason = summary["reason"].as_str().expect("a reason");
        assert!(
            reason.starts_with("implausible: position [rad] of joint 1"),
            "{reason}"
        );
        let after = &summary["after_fault"];
        assert_eq!(after["mode"], "resting", "{measurement}: {after}");
        assert!(
            after["rest_after_s"]
                .as_f64()
                .is_some_and(|time| time < 0.3),
            "{after}"
        );
        times.push(after["t_s"].as_f64().expect("a time"));
    }
    // The damping of the null space differs, and with it how joint 1 gets there.
    assert!((times[0] - times[1]).abs() < 0.1, "{times:?}");
}

/// A true speed that no arm may have is the verdict before the fault that the controller
/// makes of it, and over FRI the robot itself ends the motion.
#[test]
fn an_unsafe_speed_is_braked_on_either_side_of_the_link() {
    // Half a metre in a tenth of a second: the torque of all joints is at its limit.
    let far = "kind = 'move'\nby_m = [0.0, 0.5, 0.0]\nduration_s = 0.1";
    let own = scenario(BENT, "position", far, "");
    for measurement in ["direct", "fri"] {
        let said = run(&own, &format!("--measurement {measurement}"));
        assert_eq!(said.code, Some(3), "{}", said.text);
        let reason = said.summary["reason"].as_str().expect("a reason");
        assert!(reason.starts_with("speed of joint"), "{reason}");
        assert_eq!(said.summary["faults"]["implausible"], 0);
        let after = &said.summary["after_fault"];
        assert!(
            after["rest_after_s"]
                .as_f64()
                .is_some_and(|time| time < 0.3),
            "{after}"
        );
        assert!(after["travel_deg"].as_f64() < Some(16.0), "{after}");
    }
}

#[test]
fn a_reference_that_steps_the_torque_is_in_table_and_report() {
    let jump = "kind = 'move'\nby_m = [0.0, 0.1, 0.0]\nduration_s = 0.001";
    let said = run(&scenario(BENT, "position", jump, ""), "--duration 0.5");
    // What jumps is joined.
    assert!(said.summary["torque"]["step"].is_null(), "{}", said.text);

    let fast = "kind = 'move'\nby_m = [0.0, 0.2, 0.0]\nduration_s = 0.1";
    let said = run(&scenario(BENT, "position", fast, ""), "--duration 0.5");
    let step = &said.summary["torque"]["step"];
    // 10 kNm/s of the LWR allow 20 Nm in 2 ms: the bound is half of that, and the core's own
    // limit the largest step.
    assert_eq!(step["bound_nm"], 10.0);
    let nm = step["step_nm"].as_f64().expect("a step");
    // Rounding of a difference of torques up to 176 Nm.
    assert!(nm > 10.0 && nm <= 20.0 + 1e-12, "{step}");
    assert!(step["t_s"].as_f64() < Some(0.12), "{step}");
    let joint = step["joint"].as_u64().expect("a joint");
    let line = format!("the torque of joint {joint} stepped by {nm:.2} Nm in the cycle at ");
    assert!(said.text.contains(&line), "{}", said.text);
    assert!(said.report.contains(&line));
}

#[test]
fn no_built_in_scenario_steps_the_torque() {
    for (name, _) in BUILT_IN {
        // FRI has positions only. Speeds made of the 16 bits of OpenArm's motors step by 0.1 rad/s.
        let by_positions = *name != "two-level-openarm";
        let options = ["", "--measurement fri"];
        for options in options.into_iter().take(if by_positions { 2 } else { 1 }) {
            let folder = tempfile::tempdir().expect("a temporary folder");
            let output = Command::new(env!("CARGO_BIN_EXE_hil-sim"))
                .args(["run", name, "--out", "o"])
                .args(options.split_whitespace())
                .current_dir(folder.path())
                .output()
                .expect("the program runs");
            let text = String::from_utf8_lossy(&output.stdout).to_string();
            assert!(text.contains("verdict"), "{name} {options}");
            assert!(!text.contains("stepped by"), "{name} {options}: {text}");
        }
    }
}
