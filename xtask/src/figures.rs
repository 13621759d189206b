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
    /// Scenario.
    pub job: String,
    /// f64 or f32.
    pub precision: String,
    /// Full cycle \[instructions\].
    pub cycle: Cost,
    /// Where the full cycle is longest.
    pub worst_input: String,
    /// The stages, in order.
    pub stages: Vec<Stage>,
    /// Inputs with a cut torque, with an unresolved row.
    pub saturated: u64,
    /// See `saturated`.
    pub deficient: u64,
    /// Of all torque bits, the same on the host.
    pub checksum: String,
    /// Use of the stack \[bytes\].
    pub stack: Stack,
    /// Code of the cycle \[bytes\].
    pub code: u64,
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

impl Figures {
    /// From the lines of the image `bench`.
    pub fn parse(lines: &str) -> Result<Self, Trouble> {
        let mut figures = Self::default();
        for line in lines.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            figures.read(&words).ok_or_else(|| {
                Trouble::Content(format!("the image said what is not understood: {line}"))
            })?;
        }
        Ok(figures)
    }

    fn read(&mut self, words: &[&str]) -> Option<()> {
        match *words {
            ["calibration", _] => {}
            [
                "inputs",
                job,
                precision,
                count,
                "faults",
                "0",
                "saturated",
                saturated,
                "deficient",
                deficient,
                "checksum",
                checksum,
            ] => {
                self.inputs = count.parse().ok()?;
                self.controllers.push(Controller {
                    job: job.into(),
                    precision: precision.into(),
                    saturated: saturated.parse().ok()?,
                    deficient: deficient.parse().ok()?,
                    checksum: checksum.into(),
                    ..Controller::default()
                });
            }
            ["cost", _, _, min, max, worst, ref name @ ..] => {
                let cost = Cost {
                    min: min.parse().ok()?,
                    max: max.parse().ok()?,
                    worst: worst.into(),
                };
                let controller = self.controllers.last_mut()?;
                match name.join(" ") {
                    name if name == "cycle" => controller.cycle = cost,
                    name => controller.stages.push(Stage { name, cost }),
                }
            }
            ["worst", _, _, ref input @ ..] => {
                self.controllers.last_mut()?.worst_input = input.join(" ");
            }
            ["stack", _, _, "init", init, "cycle", cycle] => {
                let stack = &mut self.controllers.last_mut()?.stack;
                stack.init_seen = init.parse().ok()?;
                stack.cycle_seen = cycle.parse().ok()?;
            }
            ["size", precision, ref pairs @ ..] => {
                let sizes = self.sizes.entry(precision.into()).or_default();
                for pair in pairs.chunks_exact(2) {
                    sizes.insert(pair[0].into(), pair[1].parse().ok()?);
                }
            }
            _ => return None,
        }
        Some(())
    }

    /// Size of a type \[bytes\].
    pub fn size(&self, precision: &str, name: &str) -> Option<u64> {
        self.sizes.get(precision)?.get(name).copied()
    }

    /// What a cycle needs to run besides controller, input and output: state and stack
    /// together \[bytes\].
    pub fn working_memory(&self, controller: &Controller) -> Option<u64> {
        let state = self.size(&controller.precision, "state")?;
        Some(state + controller.stack.cycle_bound?)
    }

    /// Every figure that must not grow, by name.
    pub fn bounded(&self) -> BTreeMap<String, u64> {
        let mut all = BTreeMap::new();
        for controller in &self.controllers {
            let of = format!("{} {}", controller.job, controller.precision);
            all.insert(format!("{of}: cycle, instructions"), controller.cycle.max);
            for stage in &controller.stages {
                all.insert(
                    format!("{of}: {}, instructions", stage.name),
                    stage.cost.max,
                );
            }
            let stack = &controller.stack;
            all.insert(
                format!("{of}: stack of the cycle seen, bytes"),
                stack.cycle_seen,
            );
            all.insert(
                format!("{of}: stack of construction seen, bytes"),
                stack.init_seen,
            );
            for (what, bound) in [
                ("cycle", stack.cycle_bound),
                ("construction", stack.init_bound),
            ] {
                // A bound that is lost is worse than any.
                all.insert(
                    format!("{of}: stack bound of {what}, bytes"),
                    bound.unwrap_or(u64::MAX),
                );
            }
            all.insert(format!("{of}: code of the cycle, bytes"), controller.code);
        }
        for (precision, sizes) in &self.sizes {
            for (name, &bytes) in sizes {
                all.insert(format!("{precision}: {name}, bytes"), bytes);
            }
        }
        for (precision, &bytes) in &self.core_flash {
            all.insert(
                format!("{precision}: flash of the linked core, bytes"),
                bytes,
            );
        }
        for (name, &bytes) in &self.image {
            all.insert(format!("application image: {name}, bytes"), bytes);
        }
        all
    }
}
