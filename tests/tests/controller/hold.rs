//! A level that holds: where it was in the first cycle of holding, whatever pushes it.

use arms::LWR_IV;
use controller_core::fault::LimitKind;
use controller_core::joint::{JointState, JointVector, Matrix3, Vector3};
use controller_core::ranges::HOLD_S;
use controller_core::task::orientation::{Quaternion, about_axis, product, turned as turned_by};
use controller_core::task::trajectory::Rotation;
use controller_core::{Axes, Controller, ControllerConfig, Link, Reference, State, Target, Task};
use hil_sim::plant::{Plant, PlantModel};
use stratum_tests::config::{FLANGE, REFERENCE_GAINS, with_tasks};
use stratum_tests::oracle::closed_loop::{ClosedLoop, Seen, circle, no_contact, true_point};

use super::{at, start};

/// Position and orientation of the flange.
fn both() -> ControllerConfig {
    with_tasks(&[
        Task::position(FLANGE, Axes::XYZ, REFERENCE_GAINS),
        Task::orientation(Link::L7.frame(), Axes::XYZ, REFERENCE_GAINS),
    ])
}

/// Where the plant's flange is.
#[derive(Clone, Copy)]
struct Pose {
    x: Vector3<f64>,
    rotation: Matrix3<f64>,
}

impl Pose {
    fn of(plant: &Plant) -> Self {
        let at = |offset: [f64; 3]| plant.model().point(plant.state(), 7, &offset.into()).0;
        let axis =
            |i: usize| at(std::array::from_fn(|j| f64::from(u8::from(i == j)))) - at([0.0; 3]);
        Self {
            x: true_point(plant, FLANGE),
            rotation: Matrix3::from_columns(&[0, 1, 2].map(axis)),
        }
    }

    /// That of a position and an orientation as targets.
    fn wanted(targets: &[Target<f64>; 2]) -> Self {
        let [Target::Position { x, .. }, Target::Orientation { q, .. }] = targets else {
            panic!("a pose");
        };
        let [w, a, b, c] = (*q).into();
        let unit = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, a, b, c));
        Self {
            x: *x,
            rotation: unit.to_rotation_matrix().into_inner(),
        }
    }

    /// Distance \[m\] and angle \[rad\]: |R - R'| is 2 sqrt(2) sin(theta / 2).
    fn from(&self, other: &Self) -> [f64; 2] {
        let chord = (self.rotation - other.rotation).norm() / 8.0_f64.sqrt();
        [(self.x - other.x).norm(), 2.0 * libm::asin(chord.min(1.0))]
    }
}

/// Sees that there was neither fault nor limit, but for what a level does to hold or to
/// leave where it held.
fn clear(seen: Seen<f64>) -> Seen<f64> {
    let joining = |limit| limit == LimitKind::Joining;
    let joining = seen.step.status.limits().all(joining);
    assert!(
        seen.step.status.fault.is_none() && joining,
        "{:?}",
        seen.step.status
    );
    seen
}

const PUSH: [f64; 7] = [20.0, -25.0, 10.0, 12.0, -2.0, 1.5, 0.1];

fn pushed(_: f64, _: &PlantModel, _: &JointState<f64>) -> JointVector<f64> {
    PUSH.into()
}

/// For a second all joints are pushed, harder than friction would be; the flange
/// gives way by a centimetre and a quarter of a radian while the estimate rises. Once
/// the push has gone it is back in position and orientation, and the arm at rest.
#[test]
fn a_pushed_arm_comes_back_to_where_it_began_to_hold() {
    let mut closed = ClosedLoop::<f64>::new(&both(), start(), &[]);
    let hold = Reference::hold(2, start());
    let place = Pose::of(&closed.plant);
    let mut run = |cycles: u32, push: bool| {
        let mut largest = [0.0f64; 2];
        for _ in 0..cycles {
            let external = if push { pushed } else { no_contact };
            clear(closed.step_towards(&hold, external));
            let away = Pose::of(&closed.plant).from(&place);
            largest = [largest[0].max(away[0]), largest[1].max(away[1])];
        }
        println!("pushed {push}: up to {largest:?}");
        (largest, Pose::of(&closed.plant).from(&place))
    };
    let (still, _) = run(50, false);
    let (away, _) = run(500, true);
    let (_, last) = run(2000, false);
    assert!(still[0] < 1e-9 && still[1] < 1e-9, "{still:?}");
    assert!(away[0] > 5e-3 && away[1] > 0.1, "{away:?}");
    // The task error decays at 20 /s, to 1e-30 in 4 s; what is left is rounding of a
    // position of 1 m, and of the torques that hold it.
    assert!(last[0] < 1e-9 && last[1] < 1e-9, "{last:?}");
    // The null space decays with K_q / D, 5 /s for the slowest joints.
    let JointState { q, dq } = closed.plant.state();
    assert!((q - start()).amax() < 1e-6 && dq.amax() < 1e-6, "{q} {dq}");
}

/// From the middle of a motion of both levels: each rests where it was in the first
/// cycle of holding, neither where its reference was nor where it comes to a halt.
#[test]
fn a_moving_arm_that_holds_rests_where_it_was() {
    let mut closed = ClosedLoop::<f64>::new(&both(), start(), &[circle(0.1, 2.0)]);
    let swing = Rotation::Swing {
        axis: Vector3::from([0.6, 0.0, 0.8]),
        amplitude_rad: 0.3,
        period_s: 3.0,
        growth_s: 1.0,
    };
    let Target::Orientation { q: origin, .. } = closed.reference().targets()[1] else {
        panic!("an orientation level");
    };
    let moving = |closed: &ClosedLoop<f64>, cycle: u32| {
        let mut reference = closed.reference();
        reference.targets_mut()[1] = swing.sample(&origin, f64::from(cycle) * 0.002);
        reference
    };
    let hold = Reference::hold(2, start());
    // Both hold, move on, hold elsewhere: the first place is forgotten.
    for (moves, cycles) in [(0, 700), (700, 1150)] {
        let mut last = hold.clone();
        for cycle in moves..cycles {
            last = moving(&closed, cycle);
            clear(closed.step_towards(&last, no_contact));
        }
        let speed = closed.plant.state().dq.amax();
        assert!(speed > 0.1, "{speed}");
        // The motion goes on meanwhile; nobody follows it.
        let mut pausing = closed.clone();
        for _ in 0..1500 {
            clear(pausing.step_towards(&hold, no_contact));
        }
        // The way of a velocity and an acceleration that fall to zero in the time.
        let t = HOLD_S;
        let way = |v: &Vector3<f64>, a: &Vector3<f64>| v * (t / 2.0) + a * (t * t / 12.0);
        let [
            Target::Position { x, dx, ddx },
            Target::Orientation { q, w, dw },
        ] = last.targets()
        else {
            panic!("a pose");
        };
        let h = 0.002;
        let rest = [
            Target::position(x + dx * h + ddx * (h * h / 2.0) + way(&(dx + ddx * h), ddx)),
            Target::orientation(turned_by(
                &turned_by(q, &(w * h + dw * (h * h / 2.0))),
                &way(&(w + dw * h), dw),
            )),
        ];
        let wanted = Pose::wanted(&rest);
        let away = Pose::of(&pausing.plant).from(&wanted);
        println!("in the end {away:?}");
        // As above, 3 s after.
        assert!(away[0] < 1e-9 && away[1] < 1e-9, "{away:?}");
        assert!(pausing.plant.state().dq.amax() < 1e-3, "at rest");
    }
}

/// A level holds for itself: the flange follows its circle, its orientation stays; and
/// a level below the moving one is released when it gets a target of its own.
#[test]
fn a_level_may_hold_alone_and_is_released_by_a_target() {
    let mut closed = ClosedLoop::<f64>::new(&both(), start(), &[circle(0.05, 3.0)]);
    let origin = closed.reference().targets()[1];
    let place = Pose::of(&closed.plant);
    let step = |closed: &mut ClosedLoop<f64>, second: Target<f64>| {
        let mut reference = closed.reference();
        reference.targets_mut()[1] = second;
        clear(closed.step_towards(&reference, no_contact))
    };
    let mut travel = 0.0f64;
    for _ in 0..1000 {
        let seen = step(&mut closed, Target::Hold);
        // What a moving target leaves with a hold of 2 ms, as for a circle alone.
        assert!(seen.errors[0] < 1e-4, "{}", seen.errors[0]);
        let [distance, angle] = Pose::of(&closed.plant).from(&place);
        assert!(angle < 1e-4, "{angle:e}");
        travel = travel.max(distance);
    }
    assert!(travel > 0.049, "{travel}");

    // Elsewhere by a target, then hold there.
    let Target::Orientation { q, .. } = origin else {
        panic!("an orientation level");
    };
    let turned: Quaternion<f64> = product(&about_axis(&Vector3::from([0.0, 0.6, 0.8]), 0.2), &q);
    for _ in 0..1000 {
        step(&mut closed, Target::orientation(turned));
    }
    for _ in 0..1000 {
        step(&mut closed, Target::Hold);
        let [_, angle] = Pose::of(&closed.plant).from(&place);
        assert!((angle - 0.2).abs() < 1e-4, "{angle}");
    }
}

/// After a reset a level holds where it is then; a gap changes nothing.
#[test]
fn a_reset_takes_the_place_anew_and_a_gap_does_not() {
    let hold = Reference::hold(2, start());
    let offset = JointVector::from([0.02, -0.03, 0.01, 0.02, 0.03, -0.02, 0.04]);
    for reset in [false, true] {
        let mut closed = ClosedLoop::<f64>::new(&both(), start(), &[]);
        clear(closed.step_towards(&hold, no_contact));
        let first = Pose::of(&closed.plant);
        // Somebody moves the arm while nobody steps.
        let mut closed = closed.from(start() + offset);
        let second = Pose::of(&closed.plant);
        assert!(second.from(&first).iter().all(|away| *away > 5e-3));
        if reset {
            closed.state.reset();
        } else {
            closed.state.resume_after_gap();
        }
        for cycle in 0..1500 {
            let seen = closed.step_towards(&hold, no_contact);
            // From the torque of before the gap the new one is reached in two cycles.
            if cycle < 2 {
                assert!(seen.step.status.fault.is_none());
            } else {
                clear(seen);
            }
        }
        let place = if reset { second } else { first };
        let away = Pose::of(&closed.plant).from(&place);
        // Three seconds at 20 /s; rounding is left.
        assert!(away[0] < 1e-9 && away[1] < 1e-9, "{reset}: {away:?}");
    }
}

/// A place held under another controller, where the level was of another kind, is not
/// taken for one of this kind: the level holds where it is.
#[test]
fn a_place_of_another_kind_is_taken_anew() {
    let position = Task::position(FLANGE, Axes::XYZ, REFERENCE_GAINS);
    let orientation = Task::orientation(Link::L7.frame(), Axes::XYZ, REFERENCE_GAINS);
    let [first, second] = [position, orientation].map(|task| {
        let config = with_tasks(&[task]);
        Controller::<f64>::new(&LWR_IV, &config).expect("a valid configuration")
    });
    let reference = Reference::hold(1, start());
    let mut used = State::new();
    let _ = first.step(&mut used, &at(start()), &reference);
    let _ = second.step(&mut used, &at(start()), &reference);
    // At rest where it holds there is nothing to correct, but for rounding.
    let error = &used.data().rows.error;
    assert!(error.iter().all(|error| error.abs() < 1e-12), "{error:?}");
}
