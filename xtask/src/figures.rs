//! The figures of docs/timing.json.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::host::{Counts, Peer};
use crate::tools::Trouble;

/// Everything that is measured.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Figures {
    /// Compiler, emulator, profile.
    pub tools: BTreeMap<String, String>,
    /// Inputs per controller.
    pub inputs: u64,
    /// One entry per controller and precision.
    pub controllers: Vec<Controller>,
    /// The same cycles frozen.
    #[serde(default)]
    pub frozen: Vec<FrozenCycle>,
    /// Size of the types \[bytes\], by precision.
    pub sizes: BTreeMap<String, BTreeMap<String, u64>>,
    /// Memory of the application image \[bytes\].
    pub image: BTreeMap<String, u64>,
    /// Flash of constructor, cycle and record alone \[bytes\], by precision.
    #[serde(default)]
    pub core_flash: BTreeMap<String, u64>,
    /// Instructions on the host, by controller and stage.
    #[serde(default)]
    pub host: Counts,
    /// The same law by other libraries, on the host.
    #[serde(default)]
    pub peers: Vec<Peer>,
}

/// One controller in one precision.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Controller {
    /// Its scenario.
    pub experiment: String,
    /// f64 or f32.
    pub precision: String,
    /// Full cycle \[instructions\].
    pub cycle: Cost,
    /// The same by paths.
    #[serde(default)]
    pub paths: Vec<Path>,
    /// Where the full cycle is longest.
    pub worst_input: String,
    /// The stages, in order.
    pub stages: Vec<Stage>,
    /// Inputs with a cut torque, with a level released.
    pub saturated: u64,
    /// See `saturated`.
    #[serde(default)]
    pub released: u64,
    /// Of all torque bits, the same on the host.
    pub checksum: String,
    /// Use of the stack \[bytes\].
    pub stack: Stack,
    /// Code of the cycle \[bytes\].
    pub code: u64,
}

/// A frozen cycle on the same inputs, equal to the generic one in every bit.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct FrozenCycle {
    /// Its scenario and precision.
    pub name: String,
    /// Instructions with nothing at a limit: smallest, largest.
    pub idle: [u64; 2],
    /// Of the longest one.
    pub longest: u64,
}

/// Instructions over all inputs.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Cost {
    /// Smallest.
    pub min: u64,
    /// Largest.
    pub max: u64,
    /// Kind of input with the largest.
    pub worst: String,
}

/// What directions get lost, and what is done about it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Way {
    /// None.
    #[default]
    Free,
    /// One is nearly lost: commands have a limit.
    Limited,
    /// A level is released.
    Released,
    /// The arm is bent for it.
    Bent,
}

impl Way {
    fn of(number: u64) -> Option<Self> {
        [Self::Free, Self::Limited, Self::Released, Self::Bent]
            .get(usize::try_from(number).ok()?)
            .copied()
    }

    /// Behind the name of a cycle.
    fn text(self) -> &'static str {
        match self {
            Self::Free => "",
            Self::Limited => ", commands limited",
            Self::Released => ", a level released",
            Self::Bent => ", the arm bent for a released level",
        }
    }
}

/// What decides how long a cycle is, and how long it then is \[instructions\].
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Path {
    /// What directions get lost.
    pub way: Way,
    /// Pivots of the projection; without any it is not run.
    pub pivots: u64,
    /// How many inputs take it.
    pub inputs: u64,
    /// Smallest.
    pub min: u64,
    /// Largest.
    pub max: u64,
}

/// A stage of the cycle.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Stage {
    /// Name.
    pub name: String,
    /// Instructions.
    #[serde(flatten)]
    pub cost: Cost,
}

/// Seen by painting, and bound from the code.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Stack {
    /// Construction of the controller, seen.
    pub init_seen: u64,
    /// The same, bound; none where the code has calls that cannot be followed.
    pub init_bound: Option<u64>,
    /// Cycle, seen.
    pub cycle_seen: u64,
    /// Cycle, bound.
    pub cycle_bound: Option<u64>,
}

impl Path {
    /// By what decides on it.
    pub fn name(&self) -> String {
        let cycle = match self.pivots {
            0 => "cycle".into(),
            1 => "cycle with 1 pivot".into(),
            pivots => format!("cycle with {pivots} pivots"),
        };
        format!("{cycle}{}", self.way.text())
    }
}

impl Controller {
    /// Experiment and precision.
    pub fn name(&self) -> String {
        format!("{} {}", self.experiment, self.precision)
    }

    /// A path, where an input took it.
    pub fn path(&self, way: Way, pivots: u64) -> Option<&Path> {
        let is_it = |path: &&Path| (path.way, path.pivots) == (way, pivots);
        self.paths.iter().find(is_it)
    }
}

impl Figures {
    /// From the lines of the image `bench`.
    pub fn parse(lines: &str) -> Result<Self, Trouble> {
        let mut figures = Self::default();
        for line in lines.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let wrong = || Trouble::new(format!("the image said what is not understood: {line}"));
            figures.read(&words).ok_or_else(wrong)?;
        }
        Ok(figures)
    }

    fn read(&mut self, words: &[&str]) -> Option<()> {
        let number = |word: &str| word.parse::<u64>().ok();
        match *words {
            ["calibration", _] => {}
            [
                "inputs",
                experiment,
                precision,
                count,
                "faults",
                "0",
                ref rest @ ..,
            ] => {
                let [
                    "saturated",
                    saturated,
                    "released",
                    released,
                    "checksum",
                    checksum,
                ] = *rest
                else {
                    return None;
                };
                self.inputs = number(count)?;
                self.controllers.push(Controller {
                    experiment: experiment.into(),
                    precision: precision.into(),
                    saturated: number(saturated)?,
                    released: number(released)?,
                    checksum: checksum.into(),
                    ..Controller::default()
                });
            }
            [
                "frozen",
                experiment,
                precision,
                "idle",
                least,
                most,
                "longest",
                longest,
                "differing",
                "0",
                "faults",
                _,
            ] => self.frozen.push(FrozenCycle {
                name: format!("{experiment} {precision}"),
                idle: [number(least)?, number(most)?],
                longest: number(longest)?,
            }),
            ["size", precision, ref pairs @ ..] => {
                let sizes = self.sizes.entry(precision.into()).or_default();
                for pair in pairs.chunks_exact(2) {
                    sizes.insert(pair[0].into(), number(pair[1])?);
                }
            }
            [kind, _, _, ref rest @ ..] => {
                let controller = self.controllers.last_mut()?;
                match (kind, rest) {
                    ("cost", [min, max, worst, name @ ..]) => {
                        let name = name.join(" ");
                        let (min, max, worst) = (number(min)?, number(max)?, worst.to_string());
                        let cost = Cost { min, max, worst };
                        if name == "cycle" {
                            controller.cycle = cost;
                        } else {
                            controller.stages.push(Stage { name, cost });
                        }
                    }
                    ("path", &[way, pivots, inputs, min, max]) => {
                        controller.paths.push(Path {
                            way: Way::of(number(way)?)?,
                            pivots: number(pivots)?,
                            inputs: number(inputs)?,
                            min: number(min)?,
                            max: number(max)?,
                        });
                    }
                    ("worst", input) => controller.worst_input = input.join(" "),
                    ("stack", ["init", init, "cycle", cycle]) => {
                        controller.stack.init_seen = number(init)?;
                        controller.stack.cycle_seen = number(cycle)?;
                    }
                    _ => return None,
                }
            }
            _ => return None,
        }
        Some(())
    }

    /// Size of a type in the controller's precision \[bytes\].
    pub fn size(&self, controller: &Controller, name: &str) -> Option<u64> {
        self.sizes.get(&controller.precision)?.get(name).copied()
    }

    /// What a cycle needs to run besides controller, input and output: state and stack
    /// together \[bytes\].
    pub fn working_memory(&self, controller: &Controller) -> Option<u64> {
        Some(self.size(controller, "state")? + controller.stack.cycle_bound?)
    }

    /// Every figure that must not grow, by name.
    pub fn bounded(&self) -> BTreeMap<String, u64> {
        let mut all = BTreeMap::new();
        let mut add = |of: &str, what: &str, value| all.insert(format!("{of}: {what}"), value);
        // A bound that is lost is worse than any.
        let bound = |bytes: Option<u64>| bytes.unwrap_or(u64::MAX);
        for controller in &self.controllers {
            let (of, stack) = (&controller.name(), &controller.stack);
            add(of, "longest cycle, instructions", controller.cycle.max);
            for path in &controller.paths {
                add(of, &format!("{}, instructions", path.name()), path.max);
            }
            for Stage { name, cost } in &controller.stages {
                add(of, &format!("{name} alone, instructions"), cost.max);
            }
            add(of, "stack of the cycle seen, bytes", stack.cycle_seen);
            add(of, "stack of the constructor seen, bytes", stack.init_seen);
            add(
                of,
                "stack bound of the cycle, bytes",
                bound(stack.cycle_bound),
            );
            add(
                of,
                "stack bound of the constructor, bytes",
                bound(stack.init_bound),
            );
            let working = bound(self.working_memory(controller));
            add(of, "state and stack of the cycle, bytes", working);
            add(of, "code of the cycle, bytes", controller.code);
        }
        for frozen in &self.frozen {
            let of = &frozen.name;
            add(of, "frozen cycle, instructions", frozen.idle[1]);
            add(of, "longest frozen cycle, instructions", frozen.longest);
        }
        for (precision, sizes) in &self.sizes {
            for (name, &bytes) in sizes {
                add(precision, &format!("{name}, bytes"), bytes);
            }
        }
        for (precision, &bytes) in &self.core_flash {
            add(precision, "flash of the linked core, bytes", bytes);
        }
        for (name, &bytes) in &self.image {
            add("application image", &format!("{name}, bytes"), bytes);
        }
        all
    }
}
