//! What a controller makes of a measurement: torques for the motors, or positions for the
//! robot's own position controller.

use controller_core::cycle::Data;
use controller_core::cycle::velocity::{CORNER_HZ, VelocityEstimator};
use controller_core::fault::Mode;
use controller_core::joint::{JointState, JointVector};
use controller_core::resolver::{Resolver, ResolverConfig, ResolverState};
use controller_core::{
    ChangeError, Controller, Fault, Measurement, Reference, State, Step, Transition,
};

use crate::controllers::{LawGains, SplitDemand, TorqueLaw};
use crate::plant::{DeadTime, Impedance, PlantOptions};
use crate::robot::{Driving, POSITION_STIFFNESS, RobotModel};
use cell::invalid::Invalid;
use cell::scenario::Scenario;
use record::run::LimitSample;

/// K of the velocity-level controller \[1/s\].
pub const RESOLVER_GAIN: f64 = 10.0;

/// What a cycle decided, and what acts until the next.
pub(super) struct Decision {
    pub fault: Option<Fault>,
    pub mode: Mode,
    pub driving: Driving,
    /// All that the motors give at the start of the cycle \[Nm\].
    pub torque: JointVector<f64>,
    /// r \[Nm\]; zero where nothing observes.
    pub residual: JointVector<f64>,
    pub saturated: bool,
    pub rank: bool,
    pub view: PriorityView,
    /// Of the law within limits.
    pub limits: Option<LimitSample>,
}

/// What a torque law knew beyond its result.
#[derive(Default)]
pub(super) struct PriorityView {
    pub conditioning: Vec<f64>,
    /// Torque asked for below each level \[Nm\]; empty where it is not known.
    pub below: Vec<JointVector<f64>>,
    /// What the law within limits says of each level; empty of other laws.
    pub levels: Vec<LevelView>,
}

/// What the law within limits says of a level, as in [`record::run::LevelSample`].
pub(super) struct LevelView {
    pub leak: f64,
    pub share: f64,
    pub disturbance: f64,
}

impl PriorityView {
    /// Of the law within limits.
    fn within_limits(data: &Data<f64>) -> Self {
        let mobility = data.spectrum.directions().iter().map(|d| d.mobility);
        Self {
            conditioning: mobility.map(|z| z.max(0.0).sqrt()).collect(),
            below: Vec::new(),
            levels: (data.wish.leak.iter())
                .zip(&data.wish.level_share)
                .zip(&data.projection.disturbance)
                .map(|((&leak, &share), &disturbance)| LevelView {
                    leak,
                    share,
                    disturbance,
                })
                .collect(),
        }
    }

    fn new(data: &Data<f64>, demand: &SplitDemand) -> Self {
        let hierarchy = &data.hierarchy;
        Self {
            conditioning: hierarchy.conditioning()[..hierarchy.count()].to_vec(),
            below: (0..hierarchy.levels())
                .map(|level| demand.below(&data.dynamics, level))
                .collect(),
            levels: Vec::new(),
        }
    }
}

/// A controller with its memory, and the part of the robot that it talks to.
pub(super) enum Driver<'a> {
    Torque(Box<TorqueDriver<'a>>),
    Position(Box<PositionDriver>),
}

impl Driver<'_> {
    /// The plant's share of `options`: the dead time of positions is on their way to the
    /// robot's springs, that of a link on the way of the added torque; neither is the motors'.
    pub fn plant_options(&self, options: PlantOptions) -> PlantOptions {
        match self {
            Self::Torque(driver) if driver.link.is_none() => options,
            _ => PlantOptions {
                dead_cycles: 0,
                ..options
            },
        }
    }

    /// The memory of a torque law.
    pub fn state(&self) -> Option<&State<f64>> {
        match self {
            Self::Torque(driver) => Some(&driver.state),
            Self::Position(_) => None,
        }
    }

    /// Begins the changes of tasks and gains whose time has come at `t_s` \[s\].
    ///
    /// # Errors
    /// A change that the state of the tasks does not take.
    pub fn begin_due(&mut self, t_s: f64) -> Result<(), ChangeError> {
        match self {
            Self::Torque(driver) => driver.begin_due(t_s),
            Self::Position(_) => Ok(()),
        }
    }

    /// One cycle. `motors` is how they move.
    pub fn decide(
        &mut self,
        measurement: &Measurement<f64>,
        reference: &Reference<f64>,
        motors: &JointState<f64>,
    ) -> Decision {
        match self {
            Self::Torque(driver) => driver.decide(measurement, reference),
            Self::Position(driver) => driver.decide(measurement, reference, motors),
        }
    }
}

/// What stands between a torque law and the arm over a robot link, but for the link: speeds
/// are estimated, and only what is added to gravity has dead time.
struct LinkConditions {
    velocity: VelocityEstimator<f64>,
    /// The way of the added torque to the robot.
    way: DeadTime,
    /// The torque that acts since the last cycle \[Nm\].
    acting: Option<JointVector<f64>>,
}

impl LinkConditions {
    fn new(dead_cycles: usize) -> Self {
        Self {
            velocity: VelocityEstimator::new(CORNER_HZ),
            way: DeadTime::new(dead_cycles, JointVector::zeros()),
            acting: None,
        }
    }

    /// The measurement with the speed that a robot's positions give.
    fn measured(&mut self, measurement: &Measurement<f64>) -> Measurement<f64> {
        let JointState { q, dq } = (self.velocity).update(&measurement.q, measurement.interval_s);
        Measurement {
            q,
            dq,
            interval_s: measurement.interval_s,
        }
    }

    /// The torque \[Nm\] that acts from this cycle to the next.
    fn act(&mut self, step: &Step<f64>) -> JointVector<f64> {
        let torque = self.way.pass(&(step.torque - step.gravity)) + step.gravity;
        self.acting = Some(torque);
        torque
    }
}

/// A torque law inside the core's cycle.
pub(super) struct TorqueDriver<'a> {
    controller: &'a Controller<f64>,
    law: TorqueLaw,
    gains: LawGains,
    state: State<f64>,
    link: Option<LinkConditions>,
    /// Those that are still to be begun, with their times \[s\]; the next one last.
    changes: Vec<(f64, Transition<f64>)>,
}

impl<'a> TorqueDriver<'a> {
    pub fn new(controller: &'a Controller<f64>, law: TorqueLaw, scenario: &Scenario) -> Self {
        Self {
            controller,
            law,
            gains: LawGains {
                rate: JointVector::repeat(scenario.null_space.rate_gain),
                stiffness: controller.compliance().stiffness,
            },
            state: State::new(),
            link: None,
            changes: Vec::new(),
        }
    }

    /// With changes of tasks and gains on the way.
    pub fn changing(self, mut changes: Vec<(f64, Transition<f64>)>) -> Self {
        changes.reverse();
        Self { changes, ..self }
    }

    fn begin_due(&mut self, t_s: f64) -> Result<(), ChangeError> {
        while let Some((_, change)) = self.changes.pop_if(|(at_s, _)| *at_s <= t_s) {
            self.controller.begin(&mut self.state, &change)?;
        }
        Ok(())
    }

    /// Under the conditions of a link whose torques act `dead_cycles` later.
    pub fn like_over_link(self, dead_cycles: usize) -> Self {
        Self {
            link: Some(LinkConditions::new(dead_cycles)),
            ..self
        }
    }

    fn decide(&mut self, measurement: &Measurement<f64>, reference: &Reference<f64>) -> Decision {
        let (mut view, mut limits) = (PriorityView::default(), None);
        let (law, gains, state) = (self.law, &self.gains, &mut self.state);
        let mut measurement = *measurement;
        if let Some(link) = &mut self.link {
            measurement = link.measured(&measurement);
            if let Some(torque) = &link.acting {
                state.set_applied_torque(torque);
            }
        }
        let step = if self.controller.has_limits() {
            let step = self.controller.step(state, &measurement, reference);
            let data = state.data();
            view = PriorityView::within_limits(data);
            limits = Some(LimitSample {
                status: step.status,
                null_share: data.wish.null_share,
                null_power: data.projection.power,
            });
            step
        } else {
            self.controller
                .step_with(state, &measurement, reference, |_, _, data| {
                    let demand = law.decide(data, gains);
                    view = PriorityView::new(data, &demand);
                    data.demand = demand.demand(&data.dynamics);
                })
        };
        let torque = match &mut self.link {
            None => step.torque,
            Some(link) => link.act(&step),
        };
        Decision {
            fault: step.status.fault,
            mode: step.status.mode,
            driving: Driving {
                torque,
                impedance: Impedance::NONE,
            },
            torque,
            residual: step.residual,
            saturated: step.status.saturated.any(),
            rank: step.status.rank.any(),
            view,
            limits,
        }
    }
}

/// The velocity-level resolver above the position scheme of the robot: stiff springs to
/// the commanded position, gravity by the robot's own model.
pub(super) struct PositionDriver {
    resolver: Resolver<f64>,
    state: ResolverState<f64>,
    cycle_s: f64,
    /// Where the springs are at rest now \[rad\].
    reached: JointVector<f64>,
    /// The way of commands to the robot.
    way: DeadTime,
    model: RobotModel,
    torque_limit: JointVector<f64>,
}

impl PositionDriver {
    /// At the start of a scenario, commands act `dead_cycles` later.
    pub fn new(scenario: &Scenario, dead_cycles: usize) -> Result<Self, Invalid> {
        let (arm, start) = (scenario.arm().parameters, scenario.start());
        let config = ResolverConfig {
            tasks: scenario.controller_config(0)?.tasks,
            gain: RESOLVER_GAIN,
            cycle_s: scenario.cycle_s(),
        };
        let resolver = Resolver::new(&arm, &config)
            .map_err(|error| Invalid::line(error).within(&scenario.name))?;
        Ok(Self {
            resolver,
            state: ResolverState::new(start),
            cycle_s: scenario.cycle_s(),
            reached: start,
            way: DeadTime::new(dead_cycles, start),
            model: RobotModel::new(&arm),
            torque_limit: JointVector::from_fn(|i, _| arm.links[i].torque_limit),
        })
    }

    fn decide(
        &mut self,
        measurement: &Measurement<f64>,
        reference: &Reference<f64>,
        motors: &JointState<f64>,
    ) -> Decision {
        let step = self.resolver.step(&mut self.state, measurement, reference);
        let commanded = self.way.pass(&step.q);
        let (mass_matrix, torque) = self.model.at_rest(&measurement.q);
        let impedance = Impedance::moving(
            &JointVector::repeat(POSITION_STIFFNESS),
            &JointVector::repeat(1.0),
            &mass_matrix,
            [&self.reached, &commanded],
            self.cycle_s,
        );
        self.reached = commanded;
        let limited = Driving { torque, impedance }.limited(motors, &self.torque_limit);
        Decision {
            fault: step.status.fault,
            mode: step.status.mode,
            driving: limited.driving,
            torque: limited.torque,
            residual: JointVector::zeros(),
            saturated: limited.saturated || step.status.saturated.any(),
            rank: step.status.rank.any(),
            view: PriorityView::default(),
            limits: None,
        }
    }
}
