//! docs/timing.md from the figures.

use crate::figures::{Controller, Figures};

/// Core clock of the estimate \[MHz\].
const CLOCK_MHZ: f64 = 480.0;

/// Cycles per instruction between which the estimate lies, f64 and f32.
const CYCLES_PER_INSTRUCTION: [(&str, [f64; 2]); 2] = [("f64", [1.3, 3.0]), ("f32", [0.9, 2.0])];

const INTRODUCTION: &str = "# Timing on a Cortex-M7

Made by `cargo bench-m7 --write`; `cargo bench-m7` measures again and fails where a
figure is more than 2 % above [timing.json](timing.json). Do not edit.

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

const STAGES: &str = "
## Parts of a cycle

Each part alone, behind a call of its own: largest number of instructions over the same
inputs. In the cycle parts are inlined into each other, so that the sum is not the cycle;
the last row is the difference: checks, dead time, record, copies.
";

const STACK: &str = "
## Memory

Stack in bytes. *Seen* is the high-water mark of a painted stack over the adverse
inputs and every tenth random one, *bound* the deepest path through the call graph of
the disassembled image: every frame counted in full, no call left unresolved.
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
    out += "\n## A full cycle\n\nInstructions.\n\n";
    out += &cycles(figures);
    out += STAGES;
    out += &stages(figures);
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

fn stages(figures: &Figures) -> String {
    let (head, rule) = heads(figures);
    let mut out = format!("\n| part |{head}\n|---|{rule}\n");
    let names = figures.controllers.first().map(|c| &c.stages);
    for (index, stage) in names.into_iter().flatten().enumerate() {
        out += &format!("| {} |", stage.name);
        for controller in &figures.controllers {
            let count = controller
                .stages
                .get(index)
                .map_or(0, |stage| stage.cost.max);
            out += &format!(" {count} |");
        }
        out.push('\n');
    }
    out += "| the rest |";
    for controller in &figures.controllers {
        let parts: u64 = controller.stages.iter().map(|stage| stage.cost.max).sum();
        out += &format!(" {} |", controller.cycle.max as i64 - parts as i64);
    }
    out + "\n"
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
