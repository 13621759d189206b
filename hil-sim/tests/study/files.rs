//! Runs from files: what is read is what was written, and everything else is refused.

use std::fs;
use std::io::Write as _;
use std::path::Path;

use cell::names::Named;
use controller_core::Target;
use flate2::Compression;
use flate2::write::GzEncoder;
use hil_sim::study::limits::case::Case;
use hil_sim::study::limits::ground::Ground;
use hil_sim::study::limits::import;
use hil_sim::study::limits::jobs::Plan;
use hil_sim::study::limits::set::Set;

use crate::{made, plan};

/// A run as a file.
fn text(case: &Case) -> String {
    let level = |level: &hil_sim::study::limits::case::CaseLevel| {
        let (point, rest) = level.label.split_once(' ').expect("a point");
        let (kind, axes) = match rest.strip_prefix("about ") {
            Some(axes) => ("orientation", axes),
            None => ("position", rest),
        };
        serde_json::json!({"point": point, "axes": axes, "kind": kind})
    };
    let contact = |push: &cell::scenario::Push| {
        serde_json::json!({"point": "elbow", "from_s": push.from_s, "to_s": push.to_s,
            "ramp_s": push.ramp_s, "force_n": push.force_n})
    };
    let head = serde_json::json!({
        "name": case.name,
        "cycle_s": case.cycle_s,
        "start": case.start.as_slice(),
        "levels": case.levels.iter().map(level).collect::<Vec<_>>(),
        "stiffness_factor": case.stiffness_factor,
        "posture": case.posture.as_slice(),
        "contacts": case.pushes.iter().map(contact).collect::<Vec<_>>(),
        "back_at_s": case.back_at_s,
    });
    let mut text = format!("# {head}\n");
    for cycle in 0..case.cycles() {
        text += &format!("{}", cycle as f64 * case.cycle_s);
        for target in case.targets(cycle) {
            let numbers: Vec<f64> = match target {
                Target::Position { x, dx, ddx } => x
                    .iter()
                    .chain(dx.iter())
                    .chain(ddx.iter())
                    .copied()
                    .collect(),
                Target::Orientation { q, w, dw } => {
                    q.iter().chain(w.iter()).chain(dw.iter()).copied().collect()
                }
                Target::Hold => panic!("a run that holds"),
            };
            for number in numbers {
                text += &format!(",{number}");
            }
        }
        text += "\n";
    }
    text
}

fn packed(text: &[u8]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(text).expect("memory");
    packed.finish().expect("memory")
}

fn drawn(set: Set, number: usize) -> Case {
    let arm = plan(&[]).arm;
    set.case(&Ground::new(&arm), number).expect("a run")
}

/// The same figures to the last bit, drawn and from files. The levels are those of all kinds.
#[test]
fn a_run_from_a_file_is_the_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for set in Set::IN_FILES {
        for number in 0..2 {
            let path = import::path(folder.path(), set, number);
            let text = text(&drawn(set, number));
            fs::write(path, packed(text.as_bytes())).expect("a file");
        }
    }
    let drawn = Plan {
        runs: Some(2),
        ..plan(&Set::IN_FILES)
    };
    let read = Plan {
        from: Some(folder.path().to_path_buf()),
        ..drawn.clone()
    };
    for (drawn, read) in made(&drawn).iter().zip(&made(&read)) {
        let json = |of: &hil_sim::study::limits::jobs::SetOutcome| {
            serde_json::to_string(&of.within_limits).expect("JSON")
        };
        assert_eq!(read.within_limits.len(), 2);
        assert_eq!(json(drawn), json(read), "{}", drawn.set.name());
    }
}

fn answer(bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("pass-000.csv.gz");
    fs::write(&path, bytes).expect("a file");
    let read = import::case(&path, &plan(&[]).arm, Set::Pass, 0);
    let error = read.expect_err("a bad file").to_string();
    error.replace(&folder.path().display().to_string(), "")
}

#[test]
fn bad_files_are_answered_in_one_line() {
    let good = text(&drawn(Set::Push, 0));
    let (head, rows) = good.split_once('\n').expect("lines");
    let row = rows.lines().next().expect("a row");
    let with = |from: &str, to: &str| {
        assert!(head.contains(from), "{from}");
        format!("{}\n{rows}", head.replace(from, to))
    };
    let then = |rows: &str| format!("{head}\n{rows}");
    let cases: Vec<(&str, Vec<u8>)> = vec![
        ("no gzip", b"hello".to_vec()),
        ("half a file", packed(good.as_bytes())[..2000].to_vec()),
        ("nothing", packed(b"")),
        ("no header", packed(rows.as_bytes())),
        (
            "no JSON",
            packed(then("").replace("# {", "# {{").as_bytes()),
        ),
        (
            "another key",
            packed(with("\"name\"", "\"nome\"").as_bytes()),
        ),
        ("a cycle of a second", packed(with("0.002", "1").as_bytes())),
        (
            "no level",
            packed(
                with(
                    "{\"axes\":\"xyz\",\"kind\":\"position\",\"point\":\"flange\"}",
                    "",
                )
                .as_bytes(),
            ),
        ),
        (
            "another point",
            packed(with("\"flange\"", "\"hand\"").as_bytes()),
        ),
        ("other axes", packed(with("\"xyz\"", "\"zyx\"").as_bytes())),
        (
            "another kind",
            packed(with("\"position\"", "\"pose\"").as_bytes()),
        ),
        (
            "no stiffness",
            packed(with("\"stiffness_factor\":0.2", "\"stiffness_factor\":0").as_bytes()),
        ),
        (
            "a push before it ends",
            packed(with("\"to_s\":4.5", "\"to_s\":0.1").as_bytes()),
        ),
        (
            "a posture without an end",
            packed(with("\"posture\":[0.0", "\"posture\":[1e999").as_bytes()),
        ),
        ("no rows", packed(then("").as_bytes())),
        (
            "a column less",
            packed(then(&row[..row.rfind(',').expect("columns")]).as_bytes()),
        ),
        (
            "a column more",
            packed(then(&format!("{row},0")).as_bytes()),
        ),
        ("a word", packed(then(&format!("{row}x")).as_bytes())),
        (
            "not a number",
            packed(then(&row.replacen("0,", "0,NaN,", 1)).as_bytes()),
        ),
        (
            "another time",
            packed(then(&format!("{row}\n{row}")).as_bytes()),
        ),
        (
            "other bytes",
            packed(&[head.as_bytes(), b"\n\xff\xfe\n"].concat()),
        ),
        ("a line without end", packed(&vec![b' '; 100_000])),
    ];
    let mut answers = String::new();
    for (what, bytes) in cases {
        let answer = answer(&bytes);
        assert!(
            !answer.contains('\n') && answer.len() < 1400,
            "{what}: {answer}"
        );
        answers += &format!("{what}\n{answer}\n\n");
    }
    insta::assert_snapshot!(answers);
}

#[test]
fn folders_without_runs_are_refused() {
    let error = import::count(Path::new("nowhere"), Set::Wrist).expect_err("no folder");
    let text = "--from: nowhere; allowed: a folder with wrist-000.csv.gz";
    assert_eq!(error.to_string(), text);
}

/// A posture that no arm has is the core's to refuse, in its first cycle.
#[test]
fn what_the_core_refuses_stops_the_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut case = drawn(Set::Push, 0);
    case.start[1] = 30.0;
    let path = import::path(folder.path(), Set::Push, 0);
    fs::write(path, packed(text(&case).as_bytes())).expect("a file");
    let plan = Plan {
        from: Some(folder.path().to_path_buf()),
        ..plan(&[Set::Push])
    };
    let outcome = &made(&plan)[0].within_limits[0];
    let stop = outcome.stop.as_deref().expect("a fault");
    assert!(stop.starts_with("0.000 s: implausible: position"), "{stop}");
    assert_eq!(outcome.cycles, 0);
}
