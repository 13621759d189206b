//! What cannot be used gets one clear line on stderr, exit code 2, and leaves
//! nothing behind. The lines are a snapshot: `snapshots/bad_input__*.snap`.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn hil_sim(folder: &Path, arguments: &[&str], input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_hil-sim"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // A program that refuses its arguments does not read its input.
    let _ = child
        .stdin
        .take()
        .expect("piped")
        .write_all(input.as_bytes());
    child.wait_with_output().expect("the program ends")
}

/// The line of a refused call. It must be the only one, and no file may be left.
fn refusal(arguments: &[&str], input: &str) -> String {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("a-file"), "").expect("a file");
    let output = hil_sim(folder.path(), arguments, input);
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    assert_eq!(stderr.lines().count(), 1, "{arguments:?}: {stderr}");
    assert!(!stderr.contains("panicked"), "{stderr}");
    let left: Vec<_> = std::fs::read_dir(folder.path())
        .expect("readable")
        .collect();
    assert_eq!(left.len(), 1, "{arguments:?} left {left:?}");
    stderr.trim_end().to_string()
}

#[test]
fn arguments() {
    let mut lines = String::new();
    for arguments in [
        "run",
        "run two-levle",
        "run nonsense",
        "run missing.toml",
        "run two-level --plant idael",
        "run two-level --contacts maybe",
        "run two-level --controller hierarchial",
        "run two-level --null-stiffness soft",
        "run two-level --dead-cycles 9",
        "run two-level --stiction perhaps",
        "run two-level --plant ideal --stiction on",
        "run two-level --duration ",
        "run two-level --duration 1e300",
        "run two-level --seed -1",
        "run two-level --seed 1.5",
        "run two-level --duration NaN",
        "run two-level --duration inf",
        "run two-level --duration 0",
        "run two-level --duration -3",
        "run two-level --duration 3601",
        "run two-level --duration ten",
        "run two-level --cycle-ms 0.05",
        "run two-level --cycle-ms 21",
        "run two-level --cycle-ms NaN",
        // Within the range of cycles, but not with this null-space damping.
        "run two-level --cycle-ms 4",
        "run two-level --sed 1",
        "run two-level --seed",
        "run two-level --seed 1 --seed 2",
        "run two-level extra",
        "run two-level --out none --state-at 1",
        "run two-level --out none --max-trace-gb 4",
        "paper --out none",
        "serve two-level --out none",
        // 35 GB.
        "run case-1 --duration 3600 --cycle-ms 0.1",
        // No file with an end.
        "run /dev/zero",
        "run .",
        // A file where a folder should be.
        "run two-level --out a-file",
        "run two-level --out a-file/below",
        "rnu two-level",
        "--verbos",
        "serve --scenario two-levle",
        "serve --plant idael",
        "serve --port 0",
        "serve --port 65536",
        "serve --remote 127.0.0.1",
        "serve --remote 0.0.0.0:49938",
        "serve --remote 127.0.0.1:49938 --port 49938",
        "serve --local-port x",
        "serve --cycle-ms 0.5",
        "serve --duration 0",
        "serve --dead-cycles 9",
        "serve --krl manual",
        "serve --scheme cartesian-impedance",
        "serve --scheme torque",
        "serve --robot-adds everything",
        "serve --wait 0",
        "serve --port -1",
        "serve --lockstep=yes",
        "serve --serial a-file",
        "serve --drives-off 5",
        "serve --fault drop=0.1",
        "serve --fault up:drop=0.1",
        "serve --fault both:dorp=0.1",
        "serve --fault both:drop=1.1",
        "serve --fault both:drop",
        "serve --fault both:delay=-1",
        "serve --fault both:burst=0.1",
        "serve --fault both:freeze",
        "serve --fault both:drop=0.1@5-4",
        "serve --ok-rate 0.5",
        "serve --misses 1.5",
        "serve --krl-stiffness 0",
        "serve --out a-file",
        "serve --robot kuka",
        "serve --version 10",
        "serve --address 127.0.0.1",
        "serve --robot fci --version 4",
        "serve --robot fci --version ten",
        "serve --robot fci --address robot",
        "serve --robot fci --address 127.0.0.1:x",
        "serve --robot fci --remote 127.0.0.1:49938",
        "serve --robot fci --local-port 5",
        "serve --robot fci --krl handshake",
        "serve --robot fci --misses 3",
        "serve --robot fci --scenario two-level",
        "serve --robot fci --cycle-ms 2",
        "scenario tow-level",
        "scenario",
        "explain missing.json",
        "explain /dev/zero",
        "paper --out a-file",
        "gains",
        "gains lwr_iv",
        "gains lwr_vi --cycle-ms 2",
        "gains missing.toml --cycle-ms 2",
        "gains a-file/below.toml --cycle-ms 2",
        "gains lwr_iv --cycle-ms 0",
        "gains lwr_iv --cycle-ms -2",
        "gains lwr_iv --cycle-ms NaN",
        "gains lwr_iv --cycle-ms 21",
        "gains lwr_iv --cycle-ms two",
        "gains lwr_iv --cycle-ms 2 --bandwidth 0",
        "gains lwr_iv --cycle-ms 2 --bandwidth -1",
        "gains lwr_iv --cycle-ms 2 --bandwidth NaN",
        "gains lwr_iv --cycle-ms 2 --bandwidth inf",
        "gains lwr_iv --cycle-ms 2 --bandwidth",
        "gains lwr_iv --cycle-ms 2 --bandwith 3",
        "gains lwr_iv --cycle-ms 2 --dead-cycles 9",
        "gains lwr_iv --cycle-ms 2 --elasticity maybe",
        "gains lwr_iv extra --cycle-ms 2",
        "gains lwr_iv --cycle-ms 2 --cycle-ms 1",
    ] {
        let words: Vec<_> = arguments.split(' ').collect();
        writeln!(lines, "$ hil-sim {arguments}\n{}\n", refusal(&words, "")).expect("memory");
    }
    insta::assert_snapshot!(lines);
}

/// A socket that is taken: the option is named, and no folder is made.
#[test]
fn a_port_in_use() {
    let taken = std::net::UdpSocket::bind("127.0.0.1:0").expect("a port");
    let port = taken.local_addr().expect("an address").port().to_string();
    let line = refusal(&["serve", "--local-port", &port], "");
    assert!(
        line.starts_with(&format!(
            "error: --local-port: {port}; allowed: a free port"
        )),
        "{line}"
    );
}

#[cfg(unix)]
#[test]
fn an_argument_that_is_no_text() {
    use std::os::unix::ffi::OsStrExt;
    let output = Command::new(env!("CARGO_BIN_EXE_hil-sim"))
        .args(["run".as_ref(), std::ffi::OsStr::from_bytes(b"two\xfflevel")])
        .output()
        .expect("the program runs");
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(
        String::from_utf8(output.stderr).expect("text"),
        "error: argument: 'two\u{fffd}level'; allowed: text in UTF-8\n"
    );
}

/// A level that is valid.
const LEVEL: &str = r#"{"point": "flange", "axes": "xyz", "x": [0.4, 0, 0.7], "dx": [0, 0, 0], "ddx": [0, 0, 0],
"kp": [400, 400, 400], "kd": [40, 40, 40]}"#;

/// A state that is valid; the cases below change it.
const STATE: &str = r#"{"robot": "lwr_iv", "q": [0, 0.6, 0, -1.4, 0.3, 1, 0], "dq": [0, 0, 0, 0, 0, 0, 0],
"residual": [0, 0, 0, 0, 0, 0, 0],
"levels": [{"point": "flange", "axes": "xyz", "x": [0.4, 0, 0.7], "dx": [0, 0, 0], "ddx": [0, 0, 0],
"kp": [400, 400, 400], "kd": [40, 40, 40]}],
"null_space": {"q_d": [0, 0, 0, 0, 0, 0, 0], "stiffness": [20, 20, 15, 15, 3, 2, 0.2],
"damping": [4, 4, 3, 3, 0.4, 0.3, 0.03]}}"#;

#[test]
fn a_valid_state_is_explained() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = hil_sim(folder.path(), &["explain", "-"], STATE);
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stdout.starts_with(b"{") && output.stderr.is_empty());
}

#[test]
fn states() {
    let many = [LEVEL; 3].join(", ");
    let mut lines = String::new();
    writeln!(lines, "nothing\n{}\n", refusal(&["explain", "-"], " \n")).expect("memory");
    for (what, from, to) in [
        ("not JSON", "{\"robot\"", "robot"),
        ("cut off", "0.03]}}", "0.03]"),
        ("something behind", "0.03]}}", "0.03]}} 1"),
        ("unknown robot", "lwr_iv", "lwr_v"),
        ("unknown point", "flange", "flagne"),
        ("unknown axes", "\"xyz\"", "\"xzy\""),
        ("no axes", "\"xyz\"", "\"\""),
        ("unknown field", "\"residual\"", "\"residul\""),
        (
            "six joints",
            "[0, 0.6, 0, -1.4, 0.3, 1, 0]",
            "[0, 0.6, 0, -1.4, 0.3, 1]",
        ),
        (
            "eight joints",
            "[0, 0.6, 0, -1.4, 0.3, 1, 0]",
            "[0, 0.6, 0, -1.4, 0.3, 1, 0, 0]",
        ),
        ("NaN", "-1.4", "NaN"),
        ("infinite", "-1.4", "1e999"),
        ("null", "-1.4", "null"),
        ("text for a number", "-1.4", "\"-1.4\""),
        ("joint beyond its limit", "-1.4", "-2.2"),
        ("too few coordinates", "[0.4, 0, 0.7]", "[0.4, 0]"),
        ("too many gains", "[400, 400, 400]", "[400, 400, 400, 400]"),
        ("no levels", LEVEL, ""),
        ("nine rows", LEVEL, &many),
        (
            "link 8",
            "\"flange\"",
            r#"{"link": 8, "offset_m": [0, 0, 0]}"#,
        ),
        (
            "two offsets",
            "\"flange\"",
            r#"{"link": 7, "offset_m": [0, 0]}"#,
        ),
        (
            "an arm whose joint 4 has another range",
            "\"lwr_iv\"",
            "\"openarm_v20_left\"",
        ),
        (
            "mounted by more than a turn",
            "\"levels\"",
            r#""mount": {"rpy_deg": [0, 400, 0]}, "levels""#,
        ),
        (
            "an impossible tool",
            "\"levels\"",
            r#""tool": {"mass_kg": 1, "center_of_mass_m": [0,0,0], "inertia_kg_m2": [1,0,0,1,0,3]}, "levels""#,
        ),
        (
            "unknown controller",
            "\"levels\"",
            r#""controller": "no-obsever", "levels""#,
        ),
        (
            "no interval",
            "\"levels\"",
            r#""observer": {"momentum_prev": [0,0,0,0,0,0,0], "input_prev": [0,0,0,0,0,0,0], "residual_prev": [0,0,0,0,0,0,0], "gain": [50,50,50,50,50,50,50], "h": 0}, "levels""#,
        ),
    ] {
        let state = STATE.replacen(from, to, 1);
        assert_ne!(state, STATE, "{what}");
        writeln!(lines, "{what}\n{}\n", refusal(&["explain", "-"], &state)).expect("memory");
    }
    insta::assert_snapshot!(lines);
}

#[test]
fn scenario_files() {
    let good = {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let output = hil_sim(folder.path(), &["scenario", "two-level"], "");
        String::from_utf8(output.stdout).expect("text")
    };
    let mut lines = String::new();
    let more = "[[level]]\npoint = \"wrist\"\naxes = \"xyz\"\nstiffness = 1\ndamping = 1\nreference = { kind = \"hold\" }\n";
    let rows = format!("{}[null_space]", more.repeat(4));
    let long = format!("name = \"{}\"", "long".repeat(100_000));
    let tool = |from: &str, to: &str| {
        let good = "[tool]\nmass_kg = 1\ncenter_of_mass_m = [0, 0, 0]\n\
                    inertia_kg_m2 = [1, 0, 0, 1, 0, 1]\n[observer]";
        good.replacen(from, to, 1)
    };
    let mutations = [
        ("not TOML", "[observer]", "[observer"),
        (
            "a key twice",
            "cycle_ms = 2.0",
            "cycle_ms = 2.0\ncycle_ms = 1.0",
        ),
        (
            "text for a number",
            "duration_s = 20.0",
            "duration_s = \"20\"",
        ),
        ("NaN", "duration_s = 20.0", "duration_s = nan"),
        ("infinite", "duration_s = 20.0", "duration_s = inf"),
        ("zero duration", "duration_s = 20.0", "duration_s = 0.0"),
        ("cycle too long", "cycle_ms = 2.0", "cycle_ms = 30.0"),
        ("unknown key", "duration_s", "duration"),
        ("missing key", "robot = \"lwr_iv\"\n", ""),
        ("unknown robot", "lwr_iv", "lwr-iv"),
        (
            "name with a slash",
            "name = \"two-level\"",
            "name = \"../two\"",
        ),
        (
            "a name with orders for a terminal",
            "name = \"two-level\"",
            "name = \"\\u001b[31mred\"",
        ),
        ("a long name", "name = \"two-level\"", &long),
        (
            "six joints",
            "[0.0, 35.0, 0.0, -80.0, 20.0, 60.0, 0.0]",
            "[0.0, 35.0, 0.0, -80.0, 20.0, 60.0]",
        ),
        ("start beyond a limit", "-80.0", "-130.0"),
        ("unknown point", "point = \"flange\"", "point = \"flagne\""),
        (
            "link 9",
            "point = \"flange\"",
            "point = { link = 9, offset_m = [0, 0, 0] }",
        ),
        (
            "offset far away",
            "point = \"flange\"",
            "point = { link = 7, offset_m = [0, 0, 20] }",
        ),
        ("half a point", "point = \"flange\"", "point = { link = 7 }"),
        ("axes out of order", "axes = \"xyz\"", "axes = \"zyx\""),
        (
            "negative stiffness",
            "stiffness = 400.0",
            "stiffness = -400.0",
        ),
        (
            "two gains for three axes",
            "damping = 40.0",
            "damping = [40.0, 40.0]",
        ),
        ("text for a gain", "damping = 40.0", "damping = \"much\""),
        ("unknown motion", "kind = \"circle\"", "kind = \"circel\""),
        ("unknown plane", "plane = \"yz\"", "plane = \"zy\""),
        ("no period", "period_s = 6.0", "period_s = 0.0"),
        (
            "a swing of a position",
            "kind = \"circle\"\nplane = \"yz\" # xy, xz, yz\nradius_m = 0.1",
            "kind = \"swing\"\naxis = [0, 0, 1]\nangle_deg = 10.0",
        ),
        (
            "orientation on a circle",
            "point = \"flange\"",
            "task = \"orientation\"\npoint = \"flange\"",
        ),
        ("more than twelve rows", "[null_space]", &rows),
        (
            "an event of a level that is there",
            "[null_space]",
            "[[event]]\nat_s = 1.0\nkind = \"add\"\nlevel = 1\n\n[null_space]",
        ),
        (
            "an event of a level that there is not",
            "[null_space]",
            "[[event]]\nat_s = 1.0\nkind = \"remove\"\nlevel = 2\n\n[null_space]",
        ),
        (
            "an event of another kind",
            "[null_space]",
            "[[event]]\nat_s = 1.0\nkind = \"swap\"\nlevel = 1\n\n[null_space]",
        ),
        (
            "an event with a key of another kind",
            "[null_space]",
            "[[event]]\nat_s = 1.0\nkind = \"remove\"\nlevel = 1\norder = [1]\n\n[null_space]",
        ),
        (
            "an order without a level",
            "[null_space]",
            "[[event]]\nat_s = 1.0\nkind = \"reorder\"\norder = []\n\n[null_space]",
        ),
        (
            "an event in no time",
            "[null_space]",
            "[[event]]\nat_s = 1.0\nduration_s = 0.0\nkind = \"remove\"\nlevel = 1\n\n[null_space]",
        ),
        ("zero damping of a joint", "0.3, 0.03]", "0.3, 0.0]"),
        ("damping over the sampling bound", "0.3, 0.03]", "0.3, 0.3]"),
        (
            "unknown posture",
            "posture = \"constant\"",
            "posture = \"fixed\"",
        ),
        ("no observer", "gain = 50.0", "gain = 0.0"),
        ("contact without length", "to_s = 6.0", "to_s = 3.0"),
        ("ramp too long", "ramp_s = 0.3", "ramp_s = 2.0"),
        (
            "force in two dimensions",
            "force_n = [0.0, 35.0, 0.0]",
            "force_n = [0.0, 35.0]",
        ),
        (
            "unknown plant of a limit",
            "plant = \"ideal\"",
            "plant = \"idael\"",
        ),
        ("unknown metric", "level1_rms_mm", "level2_rms_mm"),
        ("a point that another arm has", "lwr_iv", "fr3"),
        (
            "a start that another arm cannot have",
            "lwr_iv",
            "openarm_v10_left",
        ),
        ("the point of no tool", "\"flange\"", "\"tool\""),
        (
            "mount by two angles",
            "[observer]",
            "[mount]\nrpy_deg = [180, 0]\n[observer]",
        ),
        (
            "mount by NaN",
            "[observer]",
            "[mount]\nrpy_deg = [0, nan, 0]\n[observer]",
        ),
        (
            "mount by more than a turn",
            "[observer]",
            "[mount]\nrpy_deg = [0, 0, 361]\n[observer]",
        ),
        (
            "mount elsewhere",
            "[observer]",
            "[mount]\nrpy_deg = [0, 0, 0]\nshift_m = [0, 0, 1]\n[observer]",
        ),
        (
            "a tool without mass",
            "[observer]",
            &tool("mass_kg = 1", "mass_kg = 0"),
        ),
        (
            "a tool of 1 ug",
            "[observer]",
            &tool("mass_kg = 1", "mass_kg = 1e-9"),
        ),
        (
            "a tool that pulls up",
            "[observer]",
            &tool("mass_kg = 1", "mass_kg = -1"),
        ),
        (
            "a tool heavier than any arm",
            "[observer]",
            &tool("mass_kg = 1", "mass_kg = 1000"),
        ),
        (
            "a tool far away",
            "[observer]",
            &tool("[0, 0, 0]", "[0, 0, 30]"),
        ),
        (
            "a tool turned too far",
            "[observer]",
            &tool("mass_kg", "rpy_deg = [0, 0, -400]\nmass_kg"),
        ),
        ("a tool of five moments", "[observer]", &tool("0, 1]", "0]")),
        (
            "a moment of inertia below 0",
            "[observer]",
            &tool("0, 1]", "0, -1]"),
        ),
        (
            "moments that no body has",
            "[observer]",
            &tool("0, 1]", "0, 2.1]"),
        ),
        (
            "products that no body has",
            "[observer]",
            &tool("1, 0, 0", "1, 3, 0"),
        ),
        (
            "a tool without inertia",
            "[observer]",
            &tool("inertia_kg_m2", "# inertia_kg_m2"),
        ),
        ("dead time of a limit", "dead_cycles = 1", "dead_cycles = 9"),
    ];
    for (what, from, to) in mutations {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{what}");
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("changed.toml"), text).expect("a file");
        let output = hil_sim(folder.path(), &["run", "changed.toml"], "");
        let stderr = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(2), "{what}: {stderr}");
        assert_eq!(stderr.lines().count(), 1, "{what}: {stderr}");
        assert!(!folder.path().join("out").exists(), "{what}");
        writeln!(lines, "{what}\n{}\n", stderr.trim_end()).expect("memory");
    }
    insta::assert_snapshot!(lines);
}

/// A pipe that nobody writes to is not waited for; a text without end is not read to it.
#[cfg(unix)]
#[test]
fn pipes_and_endless_texts() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let pipe = folder.path().join("pipe.toml");
    let made = Command::new("mkfifo").arg(&pipe).status().expect("mkfifo");
    assert!(made.success());
    let output = hil_sim(folder.path(), &["run", "pipe.toml"], "");
    assert_eq!(output.status.code(), Some(2));
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert!(stderr.contains("pipe.toml") && stderr.contains("not a regular file"));

    let endless = std::fs::File::open("/dev/zero").expect("a device");
    let output = Command::new(env!("CARGO_BIN_EXE_hil-sim"))
        .args(["explain", "-"])
        .stdin(endless)
        .output()
        .expect("the program runs");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("more than 1024 KiB"));
}
