//! A run as data: an arm, where it starts, what its levels are to follow, what pushes it.

use cell::invalid::Invalid;
use cell::scenario::{EquippedArm, Push, Scenario};
use controller_core::gain::diagonal;
use controller_core::joint::{DOF, JointVector};
use controller_core::law::null_space::{NullDamping, NullSpace, Posture};
use controller_core::{Axes, ControllerConfig, LinkPoint, Target, Task, TaskGains, TaskSet};

/// The scenario whose gains all runs have.
const GAINS: &str = "two-level";

/// The arm that most runs are made for.
pub const LWR: &str = "lwr_iv";

/// Whether it is that arm.
#[must_use]
pub fn is_lwr(arm: &EquippedArm) -> bool {
    arm.parameters.name == LWR
}

/// Seed of masses and noise of the realistic plant, but where a run says otherwise.
pub const PLANT_SEED: u64 = 3;

/// A level of a run.
#[derive(Clone, Debug)]
pub struct CaseLevel {
    /// What it tracks, with its gains.
    pub task: Task,
    /// What it is called, such as "flange xyz".
    pub label: String,
}

/// One run.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its name.
    pub name: String,
    /// The arm, which may have other limits than its table.
    pub arm: EquippedArm,
    /// Where it starts, at rest \[rad\].
    pub start: JointVector<f64>,
    /// q_d \[rad\].
    pub posture: JointVector<f64>,
    /// Levels, highest priority first.
    pub levels: Vec<CaseLevel>,
    /// Cycle \[s\].
    pub cycle_s: f64,
    /// What the levels are to follow: one target of every level, cycle by cycle.
    pub targets: Vec<Target<f64>>,
    /// Whether targets jump and are followed all the same.
    pub jumps: bool,
    /// Factor on K_q.
    pub stiffness_factor: f64,
    /// Forces on points of the arm.
    pub pushes: Vec<Push>,
    /// When the references are back where the arm can follow \[s\].
    pub back_at_s: Option<f64>,
    /// When the first level's reference rests far out, from and to \[s\].
    pub hold_s: Option<[f64; 2]>,
    /// Seed of the realistic plant.
    pub plant_seed: u64,
}

impl Case {
    /// An arm that rests in `start` \[rad\], with levels that have no targets yet.
    #[must_use]
    pub fn at_rest(
        name: String,
        arm: &EquippedArm,
        start: JointVector<f64>,
        levels: Vec<CaseLevel>,
    ) -> Self {
        Self {
            name,
            arm: arm.clone(),
            start,
            posture: start,
            levels,
            cycle_s: 0.002,
            targets: Vec::new(),
            jumps: false,
            stiffness_factor: 1.0,
            pushes: Vec::new(),
            back_at_s: None,
            hold_s: None,
            plant_seed: PLANT_SEED,
        }
    }

    /// The same with the targets that `path` gives for the times of `duration_s` \[s\], one for
    /// every level.
    #[must_use]
    pub fn following(
        mut self,
        duration_s: f64,
        mut path: impl FnMut(f64) -> Vec<Target<f64>>,
    ) -> Self {
        let cycles = (duration_s / self.cycle_s).round() as usize;
        self.targets = (0..cycles)
            .flat_map(|cycle| path(cycle as f64 * self.cycle_s))
            .collect();
        self
    }

    /// Number of cycles.
    #[must_use]
    pub fn cycles(&self) -> usize {
        self.targets.len() / self.levels.len().max(1)
    }

    /// The targets of a cycle.
    #[must_use]
    pub fn targets(&self, cycle: usize) -> &[Target<f64>] {
        let levels = self.levels.len();
        &self.targets[cycle * levels..(cycle + 1) * levels]
    }

    /// The controller of this run: gains of the two-level experiment; an arm that has others of
    /// its own strength has K_q in proportion to its torques, and D = c M.
    ///
    /// # Errors
    /// Levels that the core does not take.
    pub fn config(&self) -> Result<ControllerConfig, Invalid> {
        let scenario = Scenario::find(GAINS)?;
        let gains = scenario.controller_config(0)?;
        let tasks: Vec<_> = self.levels.iter().map(|level| level.task).collect();
        let tasks =
            TaskSet::new(&tasks).map_err(|error| Invalid::line(error).within(&self.name))?;
        let null_space = match is_lwr(&self.arm) {
            true => gains.null_space,
            false => proportional(&gains.null_space, &self.arm, &scenario.arm()),
        };
        Ok(ControllerConfig {
            tasks,
            null_space: null_space.stiffened(self.stiffness_factor),
            cycle_s: self.cycle_s,
            ..gains
        })
    }
}

/// c of D = c M \[1/s\] of arms that have no damping of their own.
const DAMPING_RATE: f64 = 10.0;

/// K_q in proportion to the torques of the arm.
fn proportional(null_space: &NullSpace, arm: &EquippedArm, of: &EquippedArm) -> NullSpace {
    let stiffness = core::array::from_fn::<_, DOF, _>(|i| {
        let [own, others] = [arm, of].map(|arm| arm.parameters.links[i].torque_limit);
        let share = own / others;
        null_space.stiffness[i][i] * share
    });
    NullSpace {
        stiffness: diagonal(stiffness),
        damping: NullDamping::Inertia(DAMPING_RATE),
        posture: Posture::Constant,
    }
}

/// The gains of every level.
///
/// # Errors
/// None, as the scenario is a built-in one.
pub fn gains() -> Result<TaskGains, Invalid> {
    let scenario = Scenario::find(GAINS)?;
    Ok(scenario.levels[0].task(0, &scenario.arm()).gains)
}

/// A named point of an arm.
///
/// # Errors
/// The names that it has.
pub fn point(arm: &EquippedArm, name: &str) -> Result<LinkPoint, Invalid> {
    arm.point(name)
        .ok_or_else(|| Invalid::name("point", name, &arm.point_names()).within(arm.parameters.name))
}

impl CaseLevel {
    /// The position of a named point along `axes`.
    ///
    /// # Errors
    /// A name that the arm does not have.
    pub fn position(arm: &EquippedArm, name: &str, axes: Axes) -> Result<Self, Invalid> {
        let label = format!("{name} {}", letters(axes));
        Ok(Self {
            task: Task::position(point(arm, name)?, axes, gains()?),
            label,
        })
    }

    /// The orientation of the flange.
    ///
    /// # Errors
    /// See [`gains`].
    pub fn orientation(arm: &EquippedArm) -> Result<Self, Invalid> {
        let frame = arm.parameters.flange_frame();
        Ok(Self {
            task: Task::orientation(frame, Axes::XYZ, gains()?),
            label: "flange about xyz".into(),
        })
    }
}

fn letters(axes: Axes) -> String {
    let letters = ['x', 'y', 'z'].into_iter().enumerate();
    letters
        .filter(|(axis, _)| axes.contains(*axis))
        .map(|(_, letter)| letter)
        .collect()
}

/// Runs that are given by postures of the LWR are for it alone.
///
/// # Errors
/// Another arm.
pub fn only_lwr(arm: &EquippedArm, set: &str) -> Result<(), Invalid> {
    if is_lwr(arm) {
        return Ok(());
    }
    let allowed = format!("{LWR} with the set {set}");
    Err(Invalid::new("--arm", arm.parameters.name, allowed))
}
