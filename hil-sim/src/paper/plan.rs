//! Which runs the paper's experiments need.

use crate::controllers::ControllerKind::{self, VelocityLevel};
use crate::controllers::TorqueLaw::{
    self, AccelerationLevel, AccelerationLevelEstimate, AsPrinted, Hierarchical, Literal,
    NoObserver,
};
use crate::experiment::Experiment;
use crate::plant::PlantOptions;
use cell::invalid::Invalid;
use cell::names::PlantKind::{self, Ideal, Realistic};
use cell::names::{MeasurementKind, Named, NullStiffness};
use cell::scenario::{LawSpec, PostureSpec, ReferenceSpec, Scenario};

/// Seeds over which figures of the realistic plant are the worst.
pub const SEEDS: std::ops::RangeInclusive<u64> = 1..=5;

/// Circle periods at which the missing coupling of (34) is shown \[s\].
pub const PERIODS_S: [f64; 3] = [5.0, 3.0, 1.5];

/// A run with its name.
#[derive(Clone, Debug)]
pub struct Planned {
    /// Name, also of its folder.
    pub id: String,
    /// What is done.
    pub experiment: Experiment,
}

/// Which runs belong together but for the seed.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// Scenario.
    pub scenario: &'static str,
    /// Plant.
    pub plant: PlantKind,
    /// With contacts or without.
    pub contacts: bool,
    /// Law.
    pub controller: ControllerKind,
    /// Null-space stiffness.
    pub stiffness: NullStiffness,
}

impl Family {
    /// Contacts on, scenario's stiffness.
    #[must_use]
    pub fn pushed(
        scenario: &'static str,
        plant: PlantKind,
        controller: impl Into<ControllerKind>,
    ) -> Self {
        Self {
            scenario,
            plant,
            contacts: true,
            controller: controller.into(),
            stiffness: NullStiffness::Normal,
        }
    }

    /// The same without contacts.
    #[must_use]
    pub const fn free(self) -> Self {
        Self {
            contacts: false,
            ..self
        }
    }

    /// The same with another stiffness.
    #[must_use]
    pub const fn stiff(self, stiffness: NullStiffness) -> Self {
        Self { stiffness, ..self }
    }

    /// Name of its run with this seed.
    #[must_use]
    pub fn id(&self, seed: u64) -> String {
        let contacts = if self.contacts { "pushed" } else { "free" };
        let stiffness = match self.stiffness {
            NullStiffness::Normal => String::new(),
            other => format!("-{}", other.name()),
        };
        format!(
            "{}-{}-{contacts}-{}{stiffness}-seed{seed}",
            self.scenario,
            self.plant.name(),
            self.controller.name()
        )
    }

    /// The seeds that its runs differ by: an ideal plant knows none.
    #[must_use]
    pub fn seeds(&self) -> std::ops::RangeInclusive<u64> {
        if self.plant == Ideal { 1..=1 } else { SEEDS }
    }

    fn planned(&self, seed: u64) -> Result<Planned, Invalid> {
        Ok(Planned {
            id: self.id(seed),
            experiment: Experiment {
                // Of the paper: it knows no limits.
                scenario: Scenario {
                    law: LawSpec::Exact,
                    ..Scenario::find(self.scenario)?
                },
                plant: self.plant,
                contacts: self.contacts,
                controller: self.controller,
                measurement: MeasurementKind::Direct,
                null_stiffness: self.stiffness,
                seed,
                options: PlantOptions::default(),
            },
        })
    }
}

/// Name of a run of the first case, ideal and free, at another circle period.
#[must_use]
pub fn period_id(controller: TorqueLaw, period_s: f64) -> String {
    format!("case-1-period-{period_s}s-{}", controller.name())
}

/// Name of the run whose posture is the integral (51).
pub const DRIFT: &str = "two-level-integral-posture";

/// All runs.
///
/// # Errors
/// None for the built-in scenarios.
pub fn all() -> Result<Vec<Planned>, Invalid> {
    let mut families = vec![
        Family::pushed("two-level", Ideal, Hierarchical).free(),
        Family::pushed("two-level", Ideal, Hierarchical),
        Family::pushed("two-level", Ideal, NoObserver),
        Family::pushed("two-level", Ideal, AsPrinted),
        Family::pushed("two-level", Ideal, VelocityLevel),
        Family::pushed("two-level", Realistic, Hierarchical).free(),
        Family::pushed("two-level", Realistic, AccelerationLevel).free(),
        Family::pushed("two-level", Realistic, NoObserver),
        Family::pushed("case-1", Ideal, Hierarchical).free(),
        Family::pushed("case-1", Ideal, Hierarchical),
        Family::pushed("case-2", Ideal, Hierarchical),
    ];
    for scenario in ["two-level", "case-1", "case-2"] {
        for controller in [Hierarchical, AccelerationLevel, AccelerationLevelEstimate] {
            families.push(Family::pushed(scenario, Realistic, controller));
        }
        families.push(Family::pushed(scenario, Realistic, VelocityLevel));
        families.push(Family::pushed(scenario, Ideal, VelocityLevel).free());
    }
    for stiffness in [
        NullStiffness::Low,
        NullStiffness::Normal,
        NullStiffness::High,
    ] {
        families.push(Family::pushed("hand", Realistic, Hierarchical).stiff(stiffness));
    }
    let mut runs = Vec::new();
    for family in families {
        for seed in family.seeds() {
            runs.push(family.planned(seed)?);
        }
    }
    for controller in [Hierarchical, Literal] {
        for period_s in PERIODS_S {
            let mut run = Family::pushed("case-1", Ideal, controller)
                .free()
                .planned(1)?;
            run.id = period_id(controller, period_s);
            if let ReferenceSpec::Circle(turn) = &mut run.experiment.scenario.levels[0].reference {
                turn.period_s = period_s;
            }
            runs.push(run);
        }
    }
    let mut drift = Family::pushed("two-level", Ideal, Hierarchical)
        .free()
        .planned(1)?;
    drift.id = DRIFT.to_string();
    drift.experiment.scenario.null_space.posture = PostureSpec::IntegralCoupled;
    runs.push(drift);
    Ok(runs)
}
