//! The plant: the simulated arm that the controller acts on.
//!
//! It is built from the same tables as the controller's model and shares no code
//! with it: the controller's sums give M and the Christoffel form of C, the plant's ([`model`])
//! accelerations of links and composite inertias. Tests hold both against a third way, the
//! articulated-body algorithm in other axes ([`PlantModel::articulated_bodies`]). An error
//! in one of them shows as a disagreement instead of cancelling.
//!
//! Two kinds. `ideal` is the exact model, integrated to rounding; it shows what
//! the control law does. `realistic` adds what a real arm adds: friction, wrong
//! masses, torque noise, encoders, a differentiated velocity or the frames of a
//! motor bus, each arm's own ([`realistic`]). On request ([`PlantOptions`]) also
//! joints that stick or are elastic, and dead time.
//!
//! Everything is `f64` and uses no elementary function of the platform, so a
//! seed gives the same bytes on every machine.

mod aba;
pub mod actuators;
mod body;
mod composite;
mod drive;
pub mod elastic;
mod factor;
pub mod frames;
pub mod friction;
pub mod impedance;
mod integrate;
pub mod mismatch;
pub mod model;
pub mod noise;
mod options;
mod segment;
pub mod sensor;
pub mod stiction;

use arms::realistic::Realistic;
use cell::names::PlantKind;
use controller_core::arm::ArmParameters;
use controller_core::joint::{JointState, JointVector};

use actuators::Actuators;
use drive::Drive;
use integrate::{Span, Start};

pub use factor::{Equations, Factor};
pub use impedance::Impedance;
pub use integrate::{IDEAL_STEP_MAX, REALISTIC_STEP_MAX, REALISTIC_SUBSTEPS};
pub use mismatch::{mismatched, realistic, true_arm, want_of_data};
pub use model::PlantModel;
pub use noise::Rng;
pub(crate) use options::DeadTime;
pub use options::PlantOptions;
pub use sensor::Sensor;

/// A simulated arm and its state.
#[derive(Clone, Debug)]
pub struct Plant {
    model: PlantModel,
    state: JointState<f64>,
    /// Of the state, where they were asked for.
    equations: Option<Equations>,
    cycle_s: f64,
    options: PlantOptions,
    dead_time: DeadTime,
    drive: Drive,
    imperfections: Option<Imperfections>,
}

/// What the realistic plant has besides a model, a drive and a state.
#[derive(Clone, Debug)]
struct Imperfections {
    sensor: Sensor,
    torque_noise: Rng,
    /// Standard deviation of it \[Nm\].
    torque_deviation: JointVector<f64>,
}

impl Plant {
    /// An arm at rest at `q0` \[rad\], to be advanced by cycles of `cycle_s`
    /// \[s\] (above 0). `parameters` are the tables the controller believes;
    /// the realistic plant departs from them as `seed` says. The ideal plant
    /// does not read `seed`.
    #[must_use]
    pub fn new(
        kind: PlantKind,
        parameters: &ArmParameters,
        q0: JointVector<f64>,
        cycle_s: f64,
        seed: u64,
    ) -> Self {
        Self::with_options(kind, parameters, q0, cycle_s, seed, PlantOptions::default())
    }

    /// As [`Plant::new`], with effects that the reference plant leaves out. The
    /// ideal plant takes the dead time and the integration steps from `options`
    /// and ignores stiction and elasticity.
    ///
    /// During the dead time at the start the motors hold the arm by the gravity
    /// torque of `parameters` at `q0`. The springs of elastic joints start in
    /// equilibrium with the arm's true weight.
    ///
    /// # Panics
    /// More than [`ranges::DEAD_CYCLES_MAX`](controller_core::ranges::DEAD_CYCLES_MAX) dead cycles.
    #[must_use]
    pub fn with_options(
        kind: PlantKind,
        parameters: &ArmParameters,
        q0: JointVector<f64>,
        cycle_s: f64,
        seed: u64,
        options: PlantOptions,
    ) -> Self {
        let realistic = realistic(parameters);
        Self::departing(kind, parameters, &realistic, q0, cycle_s, seed, options)
    }

    /// As [`Plant::with_options`], the realistic plant with departures of the caller's choice. The
    /// dead time is that of `options`.
    ///
    /// # Panics
    /// As [`Plant::with_options`].
    #[must_use]
    pub fn departing(
        kind: PlantKind,
        parameters: &ArmParameters,
        realistic: &Realistic,
        q0: JointVector<f64>,
        cycle_s: f64,
        seed: u64,
        options: PlantOptions,
    ) -> Self {
        let nominal = PlantModel::new(parameters);
        let dead_time = DeadTime::new(options.dead_cycles, nominal.gravity_torque(&q0));
        let (model, drive, imperfections) = match kind {
            PlantKind::Ideal => (nominal, Drive::ideal(), None),
            PlantKind::Realistic => {
                let mut rng = Rng::new(seed, noise::stream::MISMATCH);
                let truth = true_arm(parameters, realistic, &mut rng);
                let mut moving = truth;
                if options.elasticity {
                    // Rotors are on the other side of the springs.
                    for link in &mut moving.links {
                        link.rotor_inertia = 0.0;
                    }
                }
                let model = PlantModel::new(&moving);
                let drive = Drive::realistic(&truth, &model, &q0, &options);
                let imperfections = Imperfections {
                    sensor: Sensor::new(&realistic.interface, &q0, cycle_s),
                    torque_noise: Rng::new(seed, noise::stream::TORQUE),
                    torque_deviation: Actuators::of(parameters).torque_noise,
                };
                (model, drive, Some(imperfections))
            }
        };
        Self {
            model,
            state: JointState {
                q: q0,
                dq: JointVector::zeros(),
            },
            equations: None,
            cycle_s,
            options,
            dead_time,
            drive,
            imperfections,
        }
    }

    /// The model that moves: with the mismatch, where there is one.
    #[must_use]
    pub fn model(&self) -> &PlantModel {
        &self.model
    }

    /// The true state, of the links.
    #[must_use]
    pub fn state(&self) -> &JointState<f64> {
        &self.state
    }

    /// Equations of motion in the true state, which the next [`Plant::advance`] starts from
    /// without making them again.
    pub fn equations(&mut self) -> &Equations {
        let JointState { q, dq } = &self.state;
        self.equations
            .get_or_insert_with(|| self.model.equations(q, dq))
    }

    /// Angles \[rad\] and speeds \[rad/s\] of the motors behind their gears, if the
    /// joints are elastic.
    #[must_use]
    pub fn motors(&self) -> Option<&JointState<f64>> {
        self.drive.elastic.as_ref().map(|elastic| &elastic.motor)
    }

    /// What the arm reports at this cycle instant: the true state (ideal), or
    /// encoder positions and their filtered difference, or what its motors
    /// report (realistic). Call once
    /// per cycle, before [`Plant::advance`]: the velocity filter counts calls.
    pub fn measure(&mut self) -> JointState<f64> {
        match &mut self.imperfections {
            None => self.state,
            Some(imperfections) => {
                let elastic = self.drive.elastic.as_ref();
                let motor = elastic.map_or(&self.state, |elastic| &elastic.motor);
                imperfections.sensor.measure(&self.state, motor)
            }
        }
    }

    /// Moves on by one cycle from time `t_s` \[s\] with the motor torque
    /// `torque` \[Nm\], positive along +q, held constant. With dead time the torque
    /// acts that many cycles later.
    ///
    /// `external(t, model, state)` gives the joint torque +J^T F \[Nm\] of
    /// contact forces F on the arm (that is, -tau_ext). The ideal plant asks
    /// for it at the four stages of every substep, the realistic one at the
    /// start of every substep.
    pub fn advance(
        &mut self,
        t_s: f64,
        torque: &JointVector<f64>,
        external: impl FnMut(f64, &PlantModel, &JointState<f64>) -> JointVector<f64>,
    ) {
        self.advance_with(t_s, torque, &Impedance::NONE, external);
    }

    /// As [`Plant::advance`], with springs and dampers that act on the motors
    /// besides `torque`. They are the robot's own: no dead time, no noise.
    ///
    /// Where they do something the ideal plant is integrated by linearly implicit
    /// steps as the realistic one, without friction.
    pub fn advance_with(
        &mut self,
        t_s: f64,
        torque: &JointVector<f64>,
        impedance: &Impedance,
        mut external: impl FnMut(f64, &PlantModel, &JointState<f64>) -> JointVector<f64>,
    ) {
        let mut torque = self.dead_time.pass(torque);
        if let Some(imperfections) = &mut self.imperfections {
            torque = imperfections.sensor.commanded(&torque);
            let deviations = imperfections.torque_deviation.iter();
            for (torque, deviation) in torque.iter_mut().zip(deviations) {
                *torque += deviation * imperfections.torque_noise.gaussian();
            }
        }
        let (model, cycle_s) = (&self.model, self.cycle_s);
        let start = Start {
            state: &self.state,
            equations: self.equations.take(),
        };
        let contact = |t: f64, state: &JointState<f64>| external(t, model, state);
        let span = |reference| Span {
            t_s,
            cycle_s,
            substeps: self.options.substeps(reference),
        };
        self.state = if self.imperfections.is_none() && impedance.is_none() {
            let span = span(integrate::ideal_substeps(cycle_s));
            integrate::explicit(model, start, &span, &torque, contact)
        } else {
            let span = span(integrate::realistic_substeps(cycle_s));
            let drive = &mut self.drive;
            integrate::implicit(model, drive, start, &span, &torque, impedance, contact)
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arms::LWR_IV;

    #[test]
    fn the_ideal_plant_measures_its_true_state_and_ignores_the_seed() {
        let q0 = JointVector::from([0.1, 0.5, 0.0, -1.2, 0.3, 1.0, 0.0]);
        let run = |seed| {
            let mut plant = Plant::new(PlantKind::Ideal, &LWR_IV, q0, 0.002, seed);
            for cycle in 0..50 {
                let t = f64::from(cycle) * 0.002;
                plant.advance(t, &JointVector::zeros(), |_, _, _| JointVector::zeros());
            }
            assert_eq!(plant.measure(), *plant.state());
            *plant.state()
        };
        assert_eq!(run(1), run(2));
    }

    #[test]
    fn contact_times_cover_the_cycle() {
        for (kind, calls) in [(PlantKind::Ideal, 16), (PlantKind::Realistic, 8)] {
            let mut plant = Plant::new(kind, &LWR_IV, JointVector::zeros(), 0.002, 1);
            let mut times = Vec::new();
            plant.advance(3.0, &JointVector::zeros(), |t, _, _| {
                times.push(t);
                JointVector::zeros()
            });
            assert_eq!(times.len(), calls);
            assert_eq!(times.first(), Some(&3.0));
            assert!(times.iter().all(|t| (3.0..=3.002 + 1e-12).contains(t)));
        }
    }

    #[test]
    fn a_contact_acts_like_a_motor_torque() {
        let push = JointVector::from([1.0, -2.0, 0.5, 1.5, 0.1, -0.1, 0.01]);
        let q0 = JointVector::from([0.1, 0.5, 0.0, -1.2, 0.3, 1.0, 0.0]);
        for kind in [PlantKind::Ideal, PlantKind::Realistic] {
            let mut by_motor = Plant::new(kind, &LWR_IV, q0, 0.002, 5);
            let mut by_contact = by_motor.clone();
            by_motor.advance(0.0, &push, |_, _, _| JointVector::zeros());
            by_contact.advance(0.0, &JointVector::zeros(), |_, _, _| push);
            let difference = by_motor.state().dq - by_contact.state().dq;
            assert!(difference.amax() < 1e-11, "{difference}");
        }
    }
}
