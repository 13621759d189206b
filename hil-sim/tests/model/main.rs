//! `hil-sim model` as a user runs it: from a URDF to a run, and everything that is refused.

mod broken;
mod refused;
mod scenarios;
#[rustfmt::skip]
mod two_arms;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use cell::model::chain::{Choice, Impossible};
use hil_sim::model::import::{Request, import};

/// A URDF of the golden data.
fn urdf(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../tests/golden/urdf/{name}.urdf"))
}

fn hil_sim(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hil-sim"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the program runs")
}

/// What is printed by a call that succeeds.
fn printed(folder: &Path, arguments: &[&str]) -> String {
    let output = hil_sim(folder, arguments);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {stderr}");
    String::from_utf8(output.stdout).expect("text")
}

/// A folder with the golden URDFs.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for name in ["iiwa_14", "skew", "two_arms"] {
        let to = folder.path().join(format!("{name}.urdf"));
        fs::copy(urdf(name), to).expect("a copy");
    }
    folder
}

const TWO_ARMS: [&str; 4] = ["--base", "torso", "--tip", "tcp"];

fn request() -> Request<'static> {
    let [_, base, _, tip] = TWO_ARMS;
    Request {
        source: "two_arms.urdf",
        name: None,
        choice: Choice {
            base: Some(base.to_string()),
            tip: Some(tip.to_string()),
            continuous: std::f64::consts::TAU,
            impossible: Impossible::Refused,
        },
        has_postures: false,
    }
}

#[test]
fn an_import_agrees_with_its_urdf_and_with_no_other() {
    let folder = folder();
    for (name, ends) in [("iiwa_14", &[][..]), ("skew", &[]), ("two_arms", &TWO_ARMS)] {
        let file = format!("{name}.urdf");
        let toml = printed(folder.path(), &[&["model", "import", &file], ends].concat());
        fs::write(folder.path().join(format!("{name}.toml")), toml).expect("a file");
        let arm = format!("{name}.toml");
        let check = ["model", "check", &arm, "--against", &file];
        let said = printed(folder.path(), &[&check[..], ends].concat());
        assert!(said.contains("\nagrees: by at most"), "{said}");
    }
    let output = hil_sim(
        folder.path(),
        &["model", "check", "skew.toml", "--against", "iiwa_14.urdf"],
    );
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stdout).contains("\ndiffers: by at most"));
}

/// A heavier link is found.
#[test]
fn a_changed_number_is_a_difference() {
    let folder = folder();
    let toml = printed(folder.path(), &["model", "import", "skew.urdf"]);
    let heavier = toml.replacen("mass_kg = 0.9\n", "mass_kg = 0.9001\n", 1);
    assert_ne!(toml, heavier);
    fs::write(folder.path().join("skew.toml"), heavier).expect("a file");
    let arguments = ["model", "check", "skew.toml", "--against", "skew.urdf"];
    let output = hil_sim(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(1));
    let more = [&arguments[..], &["--tolerance", "1e-3"]].concat();
    assert!(printed(folder.path(), &more).contains("\nagrees"));
}

#[test]
fn continuous_joints_have_the_range_that_is_asked_for() {
    let folder = folder();
    let arguments = [
        "model",
        "import",
        "skew.urdf",
        "--continuous-deg",
        "720",
        "--name",
        "mine",
    ];
    let toml = printed(folder.path(), &arguments);
    assert_eq!(
        toml.matches("position_range_deg = [-720.0, 720.0]").count(),
        3
    );
    assert!(toml.contains("name = \"mine\""));
    let toml = printed(folder.path(), &["model", "import", "skew.urdf"]);
    assert_eq!(
        toml.matches("position_range_deg = [-360.0, 360.0]").count(),
        3
    );
    // That of the robot, as far as the letters go.
    assert!(toml.contains("name = \"skew_arm\""));
}

/// The constant compiles, and is the arm to the last bit. Made again by
/// `hil-sim model import tests/golden/urdf/two_arms.urdf --base torso --tip tcp --rust`.
#[test]
fn the_rust_constant_is_the_arm() {
    let text = fs::read_to_string(urdf("two_arms")).expect("a file");
    let import = import(&text, &request()).expect("an arm");
    assert_eq!(two_arms::TWO_ARMS, *import.arm);
    let rust = hil_sim::model::rust::rust(import.arm, &import.notes.join("\n"));
    assert_eq!(rust, include_str!("two_arms.rs"));
}

/// The constant of the example in C, which `controller-capi/check.sh` compiles and runs. Made again by
/// `hil-sim model import tests/golden/urdf/iiwa_14.urdf --c`.
#[test]
fn the_c_constant_is_that_of_the_example() {
    let folder = folder();
    let c = printed(folder.path(), &["model", "import", "iiwa_14.urdf", "--c"]);
    assert_eq!(
        c,
        include_str!("../../../controller-capi/examples/c/iiwa_14.h")
    );
}

/// Every arm of the crate can be looked at, and printed as a file that gives it again.
#[test]
fn arms_of_the_crate_can_be_shown_and_checked() {
    let folder = folder();
    for arm in arms::ALL {
        let text = printed(folder.path(), &["model", "show", arm.name]);
        fs::write(folder.path().join("shown.toml"), text).expect("a file");
        let again = printed(folder.path(), &["model", "show", "shown.toml"]);
        assert!(again.starts_with("# from shown.toml\nname ="), "{again}");
    }
    let said = printed(folder.path(), &["model", "check", "lwr_iv"]);
    // 0.4 m, 0.39 m and 0.078 m in a line.
    assert!(said.contains("stretched: 0.8680 m"), "{said}");
    // M_77 of the table.
    assert!(said.contains(" 1.584e-4  1.584e-4 "), "{said}");
}

/// With postures the table is longer, and the bound it gives is that of a search to some percent.
#[test]
fn postures_of_the_sampling_bound_are_those_of_a_search() {
    use controller_core::arm::{ArmModel, ArmParameters};
    use controller_core::joint::JointMatrix;
    use controller_core::law::sampling::fastest_mode;
    let text = fs::read_to_string(urdf("two_arms")).expect("a file");
    let request = Request {
        has_postures: true,
        ..request()
    };
    let arm = import(&text, &request).expect("an arm").arm;
    let bare = ArmParameters {
        damping_postures: &[],
        ..*arm
    };
    let [model, bare] = [arm, &bare].map(|arm| ArmModel::<f64>::new(arm).expect("an arm"));
    assert!(!arm.damping_postures.is_empty());
    for damping in [[1.0; 7], [4.0, 4.0, 3.0, 3.0, 0.4, 0.3, 0.03]] {
        let damping = JointMatrix::from_diagonal(&damping.into());
        let [known, found] = [&model, &bare].map(|arm| fastest_mode(arm, &damping).rate);
        // Mass matrices of real arms are known to some percent.
        assert!((known / found - 1.0).abs() < 0.03, "{known} {found}");
    }
}
