//! The velocity-level resolver against (1)-(5) in explicit inverses, on its own: the
//! position that it commands is the one that it measures in the next cycle.

use arms::LWR_IV;
use cell::scenario::{LevelSpec, Scenario};
use controller_core::fault::Quantity;
use controller_core::joint::{JointState, JointVector, Vector3, zeros};
use controller_core::ranges::COMMAND_LEAD_MAX;
use controller_core::resolver::{Resolver, ResolverConfig, ResolverState};
use controller_core::{Axes, ControllerConfig, Measurement, Reference, Target, Task, TaskSet};
use hil_sim::arm_points::origins;
use hil_sim::plant::PlantModel;
use stratum_tests::config::{FLANGE, REFERENCE_GAINS, two_level};
use stratum_tests::controller;
use stratum_tests::oracle::sample::{SPLITS, Sample, Wish, configuration};
use stratum_tests::oracle::{Matrix, Oracle};
use stratum_tests::random::States;

/// K \[1/s\].
const GAIN: f64 = 10.0;
/// h \[s\].
const CYCLE_S: f64 = 0.002;

/// Which rate of the reference the resolver sees.
#[derive(Clone, Copy, PartialEq)]
enum Rate {
    MidCycle,
    Start,
}

fn at_rest(q: JointVector<f64>) -> JointState<f64> {
    JointState { q, dq: zeros() }
}

/// |x_d - x| of every level in the posture `q` \[m\], along its axes.
fn errors(
    scenario: &Scenario,
    model: &PlantModel,
    q: &JointVector<f64>,
    reference: &Reference<f64>,
) -> Vec<f64> {
    let levels = scenario.levels.iter().zip(reference.targets());
    let error = |(level, target): (&LevelSpec, &Target<f64>)| {
        let (point, axes) = (
            level.point.resolve(&scenario.arm()),
            Axes::from_name(&level.axes),
        );
        let (x, _) = model.point(&at_rest(*q), point.link.number(), &point.offset.into());
        let Target::Position { x: desired, .. } = target else {
            panic!("a position");
        };
        let error = desired - x;
        let along = |axis: &usize| axes.expect("axes").flags()[*axis];
        let squares = (0..3).filter(along).map(|axis| error[axis] * error[axis]);
        squares.sum::<f64>().sqrt()
    };
    levels.map(error).collect()
}

/// rms of |x_d - x| of every level \[mm\] over a whole scenario.
fn tracking_mm(name: &str, rate: Rate) -> Vec<f64> {
    let scenario = Scenario::find(name).expect("built in");
    let cycle_s = scenario.cycle_s();
    assert_eq!(cycle_s, CYCLE_S);
    let resolver = resolver(scenario.controller_config(0).expect("valid").tasks);
    let origins = origins(&scenario, &scenario.start());
    let mut q = scenario.start();
    let mut state = ResolverState::new(q);
    let model = PlantModel::new(&LWR_IV);
    let mut squares = vec![0.0; scenario.levels.len()];
    for cycle in 0..scenario.cycles() {
        let mut reference = scenario.reference(&origins, &scenario.start(), cycle as f64 * cycle_s);
        for (square, error) in squares
            .iter_mut()
            .zip(errors(&scenario, &model, &q, &reference))
        {
            *square += error * error;
        }
        if rate == Rate::Start {
            for target in reference.targets_mut() {
                if let Target::Position { ddx, .. } = target {
                    *ddx = zeros();
                }
            }
        }
        let step = resolver.step(&mut state, &measured(q), &reference);
        assert!(step.status.is_clear(), "{:?}", step.status);
        q = step.q;
    }
    let cycles = scenario.cycles() as f64;
    squares
        .iter()
        .map(|square| (square / cycles).sqrt() * 1e3)
        .collect()
}

/// The residual error of a sampled rate is h / (2 K) (dJ/dt) dq, of plain Euler
/// h / (2 K) J ddq: 1e-4 s2 of some dm/s2.
#[test]
fn references_are_followed() {
    for (name, limits) in [("two-level", &[0.006][..]), ("case-1", &[0.006, 0.002])] {
        let [middle, start] = [Rate::MidCycle, Rate::Start].map(|rate| tracking_mm(name, rate));
        println!("{name}: {middle:.5?} mm rms, plain Euler {start:.5?}");
        for ((middle, start), limit) in middle.iter().zip(&start).zip(limits) {
            assert!(middle < limit, "{name}: {middle}");
            assert!(middle <= start);
        }
    }
}

fn resolver(tasks: TaskSet) -> Resolver<f64> {
    let config = ResolverConfig {
        tasks,
        gain: GAIN,
        cycle_s: CYCLE_S,
    };
    Resolver::new(&LWR_IV, &config).expect("valid")
}

fn measured(q: JointVector<f64>) -> Measurement<f64> {
    Measurement {
        q,
        dq: zeros(),
        interval_s: CYCLE_S,
    }
}

/// dx_d(t + h/2) + K x_err of every level, from the reference and the error of the rows.
fn task_velocities(
    config: &ControllerConfig,
    reference: &Reference<f64>,
    error: &[f64],
) -> Vec<Matrix> {
    let mut error = error.iter();
    let levels = config.tasks.tasks().iter().zip(reference.targets());
    let velocity = |(task, target): (&Task, &Target<f64>)| {
        let (rate, growth) = match target {
            Target::Position { dx, ddx, .. } => (*dx, *ddx),
            Target::Orientation { w, dw, .. } => (*w, *dw),
            Target::Hold => (zeros(), zeros()),
        };
        let axes = (0..3).filter(|&axis| task.axes.flags()[axis]);
        let rows = axes.map(|axis| {
            rate[axis] + 0.5 * CYCLE_S * growth[axis] + GAIN * error.next().expect("a row")
        });
        Matrix::column(&rows.collect::<Vec<_>>())
    };
    levels.map(velocity).collect()
}

/// eq (1), eq (2), eq (3), eq (4), eq (5) with Moore-Penrose inverses, on every split of the rows.
#[test]
fn speeds_are_those_of_the_printed_recursion_in_exact_order() {
    let mut random = States::new(5);
    let (mut worst, mut disturbed) = (0.0f64, 0.0f64);
    for (name, split) in SPLITS {
        let config = configuration(split);
        let (controller, resolver) = (controller(&config), resolver(config.tasks));
        let mut checked = 0;
        while checked < 40 {
            let joints = at_rest(random.state().q);
            let wish = Wish::random(&controller, &joints, &mut random);
            let sample = Sample::new(&controller, joints, &wish);
            let oracle = Oracle::new(sample.terms());
            if oracle.conditioning() > 1e6 {
                continue;
            }
            checked += 1;
            let mut state = ResolverState::new(joints.q);
            state.follow_at_once();
            let step = resolver.step(&mut state, &measured(joints.q), &wish.reference);
            assert!(step.status.fault.is_none() && !step.status.rank.any());
            let wanted = task_velocities(&config, &wish.reference, &sample.data.rows.error);
            let (mut dq, mut free) = (Matrix::zeros(7, 1), Matrix::identity(7));
            for (level, wanted) in oracle.terms.levels.iter().zip(&wanted) {
                let j = &level.jacobian;
                let jp = j * &free;
                let inverse = jp.t() * (&jp * jp.t()).inverse();
                dq = &dq + &inverse * (wanted - j * &dq);
                free = &free - &inverse * &jp;
            }
            // All are shortened alike where one is too fast.
            let links = LWR_IV.links.iter().zip(dq.entries());
            let excess = links.fold(1.0f64, |most, (link, speed)| {
                most.max(speed.abs() / link.speed_limit)
            });
            let given = Matrix::of(&step.dq).scaled(excess);
            let scale = dq.amax();
            worst = worst.max((&given - &dq).amax() / scale);
            let (first, wanted) = (&oracle.terms.levels[0], &wanted[0]);
            disturbed = disturbed.max((&first.jacobian * &given - wanted).amax() / scale);
            assert!(worst < 1e-9, "{name}: {worst:e}");
        }
    }
    println!("worst {worst:.1e} against explicit inverses, level 1 disturbed {disturbed:.1e}");
    // The rounding of seven products.
    assert!(disturbed < 1e-14, "{disturbed:e}");
}

/// The same point twice: the second level can have nothing, the first loses nothing.
#[test]
fn a_level_in_conflict_takes_nothing_from_the_one_above() {
    let flange = Task::position(FLANGE, Axes::XYZ, REFERENCE_GAINS);
    let resolver = resolver(TaskSet::new(&[flange, flange]).expect("tasks"));
    let q = JointVector::from([0.0, 0.61, 0.0, -1.40, 0.35, 1.05, 0.0]);
    let model = PlantModel::new(&LWR_IV);
    let (x, _) = model.point(&at_rest(q), FLANGE.link.number(), &FLANGE.offset.into());
    let aside = Target::position(x + Vector3::from([0.0, 0.05, 0.0]));
    let alone = Target::position(x + Vector3::from([0.01, 0.0, 0.0]));
    let reference = Reference::new([alone, aside], q);
    let mut state = ResolverState::new(q);
    state.follow_at_once();
    let step = resolver.step(&mut state, &measured(q), &reference);
    let (_, dx) = model.point(
        &JointState { q, dq: step.dq },
        FLANGE.link.number(),
        &FLANGE.offset.into(),
    );
    assert!((dx - Vector3::from([0.1, 0.0, 0.0])).amax() < 1e-14, "{dx}");
    assert_eq!(step.status.rank.0, 0b11_1000);
}

#[test]
fn what_cannot_be_true_holds_the_commanded_position() {
    let config = two_level();
    let resolver = resolver(config.tasks);
    let q = JointVector::from([0.0, 0.61, 0.0, -1.40, 0.35, 1.05, 0.0]);
    let hold = Reference::hold(1, q);
    let mut far = q;
    far[3] = 9.0;
    let refused = [
        (measured(far), hold.clone(), Quantity::Position),
        (measured(q), Reference::hold(2, q), Quantity::TargetCount),
        (
            measured(q),
            Reference::new([Target::position([f64::NAN; 3])], q),
            Quantity::TargetDistance,
        ),
        (
            measured(q),
            Reference::new([Target::position([1e300; 3])], q),
            Quantity::TargetDistance,
        ),
        (
            measured(q),
            Reference::new([Target::orientation([1.0, 0.0, 0.0, 0.0])], q),
            Quantity::TargetKind,
        ),
    ];
    for (measurement, reference, quantity) in refused {
        let mut state = ResolverState::new(q);
        let step = resolver.step(&mut state, &measurement, &reference);
        let fault = step.status.fault.expect("a fault");
        assert_eq!(
            (fault.quantity, step.q, step.dq),
            (quantity, q, zeros()),
            "{fault}"
        );
        // Latched, until it is cleared.
        let latched = resolver.step(&mut state, &measured(q), &hold).status.fault;
        assert_eq!(latched.map(|fault| fault.quantity), Some(quantity));
        state.reset();
        assert!(
            resolver
                .step(&mut state, &measured(q), &hold)
                .status
                .is_clear()
        );
    }
}

#[test]
fn commands_stay_within_speed_range_and_reach_of_the_arm() {
    let resolver = resolver(two_level().tasks);
    let mut q = JointVector::from([0.0, 0.61, 0.0, -1.40, 0.35, 1.05, 0.0]);
    // Beyond the reach of 0.87 m, and not so far that it cannot be meant.
    let away = Reference::new([Target::position([1.3, 0.0, 0.4])], q);
    let (mut state, mut limited, mut stuck) = (ResolverState::new(q), false, q);
    // An arm that follows to the end of its reach, then one that is held.
    for cycle in 0..4000 {
        let step = resolver.step(&mut state, &measured(q), &away);
        assert!(step.status.fault.is_none());
        limited |= step.status.saturated.any();
        for (i, link) in LWR_IV.links.iter().enumerate() {
            assert!(step.dq[i].abs() <= link.speed_limit * (1.0 + 1e-15));
            assert!(step.q[i].abs() <= link.position_range[1]);
            assert!((step.q[i] - q[i]).abs() <= COMMAND_LEAD_MAX * (1.0 + 1e-12));
        }
        if cycle < 2000 {
            assert!(
                (step.q - q)
                    .component_div(&JointVector::from_fn(|i, _| LWR_IV.links[i].speed_limit))
                    .amax()
                    <= CYCLE_S * (1.0 + 1e-12)
            );
            q = step.q;
        }
        stuck = step.q;
    }
    assert!(limited);
    assert!((stuck - q).amax() > 0.5 * COMMAND_LEAD_MAX);
}

#[test]
fn a_gain_that_the_cycle_cannot_carry_is_refused() {
    let config = |gain, cycle_s| ResolverConfig {
        tasks: two_level().tasks,
        gain,
        cycle_s,
    };
    for (gain, cycle_s) in [
        (0.0, 0.002),
        (f64::NAN, 0.002),
        (500.1, 0.002),
        (10.0, 0.0),
        (10.0, 0.021),
    ] {
        assert!(Resolver::<f64>::new(&LWR_IV, &config(gain, cycle_s)).is_err());
    }
    assert!(Resolver::<f64>::new(&LWR_IV, &config(500.0, 0.002)).is_ok());
    let error = Resolver::<f64>::new(&LWR_IV, &config(501.0, 0.002)).expect_err("too large");
    assert_eq!(
        error.to_string(),
        "resolver gain 501 1/s; it must be above 0 and at most 500"
    );
}
