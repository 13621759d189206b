//! `hil-sim gains`: gains for an arm and a cycle.

use std::f64::consts::TAU;

use clap::Args;
use controller_core::arm::ArmModel;

use super::run::switch;
use crate::gains::kind::most_mobile;
use crate::gains::link::Departure;
use crate::gains::proposal::{BANDWIDTH_HZ, Refusal, Request, propose};
use crate::gains::{text, workspace};

use cell::arguments::values::{number, whole};
use cell::arm::robot::Robot;
use cell::invalid::Invalid;
use cell::ranges::{CYCLE_MS, DEAD_CYCLES};
use cell::terminal::{print, tell};

/// Options of `gains`.
#[derive(Clone, Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct GainsOptions {
    /// Arm file, or an arm of the crate arms
    arm: String,
    #[arg(long, value_parser = number(CYCLE_MS), help = format!("Control cycle in ms, {CYCLE_MS}"))]
    cycle_ms: f64,
    #[arg(long, value_name = "HZ", value_parser = number(BANDWIDTH_HZ),
        help = format!("Bandwidth of all levels in Hz, {BANDWIDTH_HZ}: K_p = w^2, K_d = 2 w with \
            w = 2 pi HZ [default: the largest that the bounds allow, by kind of level]"))]
    bandwidth: Option<f64>,
    #[arg(long, value_parser = whole(DEAD_CYCLES),
        help = format!("Cycles between a torque and its effect, {DEAD_CYCLES} [default: those of \
            the arm's realistic plant]"))]
    dead_cycles: Option<u8>,
    /// Elastic joints, as of the realistic plant: on, off
    #[arg(long, default_value = "off")]
    elasticity: String,
    /// A whole scenario, to be run as it is, instead of the tables with gains
    #[arg(long)]
    scenario: bool,
}

impl GainsOptions {
    /// Prints a proposal, gives the exit code: 1 where what is asked for cannot be had.
    ///
    /// # Errors
    /// Whatever was given that cannot be used.
    pub fn run(&self) -> Result<u8, Invalid> {
        let arm = Robot::found(&self.arm)?.table()?;
        let request = Request {
            cycle_s: self.cycle_ms / 1e3,
            bandwidth: self.bandwidth.map(|hertz| TAU * hertz),
            departure: Departure {
                dead_cycles: self.dead_cycles,
                elastic: switch("--elasticity", &self.elasticity)?,
            },
        };
        match propose(arm, request) {
            Ok(proposal) => {
                let model = ArmModel::new(arm).map_err(Invalid::line)?;
                print(match self.scenario {
                    true => {
                        let start = most_mobile(&model, &workspace::inner(arm));
                        text::scenario(&proposal, &self.arm, &start)
                    }
                    false => text::tables(&proposal),
                })?;
                Ok(0)
            }
            Err(Refusal::Invalid(error)) => Err(error),
            Err(refusal) => {
                tell(format_args!("error: {refusal}"));
                Ok(1)
            }
        }
    }
}
