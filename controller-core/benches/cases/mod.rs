//! What is measured: the controllers of the scenarios `two-level` ("2 levels",
//! flange and null space) and `case-1` ("3 levels", flange, wrist in the plane
//! and null space), of the LWR or another arm, in random and adversarial states.

pub mod stages;

use arms::{LWR_IV, LWR_IV_DAMPING, LWR_IV_STIFFNESS};
use controller_core::arm::ArmParameters;
use controller_core::joint::{JointVector, Vector3};
use controller_core::real::Real;
use controller_core::resolver::{Resolver, ResolverConfig};
use controller_core::{
    Axes, Controller, ControllerConfig, Measurement, NullSpace, Reference, Target, Task, TaskGains,
    TaskSet,
};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

/// Random states, besides the adversarial ones.
pub const RANDOM: usize = 2_000;

/// One controller.
pub struct Case<T: Real> {
    pub name: String,
    pub controller: Controller<T>,
    pub resolver: Resolver<T>,
}

/// One cycle's input, in double precision.
#[derive(Clone, Copy)]
pub struct Input {
    pub q: [f64; 7],
    pub dq: [f64; 7],
    pub interval_s: f64,
    /// Reference of a level: where it is, plus this \[m\], and speeds of this size.
    pub offset: f64,
    /// q_d \[rad\].
    pub posture: [f64; 7],
}

/// The controller with two or three levels, the null space counted.
pub fn levels<T: Real>(count: usize) -> Case<T> {
    levels_of(&LWR_IV, count)
}

/// The same of another arm, with its name.
pub fn levels_of<T: Real>(arm: &ArmParameters, count: usize) -> Case<T> {
    let wrist = arm.point("wrist").expect("a point of the arm");
    let gains = TaskGains::uniform(400.0, 40.0);
    let tasks = [
        Task::position(arm.flange_point(), Axes::XYZ, gains),
        Task::position(wrist, Axes::XY, gains),
    ];
    // Lighter arms bear less in this cycle; the work does not depend on it.
    let share = if arm.name == LWR_IV.name { 1.0 } else { 0.1 };
    let config = ControllerConfig {
        tasks: TaskSet::new(&tasks[..count - 1]).expect("valid tasks"),
        null_space: NullSpace::diagonal(LWR_IV_STIFFNESS, LWR_IV_DAMPING.map(|d| d * share)),
        observer_gain: [50.0; 7],
        cycle_s: 0.002,
        dead_cycles: 0,
    };
    let resolver = ResolverConfig {
        tasks: config.tasks,
        gain: 10.0,
        cycle_s: config.cycle_s,
    };
    let levels = format!("{count}-levels-{}", std::any::type_name::<T>());
    Case {
        name: if arm.name == LWR_IV.name {
            levels
        } else {
            format!("{}-{levels}", arm.name)
        },
        resolver: Resolver::new(arm, &resolver).expect("a valid configuration"),
        controller: Controller::new(arm, &config).expect("a valid configuration"),
    }
}

impl<T: Real> Case<T> {
    pub fn typed(&self, input: &Input) -> (Measurement<T>, Reference<T>) {
        let measurement = Measurement {
            q: JointVector::from(input.q.map(T::from_f64)),
            dq: JointVector::from(input.dq.map(T::from_f64)),
            interval_s: T::from_f64(input.interval_s),
        };
        let mut reference = self.controller.rest_reference(&measurement.q);
        let offset = T::from_f64(input.offset);
        for target in reference.targets_mut() {
            if let Target::Position { x, dx, ddx } = target {
                *x = x.map(|x| x + offset);
                (*dx, *ddx) = (Vector3::repeat(offset), Vector3::repeat(offset));
            }
        }
        reference.posture = JointVector::from(input.posture.map(T::from_f64));
        (measurement, reference)
    }
}

struct Random(ChaCha8Rng);

impl Random {
    /// Uniform in -1 .. 1.
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn joints(&mut self, scaled: impl Fn(usize, f64) -> f64) -> [f64; 7] {
        std::array::from_fn(|i| scaled(i, self.unit()))
    }
}

/// Random states over the whole range of the joints, then what is hard: singular,
/// at rest, at the border of what is believed, denormal, saturated.
pub fn states(arm: &ArmParameters) -> Vec<Input> {
    let mut random = Random(ChaCha8Rng::seed_from_u64(1));
    let range = |i: usize| arm.links[i].position_range;
    let anywhere = |random: &mut Random| {
        random.joints(|i, unit| {
            let [least, greatest] = range(i);
            (least + greatest) / 2.0 + unit * ((greatest - least) / 2.0)
        })
    };
    let speed = |i: usize| arm.links[i].speed_limit;
    let mut states: Vec<Input> = (0..RANDOM)
        .map(|_| Input {
            q: anywhere(&mut random),
            dq: random.joints(|i, unit| unit * speed(i)),
            interval_s: 0.002 * (1.0 + 0.4 * random.unit()),
            offset: 0.05 * random.unit(),
            posture: anywhere(&mut random),
        })
        .collect();
    let quarter = core::f64::consts::FRAC_PI_2;
    let postures = [
        [0.0; 7],
        [-0.0; 7],
        [0.0, 0.0, 0.0, quarter, 0.0, 0.0, 0.0],
        [0.0, quarter, 0.0, 0.0, 0.0, -quarter, 0.0],
        [quarter; 7],
        [1e-310; 7],
        [1e-9, -1e-9, 1e-9, -1e-9, 1e-9, -1e-9, 1e-9],
        [f64::MAX; 7],
        [f64::MIN; 7],
        [0.0, 0.611, 0.0, -1.396, 0.349, 1.047, 0.0],
    ];
    let speeds = [
        [0.0; 7],
        [-0.0; 7],
        [1e-310; 7],
        [-1e-160; 7],
        std::array::from_fn(|i| speed(i) * 2.9),
        std::array::from_fn(|i| speed(i) * if i % 2 == 0 { -2.9 } else { 2.9 }),
    ];
    // As far as it is believed, or followed.
    let within = |angles: [f64; 7], beyond: fn([f64; 2]) -> f64| {
        std::array::from_fn(|i| {
            let ([least, greatest], beyond) = (range(i), beyond(range(i)));
            angles[i].clamp(least - beyond, greatest + beyond)
        })
    };
    for q in postures.map(|q| within(q, |_| 0.19)) {
        for dq in speeds {
            for (interval_s, offset, far) in [
                (0.002, 0.0, 0.0),
                (0.0011, 1e-310, -0.0),
                // As far as a reference may be from an outstretched arm.
                (0.039, 0.28, 4.0),
                (0.002, -0.28, -4.0),
            ] {
                states.push(Input {
                    q,
                    dq,
                    interval_s,
                    offset,
                    posture: within([far; 7], |[least, greatest]| 0.49 * (greatest - least)),
                });
            }
        }
    }
    states
}
