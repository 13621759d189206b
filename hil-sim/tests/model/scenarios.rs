//! Arm files where an arm has a name: in scenarios and states.

use std::fs;
use std::path::Path;

use super::{folder, hil_sim, printed};

/// The arm of skew axes in a folder of its own, and a scenario beside it.
fn scenario(folder: &Path) {
    let toml = printed(folder, &["model", "import", "skew.urdf", "--name", "skew"]);
    fs::create_dir(folder.join("cell")).expect("a folder");
    fs::write(folder.join("cell/skew.toml"), toml).expect("a file");
    let scenario = "name = \"mine\"\nrobot = \"skew.toml\"\nduration_s = 4.0\ncycle_ms = 2.0\n\
        start_deg = [10, 30, -40, 20, 30, 20, 10]\n\
        [[level]]\npoint = \"flange\"\naxes = \"xyz\"\nstiffness = 400.0\ndamping = 40.0\n\
        reference = { kind = \"circle\", plane = \"yz\", radius_m = 0.05, period_s = 3.0, growth_s = 1.0 }\n\
        [null_space]\nstiffness = [20, 20, 15, 10, 3, 2, 0.2]\n\
        damping = [2, 2, 1, 0.1, 0.1, 0.02, 0.005]\n\
        [observer]\ngain = 50\n\
        [[limit]]\nplant = \"ideal\"\ncontacts = true\nmetric = \"level1_rms_mm\"\nbelow = 0.01\n\
        [[limit]]\nplant = \"ideal\"\nmeasurement = \"fri\"\ncontacts = true\nmetric = \"level1_rms_mm\"\nbelow = 1.0\n";
    fs::write(folder.join("cell/scenario.toml"), scenario).expect("a file");
}

#[test]
fn an_imported_arm_runs_from_any_folder() {
    let folder = folder();
    scenario(folder.path());
    let run = [
        "run",
        "cell/scenario.toml",
        "--plant",
        "ideal",
        "--out",
        "o",
    ];
    let said = printed(folder.path(), &run);
    assert!(said.contains("pass"), "{said}");
    let said = printed(
        folder.path(),
        &[&run[..], &["--measurement", "fri"]].concat(),
    );
    assert!(said.contains("pass"), "{said}");
    // The robot at the end of a link starts with it.
    let serve = [
        "serve",
        "--scenario",
        "cell/scenario.toml",
        "--wait",
        "0.2",
        "--local-port",
        "0",
    ];
    let output = hil_sim(
        folder.path(),
        &[&serve[..], &["--remote", "127.0.0.1:9"]].concat(),
    );
    assert_eq!(
        output.status.code(),
        Some(4),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// As docs/arms.md has it.
#[test]
fn the_first_run_of_the_document_passes() {
    let folder = folder();
    let document = include_str!("../../../docs/arms.md");
    let (_, block) = document.split_once("```toml\n").expect("a scenario");
    let (block, _) = block.split_once("```").expect("its end");
    fs::write(folder.path().join("first.toml"), block).expect("a file");
    let toml = printed(folder.path(), &["model", "import", "iiwa_14.urdf"]);
    fs::write(folder.path().join("my_arm.toml"), toml).expect("a file");
    let said = printed(folder.path(), &["run", "first.toml", "--plant", "ideal"]);
    assert!(said.contains("no limit"), "{said}");
    let summary = fs::read_to_string(folder.path().join("out/first/summary.json"));
    let summary: serde_json::Value =
        serde_json::from_str(&summary.expect("a summary")).expect("JSON");
    let rms = summary["levels"][0]["rms_mm"].as_f64().expect("a figure");
    // An exact law on an exact model leaves what a cycle of 2 ms leaves: micrometres.
    assert!(rms < 0.01, "{rms}");
}

#[test]
fn a_state_of_an_imported_arm_is_explained() {
    let folder = folder();
    scenario(folder.path());
    let state = r#"{"robot": "skew.toml", "q": [0, 0.6, 0, -1.4, 0.3, 1, 0], "dq": [0, 0, 0, 0, 0, 0, 0],
        "levels": [{"point": "flange", "axes": "xyz", "x": [0.4, 0, 0.7], "dx": [0, 0, 0], "ddx": [0, 0, 0],
        "kp": [400, 400, 400], "kd": [40, 40, 40]}],
        "null_space": {"q_d": [0, 0, 0, 0, 0, 0, 0], "stiffness": [20, 20, 15, 15, 3, 2, 0.2],
        "damping": [4, 4, 3, 3, 0.4, 0.3, 0.03]}}"#;
    fs::write(folder.path().join("cell/state.json"), state).expect("a file");
    let said = printed(folder.path(), &["explain", "cell/state.json"]);
    assert!(said.contains("\"gravity\""), "{said}");
}
