//! The fastest mode that the sampling bound knows, against a search of another kind: random
//! postures, then random steps uphill from the worst of them.

use std::f64::consts::{PI, TAU};

use arms::ALL;
use controller_core::arm::{ArmModel, ArmParameters, Pose, Tool};
use controller_core::joint::{DOF, JointMatrix};
use controller_core::law::sampling::{DampingRate, fastest_mode, mode_at};
use hil_sim::plant::noise::Rng;
use stratum_tests::config::REFERENCE_DAMPING;

/// What another search may find above the bound: mass matrices of real arms are known to some
/// 1 %, so a finer bound would promise what the tables cannot hold.
const EXCESS: f64 = 0.01;

const LOAD: Tool = Tool {
    pose: Pose::at([0.0, 0.0, 0.05]),
    mass: 2.0,
    com: [0.02, 0.01, 0.06],
    inertia: [0.004, 0.0, 0.0, 0.005, 0.0, 0.003],
};

struct Search {
    model: ArmModel<f64>,
    ranges: [[f64; 2]; DOF],
    rng: Rng,
}

impl Search {
    fn new(arm: &ArmParameters) -> Self {
        let ranges = arm.links.each_ref().map(|link| {
            let [min, max] = link.position_range;
            if max - min > TAU {
                [-PI, PI]
            } else {
                [min, max]
            }
        });
        Self {
            model: ArmModel::new(arm).expect("a table of the crate"),
            ranges,
            rng: Rng::new(5, 1),
        }
    }

    /// Uniform in the ranges.
    fn anywhere(&mut self) -> [f64; DOF] {
        self.ranges
            .map(|[min, max]| min + (max - min) * self.rng.uniform())
    }

    /// A step of at most `size` times the ranges, in all joints or in some.
    fn beside(&mut self, posture: &[f64; DOF], size: f64) -> [f64; DOF] {
        let share = if self.rng.uniform() < 0.5 { 1.0 } else { 0.3 };
        std::array::from_fn(|i| {
            let [min, max] = self.ranges[i];
            let step = size * (max - min) * (2.0 * self.rng.uniform() - 1.0);
            if self.rng.uniform() < share {
                (posture[i] + step).clamp(min, max)
            } else {
                posture[i]
            }
        })
    }

    /// 600 steps; longer after each that gains, shorter after the others.
    fn climbed(&mut self, damping: &JointMatrix<f64>, start: DampingRate) -> DampingRate {
        let (mut best, mut size) = (start, 0.1f64);
        for _ in 0..600 {
            let posture = self.beside(&best.posture, size);
            let mode = mode_at(&self.model, damping, posture);
            if mode.rate > best.rate {
                best = mode;
                size *= 1.3;
            } else {
                size = (0.97 * size).max(1e-4);
            }
        }
        best
    }

    /// The fastest of `count` random postures, after a climb from the `climbs` worst.
    fn fastest(&mut self, damping: &JointMatrix<f64>, count: usize, climbs: usize) -> f64 {
        let mut seen: Vec<_> = (0..count)
            .map(|_| {
                let posture = self.anywhere();
                mode_at(&self.model, damping, posture)
            })
            .collect();
        seen.sort_by(|one, other| other.rate.total_cmp(&one.rate));
        let worst = seen.into_iter().take(climbs);
        worst
            .map(|start| self.climbed(damping, start).rate)
            .fold(0.0, f64::max)
    }

    /// Reference, equal, each joint alone, and `random` ones over three decades.
    fn dampings(&mut self, random: usize) -> Vec<[f64; DOF]> {
        let mut dampings = vec![REFERENCE_DAMPING, [1.0; DOF]];
        dampings.extend(std::array::from_fn::<_, DOF, _>(|joint| {
            let mut only = [1e-9; DOF];
            only[joint] = 1.0;
            only
        }));
        let mut decades = || 10f64.powf(-3.0 * self.rng.uniform());
        dampings.extend((0..random).map(|_| std::array::from_fn(|_| decades())));
        dampings
    }
}

/// Largest excess over the bound, shown per arm.
fn excess(arm: &ArmParameters, random: usize, count: usize, climbs: usize) -> f64 {
    let mut search = Search::new(arm);
    let mut worst = f64::NEG_INFINITY;
    for damping in search.dampings(random) {
        let damping = JointMatrix::from_diagonal(&damping.into());
        let bound = fastest_mode(&search.model, &damping).rate;
        worst = worst.max(search.fastest(&damping, count, climbs) / bound - 1.0);
    }
    println!("{}: {:+.3} %", arm.name, 100.0 * worst);
    worst
}

#[test]
fn no_posture_is_worse_than_the_bound_says() {
    for arm in ALL {
        assert!(excess(arm, 3, 1_000, 10) <= EXCESS, "{}", arm.name);
    }
}

/// Rotors weigh on the diagonal of M only, a load on all of it.
#[test]
fn no_posture_is_worse_with_rotors_and_a_load() {
    let mut geared = arms::FR3;
    for (link, rotor) in geared
        .links
        .iter_mut()
        .zip([0.5, 0.5, 0.3, 0.3, 0.1, 0.1, 0.05])
    {
        link.rotor_inertia = rotor;
    }
    let [openarm, loaded] = [arms::OPENARM_V20_LEFT, geared.with_tool(&LOAD)];
    for arm in [openarm.with_tool(&LOAD), geared, loaded] {
        assert!(excess(&arm, 1, 1_000, 10) <= EXCESS, "{}", arm.name);
    }
}

#[test]
#[ignore = "minutes"]
fn no_posture_of_many_is_worse_than_the_bound_says() {
    for arm in ALL {
        for arm in [*arm, arm.with_tool(&LOAD)] {
            assert!(excess(&arm, 8, 20_000, 50) <= EXCESS, "{}", arm.name);
        }
    }
}

/// The postures of a table are those of a bare arm.
#[test]
fn a_load_is_searched_for_itself() {
    for arm in ALL {
        assert!(arm.with_tool(&LOAD).damping_postures.is_empty());
    }
}
