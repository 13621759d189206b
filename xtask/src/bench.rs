//! Instructions, stack and memory of constructor and cycle, against the committed
//! figures and the limits.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::figures::Figures;
use crate::stack::{Below, CallGraph};
use crate::tools::{Need, Outcome, Tools, Trouble, failed, first_line, llvm_tool, qemu_version};
use crate::{host, limits, table};

const JSON: &str = "docs/timing.json";
const TABLE: &str = "docs/timing.md";

/// The calls behind a bound are printed with this experiment: they are the same with
/// every other.
const EXPLAINED: &str = "two-level";

/// How much a figure may grow before the check fails.
const ALLOWANCE: f64 = 0.02;

/// Measures; compares with limits and committed figures, or writes them anew.
pub fn run(write: bool) -> Outcome {
    let tools = Tools::find(&[Need::Emulator, Need::LlvmTools])?;
    let valgrind = if write {
        host::count(&tools.root)?
    } else {
        None
    };
    let mut figures = measure(&tools)?;
    print!("{}", table::summary(&figures));
    let (json, text) = (tools.root.join(JSON), tools.root.join(TABLE));
    let committed = fs::read_to_string(&json)
        .map_err(Trouble::from)
        .and_then(|text| {
            serde_json::from_str::<Figures>(&text)
                .map_err(|error| Trouble::Content(format!("{JSON}: {error}")))
        });

    let mut lines = limits::exceeded(&figures);
    if lines.is_empty() {
        println!("no figure is beyond its limit");
    }
    if write {
        let before = committed
            .ok()
            .and_then(|mut old| old.tools.remove("valgrind"));
        if let Some(version) = valgrind.or(before) {
            figures.tools.insert("valgrind".into(), version);
        }
        let data = serde_json::to_string_pretty(&figures)
            .map_err(|error| Trouble::Content(error.to_string()))?;
        fs::write(&json, data + "\n")?;
        fs::write(&text, table::page(&figures))?;
        println!("written: {JSON}, {TABLE}");
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

fn measure(tools: &Tools) -> Result<Figures, Trouble> {
    let image = tools.image("bench", &[])?;
    let output = tools.emulate(&image, &["-icount", "shift=10,sleep=off"])?;
    if !output.status.success() {
        return Err(failed("the image bench", &output));
    }
    let said = String::from_utf8_lossy(&output.stdout);
    let here: Vec<&str> = said
        .lines()
        .filter(|line| line.starts_with("inputs"))
        .collect();
    let host = tools.host("bench", &[])?;
    if here != host.lines().collect::<Vec<_>>() {
        let text = format!("torques differ:\nhost:\n{host}target:\n{}", here.join("\n"));
        return Err(Trouble::Content(text));
    }

    let mut figures = Figures::parse(&said)?;
    let graph = CallGraph::of(&image)?;
    for controller in &mut figures.controllers {
        let precision = &controller.precision;
        let cycle = graph.below(&format!("cycle_{precision}"))?;
        let init = graph.below(&format!("build_{precision}"))?;
        if controller.job == EXPLAINED {
            explain(&format!("cycle {precision}"), &cycle);
            explain(&format!("constructor {precision}"), &init);
        }
        controller.code = cycle.code;
        controller.stack.cycle_bound = cycle.stack.ok();
        controller.stack.init_bound = init.stack.ok();
    }
    figures.core_flash = core_flash(tools)?;
    figures.host = host::counts(&tools.root)?;
    figures.peers = host::peers(&tools.root)?;
    figures.image = memory(&tools.image("arm", &[])?)?;
    figures.tools = BTreeMap::from([
        ("rustc".into(), first_line("rustc", &["--version"])?),
        ("qemu".into(), qemu_version()?),
        (
            "profile".into(),
            "release; target-cpu=cortex-m7, host: x86-64-v3".into(),
        ),
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

/// Flash of constructor, cycle and record alone: the image `footprint` with them less
/// the one without.
fn core_flash(tools: &Tools) -> Result<BTreeMap<String, u64>, Trouble> {
    let flash = |features: &[&str]| -> Result<u64, Trouble> {
        let sizes = memory(&tools.image("footprint", features)?)?;
        Ok(sizes.get("flash").copied().unwrap_or(0))
    };
    let empty = flash(&[])?;
    let mut sizes = BTreeMap::new();
    for (precision, feature) in [("f64", "footprint-f64"), ("f32", "footprint-f32")] {
        sizes.insert(precision.into(), flash(&[feature])?.saturating_sub(empty));
    }
    Ok(sizes)
}

/// Flash and RAM of an image.
fn memory(image: &Path) -> Result<BTreeMap<String, u64>, Trouble> {
    let output = Command::new(llvm_tool("llvm-size")?)
        .arg("-A")
        .arg(image)
        .output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    let section = |name: &str| {
        let line = text
            .lines()
            .find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
        let size = line.and_then(|rest| rest.split_whitespace().next()?.parse::<u64>().ok());
        size.unwrap_or(0)
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
