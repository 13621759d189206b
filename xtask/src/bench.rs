//! Instructions, stack and memory of constructor and cycle, against the committed
//! figures and the limits.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::figures::Figures;
use crate::stack::{Below, CallGraph};
use crate::tools::{LLVM, Outcome, QEMU, Trouble};
use crate::tools::{emulate, find, first_line, good, image, llvm_tool, root, run as output_of};
use crate::{host, limits, table, tools};

const JSON: &str = "docs/timing.json";
const TABLE: &str = "docs/timing.md";

/// The calls behind a bound are printed with this experiment: they are the same with
/// every other.
const EXPLAINED: &str = "two-level";

/// How much a figure may grow before the check fails.
const ALLOWANCE: f64 = 0.02;

/// Measures; compares with limits and committed figures, or writes them anew.
pub fn run(write: bool) -> Outcome {
    find(&[QEMU, LLVM])?;
    let valgrind = if write { host::count()? } else { None };
    let mut figures = measure()?;
    print!("{}", table::summary(&figures));
    let path = root().join(JSON);
    let committed = fs::read_to_string(&path).map_err(Trouble::from);
    let committed = committed.and_then(|text| Ok(serde_json::from_str::<Figures>(&text)?));

    let mut lines = limits::exceeded(&figures);
    if lines.is_empty() {
        println!("no figure is beyond its limit");
    }
    if write {
        let before = || committed.ok()?.tools.remove("valgrind");
        if let Some(version) = valgrind.or_else(before) {
            figures.tools.insert("valgrind".into(), version);
        }
        write_down(&figures)?;
    } else {
        let committed = committed?;
        let larger = compare(&figures.bounded(), &committed.bounded());
        if larger.is_empty() {
            println!("no figure is more than 2 % above {JSON}");
        }
        lines.extend(larger);
        if figures.host != committed.host || figures.peers != committed.peers {
            lines.push(format!(
                "{JSON} does not have the committed counts of host and peers: cargo bench-m7 --write"
            ));
        }
    }
    for line in &lines {
        println!("{line}");
    }
    Ok(lines.is_empty())
}

/// Takes the committed counts of host and peers into figures and table, and leaves those of the
/// target as they are: nothing is measured.
pub fn write_host() -> Outcome {
    let path = root().join(JSON);
    let mut figures: Figures = serde_json::from_str(&fs::read_to_string(&path)?)?;
    figures.host = host::counts()?;
    figures.peers = host::peers()?;
    write_down(&figures)?;
    Ok(true)
}

fn write_down(figures: &Figures) -> Result<(), Trouble> {
    let text = serde_json::to_string_pretty(figures)? + "\n";
    fs::write(root().join(JSON), text)?;
    fs::write(root().join(TABLE), table::page(figures))?;
    println!("written: {JSON}, {TABLE}");
    Ok(())
}

fn measure() -> Result<Figures, Trouble> {
    let bench = image("bench", "")?;
    let output = emulate(&bench, &["-icount", "shift=10,sleep=off"])?;
    let said = good("the image bench", &output)?;
    let here: Vec<&str> = (said.lines())
        .filter(|line| line.starts_with("inputs"))
        .collect();
    let host = tools::host("bench", &[])?;
    let there: Vec<&str> = (host.lines())
        .filter(|line| line.starts_with("inputs"))
        .collect();
    if here != there {
        let here = here.join("\n");
        return Err(Trouble::new(format!(
            "torques differ:\nhost:\n{host}target:\n{here}"
        )));
    }

    let mut figures = Figures::parse(&said)?;
    let unbound = CallGraph::of(&bench)?;
    for controller in &mut figures.controllers {
        let precision = &controller.precision;
        let graph = unbound
            .clone()
            .with_laws_of(&format!("build_{precision}"))?;
        let cycle = graph.below(&format!("cycle_{precision}"))?;
        let init = graph.below(&format!("build_{precision}"))?;
        if controller.experiment == EXPLAINED {
            explain(&format!("cycle {precision}"), &cycle);
            explain(&format!("constructor {precision}"), &init);
        }
        controller.code = cycle.code;
        controller.stack.cycle_bound = cycle.stack.ok();
        controller.stack.init_bound = init.stack.ok();
    }
    // Flash of constructor, cycle and record alone: the image with them less the one without.
    let flash = |features: &str| Ok(memory(&image("footprint", features)?)?["flash"]);
    let empty: u64 = flash("")?;
    for precision in ["f64", "f32"] {
        for (law, feature) in [("", ""), (" with the exact law", ",footprint-exact")] {
            let full: Result<u64, Trouble> = flash(&format!("footprint-{precision}{feature}"));
            let flash = full?.saturating_sub(empty);
            figures
                .core_flash
                .insert(format!("{precision}{law}"), flash);
        }
    }
    figures.host = host::counts()?;
    figures.peers = host::peers()?;
    figures.image = memory(&image("arm", "")?)?;
    let profile = "release; target-cpu=cortex-m7, host: x86-64-v3";
    figures.tools = BTreeMap::from([
        ("rustc".into(), first_line("rustc", &["--version"])?),
        ("qemu".into(), first_line(QEMU, &["--version"])?),
        ("profile".into(), profile.into()),
    ]);
    Ok(figures)
}

/// Says why there is no bound, or which calls make it.
fn explain(what: &str, below: &Below) {
    match &below.stack {
        Err(why) => println!("stack of the {what}: {why}"),
        Ok(bytes) => {
            println!("stack of the {what}: {bytes} bytes by");
            for (frame, name) in &below.deepest {
                println!("{frame:8} {name}");
            }
        }
    }
}

/// Flash and RAM of an image.
fn memory(image: &Path) -> Result<BTreeMap<String, u64>, Trouble> {
    let text = output_of(llvm_tool("llvm-size")?.arg("-A").arg(image))?;
    let section = |name: &str| {
        let words = |line: &str| {
            line.split_whitespace()
                .map(str::to_string)
                .collect::<Vec<_>>()
        };
        let line = text
            .lines()
            .map(words)
            .find(|it| it.first().is_some_and(|it| it == name));
        line.and_then(|words| words.get(1)?.parse().ok())
            .unwrap_or(0)
    };
    let flash = [".vector_table", ".text", ".rodata", ".data", ".gnu.sgstubs"];
    let ram = [".data", ".bss", ".uninit"];
    Ok(BTreeMap::from([
        ("flash".into(), flash.map(section).iter().sum()),
        ("ram without stack".into(), ram.map(section).iter().sum()),
    ]))
}

/// What has grown by more than the allowance, or is new.
fn compare(now: &BTreeMap<String, u64>, before: &BTreeMap<String, u64>) -> Vec<String> {
    let mut lines = Vec::new();
    for (name, &value) in now {
        match before.get(name) {
            None => lines.push(format!("{name}: {value}, not in the committed figures")),
            Some(&old) if value as f64 > old as f64 * (1.0 + ALLOWANCE) => {
                lines.push(format!("{name}: {value}, committed {old}; allowed +2 %"));
            }
            Some(_) => {}
        }
    }
    lines.extend(
        (before.keys())
            .filter(|name| !now.contains_key(*name))
            .map(|name| format!("{name}: committed, but not measured")),
    );
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_percent_are_allowed() {
        let before = BTreeMap::from([("a".to_string(), 1000), ("b".to_string(), 10)]);
        let with = |a, b| BTreeMap::from([("a".to_string(), a), ("b".to_string(), b)]);
        assert!(compare(&with(1020, 10), &before).is_empty());
        assert!(compare(&with(1, 1), &before).is_empty());
        assert_eq!(compare(&with(1021, 10), &before).len(), 1);
        assert_eq!(compare(&with(1021, 11), &before).len(), 2);
        assert_eq!(compare(&BTreeMap::new(), &before).len(), 2);
        assert_eq!(compare(&before, &BTreeMap::new()).len(), 2);
    }
}
