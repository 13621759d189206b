//! docs/timing.md from the figures.

use crate::figures::{Controller, Figures};
use crate::flops;

/// Core clock of the estimate \[MHz\].
const CLOCK_MHZ: f64 = 480.0;

/// Cycles per instruction between which the estimate lies, f64 and f32.
const CYCLES_PER_INSTRUCTION: [(&str, [f64; 2]); 2] = [("f64", [1.3, 3.0]), ("f32", [0.9, 2.0])];

const INTRODUCTION: &str = "# Timing on a Cortex-M7

Made by `cargo bench-m7 --write`, with [timing.json](timing.json) for programs; do not
edit. `cargo bench-m7` measures again and fails where a figure is more than 2 % above
timing.json or beyond its limit; `controller-core/benches/instructions.sh` does the same
for the host. CI runs both.

**QEMU counts instructions, not cycles.** It has no pipeline, no dual issue, no
caches, no wait states. The counts are exact and the same on every host; how long
they take on silicon is an estimate (last table), and nobody has measured it.

A cycle is what a caller does every period: `Controller::step`, from the check of the
measurement to the limited torque and the observer, then `Recorder::push`. Every
controller runs on random inputs (positions within the limits, half of them slow and on
their reference, half fast and far from it) and on adverse ones: corners of the believed
range, largest speeds, stretched and nearly stretched arms, references so far away that
torques are cut, denormal numbers, zeros. Torques of all of them are the same bits as
on the host.
";

const LIMITS: &str = "
Limits, whatever is committed: at most 20000 instructions in f64 and 16000 in f32 here,
10000 with two levels and 12000 with three on the host (the null space counts as a
level), a spread below 0.5 %.
";

const STAGES: &str = "
## Parts of a cycle

Each part alone, behind a call of its own: largest number of instructions over the same
inputs on the Cortex-M7 (`cargo bench-m7`), and over 16 states on x86-64-v3
(`controller-core/benches/instructions.sh`, callgrind; its vector unit does up to four
operations in one instruction). In the cycle parts are inlined into each other, so that
the sum is not the cycle; *the rest* is the difference: checks, dead time, record, copies.

*flops* is what the algorithm of the part needs: one for an addition, subtraction,
multiplication, division or square root, by the formulas below; loads, stores, selects
and comparisons come on top. The scalar FPU of the Cortex-M7 does one or, in a
multiply-accumulate, two of them per instruction.
";

const PEERS: &str = "
Below the cycle: the same law by other libraries, on x86-64-v3 in double precision, full
cycle with observer; `tests/peers/run.sh` makes these figures anew and checks the torques
against the golden data.
";

const STACK: &str = "
## Memory

Stack in bytes. *Seen* is the high-water mark of a painted stack over the adverse
inputs and every tenth random one, *bound* the deepest path through the call graph of
the disassembled image: every frame counted in full, no call left unresolved. The
constructor's includes arm and configuration, made on the stack from the tables on;
the controller itself is the caller's. Limit of each bound: 12288 bytes.

*Flash of the linked core*: constructor, cycle, observer and record with their tables, in
one precision, no driver and no log: an image with them less the same image without.
Limit: 65536 bytes.
";

const ESTIMATE: &str = "
## Estimate for an STM32H743 at 480 MHz

Not measured. Assumed: cycle and constants in ITCM, controller, state and stack in DTCM
([memory.x](../memory.x)), no interrupt. Cycles per instruction are a guess between two
borders: single precision 0.9 (some dual issue) to 2.0 (every result waited for); double
precision 1.3 to 3.0, because its additions and multiplications occupy the FPU for more
than one cycle. Divisions and square roots take up to about 30 cycles in double precision;
there are only some thirty per cycle of control, which the borders cover. From flash
through the caches, or from AXI SRAM, it takes longer. A cycle with a fault is shorter.
";

/// The page.
pub fn page(figures: &Figures) -> String {
    let mut out = String::from(INTRODUCTION);
    out += "\n| tool | version |\n|---|---|\n";
    for (tool, version) in &figures.tools {
        out += &format!("| {tool} | {version} |\n");
    }
    out += &format!(
        "| board | QEMU mps2-an500, `-icount shift=10` |\n| inputs | {} per row |\n",
        figures.inputs
    );
    for peer in &figures.peers {
        out += &format!("| {} | {} |\n", peer.name, peer.version);
    }
    out += "\n## A full cycle\n\nInstructions.\n\n";
    out += &cycles(figures);
    out += LIMITS;
    out += STAGES;
    for job in jobs(figures) {
        out += &stages(figures, job);
    }
    out += PEERS;
    out += &formulas();
    out += STACK;
    out += &memory(figures);
    out += ESTIMATE;
    out += &estimate(figures);
    out
}

/// What the command prints.
pub fn summary(figures: &Figures) -> String {
    cycles(figures) + &memory(figures)
}

fn cycles(figures: &Figures) -> String {
    let mut out = String::from(
        "| controller | rows | precision | smallest | largest | spread | largest at | torques cut | rows not resolved |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for controller in &figures.controllers {
        let Controller {
            job,
            precision,
            cycle,
            saturated,
            deficient,
            ..
        } = controller;
        let spread = 100.0 * (cycle.max - cycle.min) as f64 / cycle.min.max(1) as f64;
        out += &format!(
            "| {job} | {} | {precision} | {} | {} | {spread:.2} % | {} | {saturated} | {deficient} |\n",
            rows(job),
            cycle.min,
            cycle.max,
            cycle.worst,
        );
    }
    out
}

fn rows(job: &str) -> &'static str {
    match job {
        "two-level" => "3",
        _ => "3 + 2",
    }
}

fn heads(figures: &Figures) -> (String, String) {
    let names = (figures.controllers.iter()).map(|c| format!(" {} {} |", c.job, c.precision));
    (names.collect(), "---|".repeat(figures.controllers.len()))
}

/// The experiments, each once.
fn jobs(figures: &Figures) -> Vec<&str> {
    let mut jobs: Vec<&str> = Vec::new();
    for controller in &figures.controllers {
        if !jobs.contains(&controller.job.as_str()) {
            jobs.push(&controller.job);
        }
    }
    jobs
}

/// Parts, cycle and peers of one experiment, both precisions side by side.
fn stages(figures: &Figures, job: &str) -> String {
    let mut out = format!("\n### {job}, {} task rows\n\n| part |", rows(job));
    let both: Vec<&Controller> = (figures.controllers.iter())
        .filter(|controller| controller.job == job)
        .collect();
    let mut rule = String::from("|---|");
    for Controller { precision, .. } in &both {
        out += &format!(" flops {precision} | M7 {precision} | host {precision} |");
        rule += "---|---|---|";
    }
    out += &format!("\n{rule}\n");
    let host = |controller: &Controller, part: &str| {
        let case = figures.host.get(&format!("{job} {}", controller.precision));
        let count = case.and_then(|counts| counts.get(part));
        count.map_or(String::new(), u64::to_string)
    };
    for (index, stage) in both.iter().flat_map(|c| &c.stages).enumerate() {
        if both.first().is_none_or(|first| index >= first.stages.len()) {
            break;
        }
        out += &format!("| {} |", stage.name);
        for controller in &both {
            let own = controller.stages.get(index);
            let (flops, count) = own.map_or((0, 0), |own| (own.flops, own.cost.max));
            out += &format!(" {flops} | {count} | {} |", host(controller, &stage.name));
        }
        out.push('\n');
    }
    let mut rest = String::from("| the rest |");
    let mut cycle = String::from("| **cycle** |");
    for controller in &both {
        let parts: u64 = controller.stages.iter().map(|stage| stage.cost.max).sum();
        let (max, flops) = (
            controller.cycle.max,
            flops::total(job, &controller.precision),
        );
        rest += &format!(" | {} | |", max as i64 - parts as i64);
        cycle += &format!(
            " **{flops}** | **{max}** | **{}** |",
            host(controller, "cycle")
        );
    }
    out += &format!("{rest}\n{cycle}\n");
    for peer in &figures.peers {
        if let Some(count) = peer.cycle.get(job) {
            out += &format!("| {} | | | {count} | | | |\n", peer.name);
        }
    }
    out
}

fn formulas() -> String {
    let mut out = String::from("\n| part | flops |\n|---|---|\n");
    for (part, formula) in flops::FORMULAS {
        out += &format!("| {part} | {formula} |\n");
    }
    out + "\n" + flops::LEGEND + "\n"
}

fn memory(figures: &Figures) -> String {
    let (head, rule) = heads(figures);
    let mut out = format!("\n| bytes |{head}\n|---|{rule}\n");
    let bound = |bytes: Option<u64>| bytes.map_or("none".into(), |bytes| bytes.to_string());
    let mut row = |name: &str, value: &dyn Fn(&Controller) -> String| {
        let cells = figures
            .controllers
            .iter()
            .map(|c| format!(" {} |", value(c)));
        out += &format!("| {name} |{}\n", cells.collect::<String>());
    };
    row("stack of the cycle, seen", &|c| {
        c.stack.cycle_seen.to_string()
    });
    row("stack of the cycle, bound", &|c| bound(c.stack.cycle_bound));
    row("stack of the constructor, seen", &|c| {
        c.stack.init_seen.to_string()
    });
    row("stack of the constructor, bound", &|c| {
        bound(c.stack.init_bound)
    });
    row("code of the cycle", &|c| c.code.to_string());
    row("flash of the linked core", &|c| {
        let flash = figures.core_flash.get(&c.precision);
        flash.map_or(String::new(), u64::to_string)
    });
    for name in ["controller", "state", "step", "record"] {
        row(&format!("size of the {name}"), &|c| {
            let sizes = figures.sizes.get(&c.precision);
            sizes
                .and_then(|sizes| sizes.get(name))
                .map_or(String::new(), u64::to_string)
        });
    }
    let image = |name: &str| figures.image.get(name).copied().unwrap_or(0);
    out += &format!(
        "\nThe application image `arm` (f64, log, guard): {} bytes of flash, {} bytes of RAM\n\
         besides the stack.\n",
        image("flash"),
        image("ram without stack"),
    );
    out
}

fn estimate(figures: &Figures) -> String {
    let mut out = String::from(
        "\n| controller | precision | instructions | cycles | time | share of a 2 ms cycle |\n\
         |---|---|---|---|---|---|\n",
    );
    for controller in &figures.controllers {
        let factors = CYCLES_PER_INSTRUCTION
            .iter()
            .find(|(name, _)| *name == controller.precision);
        let [low, high] = factors
            .map_or([1.0, 1.0], |(_, factors)| *factors)
            .map(|factor| factor * controller.cycle.max as f64);
        let [fast, slow] = [low, high].map(|cycles| cycles / CLOCK_MHZ);
        out += &format!(
            "| {} | {} | {} | {:.0} to {:.0} thousand | {fast:.0} to {slow:.0} µs | {:.1} to {:.1} % |\n",
            controller.job,
            controller.precision,
            controller.cycle.max,
            low / 1e3,
            high / 1e3,
            fast / 20.0,
            slow / 20.0,
        );
    }
    out
}
