//! Mounted on a ceiling or a wall the arm does in its own frame what it does on the floor.

use cell::names::PlantKind;
use hil_sim::summary::Verdict;

use super::{experiment, run, two_level};

/// Roll, pitch, yaw of a ceiling, and of walls to which gravity is along x and along y.
const MOUNTS: [[f64; 3]; 3] = [[180.0, 0.0, 0.0], [0.0, 90.0, 0.0], [90.0, 0.0, 0.0]];

/// rms, largest error and largest plateau of the flange \[mm\], the worst over `seeds`.
fn figures(more: &str, plant: PlantKind, seeds: u64) -> [f64; 3] {
    let mut experiment = experiment(&two_level(more), plant);
    let mut worst = [0.0_f64; 3];
    for seed in 1..=seeds {
        experiment.seed = seed;
        let summary = run(&experiment);
        assert_eq!(summary.verdict, Verdict::Pass, "{more} {seed}");
        let level = &summary.levels[0];
        let found = [level.rms(), level.max(), level.worst_plateau()];
        for (worst, found) in worst.iter_mut().zip(found) {
            *worst = worst.max(found.expect("samples"));
        }
    }
    worst
}

fn mount(rpy_deg: [f64; 3]) -> String {
    format!("[mount]\nrpy_deg = {rpy_deg:?}\n")
}

/// The ideal plant: M and C are those of the floor, g is known, so nothing differs but
/// what a torque that is held for a cycle leaves of g. The realistic one: its wrong masses
/// weigh on other joints than on the floor, so the figures of a seed differ and those of
/// ten seeds, as in the README, do not.
#[test]
fn ceiling_and_walls_have_the_figures_of_the_floor() {
    for (plant, seeds) in [(PlantKind::Ideal, 1), (PlantKind::Realistic, 10)] {
        let floor = figures("", plant, seeds);
        for rpy in MOUNTS {
            let mounted = figures(&mount(rpy), plant, seeds);
            for (mounted, floor) in mounted.iter().zip(&floor) {
                let ratio = mounted / floor;
                assert!((0.9..1.1).contains(&ratio), "{rpy:?} {plant:?}: {ratio}");
            }
        }
    }
}

/// The figures do tell a controller that does not know of the mount: the observer takes twice
/// the weight for an external torque, and the flange drops until it has.
#[test]
fn a_controller_that_believes_in_the_floor_is_seen_on_a_ceiling() {
    let floor = experiment(&two_level(""), PlantKind::Ideal);
    let ceiling = experiment(&two_level(&mount(MOUNTS[0])), PlantKind::Ideal);
    let wrong = floor.controller().expect("a controller");
    let summary = ceiling.run(&wrong, |_| Ok(()), |_| ());
    let summary = summary.expect("nothing is written");
    let worst = summary.levels[0].max().expect("samples");
    let [_, max, _] = figures("", PlantKind::Ideal, 1);
    assert!(worst > 5.0 * max, "{worst} mm, {max} mm");
}
