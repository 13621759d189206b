//! What the plant can imitate beyond the reference behaviour.

use cell::names::PlantKind;
use controller_core::arm::ArmParameters;
use controller_core::cycle::delay::Delay;
use controller_core::joint::JointVector;
use controller_core::ranges;

use super::mismatch::realistic;

/// Largest dead time, in cycles: that of the controller.
const DEAD_CYCLES_MAX: usize = ranges::DEAD_CYCLES_MAX as usize;

/// Effects that the reference plant leaves out. The default is the reference
/// plant, to the last bit; [`PlantOptions::of`] has the dead time of an arm's own.
///
/// Stiction and elasticity are effects of a real drive: the ideal plant does
/// not read them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlantOptions {
    /// Joints that stick: set-valued Coulomb friction with a break-away level
    /// ([`super::stiction`]) instead of a smooth passage through zero speed.
    pub stiction: bool,
    /// Springs between motors and links ([`super::elastic`]).
    pub elasticity: bool,
    /// Cycles between a torque command and its effect, 0 to
    /// [`ranges::DEAD_CYCLES_MAX`].
    pub dead_cycles: usize,
    /// How many times as many integration steps as the reference; 0 counts as 1.
    /// Says how large the integration error is.
    pub substeps_factor: usize,
}

impl PlantOptions {
    /// What the plant of this arm has where nothing else is asked for: on the realistic one the dead
    /// time that is the arm's own.
    #[must_use]
    pub fn of(kind: PlantKind, arm: &ArmParameters) -> Self {
        let dead_cycles = match kind {
            PlantKind::Ideal => 0,
            PlantKind::Realistic => realistic(arm).dead_cycles.into(),
        };
        Self {
            dead_cycles,
            ..Self::default()
        }
    }

    /// `reference` integration steps, times the factor.
    pub(super) fn substeps(&self, reference: u32) -> u32 {
        let factor = u32::try_from(self.substeps_factor.max(1)).unwrap_or(u32::MAX);
        reference.saturating_mul(factor)
    }
}

/// Torque commands on their way: what goes in comes out a fixed number of
/// cycles later.
#[derive(Clone, Debug)]
pub(crate) struct DeadTime {
    sent: Delay<f64>,
    cycles: u8,
    before: JointVector<f64>,
}

impl DeadTime {
    /// `cycles` of dead time, at most [`DEAD_CYCLES_MAX`]. Until the first
    /// command arrives, `torque` \[Nm\] comes out.
    pub fn new(cycles: usize, torque: JointVector<f64>) -> Self {
        assert!(
            cycles <= DEAD_CYCLES_MAX,
            "{cycles} dead cycles; allowed: 0 to {DEAD_CYCLES_MAX}"
        );
        Self {
            sent: Delay::new(),
            cycles: cycles as u8,
            before: torque,
        }
    }

    /// One cycle: takes this cycle's command \[Nm\], gives the one that arrives.
    pub fn pass(&mut self, command: &JointVector<f64>) -> JointVector<f64> {
        self.sent.send(self.cycles, command, &self.before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_arrives_after_its_dead_time() {
        let command = |n: usize| JointVector::repeat(n as f64);
        for cycles in 0..=DEAD_CYCLES_MAX {
            let mut dead_time = DeadTime::new(cycles, command(1000));
            for n in 0..30_usize {
                let expected = n.checked_sub(cycles).map_or(command(1000), command);
                assert_eq!(dead_time.pass(&command(n)), expected);
            }
        }
    }

    #[test]
    #[should_panic(expected = "9 dead cycles; allowed: 0 to 8")]
    fn too_long_a_dead_time_is_refused() {
        let _ = DeadTime::new(DEAD_CYCLES_MAX + 1, JointVector::zeros());
    }

    #[test]
    fn no_factor_is_a_factor_of_one() {
        for (factor, steps) in [(0, 8), (1, 8), (4, 32)] {
            let options = PlantOptions {
                substeps_factor: factor,
                ..PlantOptions::default()
            };
            assert_eq!(options.substeps(8), steps);
        }
    }
}
