//! Random sequences of changes, one upon the other.

use arms::LWR_IV;
use cell::names::PlantKind;
use controller_core::gain::diagonal;
use controller_core::joint::{DOF, JointVector};
use controller_core::law::null_space::NullDamping;
use controller_core::{
    Axes, Capacity, Change, ControllerConfig, Link, NullSpace, Order, Reference, Target, Task,
    TaskGains, TaskSet,
};
use stratum_tests::config::{
    ELBOW, FLANGE, REFERENCE_DAMPING, REFERENCE_GAINS, REFERENCE_STIFFNESS, WRIST, two_level,
};
use stratum_tests::oracle::closed_loop::{TWO_LEVEL_START, posture};
use stratum_tests::random::States;

use super::run::{Run, on_circle};

/// Slots.
const SLOTS: usize = 5;

/// Of each sequence.
const CYCLES: u32 = 4000;

/// Tasks that come and go.
fn pool() -> [Task; SLOTS] {
    let gains = REFERENCE_GAINS;
    [
        Task::position(FLANGE, Axes::XYZ, gains),
        Task::position(WRIST, Axes::XY, gains),
        Task::orientation(Link::L7.frame(), Axes::XYZ, gains),
        Task::position(ELBOW, Axes::Z, gains),
        Task::position(ELBOW, Axes::X | Axes::Y, gains),
    ]
}

/// What a sequence came to.
struct Outcome {
    seed: u64,
    step: f64,
    at_s: f64,
    changes: u32,
}

/// Random numbers of a sequence.
struct Draw(States);

impl Draw {
    /// 0 to 1.
    fn share(&mut self) -> f64 {
        0.5 * (self.0.signed() + 1.0)
    }

    fn below(&mut self, count: usize) -> usize {
        ((self.share() * count as f64) as usize).min(count.saturating_sub(1))
    }
}

/// Slots of an order, in it.
fn listed(order: &Order) -> Vec<usize> {
    order.slots().collect()
}

/// A change that these tasks take.
fn change(draw: &mut Draw, there: &Order) -> Change {
    let slots = listed(there);
    let absent: Vec<_> = (0..SLOTS).filter(|slot| !there.contains(*slot)).collect();
    match draw.below(5) {
        0 | 1 if !absent.is_empty() => {
            let slot = absent[draw.below(absent.len())];
            Change::Add {
                slot,
                task: pool()[slot],
                place: draw.below(slots.len() + 1),
            }
        }
        0 | 2 if !slots.is_empty() => Change::Remove {
            slot: slots[draw.below(slots.len())],
        },
        3 if slots.len() > 1 => {
            let mut order = slots;
            for last in (1..order.len()).rev() {
                order.swap(last, draw.below(last + 1));
            }
            Change::Reorder(Order::new(&order).expect("each once"))
        }
        4 if !slots.is_empty() => {
            let rate = 8.0 + 16.0 * draw.share();
            Change::Gains {
                slot: slots[draw.below(slots.len())],
                gains: TaskGains::uniform(rate * rate, 2.0 * rate),
            }
        }
        _ => {
            let factor = 0.5 + draw.share();
            Change::NullSpace(NullSpace {
                stiffness: diagonal(REFERENCE_STIFFNESS.map(|entry| entry * factor)),
                damping: NullDamping::Joint(diagonal(
                    REFERENCE_DAMPING.map(|entry| entry * factor),
                )),
                ..two_level().null_space
            })
        }
    }
}

fn sequence(seed: u64) -> Outcome {
    let mut draw = Draw(States::new(seed));
    let set = TaskSet::new(&pool()).expect("a set");
    let set = (1..SLOTS).fold(set, TaskSet::without);
    let set = set
        .with_capacity(Capacity {
            levels: SLOTS,
            rows: 12,
        })
        .expect("room");
    let config = ControllerConfig {
        tasks: set,
        ..two_level()
    };
    let start = posture(TWO_LEVEL_START);
    let mut run = Run::new(&LWR_IV, &config, PlantKind::Ideal, start, seed);
    let origin = run.controller.rest_reference(&start).targets()[0];
    let mut next = 0.3 + 0.9 * draw.share();
    let mut changes = 0;
    for _ in 0..CYCLES {
        if run.t_s() >= next {
            let there = run.controller.order(&run.state);
            run.begin(&change(&mut draw, &there));
            changes += 1;
            next += 0.05 + 0.9 * draw.share();
        }
        let mut reference = Reference::hold(SLOTS, start);
        reference.targets_mut()[0] = on_circle(&origin, run.t_s());
        // A task comes from where the arm is: the circle is joined, the others hold.
        for target in &mut reference.targets_mut()[1..] {
            *target = Target::Hold;
        }
        let step = run.cycle(&reference);
        assert_eq!(step.status.fault, None, "seed {seed}");
        within(&step.torque, seed, |i| LWR_IV.links[i].torque_limit);
        within(&run.plant.state().q, seed, |i| {
            LWR_IV.links[i].position_range[1]
        });
    }
    Outcome {
        seed,
        step: run.step,
        at_s: run.stepped_at_s,
        changes,
    }
}

fn within(values: &JointVector<f64>, seed: u64, limit: impl Fn(usize) -> f64) {
    for i in 0..DOF {
        assert!(
            values[i].abs() <= limit(i) + 1e-9,
            "seed {seed}, joint {}",
            i + 1
        );
    }
}

fn check(seeds: impl Iterator<Item = u64>) {
    let mut outcomes: Vec<_> = seeds.map(sequence).collect();
    outcomes.sort_by(|a, b| b.step.total_cmp(&a.step));
    let changes: u32 = outcomes.iter().map(|outcome| outcome.changes).sum();
    println!(
        "{} sequences, {changes} changes; largest steps:",
        outcomes.len()
    );
    for Outcome {
        seed, step, at_s, ..
    } in outcomes.iter().take(12)
    {
        println!("seed {seed}: {step:.2} Nm at {at_s:.3} s");
    }
    let beyond = outcomes.iter().filter(|outcome| outcome.step > 5.0).count();
    println!("{beyond} of {} with a step above 5 Nm", outcomes.len());
    assert_eq!(beyond, 0);
}

#[test]
fn random_changes_keep_the_arm_within_its_limits_and_make_no_step() {
    check(0..24);
}

/// The whole: `cargo test --release -p stratum-tests --test transitions -- --ignored --nocapture`.
#[test]
#[ignore = "takes a minute"]
fn five_hundred_random_sequences() {
    check(0..500);
}
