//! One run: plant, controller and contacts in lock-step, in this process.

mod driver;

use std::io;

use bridge::lwr::Lwr;
use bridge::session::SessionConfig;
use controller_core::joint::{JointState, JointVector};
use controller_core::{Controller, ControllerConfig, Measurement, Reference, State};
use fci::Version;

use crate::after_fault::{Acting, Ending};
use crate::arm_points::origins;
use crate::contact::Contacts;
use crate::controllers::{ControllerKind, TorqueLaw};
use crate::interrupt;
use crate::loopback::{self, BridgeClient, FciClient, Local};
use crate::metrics::Metrics;
use crate::plant::{Plant, PlantOptions};
use crate::robot::{
    self, ControlBox, Driving, FciOptions, FciRobot, LwrRobot, Robot, RobotOptions, RobotSetup,
};
use crate::sample::{LevelProbes, Stop, UnsafeMotion};
use crate::summary::{Conditions, Summary};
use cell::invalid::Invalid;
use cell::names::{MeasurementKind, Named, NullStiffness, PlantKind, RobotInterface};
use cell::scenario::{Scenario, TimedTransition};
use record::run::Sample;

use driver::{Driver, PositionDriver, TorqueDriver};

/// A scenario and the choices that a run adds to it.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// What is to be done.
    pub scenario: Scenario,
    /// On which plant.
    pub plant: PlantKind,
    /// Whether the scripted contacts act.
    pub contacts: bool,
    /// Which law.
    pub controller: ControllerKind,
    /// Factor on the null-space stiffness.
    pub null_stiffness: NullStiffness,
    /// How the controller sees the arm.
    pub measurement: MeasurementKind,
    /// Seed of mismatch and noise.
    pub seed: u64,
    /// What the plant does beyond the reference.
    pub options: PlantOptions,
}

/// A cycle of a torque law that is watched.
pub(crate) struct Watched<'a> {
    /// Its time \[s\].
    pub t_s: f64,
    /// What comes into it.
    pub measurement: &'a Measurement<f64>,
    /// The memory of the law.
    pub state: &'a State<f64>,
    /// Whether it is that behind the cycle, or still that before it.
    pub decided: bool,
}

impl Experiment {
    /// The controller of this run.
    ///
    /// # Errors
    /// A configuration that the core refuses, for example a damping that is too
    /// strong for the cycle.
    pub fn controller(&self) -> Result<Controller<f64>, Invalid> {
        let make = match self.controller {
            ControllerKind::Torque(TorqueLaw::Hierarchical) => self.scenario.law.maker(),
            // The others take the place of the exact law.
            _ => Controller::exact,
        };
        let arm = self.scenario.arm().parameters;
        make(&arm, &self.controller_config()?)
            .map_err(|error| Invalid::line(error.named(&arm)).within(&self.scenario.name))
    }

    /// What that controller is made from.
    ///
    /// # Errors
    /// Tasks that the core does not take.
    pub fn controller_config(&self) -> Result<ControllerConfig, Invalid> {
        if self.way() != MeasurementKind::Direct {
            return Ok(self.session()?.controller);
        }
        let dead_cycles = self.options.dead_cycles as u8;
        let mut config = self.scenario.controller_config(dead_cycles)?;
        config.null_space = config.null_space.stiffened(self.null_stiffness.factor());
        Ok(config)
    }

    /// How the controller sees the arm: the link is that of the arm.
    #[must_use]
    pub fn way(&self) -> MeasurementKind {
        self.measurement.of_arm(&self.scenario.arm().parameters)
    }

    /// The bridge of a run over a link.
    fn session(&self) -> Result<SessionConfig, Invalid> {
        let (scenario, dead_cycles) = (&self.scenario, self.options.dead_cycles as u8);
        let robot = match self.way() {
            MeasurementKind::Link => {
                FciOptions::check_cycle(scenario)?;
                RobotInterface::Fci
            }
            _ => RobotInterface::Lwr,
        };
        let mut config = scenario.session_config_for(robot, dead_cycles, scenario.duration_s)?;
        let null_space = &mut config.controller.null_space;
        *null_space = null_space.stiffened(self.null_stiffness.factor());
        Ok(config)
    }

    /// The robot of a run over a link.
    fn robot<O>(&self, options: O) -> RobotSetup<O> {
        RobotSetup {
            scenario: self.scenario.clone(),
            plant: self.plant,
            contacts: self.contacts,
            seed: self.seed,
            plant_options: self.options,
            options,
        }
    }

    /// What its client has: the session, and the changes of tasks and gains on the way.
    fn led(
        &self,
        controller: &Controller<f64>,
    ) -> Result<(SessionConfig, Vec<TimedTransition>), Invalid> {
        Ok((self.session()?, self.scenario.transitions(controller)?))
    }

    /// Runs it over FRI, robot and bridge in this process.
    fn run_over_fri(
        &self,
        controller: &Controller<f64>,
        sink: impl FnMut(&Sample) -> io::Result<()>,
        progress: impl FnMut(f64),
    ) -> io::Result<Summary> {
        let (config, changes) = self.led(controller).map_err(io::Error::other)?;
        let robot = LwrRobot::new(self.robot(RobotOptions::default()));
        let client = BridgeClient::new(Lwr::new(), config, &self.scenario).changing(changes);
        self.run_over_link(robot, client, sink, progress)
    }

    /// Runs it over FCI.
    fn run_over_fci(
        &self,
        controller: &Controller<f64>,
        sink: impl FnMut(&Sample) -> io::Result<()>,
        progress: impl FnMut(f64),
    ) -> io::Result<Summary> {
        let (config, changes) = self.led(controller).map_err(io::Error::other)?;
        let options = FciOptions::of(&self.scenario, Version::V10);
        let robot = FciRobot::new(self.robot(options));
        let client = FciClient::new(config, &self.scenario, false).changing(changes);
        self.run_over_link(robot, client, sink, progress)
    }

    fn run_over_link<B: ControlBox>(
        &self,
        mut robot: Robot<B>,
        mut client: impl Local<B>,
        mut sink: impl FnMut(&Sample) -> io::Result<()>,
        mut progress: impl FnMut(f64),
    ) -> io::Result<Summary> {
        loopback::run(&mut robot, &mut client, &[], |instant, _| {
            progress(instant.t_s / self.scenario.duration_s);
            sink(instant)
        })?;
        Ok(Summary {
            controller: self.controller.name(),
            ..robot.summary()
        })
    }

    /// Runs it. Every cycle is shown to `sink` and to the figures of the summary;
    /// `progress` is told the share done, 0 to 1.
    ///
    /// # Errors
    /// Those of `sink`.
    pub fn run(
        &self,
        controller: &Controller<f64>,
        sink: impl FnMut(&Sample) -> io::Result<()>,
        progress: impl FnMut(f64),
    ) -> io::Result<Summary> {
        self.run_watched(controller, sink, progress, |_| ())
    }

    /// The same, with a look at the memory of a torque law before and behind each of its cycles in
    /// this process.
    pub(crate) fn run_watched(
        &self,
        controller: &Controller<f64>,
        mut sink: impl FnMut(&Sample) -> io::Result<()>,
        mut progress: impl FnMut(f64),
        mut watch: impl FnMut(&Watched<'_>),
    ) -> io::Result<Summary> {
        match self.way() {
            MeasurementKind::Fri => return self.run_over_fri(controller, sink, progress),
            MeasurementKind::Link => return self.run_over_fci(controller, sink, progress),
            MeasurementKind::Direct | MeasurementKind::LikeFri => {}
        }
        let scenario = &self.scenario;
        let arm = scenario.arm().parameters;
        let (cycle_s, cycles) = (scenario.cycle_s(), scenario.cycles());
        let mut contacts = if self.contacts {
            Contacts::of(scenario)
        } else {
            Contacts::none()
        };
        let probes = LevelProbes::new(scenario);
        let origins = origins(scenario, &scenario.start());
        let like_over_link = self.measurement == MeasurementKind::LikeFri;
        let mut driver = match self.controller {
            ControllerKind::Torque(law) => {
                let changes = scenario.transitions(controller).map_err(io::Error::other)?;
                let mut driver = TorqueDriver::new(controller, law, scenario).changing(changes);
                if like_over_link {
                    driver = driver.like_over_link(self.options.dead_cycles);
                }
                Driver::Torque(Box::new(driver))
            }
            ControllerKind::VelocityLevel => {
                let driver = PositionDriver::new(scenario, self.options.dead_cycles);
                Driver::Position(Box::new(driver.map_err(io::Error::other)?))
            }
        };
        let mut plant = Plant::with_options(
            self.plant,
            &arm,
            scenario.start(),
            cycle_s,
            self.seed,
            driver.plant_options(self.options),
        );
        let mut metrics = Metrics::new(scenario, &contacts.intervals(), &arm);
        let mut ending = Ending::new(cycle_s);

        // Cycles before time 0, in which the arm is held where it starts.
        let held = match like_over_link {
            true => robot::cycles(RobotOptions::default().settle_s, cycle_s) as i64,
            false => 0,
        };
        for cycle in -held.. {
            let t_s = cycle as f64 * cycle_s;
            let truth = *plant.state();
            let unsafe_motion = UnsafeMotion::of(&truth, &arm);
            let lost =
                unsafe_motion.filter(|motion| matches!(motion, UnsafeMotion::NotFinite { .. }));
            if let Some(stop) = lost.map(Stop::Unsafe).or_else(interrupt::stop) {
                ending.at_once(stop);
            }
            let over = match ending.has_begun() {
                false => cycle >= cycles as i64,
                true => ending.is_over(),
            };
            if over {
                break;
            }
            let JointState { q, dq } = plant.measure();
            let measurement = Measurement {
                q,
                dq,
                interval_s: cycle_s,
            };
            let reference = match cycle < 0 {
                true => Reference::hold(scenario.levels.len(), scenario.start()),
                false => scenario.reference(&origins, &scenario.start(), t_s),
            };
            let motors = *plant.motors().unwrap_or(&truth);
            let mut look = |driver: &Driver<'_>, decided| {
                if let Some(state) = driver.state() {
                    let measurement = &measurement;
                    watch(&Watched {
                        t_s,
                        measurement,
                        state,
                        decided,
                    });
                }
            };
            look(&driver, false);
            driver.begin_due(t_s).map_err(io::Error::other)?;
            let decision = driver.decide(&measurement, &reference, &motors);
            look(&driver, true);
            let acting = Acting {
                torque: decision.torque,
                fault: decision.fault,
                mode: Some(decision.mode),
            };
            ending.cycle(t_s, &truth, unsafe_motion, &acting);

            contacts.take_hold(t_s, plant.model(), &truth);
            let (contact_torque, hand_force_n) = contacts.joint_torque(t_s, plant.model(), &truth);
            let mut levels = probes.levels(plant.model(), &truth, &reference);
            let below = &decision.view.below;
            if !below.is_empty() {
                let factor = plant.equations().factor(&JointVector::zeros());
                let caused = below.iter().map(|torque| factor.solve(torque));
                for (level, (probe, caused)) in levels.iter_mut().zip(probes.0.iter().zip(caused)) {
                    level.leak = probe.leak(plant.model(), &truth, caused);
                }
            }
            for (level, view) in levels.iter_mut().zip(&decision.view.levels) {
                level.leak = view.leak;
                level.share = view.share;
                level.disturbance = view.disturbance;
            }
            let sample = Sample {
                t_s,
                state: truth,
                torque: decision.torque,
                residual: decision.residual,
                mode: Some(decision.mode),
                saturated: decision.saturated,
                rank: decision.rank,
                tau_ext: -contact_torque,
                hand_force_n,
                conditioning: decision.view.conditioning,
                limits: decision.limits,
                levels,
            };
            if cycle >= 0 {
                if !ending.has_begun() {
                    metrics.add(&sample);
                }
                sink(&sample)?;
            }
            let Driving { torque, impedance } = &decision.driving;
            plant.advance_with(t_s, torque, impedance, |t, model, state| {
                contacts.joint_torque(t, model, state).0
            });
            if cycle % 512 == 0 {
                progress((t_s / scenario.duration_s).max(0.0));
            }
        }
        Ok(self.summary(&metrics, &ending))
    }

    fn summary(&self, metrics: &Metrics, ending: &Ending) -> Summary {
        let conditions = Conditions {
            plant: self.plant,
            contacts: self.contacts,
            measurement: self.way(),
            dead_cycles: self.options.dead_cycles,
        };
        Summary {
            controller: self.controller.name(),
            ..Summary::of(&self.scenario, &conditions, self.seed, metrics, ending)
        }
    }
}
