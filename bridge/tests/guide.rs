//! Transitions of the reference: what it says of velocity is how it moves, and silence or
//! a level that holds makes no jump.

use arms::LWR_IV_FLANGE;
use bridge::guide::{Guide, GuideMode, GuideTimes};
use controller_core::joint::Vector3;
use controller_core::task::orientation::{self, Quaternion};
use controller_core::task::trajectory::{Plane, Rotation, Trajectory};
use controller_core::{Axes, Link, Reference, Target, Task, TaskGains, TaskSet};

const CYCLE_S: f64 = 1e-3;

fn tasks() -> TaskSet {
    let gains = TaskGains::uniform(400.0, 40.0);
    TaskSet::new(&[
        Task::position(LWR_IV_FLANGE, Axes::XYZ, gains),
        Task::orientation(Link::L7, Axes::XYZ, gains),
    ])
    .expect("tasks that can be")
}

fn start() -> Quaternion<f64> {
    orientation::about_axis(&Vector3::from([0.6, 0.0, 0.8]), 0.7)
}

/// A circle of 5 cm, and a swing of 0.05 rad.
fn motion(t_s: f64) -> Reference<f64> {
    let circle = Trajectory::Turn {
        plane: Plane::Yz,
        radius_m: 0.05,
        period_s: 2.0,
        growth_s: 1.0,
    };
    let swing = Rotation::Swing {
        axis: Vector3::from([0.0, 0.6, 0.8]),
        amplitude_rad: 0.05,
        period_s: 2.0,
        growth_s: 1.0,
    };
    let origin = Vector3::from([-0.5, 0.0, 0.4]);
    let targets = [circle.sample(&origin, t_s), swing.sample(&start(), t_s)];
    Reference::new(targets, [t_s * 0.1; 7])
}

/// Position \[m\], or rotation vector from the start \[rad\], and its velocity as the
/// target says it.
fn place(target: &Target<f64>) -> (Vector3<f64>, Vector3<f64>) {
    match target {
        Target::Hold => panic!("a place"),
        Target::Position { x, dx, .. } => (*x, *dx),
        Target::Orientation { q, w, .. } => (
            orientation::rotation_vector(&orientation::chord(q, &start())),
            *w,
        ),
    }
}

/// Runs the circle and the swing for 6 s from rest on; `change` says what is wanted.
fn run(mut change: impl FnMut(f64, &mut Reference<f64>) -> bool) -> Vec<Reference<f64>> {
    let mut guide = Guide::new(GuideTimes::default(), &tasks());
    guide.rest(&motion(0.0));
    guide.follow();
    (0..6000)
        .map(|cycle| {
            let t_s = f64::from(cycle) * CYCLE_S;
            let mut wanted = motion(t_s);
            let speaks = change(t_s, &mut wanted);
            guide.advance(speaks.then_some(&wanted), CYCLE_S).clone()
        })
        .collect()
}

/// From cycle to cycle a level moves by the mean of its velocities. The rest of that is
/// third order: 1e-9 s3 times a jerk of up to 60 x 0.1 m / (0.2 s)^3, 1e-6 m at most. An
/// orientation is joined along the chord, which ends short of the angle by its cube over
/// 24: 4e-5 rad of 0.1 rad.
fn assert_smooth(run: &[Reference<f64>]) {
    for (cycle, pair) in run.windows(2).enumerate() {
        let [before, after] = pair else { continue };
        let pairs = before.targets().iter().zip(after.targets());
        for (level, (before, after)) in pairs.enumerate() {
            let ((x, dx), (y, dy)) = (place(before), place(after));
            let jump: Vector3<f64> = y - x - (dx + dy) * (0.5 * CYCLE_S);
            assert!(jump.amax() < 5e-5, "level {level}, cycle {cycle}: {jump}");
        }
        assert!((after.posture - before.posture).amax() < 1e-3, "{cycle}");
    }
}

#[test]
fn what_is_followed_comes_out_bit_for_bit() {
    let run = run(|_, _| true);
    for (cycle, reference) in (0..).zip(&run) {
        assert_eq!(*reference, motion(f64::from(cycle) * CYCLE_S));
    }
}

#[test]
fn silence_brakes_and_the_motion_is_joined_again() {
    let run = run(|t_s, _| !(2.0..3.0).contains(&t_s));
    assert_smooth(&run);
    for target in run[2300].targets() {
        assert_eq!(place(target).1, Vector3::zeros());
    }
    assert_eq!(run[2300], run[2900], "rests");
    assert_eq!(run[2900].posture, run[1999].posture, "stays");
    assert_eq!(run[3600], motion(3.6), "follows again");
}

/// A far orientation is reached without a jump: no cycle turns further than the blend's
/// largest rate, 1.875 times the mean, and the last one ends where it is wanted.
#[test]
fn a_far_orientation_is_joined_without_a_jump() {
    let times = GuideTimes::default();
    for angle in [0.3, 1.0, 2.0, 3.0] {
        let mut guide = Guide::new(times, &tasks());
        let position = Target::position([-0.5, 0.0, 0.4]);
        let at = |q: Quaternion<f64>| Reference::new([position, Target::orientation(q)], [0.0; 7]);
        let turn = orientation::about_axis(&Vector3::from([0.0, 0.6, 0.8]), angle);
        let wanted = at(orientation::product(&turn, &start()));
        guide.rest(&at(start()));
        let mut last = place(&at(start()).targets()[1]).0;
        let fastest = 1.875 * angle * CYCLE_S / times.join_s;
        for _ in 0..1000 {
            let now = place(&guide.advance(Some(&wanted), CYCLE_S).targets()[1]).0;
            assert!((now - last).norm() < 1.001 * fastest, "{angle}");
            last = now;
        }
        // Rounding of an arc sine near half a turn.
        assert!((last.norm() - angle).abs() < 1e-7, "{angle}");
    }
}

/// One level holds while the other goes on as if nothing were, and joins again.
#[test]
fn a_level_that_holds_brakes_alone() {
    let all = run(|_, _| true);
    let silent = run(|t_s, _| !(2.0..3.0).contains(&t_s));
    for level in 0..2 {
        let run = run(|t_s, wanted| {
            if (2.0..3.0).contains(&t_s) {
                wanted.targets_mut()[level] = Target::Hold;
            }
            true
        });
        assert_smooth(&run);
        for (cycle, reference) in run.iter().enumerate() {
            let (holds, moves) = (level, 1 - level);
            let [own, silent] = [reference, &silent[cycle]].map(|r| r.targets()[holds]);
            assert_eq!(own, silent, "as in silence, cycle {cycle}");
            assert_eq!(reference.targets()[moves], all[cycle].targets()[moves]);
            assert_eq!(reference.posture, all[cycle].posture);
        }
    }
}

#[test]
fn what_cannot_be_meant_is_passed_on_and_forgotten() {
    let mut guide = Guide::new(GuideTimes::default(), &tasks());
    guide.rest(&motion(0.0));
    let [circle, swing] = *motion(2.0).targets() else {
        panic!("two levels");
    };
    let twice = Target::orientation(start() * 2.1);
    for targets in [
        [circle, circle].as_slice(),
        &[swing, swing],
        &[swing, circle],
        &[circle],
        &[circle, swing, Target::Hold],
        &[circle, twice],
    ] {
        let wrong = Reference::from_targets(targets, [0.0; 7]).expect("few targets");
        assert_eq!(*guide.advance(Some(&wrong), CYCLE_S), wrong);
        assert_eq!(*guide.reference(), motion(0.0));
        assert_eq!(guide.mode(), GuideMode::Holding);
    }
    assert_eq!(*guide.advance(None, CYCLE_S), motion(0.0));
}
