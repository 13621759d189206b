//! What lies between the law and an arm: of the ideal plant, and of the realistic one.

use arms::realistic::Interface;
use controller_core::arm::ArmParameters;
use controller_core::cycle::velocity::CORNER_HZ;
use controller_core::joint::{DOF, JointVector};

use super::sampled::{Reading, Timing};
use crate::plant::frames::Frames;
use crate::plant::realistic;

/// What a loop has to bear: an arm that answers a torque as believed, twice as much, and half as
/// much. A gain margin of 6 dB to both sides.
pub const ANSWERS: [f64; 3] = [1.0, 2.0, 0.5];

/// An arm's link to its controller.
#[derive(Clone, Debug)]
pub struct Link {
    /// "ideal" or "realistic".
    pub name: &'static str,
    /// Cycle, dead time, reading.
    pub timing: Timing,
    /// Whether joints are elastic.
    pub elastic: bool,
    /// Viscous friction \[Nms/rad\].
    pub friction: [f64; DOF],
    /// Standard deviations of the rounding of what is read: of positions \[rad\] and of speeds
    /// \[rad/s\].
    pub rounding: [JointVector<f64>; 2],
}

/// What a realistic arm has besides its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure {
    /// Cycles of dead time; none: the arm's own.
    pub dead_cycles: Option<u8>,
    /// Whether its joints are elastic.
    pub elastic: bool,
}

impl Link {
    /// True state, no dead time.
    #[must_use]
    pub fn ideal(cycle_s: f64) -> Self {
        Self {
            name: "ideal",
            timing: Timing {
                cycle_s,
                dead_cycles: 0,
                reading: Reading::Link,
            },
            elastic: false,
            friction: [0.0; DOF],
            rounding: [JointVector::zeros(); 2],
        }
    }

    /// What its loop has to bear. Motors on springs are the departure themselves: of inertias
    /// that no table has.
    #[must_use]
    pub fn answers(&self) -> Vec<f64> {
        match self.elastic {
            true => vec![1.0],
            false => ANSWERS.to_vec(),
        }
    }

    /// That of the realistic plant.
    #[must_use]
    pub fn realistic(arm: &ArmParameters, cycle_s: f64, departure: Departure) -> Self {
        let own = realistic(arm);
        let timing = Timing {
            cycle_s,
            dead_cycles: departure.dead_cycles.unwrap_or(own.dead_cycles),
            reading: match own.interface {
                Interface::Encoders { .. } => Reading::Filtered {
                    corner_hz: CORNER_HZ,
                },
                Interface::Frames(_) => Reading::Motor,
            },
        };
        // A value lies anywhere within its step.
        let deviation = 1.0 / f64::sqrt(12.0);
        let steps = match &own.interface {
            Interface::Encoders { step } => {
                // White errors of positions, differenced and through the pole:
                // (a / h)^2 2 / (2 - a) times their variance.
                let pole = timing.pole();
                let gain = pole / cycle_s * f64::sqrt(2.0 / (2.0 - pole));
                [step, &(step * gain)].map(|step| JointVector::repeat(*step))
            }
            Interface::Frames(motors) => Frames::new(motors).steps(),
        };
        Self {
            name: "realistic",
            timing,
            elastic: departure.elastic,
            friction: own.friction.map(|friction| friction.viscous),
            rounding: steps.map(|step| step * deviation),
        }
    }
}
