//! What a reference may ask for, and what becomes of one that jumps.

use arms::LWR_IV;
use controller_core::fault::{Fault, LimitKind, Quantity};
use controller_core::joint::{JointVector, Vector3};
use controller_core::ranges::{
    HOLD_S, JOIN_S, JOIN_SPEED, JUMP, POSTURE_FACTOR, REACH_MARGIN_M, TARGET_ACCELERATION_MAX,
    TARGET_SPEED_MAX,
};
use controller_core::real::Real;
use controller_core::resolver::{Resolver, ResolverConfig, ResolverState};
use controller_core::task::orientation::{self, Quaternion};
use controller_core::task::trajectory::{Plane, Rotation, Trajectory};
use controller_core::{
    Axes, Controller, ControllerConfig, Link, Measurement, Reference, State, Step, Target, Task,
};
use stratum_tests::config::{FLANGE, REFERENCE_GAINS, two_level, with_tasks};
use stratum_tests::oracle::closed_loop::{ClosedLoop, no_contact};

const CYCLE_S: f64 = 0.002;

/// Bent, far from singular.
fn start() -> JointVector<f64> {
    JointVector::from([0.0, 0.61, 0.0, -1.40, 0.35, 1.05, 0.0])
}

/// Position and orientation of the flange.
fn pose() -> ControllerConfig {
    with_tasks(&[
        Task::position(FLANGE, Axes::XYZ, REFERENCE_GAINS),
        Task::orientation(Link::L7.frame(), Axes::XYZ, REFERENCE_GAINS),
    ])
}

fn controller<T: Real>(config: &ControllerConfig) -> Controller<T> {
    Controller::new(&LWR_IV, config).expect("a valid configuration")
}

fn at_rest<T: Real>(q: &JointVector<f64>) -> Measurement<T> {
    Measurement {
        q: q.map(T::from_f64),
        dq: JointVector::from([T::ZERO; 7]),
        interval_s: T::from_f64(CYCLE_S),
    }
}

/// The fault of a first cycle whose reference `change` has changed.
fn fault<T: Real>(change: impl FnOnce(&mut Reference<T>)) -> Option<Fault> {
    let controller = controller::<T>(&pose());
    let measurement = at_rest(&start());
    let mut reference = controller.rest_reference(&measurement.q);
    change(&mut reference);
    let step = controller.step(&mut State::new(), &measurement, &reference);
    assert!(step.torque.iter().all(|torque| torque.finite()));
    step.status.fault
}

/// Each bound from both sides, by a part in ten thousand; a direction that no axis has.
fn bounds<T: Real>() {
    let direction = Vector3::from([0.6, 0.0, -0.8]);
    // Shoulder at the foot of the table: 0.3105 m above the plate; 0.4 m upper arm, 0.39 m
    // forearm, 0.078 m to the flange.
    let shoulder = Vector3::from([0.0, 0.0, 0.3105]);
    let reach = 0.4 + 0.39 + 0.078 + REACH_MARGIN_M;
    type Change = fn(&mut [Vector3<f64>; 5], Vector3<f64>);
    let cases: [(Quantity, u8, f64, Change); 5] = [
        (Quantity::TargetDistance, 1, reach, |all, v| all[0] = v),
        (Quantity::TargetSpeed, 1, TARGET_SPEED_MAX[0], |all, v| {
            all[1] = v
        }),
        (
            Quantity::TargetAcceleration,
            1,
            TARGET_ACCELERATION_MAX[0],
            |all, v| all[2] = v,
        ),
        (
            Quantity::TargetAngularSpeed,
            2,
            TARGET_SPEED_MAX[1],
            |all, v| all[3] = v,
        ),
        (
            Quantity::TargetAngularAcceleration,
            2,
            TARGET_ACCELERATION_MAX[1],
            |all, v| all[4] = v,
        ),
    ];
    for (quantity, index, bound, change) in cases {
        for (factor, refused) in [(0.9999, false), (1.0001, true), (1e300, true)] {
            let fault = fault::<T>(|reference| {
                let mut all = [Vector3::zeros(); 5];
                all[0] = Vector3::from([0.3, 0.0, 0.2]);
                change(&mut all, direction * (bound * factor));
                all[0] += shoulder;
                let [x, dx, ddx, w, dw] = all.map(|v| v.map(T::from_f64));
                let [first, second] = reference.targets_mut() else {
                    panic!("two levels");
                };
                *first = Target::Position { x, dx, ddx };
                if let Target::Orientation { q, .. } = *second {
                    *second = Target::Orientation { q, w, dw };
                }
            });
            let Some(fault) = fault else {
                assert!(!refused, "{quantity:?} {factor}");
                continue;
            };
            assert!(refused, "{fault}");
            assert_eq!((fault.quantity, fault.index), (quantity, index));
            // Single precision rounds the bound.
            assert!(
                (fault.max / bound - 1.0).abs() < 1e-6 && fault.min == 0.0,
                "{fault}"
            );
            assert!(fault.value > bound, "{fault}");
        }
    }
    for joint in 0..7 {
        let bound = POSTURE_FACTOR * LWR_IV.links[joint].position_range[1];
        for (value, refused) in [
            (0.9999, false),
            (-0.9999, false),
            (1.0001, true),
            (-1e200, true),
        ] {
            let fault = fault::<T>(|reference| {
                reference.posture[joint] = T::from_f64(value * bound);
            });
            let named = fault.map(|fault| (fault.quantity, usize::from(fault.index)));
            assert_eq!(
                named,
                refused.then_some((Quantity::PostureReference, joint + 1))
            );
        }
    }
}

#[test]
fn each_bound_of_a_reference_is_held() {
    bounds::<f64>();
    bounds::<f32>();
}

/// A circle of 5 cm, and a swing of 0.3 rad.
fn motion(t_s: f64) -> Reference<f64> {
    let circle = Trajectory::Turn {
        plane: Plane::Yz,
        radius_m: 0.05,
        period_s: 2.0,
        growth_s: 1.0,
    };
    let swing = Rotation::Swing {
        axis: Vector3::from([0.0, 0.6, 0.8]),
        amplitude_rad: 0.3,
        period_s: 2.0,
        growth_s: 1.0,
    };
    let rest = controller::<f64>(&pose()).rest_reference(&start());
    let [Target::Position { x, .. }, Target::Orientation { q, .. }] = rest.targets() else {
        panic!("a pose");
    };
    let targets = [circle.sample(x, t_s), swing.sample(q, t_s)];
    Reference::new(targets, start())
}

/// What is followed while `wanted` says what to do at each time; the arm stands still.
fn followed(cycles: u32, mut wanted: impl FnMut(f64) -> Reference<f64>) -> Vec<Reference<f64>> {
    let controller = controller::<f64>(&pose());
    let mut state = State::new();
    let cycle = |cycle| {
        let reference = wanted(f64::from(cycle) * CYCLE_S);
        let step = controller.step(&mut state, &at_rest(&start()), &reference);
        assert_eq!(step.status.fault, None);
        controller.followed_reference(&state)
    };
    (0..cycles).map(cycle).collect()
}

/// Place from `origin` (position \[m\] or rotation vector \[rad\]), velocity, acceleration.
fn parts(target: &Target<f64>, origin: &Quaternion<f64>) -> [Vector3<f64>; 3] {
    match target {
        Target::Hold => panic!("a place"),
        Target::Position { x, dx, ddx } => [*x, *dx, *ddx],
        Target::Orientation { q, w, dw } => {
            let chord = orientation::chord(q, origin);
            [orientation::rotation_vector(&chord), *w, *dw]
        }
    }
}

/// From cycle to cycle a level moves by the mean of its velocities: what the trapezoidal
/// rule leaves is h^3 / 12 times a jerk of at most 60 x 0.1 / 0.3^3 + 36 x 0.2 / 0.3^2, 2e-7.
/// Its acceleration goes on by h times that jerk: (60 e / T^3 + 36 de / T^2 + 9 dde / T) h,
/// with e below T / 4 (in rad T / 2) and what a jump in the middle of another adds below 0.8
/// (1.7). Of an orientation the rates of what is joined hold for small angles or one axis: a
/// hundredth of its speed is left to that.
fn assert_smooth(run: &[Reference<f64>]) {
    for (cycle, pair) in run.windows(2).enumerate() {
        let [before, after] = pair else { continue };
        for (level, allowed, step) in [(0, 2e-7, 0.8), (1, 2e-5, 1.7)] {
            let origin = match before.targets()[level] {
                Target::Orientation { q, .. } => q,
                _ => orientation::identity(),
            };
            let [x, dx, ddx] = parts(&before.targets()[level], &origin);
            let [y, dy, ddy] = parts(&after.targets()[level], &origin);
            let jump: Vector3<f64> = y - x - (dx + dy) * (0.5 * CYCLE_S);
            assert!(
                jump.amax() < allowed,
                "level {level}, cycle {cycle}: {jump}"
            );
            let step_up = (ddy - ddx).amax();
            assert!(step_up < step, "level {level}, cycle {cycle}: {step_up}");
        }
        assert!((after.posture - before.posture).amax() < 2e-3, "{cycle}");
    }
}

#[test]
fn a_motion_without_a_jump_is_followed_bit_for_bit() {
    for (cycle, reference) in (0..).zip(&followed(2000, motion)) {
        assert_eq!(*reference, motion(f64::from(cycle) * CYCLE_S));
    }
}

/// A level that holds comes to rest in its time, stays, and joins again.
#[test]
fn a_hold_brakes_and_the_motion_is_joined_again() {
    let all = followed(2000, motion);
    for level in 0..2 {
        let run = followed(2000, |t_s| {
            let mut wanted = motion(t_s);
            if (2.0..3.0).contains(&t_s) {
                wanted.targets_mut()[level] = Target::Hold;
            }
            wanted
        });
        assert_smooth(&run);
        let own = |cycle: usize| &run[cycle].targets()[level];
        let rests = 1000 + (HOLD_S / CYCLE_S) as usize;
        let [_, speed, acceleration] = parts(own(rests), &orientation::identity());
        assert_eq!((speed, acceleration), (Vector3::zeros(), Vector3::zeros()));
        assert_eq!(own(rests), own(1499), "rests");
        for (cycle, (reference, all)) in run.iter().zip(&all).enumerate() {
            let other = 1 - level;
            assert_eq!(reference.targets()[other], all.targets()[other], "{cycle}");
        }
        assert_eq!(*run.last().expect("cycles"), motion(1999.0 * CYCLE_S));
    }
}

/// Jumps of every size, in the middle of the motion and of each other: what is followed
/// goes on smoothly, and ends where it is wanted after the stated time.
#[test]
fn jumps_are_joined_without_a_step() {
    let swung = |reference: &mut Reference<f64>, by: &Vector3<f64>, turn: &Vector3<f64>| {
        if let [Target::Position { x, .. }, Target::Orientation { q, .. }] = reference.targets_mut()
        {
            *x += by;
            *q = orientation::turned(q, turn);
        }
    };
    for far in [0.006, 0.02, 0.1] {
        let by = Vector3::from([0.6, 0.0, 0.8]) * far;
        let turn = Vector3::from([0.0, 0.6, 0.8]) * (10.0 * far);
        let run = followed(2000, |t_s| {
            let mut wanted = motion(t_s);
            if t_s >= 1.0 {
                swung(&mut wanted, &by, &turn);
            }
            if t_s >= 1.1 {
                swung(&mut wanted, &(-by * 1.5), &(-turn * 1.5));
            }
            if t_s >= 1.2 {
                wanted.posture[3] += 0.2;
            }
            wanted
        });
        assert_smooth(&run);
        let mut last = motion(1999.0 * CYCLE_S);
        swung(&mut last, &by, &turn);
        swung(&mut last, &(-by * 1.5), &(-turn * 1.5));
        last.posture[3] += 0.2;
        assert_eq!(*run.last().expect("cycles"), last);
    }
}

/// The smallest jump that is joined, and for how long a far one is.
#[test]
fn joining_is_flagged_as_long_as_it_lasts() {
    let controller = controller::<f64>(&two_level());
    let rest = controller.rest_reference(&start());
    let joined_s = |far: f64| {
        let mut state = State::new();
        let mut away = rest.clone();
        if let [Target::Position { x, .. }] = away.targets_mut() {
            x.y += far;
        }
        let _ = controller.step(&mut state, &at_rest(&start()), &rest);
        let flagged = (0..2000)
            .map(|_| controller.step(&mut state, &at_rest(&start()), &away))
            .filter(|step| step.status.limits().any(|kind| kind == LimitKind::Joining));
        flagged.count() as f64 * CYCLE_S
    };
    let [jump, _] = JUMP;
    assert_eq!(joined_s(0.99 * jump), 0.0);
    let [speed, _] = JOIN_SPEED;
    for (far, expected) in [(1.01 * jump, JOIN_S), (0.07, JOIN_S), (0.2, 0.2 / speed)] {
        // Rounded up to cycles, and one for a sum that is short of it.
        assert!((joined_s(far) - expected).abs() < 2.1 * CYCLE_S, "{far}");
    }
}

/// Axes that a level does not control count for nothing: a jump along them is followed at once,
/// does not change the torque, and does not prolong the joining of one along the others.
#[test]
fn only_jumps_along_controlled_axes_are_joined() {
    let position = |axes| Task::position(FLANGE, axes, REFERENCE_GAINS);
    let facing = |axes| Task::orientation(Link::L7.frame(), axes, REFERENCE_GAINS);
    for (task, axes) in [position as fn(_) -> _, facing]
        .iter()
        .flat_map(|task| [Axes::X, Axes::XY].map(|axes| (task, axes)))
    {
        let controller = controller::<f64>(&with_tasks(&[task(axes)]));
        let rest = controller.rest_reference(&start());
        let jumped = |by: [f64; 3]| {
            let mut reference = rest.clone();
            match &mut reference.targets_mut()[0] {
                Target::Position { x, .. } => *x += Vector3::from(by),
                Target::Orientation { q, .. } => *q = orientation::turned(q, &by.into()),
                Target::Hold => panic!("a place"),
            }
            reference
        };
        let run = |by: [f64; 3]| {
            let mut state = State::new();
            let _ = controller.step(&mut state, &at_rest(&start()), &rest);
            let jumped = jumped(by);
            let steps: Vec<_> = (0..1000)
                .map(|_| controller.step(&mut state, &at_rest(&start()), &jumped))
                .collect();
            let joining = steps.iter().filter(|step| step.status.joining.contains(0));
            let joined_s = joining.count() as f64 * CYCLE_S;
            (
                joined_s,
                steps[0].torque,
                controller.followed_reference(&state),
            )
        };
        let (_, held, _) = run([0.0; 3]);
        // Seen from where the arm is, a turn about z has no other component.
        let (joined_s, torque, followed) = run([0.0, 0.0, 0.3]);
        assert_eq!(joined_s, 0.0, "{axes:?}");
        assert!((torque - held).amax() < 1e-10, "{axes:?}: roundings");
        assert_eq!(followed, jumped([0.0, 0.0, 0.3]), "{axes:?}");
        // What is joined takes its own time, however far the other axes go; a cycle for a sum
        // that is short of it.
        let (joined_s, torque, _) = run([0.06, 0.0, 0.3]);
        assert!(
            (joined_s - JOIN_S).abs() < 2.1 * CYCLE_S,
            "{axes:?}: {joined_s}"
        );
        assert!((torque - held).amax() < 1e-10, "{axes:?}: no step");
    }
}

/// On the plant: a jump of 10 cm and one of the posture by half a radian. Followed at once
/// the first makes a step of K_p x 0.1 m = 40 m/s2 times the inertia, tens of Nm.
#[test]
fn the_torque_does_not_step_with_the_reference() {
    let step_of = |at_once: bool| {
        let mut closed = ClosedLoop::<f64>::new(&two_level(), start(), &[Trajectory::Hold]);
        let (mut last, mut largest) = (None::<JointVector<f64>>, 0.0_f64);
        let mut error = 0.0;
        for cycle in 0..1000 {
            let mut reference = closed.reference();
            if cycle >= 100 {
                if let [Target::Position { x, .. }] = reference.targets_mut() {
                    x.y += 0.1;
                }
                reference.posture[0] += 0.5;
            }
            if cycle == 100 && at_once {
                closed.state.follow_at_once();
            }
            let seen = closed.step_towards(&reference, no_contact);
            assert_eq!(seen.step.status.fault, None);
            if let Some(last) = last {
                largest = largest.max((seen.step.torque - last).amax());
            }
            last = Some(seen.step.torque);
            error = seen.errors[0];
        }
        // What the gains leave of either after 1.4 s.
        assert!(error < 1e-5, "{error}");
        largest
    };
    let (joined, at_once) = (step_of(false), step_of(true));
    println!("largest step of a joint's torque: joined {joined:.3} Nm, at once {at_once:.1} Nm");
    // h times the jerk 60 x 0.1 / 0.4^3 is 0.19 m/s2 per cycle: an inertia below 10 kg at a
    // lever below 0.5 m makes 1 Nm of it.
    assert!(joined < 1.0 && at_once > 10.0);
}

/// A state that was made for another place: the arm is where it is, and goes from there.
#[test]
fn a_first_reference_far_from_the_arm_is_joined() {
    let controller = controller::<f64>(&two_level());
    let far = controller.rest_reference(&JointVector::zeros());
    let mut state = State::new();
    let step = controller.step(&mut state, &at_rest(&start()), &far);
    let held = controller.step(
        &mut State::new(),
        &at_rest(&start()),
        &controller.rest_reference(&start()),
    );
    assert_eq!(step.status.fault, None);
    // The first cycle holds the arm; what is left are roundings of its place.
    assert!((step.torque - held.torque).amax() < 1e-10);
    assert!(step.status.joining.contains(0) && step.status.joining.contains(7));
    // Within a second it would be a step of tens of Nm from one posture to the other.
    let at_once = {
        let mut state = State::new();
        state.follow_at_once();
        controller.step(&mut state, &at_rest(&start()), &far)
    };
    assert!((at_once.torque - held.torque).amax() > 10.0);
}

/// An arm that moves when it is taken over is brought to rest without a step.
#[test]
fn a_hold_begins_with_the_motion_of_the_arm() {
    let controller = controller::<f64>(&two_level());
    let mut measurement = at_rest(&start());
    measurement.dq = JointVector::from([0.3, -0.2, 0.1, 0.4, 0.0, 0.2, 0.0]);
    let hold = Reference::hold(1, start());
    let mut state = State::new();
    let Step { status, .. } = controller.step(&mut state, &measurement, &hold);
    assert!(status.joining.contains(0));
    let joints = controller_core::joint::JointState {
        q: measurement.q,
        dq: measurement.dq,
    };
    let moving = controller.moving_reference(&joints);
    let followed = controller.followed_reference(&state);
    let (moving, followed) = (&moving.targets()[0], &followed.targets()[0]);
    let none = orientation::identity();
    for (moving, followed) in parts(moving, &none).iter().zip(parts(followed, &none)) {
        // Roundings of lengths below 1 m and of their rates over 0.2 s.
        assert!((moving - followed).amax() < 1e-13);
    }
}

/// The resolver's command after a jump of 10 cm begins at rest.
#[test]
fn a_resolver_joins_as_well() {
    let config = ResolverConfig {
        tasks: two_level().tasks,
        gain: 10.0,
        cycle_s: CYCLE_S,
    };
    let resolver = Resolver::<f64>::new(&LWR_IV, &config).expect("a valid configuration");
    let controller = controller::<f64>(&two_level());
    let (mut q, mut state) = (start(), ResolverState::new(start()));
    let mut reference = controller.rest_reference(&q);
    let mut last = JointVector::zeros();
    for cycle in 0..500 {
        if cycle == 10
            && let [Target::Position { x, .. }] = reference.targets_mut()
        {
            x.y += 0.1;
        }
        let step = resolver.step(&mut state, &at_rest(&q), &reference);
        assert_eq!(step.status.fault, None);
        // Acceleration of the blend: 5.8 x 0.1 m / 0.4^2 is 3.6 m/s2, over a lever of 0.3 m.
        assert!((step.dq - last).amax() < 12.0 * CYCLE_S, "{cycle}");
        (q, last) = (step.q, step.dq);
    }
}
