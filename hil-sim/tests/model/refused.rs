//! URDFs and options that cannot be used: one line each, a snapshot, and exit code 2.

use std::fmt::Write as _;
use std::fs;

use super::{folder, hil_sim, printed, urdf};

/// The line of a refused import of this text.
fn refusal(text: &str, more: &[&str]) -> String {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("arm.urdf"), text).expect("a file");
    let output = hil_sim(
        folder.path(),
        &[&["model", "import", "arm.urdf"], more].concat(),
    );
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(output.stdout.is_empty());
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    stderr.trim_end().to_string()
}

#[test]
fn files() {
    let good = fs::read_to_string(urdf("iiwa_14")).expect("a file");
    let mut lines = String::new();
    let six = "type=\"fixed\">\n    <origin xyz=\"0 0 0\" rpy=\"0 0 0\"/>\n    <parent link=\"frame_6\"/>";
    let seven = "type=\"revolute\">\n    <origin xyz=\"0 0 0\" rpy=\"0 0 0\"/>\n    <parent link=\"frame_6\"/>";
    let eighth = "<link name=\"tool0\"/>\n  <joint name=\"A8\" type=\"revolute\"><parent link=\"tool0\"/>\
                  <child link=\"tool1\"/><limit lower=\"0\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>\
                  <link name=\"tool1\"/>";
    let second = "<link name=\"tool0\"/>\n  <joint name=\"other\" type=\"fixed\"><parent link=\"frame_7\"/>\
                  <child link=\"camera\"/></joint>\n  <link name=\"camera\"/>";
    let mimic = "<axis xyz=\"0 0 1\"/>\n    <mimic joint=\"A2\"/>";
    let inertia =
        "ixx=\"0.042462\" ixy=\"0\" ixz=\"0\" iyy=\"0.01587\" iyz=\"-0.006341\" izz=\"0.042838\"";
    let triangle = "ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.03\"";
    let negative = "ixx=\"0.01\" ixy=\"0.02\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"";
    for (what, from, to) in [
        ("cut off", "</robot>", ""),
        ("tags that cross", "</link>", "</lnik>"),
        ("another root", "robot", "sdf"),
        ("MJCF", "robot", "mujoco"),
        (
            "xacro",
            "<link name=\"base_link\"/>",
            "<xacro:arm xmlns:xacro=\"http://ros.org/wiki/xacro\"/>",
        ),
        (
            "an entity",
            "<?xml version=\"1.0\"?>",
            "<!DOCTYPE a [<!ENTITY b \"c\">]>",
        ),
        (
            "a prismatic joint",
            "name=\"A4\" type=\"revolute\"",
            "name=\"A4\" type=\"prismatic\"",
        ),
        (
            "a joint of no type",
            "name=\"A4\" type=\"revolute\"",
            "name=\"A4\" type=\"revolut\"",
        ),
        (
            "a joint that follows another",
            "<axis xyz=\"0 0 1\"/>",
            mimic,
        ),
        ("six joints", seven, six),
        ("eight joints", "<link name=\"tool0\"/>", eighth),
        ("two ends", "<link name=\"tool0\"/>", second),
        ("no effort", " effort=\"200\"", ""),
        ("no effort at all", "effort=\"200\"", "effort=\"0\""),
        ("no velocity", " velocity=\"1.4835298641951802\"", ""),
        (
            "no limit",
            "<limit lower=\"-2.9670597283903604\"",
            "<limits lower=\"-2.9670597283903604\"",
        ),
        ("no lower end", "lower=\"-2.9670597283903604\" ", ""),
        (
            "ends the wrong way round",
            "lower=\"-2.9670597283903604\"",
            "lower=\"4\"",
        ),
        ("text for a number", "effort=\"200\"", "effort=\"much\""),
        ("NaN", "effort=\"200\"", "effort=\"NaN\""),
        (
            "an axis of no length",
            "<axis xyz=\"0 0 1\"/>",
            "<axis xyz=\"0 0 0\"/>",
        ),
        (
            "an axis of two numbers",
            "<axis xyz=\"0 0 1\"/>",
            "<axis xyz=\"0 1\"/>",
        ),
        ("millimetres", "xyz=\"0 0 0.36\"", "xyz=\"0 0 360\""),
        ("degrees", "rpy=\"-1.5708 0 0\"", "rpy=\"-90 0 0\""),
        ("no mass", "<mass value=\"5.289529\"/>", ""),
        (
            "a mass of 0",
            "<mass value=\"5.289529\"/>",
            "<mass value=\"0\"/>",
        ),
        (
            "a mass below 0",
            "<mass value=\"5.289529\"/>",
            "<mass value=\"-5.289529\"/>",
        ),
        (
            "an inertia that is not positive definite",
            inertia,
            negative,
        ),
        (
            "an inertia that breaks the triangle inequality",
            inertia,
            triangle,
        ),
        ("an inertia of five numbers", " izz=\"0.042838\"", ""),
        (
            "a link that is not there",
            "<parent link=\"frame_3\"/>",
            "<parent link=\"frame_33\"/>",
        ),
        (
            "a link twice",
            "<link name=\"link_4\"/>",
            "<link name=\"link_4\"/><link name=\"link_4\"/>",
        ),
        (
            "a link on two others",
            "<child link=\"link_4\"/>",
            "<child link=\"link_3\"/>",
        ),
        (
            "a circle",
            "<parent link=\"frame_3\"/>",
            "<parent link=\"frame_5\"/>",
        ),
        ("a name for a terminal", "name=\"A4\"", "name=\"A4&#x7;\""),
        ("a joint without a name", "name=\"A4\"", "name=\"\""),
    ] {
        let text = good.replacen(
            from,
            to,
            if what == "another root" || what == "MJCF" {
                99
            } else {
                1
            },
        );
        assert!(text != good, "{what}");
        writeln!(lines, "{what}\n{}\n", refusal(&text, &[])).expect("memory");
    }
    for (what, text) in [
        ("nothing", String::new()),
        ("no XML", "arm".to_string()),
        ("no links", "<robot name=\"a\"/>".to_string()),
        (
            "one link",
            "<robot name=\"a\"><link name=\"b\"/></robot>".to_string(),
        ),
        (
            "deep",
            format!(
                "<robot>{}{}</robot>",
                "<a>".repeat(100_000),
                "</a>".repeat(100_000)
            ),
        ),
        ("deeper", "<a>".repeat(300_000)),
        ("huge", " ".repeat(2 << 20)),
    ] {
        writeln!(lines, "{what}\n{}\n", refusal(&text, &[])).expect("memory");
    }
    insta::assert_snapshot!(lines);
}

#[test]
fn options() {
    let (iiwa, two_arms) = (urdf("iiwa_14"), urdf("two_arms"));
    let [iiwa, two_arms] = [iiwa, two_arms].map(|path| fs::read_to_string(path).expect("a file"));
    let mut lines = String::new();
    for (text, more) in [
        (&iiwa, "--tip tool9"),
        (&iiwa, "--base link0"),
        (&iiwa, "--base tool0 --tip base_link"),
        (&iiwa, "--base link_2"),
        (&iiwa, "--name my.arm"),
        (&iiwa, "--continuous-deg 0"),
        (&iiwa, "--continuous-deg 36000"),
        (&iiwa, "--rust --c"),
        (&two_arms, ""),
        (&two_arms, "--base torso"),
        (&two_arms, "--base torso --tip finger_left"),
        (&two_arms, "--base torso --tip left_upper"),
    ] {
        let words: Vec<_> = more.split_whitespace().collect();
        writeln!(lines, "{more}\n{}\n", refusal(text, &words)).expect("memory");
    }
    let folder = folder();
    for arguments in [
        "model",
        "model improt",
        "model import",
        "model import no.urdf",
        "model import /dev/zero",
        "model import .",
        "model check lwr_v",
        "model check iiwa_14.urdf",
        "model check lwr_iv --against no.urdf",
        "model check lwr_iv --tolerance 0",
        "model show no.toml",
    ] {
        let words: Vec<_> = arguments.split(' ').collect();
        let output = hil_sim(folder.path(), &words);
        let stderr = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(2), "{arguments}: {stderr}");
        assert_eq!(stderr.lines().count(), 1, "{arguments}: {stderr}");
        writeln!(lines, "$ hil-sim {arguments}\n{}\n", stderr.trim_end()).expect("memory");
    }
    insta::assert_snapshot!(lines);
}

/// A pipe that nobody writes to is not waited for.
#[cfg(unix)]
#[test]
fn a_pipe_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let pipe = folder.path().join("pipe.urdf");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.expect("mkfifo").success());
    for arguments in [
        ["model", "import", "pipe.urdf"],
        ["model", "check", "pipe.urdf"],
    ] {
        let output = hil_sim(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(2));
        let stderr = String::from_utf8(output.stderr).expect("text");
        assert!(
            stderr.contains("pipe.urdf") && stderr.contains("not a regular file"),
            "{stderr}"
        );
    }
}

/// With --nearest an impossible body is replaced, and it is said how far it moved.
#[test]
fn the_nearest_body_takes_the_place_of_an_impossible_one() {
    let folder = folder();
    let good = fs::read_to_string(urdf("iiwa_14")).expect("a file");
    let text = good.replacen("iyy=\"0.006958\"", "iyy=\"0.016958\"", 1);
    assert_ne!(text, good);
    let line = refusal(&text, &[]);
    assert!(
        line.contains("link 'frame_6'") && line.contains("triangle inequality"),
        "{line}"
    );
    fs::write(folder.path().join("arm.urdf"), &text).expect("a file");
    let output = hil_sim(folder.path(), &["model", "import", "arm.urdf", "--nearest"]);
    assert_eq!(output.status.code(), Some(0));
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert!(
        stderr.contains("link 'frame_6'") && stderr.contains("kg m2 away"),
        "{stderr}"
    );
    // Against the file as it is printed the table differs.
    fs::write(folder.path().join("arm.toml"), output.stdout).expect("a file");
    printed(folder.path(), &["model", "check", "arm.toml"]);
    let arguments = ["model", "check", "arm.toml", "--against", "arm.urdf"];
    let output = hil_sim(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(1));
}
