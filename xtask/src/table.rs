//! docs/timing.md from the figures; timing.md beside this file has its text.

use crate::figures::{Controller, Figures, Path, Stage, Way};
use crate::host::LINK;
use crate::limits::LIMITS;

/// Core clock of the estimate \[MHz\].
const CLOCK_MHZ: f64 = 480.0;

/// Period of a cycle of control \[µs\].
const CYCLE_US: f64 = 2000.0;

/// Cycles per instruction between which the estimate lies.
const F64_CYCLES: [f64; 2] = [1.3, 3.0];
const F32_CYCLES: [f64; 2] = [0.9, 2.0];

/// The page.
pub fn page(figures: &Figures) -> String {
    let image = |name: &str| {
        figures
            .image
            .get(name)
            .map_or(String::new(), u64::to_string)
    };
    let parts = [
        ("{tools}", tools(figures)),
        ("{cycles}", cycles(figures)),
        ("{paths}", paths(figures)),
        ("{frozen}", frozen(figures)),
        ("{limits}", limits()),
        ("{stages}", stages(figures)),
        ("{links}", links(figures)),
        ("{memory}", memory(figures)),
        ("{flash}", image("flash")),
        ("{ram}", image("ram without stack")),
        ("{estimate}", estimate(figures)),
    ];
    let text = include_str!("timing.md").to_string();
    (parts.iter()).fold(text, |text, (mark, part)| text.replace(mark, part))
}

/// What the command prints.
pub fn summary(figures: &Figures) -> String {
    let parts = [
        cycles(figures),
        paths(figures),
        frozen(figures),
        memory(figures),
    ];
    parts.join("\n")
}

fn table(head: &str, rows: impl IntoIterator<Item = String>) -> String {
    let columns = head.matches(" | ").count() + 1;
    let rule = format!("|{}", "---|".repeat(columns));
    let rows = rows
        .into_iter()
        .map(|row| format!("| {row} |\n").replace("  |", " |"));
    format!("| {head} |\n{rule}\n{}", rows.collect::<String>())
}

fn tools(figures: &Figures) -> String {
    let peers = figures.peers.iter().map(|peer| (&peer.name, &peer.version));
    let tools = figures.tools.iter().chain(peers);
    let rows = tools.map(|(tool, version)| format!("{tool} | {version}"));
    let board = "board | QEMU mps2-an500, `-icount shift=10`".to_string();
    let inputs = format!("inputs | {} per row", figures.inputs);
    table("tool | version", rows.chain([board, inputs]))
}

fn cycles(figures: &Figures) -> String {
    let row = |controller: &Controller| {
        let Controller {
            experiment,
            precision,
            cycle,
            saturated,
            released,
            ..
        } = controller;
        let (idle, max, worst) = (idle(controller), cycle.max, &cycle.worst);
        let rows = rows(experiment);
        format!(
            "{experiment} | {rows} | {precision} | {idle} | {max} | {worst} | {saturated} | {released}"
        )
    };
    let head = "controller | rows | precision | nothing at a limit | longest | longest at | torques cut | levels released";
    table(head, figures.controllers.iter().map(row))
}

/// The longest cycle that neither projects nor loses a direction.
fn idle(controller: &Controller) -> u64 {
    controller.path(Way::Free, 0).map_or(0, |path| path.max)
}

/// What makes a cycle longer, and the paths themselves.
fn paths(figures: &Figures) -> String {
    let row = |name: &str, value: &dyn Fn(&Controller) -> Option<String>| {
        let cells = figures.controllers.iter().map(value);
        let cells = cells.map(|cell| format!(" | {}", cell.unwrap_or_default()));
        format!("{name}{}", cells.collect::<String>())
    };
    let max = |it: &Controller, way, pivots| Some(it.path(way, pivots)?.max as f64);
    let free = |it: &Controller, pivots| max(it, Way::Free, pivots);
    let pivot = |it: &Controller| Some((free(it, 12)? - free(it, 1)?) / 11.0);
    let mut lines = vec![
        row("nothing at a limit", &|it| Some(idle(it).to_string())),
        row("commands limited near a lost direction, besides", &|it| {
            Some((max(it, Way::Limited, 0)? - free(it, 0)?).to_string())
        }),
        row("a level released, besides", &|it| {
            Some((max(it, Way::Released, 0)? - max(it, Way::Limited, 0)?).to_string())
        }),
        row("the arm bent for it, besides", &|it| {
            Some((max(it, Way::Bent, 0)? - max(it, Way::Released, 0)?).to_string())
        }),
        row("projection, besides", &|it| {
            let stage = free(it, 1)? - free(it, 0)? - pivot(it)?;
            Some(format!("{stage:.0}"))
        }),
        row("each pivot, besides", &|it| {
            Some(format!("{:.0}", pivot(it)?))
        }),
    ];
    for pivots in 1..=12 {
        let plural = if pivots == 1 { "" } else { "s" };
        lines.push(row(&format!("with {pivots} pivot{plural}"), &|it| {
            Some(free(it, pivots)?.to_string())
        }));
    }
    lines.push(row("largest spread of a path", &|it| {
        let spread = |path: &Path| 100.0 * (path.max - path.min) as f64 / path.min.max(1) as f64;
        let largest = it.paths.iter().map(spread).fold(0.0, f64::max);
        Some(format!("{largest:.2} %"))
    }));
    let names = figures
        .controllers
        .iter()
        .map(|it| format!(" | {}", it.name()));
    table(&format!("cycle{}", names.collect::<String>()), lines)
}

/// The same cycles frozen, beside the generic ones.
fn frozen(figures: &Figures) -> String {
    let rows = figures.frozen.iter().map(|frozen| {
        let generic = figures.controllers.iter();
        let generic = generic.clone().find(|it| it.name() == frozen.name);
        let (idle, longest) = generic.map_or((0, 0), |it| (idle(it), it.cycle.max));
        let [least, most] = frozen.idle;
        let share = most as f64 / idle as f64;
        format!(
            "{} | {idle} | {least} to {most} | {share:.2} | {longest} | {}",
            frozen.name, frozen.longest
        )
    });
    let head = "controller | generic | frozen | share | longest generic | longest frozen";
    table(head, rows)
}

fn rows(experiment: &str) -> &'static str {
    if experiment == "two-level" {
        "3"
    } else {
        "3 + 2"
    }
}

fn limits() -> String {
    let rows = LIMITS
        .iter()
        .map(|(what, limit)| format!("{what} | {limit}"));
    table("figure | limit", rows)
}

/// Codec and session of each robot link, on the host.
fn links(figures: &Figures) -> String {
    let rows = figures.host.iter().filter_map(|(case, counts)| {
        let name = match case.strip_prefix(LINK)? {
            "fri" => "LWR, FRI".to_string(),
            other => format!("Panda and FR3, {}", other.replace("fci-", "FCI version ")),
        };
        let cell = |names: &[&str]| {
            let count = names.iter().find_map(|name| counts.get(*name));
            count.map_or(String::new(), u64::to_string)
        };
        Some(format!(
            "{name} | {} | {} | {} | {}",
            cell(&["measurement", "state"]),
            cell(&["command"]),
            cell(&["session"]),
            cell(&["session audited"]),
        ))
    });
    table(
        "link | read what comes | write a command | cycle of the session | with the robot's model",
        rows,
    )
}

/// Stages, cycle and peers of each experiment, both precisions side by side.
fn stages(figures: &Figures) -> String {
    let mut out = String::new();
    for both in figures.controllers.chunks(2) {
        let experiment = &both[0].experiment;
        let row = |name: &str, mark: &str, stage: &str, here: &dyn Fn(&Controller) -> i64| {
            let cells = both.iter().map(|controller| {
                let counts = figures.host.get(&controller.name());
                let host = counts.and_then(|counts| counts.get(stage));
                let host = host.map_or(String::new(), |host| format!("{mark}{host}{mark}"));
                format!(" | {mark}{}{mark} | {host}", here(controller))
            });
            format!("{mark}{name}{mark}{}", cells.collect::<String>())
        };
        let mut lines: Vec<String> = (both[0].stages.iter().enumerate())
            .map(|(index, Stage { name, .. })| {
                row(name, "", name, &|own| own.stages[index].cost.max as i64)
            })
            .collect();
        lines.push(row("the rest", "", "", &|own| {
            let parts: u64 = own.stages.iter().map(|stage| stage.cost.min).sum();
            idle(own) as i64 - parts as i64
        }));
        lines.push(row("longest cycle", "**", "cycle", &|own| {
            own.cycle.max as i64
        }));
        lines.push(row("cycle with nothing at a limit", "**", "idle", &|own| {
            idle(own) as i64
        }));
        for peer in &figures.peers {
            let count = peer.cycle.get(experiment);
            lines.extend(count.map(|count| format!("{} | | {count} | |", peer.name)));
        }
        let heads = both
            .iter()
            .map(|it| format!(" | M7 {0} | host {0}", it.precision));
        let head = format!("stage{}", heads.collect::<String>());
        out += &format!("\n### {experiment}, {} task rows\n\n", rows(experiment));
        out += &table(&head, lines);
    }
    out
}

fn memory(figures: &Figures) -> String {
    let row = |name: &str, value: &dyn Fn(&Controller) -> Option<u64>| {
        let values = figures.controllers.iter().map(value);
        let cells =
            values.map(|it| format!(" | {}", it.map_or("none".into(), |it| it.to_string())));
        format!("{name}{}", cells.collect::<String>())
    };
    let size = |name: &str| row(&format!("size of the {name}"), &|it| figures.size(it, name));
    let heads = figures
        .controllers
        .iter()
        .map(|it| format!(" | {}", it.name()));
    let head = format!("bytes{}", heads.collect::<String>());
    table(
        &head,
        [
            row("stack of the cycle, seen", &|it| Some(it.stack.cycle_seen)),
            row("stack of the cycle, bound", &|it| it.stack.cycle_bound),
            row("stack of the constructor, seen", &|it| {
                Some(it.stack.init_seen)
            }),
            row("stack of the constructor, bound", &|it| it.stack.init_bound),
            row("state and stack of the cycle, bound", &|it| {
                figures.working_memory(it)
            }),
            row("code of the cycle", &|it| Some(it.code)),
            row("flash of the linked core", &|it| {
                figures.core_flash.get(&it.precision).copied()
            }),
            row("the same with the exact law", &|it| {
                let name = format!("{} with the exact law", it.precision);
                figures.core_flash.get(&name).copied()
            }),
            size("controller"),
            size("state"),
            size("step"),
            size("record"),
        ],
    )
}

fn estimate(figures: &Figures) -> String {
    let row = |controller: &Controller| {
        let Controller {
            experiment,
            precision,
            cycle,
            ..
        } = controller;
        let factors = if precision == "f64" {
            F64_CYCLES
        } else {
            F32_CYCLES
        };
        let [low, high] = factors.map(|factor| factor * cycle.max as f64);
        let [fast, slow] = [low, high].map(|cycles| cycles / CLOCK_MHZ);
        let [least, most] = [fast, slow].map(|time| 100.0 * time / CYCLE_US);
        let [low, high] = [low, high].map(|cycles| cycles / 1e3);
        format!(
            "{experiment} | {precision} | {} | {low:.0} to {high:.0} thousand | {fast:.0} to {slow:.0} µs | {least:.1} to {most:.1} %",
            cycle.max
        )
    };
    let head = "controller | precision | instructions | cycles | time | share of a 2 ms cycle";
    table(head, figures.controllers.iter().map(row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_of_the_text_is_filled() {
        let page = page(&Figures::default());
        assert!(!page.contains(['{', '}']), "{page}");
        assert!(page.contains("| inputs | 0 per row |\n"));
    }
}
