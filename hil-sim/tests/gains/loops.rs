//! The sampled loop against closed forms, the core and simulated arms.

use arms::realistic::ENCODER_STEP;
use arms::{LWR_IV, OPENARM_V20_RIGHT};
use cell::names::PlantKind;
use controller_core::arm::{ArmModel, ArmParameters};
use controller_core::cycle::velocity::{CORNER_HZ, VelocityEstimator};
use controller_core::cycle::{Data, Input};
use controller_core::gain::diagonal;
use controller_core::joint::{DOF, JointVector, Vector3};
use controller_core::law::null_space::{NullDamping, NullSpace, Posture};
use controller_core::law::sampling;
use controller_core::task::orientation;
use controller_core::{
    Controller, ControllerConfig, Measurement, Reference, State, Target, Task, TaskGains, TaskSet,
};
use hil_sim::arm_points;
use hil_sim::gains::bounds::{self, Cause, TORQUE_SHARE, row_law};
use hil_sim::gains::kind::{Ask, Kind};
use hil_sim::gains::link::{Departure, Link};
use hil_sim::gains::matrix::Matrix;
use hil_sim::gains::near_rest::NearRest;
use hil_sim::gains::proposal::step_peak;
use hil_sim::gains::sampled::{Arm, Reading, Slopes, Timing, transition};
use hil_sim::model::search::drawn;
use hil_sim::plant::sensor::quantised;
use hil_sim::plant::{Plant, PlantModel, PlantOptions, Rng, noise};

fn timing(dead_cycles: u8) -> Timing {
    Timing {
        cycle_s: 0.002,
        dead_cycles,
        reading: Reading::Link,
    }
}

fn uncompensated(stiffness: f64, damping: f64) -> Slopes {
    Slopes {
        residual: Matrix::zeros(1, 1),
        ..row_law(stiffness, damping, 100.0)
    }
}

/// z^2 - (2 - h K_d - h^2 K_p / 2) z + (1 - h K_d + h^2 K_p / 2) of docs/hierarchy.md.
#[test]
fn a_double_integrator_is_the_closed_form() {
    let h = 0.002;
    for (stiffness, damping) in [(400.0, 40.0), (400.0, 5.0), (1e4, 900.0), (1e4, 1100.0)] {
        let [place, rate] = [0.5 * h * h * stiffness, h * damping];
        let [sum, product] = [2.0 - rate - place, 1.0 - rate + place];
        let root = sum * sum / 4.0 - product;
        let radius = match root < 0.0 {
            true => f64::sqrt(product),
            false => (sum / 2.0).abs() + root.sqrt(),
        };
        let law = uncompensated(stiffness, damping);
        let found = transition(&Arm::unit(), &timing(0), &law).spectral_radius();
        assert!((found - radius).abs() < 1e-7, "{found} {radius}");
    }
}

/// 2 cos(d pi / (2 d + 1)) without a spring: the margin of a factor of 2 leaves half of it. The
/// spring that a damping comes with takes some of it where there is dead time.
#[test]
fn the_rate_of_a_damping_is_half_the_sampling_bound() {
    for dead_cycles in 0..=3 {
        let bound = sampling::bound(dead_cycles) / 0.002;
        for (share, is_stable) in [(0.99, true), (1.01, false)] {
            // So slow a spring that it does not matter, but no eigenvalue is 1.
            let law = uncompensated(1.0, share * bound);
            let radius = transition(&Arm::unit(), &timing(dead_cycles), &law).spectral_radius();
            assert_eq!(radius < 1.0, is_stable, "{dead_cycles}: {share} {radius}");
        }
        let mut link = Link::ideal(0.002);
        link.timing = timing(dead_cycles);
        let share = bounds::damping_rate(&link) / bound;
        let allowed = match dead_cycles {
            0 => 0.4999..0.5001,
            _ => 0.4..0.5,
        };
        assert!(allowed.contains(&share), "{dead_cycles}: {share}");
    }
}

/// With K_I = c w an arm k times as heavy as believed is stable below
/// 1/k = c / ((c + 2) (1 + 2 c)), Routh's condition of the loop in continuous time.
#[test]
fn how_heavy_an_arm_may_be_is_the_closed_form() {
    let w = 20.0;
    let fast = Timing {
        cycle_s: 1e-5,
        ..timing(0)
    };
    for c in [0.5, 1.0, 2.0, 5.0] {
        let least = c / ((c + 2.0) * (1.0 + 2.0 * c));
        for (share, is_stable) in [(1.02, true), (0.98, false)] {
            let arm = Arm::unit().answering(share * least);
            let law = row_law(w * w, 2.0 * w, c * w);
            let radius = transition(&arm, &fast, &law).spectral_radius();
            assert_eq!(radius < 1.0, is_stable, "{c}: {share} {radius}");
        }
    }
}

/// Three lines of a differential equation, in small steps.
#[test]
fn the_error_behind_a_step_peaks_as_the_formula_says() {
    for (w, observer_gain) in [(20.0, 40.0), (50.0, 50.0), (30.0, 12.0)] {
        let (mut x, mut v, mut disturbance, dt) = (0.0, 0.0, 1.0, 1e-6);
        let mut peak = 0.0f64;
        for _ in 0..600_000 {
            let a = disturbance - 2.0 * w * v - w * w * x;
            x += dt * v;
            v += dt * a;
            disturbance -= dt * observer_gain * disturbance;
            peak = peak.max(x);
        }
        let formula = step_peak(w, observer_gain);
        // Steps of 1e-6 s against rates of 50 1/s, and c = 1 taken as 1.001.
        assert!((formula / peak - 1.0).abs() < 1e-3, "{formula} {peak}");
    }
}

struct Loop {
    arm: &'static ArmParameters,
    link: Link,
    tasks: Vec<Task>,
    config: ControllerConfig,
    q: JointVector<f64>,
}

impl Loop {
    fn new(arm: &'static ArmParameters, gains: [f64; 3], timing: Timing) -> Self {
        let [stiffness, damping, observer_gain] = gains;
        let task = TaskGains::uniform(stiffness, damping);
        let tasks: Vec<_> = Kind::ALL.iter().map(|kind| kind.task(arm, task)).collect();
        let config = ControllerConfig {
            tasks: TaskSet::new(&tasks).expect("two levels"),
            null_space: NullSpace {
                stiffness: diagonal([20.0, 20.0, 15.0, 15.0, 3.0, 2.0, 0.2]),
                damping: match timing.dead_cycles {
                    0 => NullDamping::Joint(diagonal([4.0, 4.0, 3.0, 3.0, 0.4, 0.3, 0.03])),
                    _ => NullDamping::Inertia(20.0),
                },
                posture: Posture::Constant,
            },
            observer_gain: [observer_gain; DOF],
            cycle_s: timing.cycle_s,
            dead_cycles: timing.dead_cycles,
        };
        let degrees = [0.0f64, 35.0, 0.0, 80.0, 20.0, 30.0, 0.0];
        Self {
            arm,
            link: Link {
                timing,
                ..Link::ideal(timing.cycle_s)
            },
            tasks,
            config,
            q: JointVector::from(degrees.map(f64::to_radians)),
        }
    }

    fn controller(&self) -> Controller<f64> {
        Controller::new(self.arm, &self.config).expect("gains that the core takes")
    }

    fn near_rest(&self) -> NearRest {
        let gain = self.config.observer_gain[0];
        let controller = self.controller();
        let near = NearRest::of(
            self.arm,
            &controller,
            &self.tasks,
            gain,
            &self.link,
            &self.q,
        );
        near.expect("a mass matrix")
    }

    fn transition(&self) -> Matrix {
        let near = self.near_rest();
        transition(&near.arm, &self.link.timing, &near.law)
    }

    /// The same way as [`Loop::ways`] by the matrix alone.
    fn predicted(&self, offset: &JointVector<f64>, cycles: usize) -> Vec<JointVector<f64>> {
        let (near, timing) = (self.near_rest(), &self.link.timing);
        let transition = transition(&near.arm, timing, &near.law);
        let column = Matrix::from_fn(DOF, 1, |row, _| offset[row]);
        let mut state = Matrix::zeros(transition.rows(), 1);
        state.add_block(0, 0, &column);
        if let Reading::Filtered { .. } = timing.reading {
            // The first speed is 0.
            state.add_block(2 * DOF, 0, &column.scaled(-timing.pole() / timing.cycle_s));
        }
        for dead in 0..usize::from(timing.dead_cycles) {
            // The arm is held where it starts.
            let held = near.arm.gravity_slope.times(&column);
            state.add_block((5 + dead) * DOF, 0, &held);
        }
        let mut ways = Vec::new();
        for _ in 0..cycles {
            ways.push(JointVector::from_fn(|row, _| state.at(row, 0)));
            state = transition.times(&state);
        }
        ways
    }

    /// How far the joints of the simulated ideal arm are from rest \[rad\], cycle by cycle; it starts
    /// `offset` off.
    fn ways(&self, offset: &JointVector<f64>, cycles: usize) -> Vec<JointVector<f64>> {
        let controller = self.controller();
        let geometry = PlantModel::new(self.arm);
        let mut reference = Reference::hold(2, self.q);
        let flange = self.arm.flange_point();
        reference.targets_mut()[0] =
            Target::position(arm_points::at_rest(&geometry, &self.q, &flange));
        let frame = self.arm.flange_frame();
        reference.targets_mut()[1] =
            Target::orientation(arm_points::orientation(&geometry, &self.q, &frame));
        let start = self.q + offset;
        let h = self.link.timing.cycle_s;
        let options = PlantOptions {
            dead_cycles: self.link.timing.dead_cycles.into(),
            ..PlantOptions::default()
        };
        let mut plant = Plant::with_options(PlantKind::Ideal, self.arm, start, h, 1, options);
        let mut filter = VelocityEstimator::new(CORNER_HZ);
        let mut state = State::new();
        state.follow_at_once();
        let mut ways = Vec::new();
        for cycle in 0..cycles {
            let truth = *plant.state();
            let filtered = filter.update(&truth.q, h);
            let dq = match self.link.timing.reading {
                Reading::Filtered { .. } => filtered.dq,
                _ => truth.dq,
            };
            let measurement = Measurement {
                q: truth.q,
                dq,
                interval_s: h,
            };
            let step = controller.step(&mut state, &measurement, &reference);
            assert_eq!(step.status.fault, None);
            ways.push(truth.q - self.q);
            let t_s = cycle as f64 * h;
            plant.advance(t_s, &step.torque, |_, _, _| JointVector::zeros());
        }
        ways
    }
}

/// Joint by joint and cycle by cycle, whatever lies between arm and law. In the end the slowest or
/// fastest growing mode is left: its growth is the spectral radius.
#[test]
fn a_simulated_arm_moves_as_the_matrix_says() {
    let filtered = Timing {
        reading: Reading::Filtered {
            corner_hz: CORNER_HZ,
        },
        ..timing(0)
    };
    let ordinary = [400.0, 40.0, 100.0];
    for (arm, timing, gains, is_stable) in [
        (&LWR_IV, timing(0), ordinary, true),
        (&LWR_IV, timing(1), ordinary, true),
        (&OPENARM_V20_RIGHT, timing(2), ordinary, true),
        (&LWR_IV, filtered, ordinary, true),
        // Beyond what the filter leaves, and within what the core allows without one.
        (&LWR_IV, filtered, [1e5, 632.0, 632.0], false),
    ] {
        let it = Loop::new(arm, gains, timing);
        let radius = it.transition().spectral_radius();
        assert_eq!(radius < 1.0, is_stable, "{radius}");
        // Near enough to rest for the whole way: growth by at most e^7.
        let (size, cycles) = match is_stable {
            true => (1e-6, 600),
            false => (1e-9, (7.0 / radius.ln()) as usize),
        };
        let offset = JointVector::from_fn(|i, _| size * f64::sin(1.0 + 2.0 * i as f64));
        let [moved, predicted] = [it.ways(&offset, cycles), it.predicted(&offset, cycles)];
        let most = moved.iter().map(|way| way.amax()).fold(0.0, f64::max);
        for (moved, predicted) in moved.iter().zip(&predicted) {
            // What is left of second order, and of an input u that is taken where a cycle starts.
            assert!(
                (moved - predicted).amax() < 2e-3 * most,
                "{} {radius}: {moved} {predicted}",
                arm.name
            );
        }
    }
}

/// Of a loop whose slowest mode is real and alone.
#[test]
fn a_simulated_arm_comes_to_rest_as_its_radius_says() {
    let it = Loop::new(&LWR_IV, [400.0, 40.0, 100.0], timing(1));
    let predicted = it.transition().spectral_radius();
    let offset = JointVector::repeat(1e-5);
    let ways = it.ways(&offset, 1200);
    let measured = (ways[1100].norm() / ways[900].norm()).powf(1.0 / 200.0);
    // 1 % of the rate: the tasks, half as fast again, have left e^-11 of what there was.
    let ratio = measured.ln() / predicted.ln();
    assert!((ratio - 1.0).abs() < 0.01, "{measured} {predicted}");
}

/// The exact law asks the joint that bounds an orientation for the share of its torque, for an
/// error of 0.05 rad in the worst direction.
#[test]
fn the_wrist_needs_the_torque_that_bounds_its_bandwidth() {
    let arm = &LWR_IV;
    let model = ArmModel::new(arm).expect("a table");
    let kind = Kind::Orientation;
    let asks: Vec<_> = drawn(arm, 300)
        .iter()
        .filter_map(|q| Ask::of(kind, &model, arm, q))
        .collect();
    let bound = bounds::torque(kind, arm, &asks);
    assert_eq!(bound.cause, Cause::Torque);
    let (joint, posture) = bound.place.expect("a joint");
    let w = bound.bandwidth;
    let mut it = Loop::new(arm, [w * w, 2.0 * w, 2.0 * w], timing(0));
    it.q = posture.into();
    it.config.tasks =
        TaskSet::new(&[kind.task(arm, TaskGains::uniform(w * w, 2.0 * w))]).expect("a level");
    let controller = Controller::exact(arm, &it.config).expect("gains that the core takes");
    let here = arm_points::orientation(&PlantModel::new(arm), &it.q, &arm.flange_frame());
    let measurement = Measurement {
        q: it.q,
        dq: JointVector::zeros(),
        interval_s: 0.002,
    };
    let mut most = 0.0f64;
    let mut free = 0.0;
    for number in 0..4000 {
        // Evenly over the sphere.
        let height = 1.0 - 2.0 * (f64::from(number) + 0.5) / 4000.0;
        let turn = 2.399_963 * f64::from(number);
        let across = f64::sqrt(1.0 - height * height);
        let axis = Vector3::new(across * turn.cos(), across * turn.sin(), height);
        let mut reference = Reference::hold(1, it.q);
        let there = orientation::turned(&here, &(axis * kind.jump()));
        reference.targets_mut()[0] = Target::orientation(there);
        let mut data = Data::new();
        let input = Input {
            measurement: &measurement,
            reference: &reference,
        };
        controller.evaluate(&input, &mut data);
        let gravity = data.dynamics.gravity[joint];
        free = arm.links[joint].torque_limit - gravity.abs();
        most = most.max((data.demand.0[joint] - gravity).abs());
    }
    // The error is 2 sin(angle / 2): 1e-4 less than the angle; directions 2 degrees apart.
    assert!(
        (most / (TORQUE_SHARE * free) - 1.0).abs() < 2e-3,
        "{most} {free}"
    );
}

/// White rounding of positions makes speeds with the deviation that is reckoned with.
#[test]
fn the_rounding_of_speeds_is_that_of_rounded_positions() {
    let none = Departure {
        dead_cycles: None,
        elastic: false,
    };
    let h = 0.002;
    let link = Link::realistic(&LWR_IV, h, none);
    let mut rng = Rng::new(1, noise::stream::STUDY);
    let mut filters = [VelocityEstimator::new(CORNER_HZ); 2];
    let (mut q, mut squares, cycles) = (JointVector::<f64>::zeros(), JointVector::zeros(), 20_000);
    for _ in 0..cycles {
        // A way of some steps, another one every cycle: where in its step it ends is even.
        q += JointVector::from_fn(|_, _| 1e-3 * rng.uniform());
        let read = q.map(|angle| quantised(angle, ENCODER_STEP));
        let [of_true, of_read] = &mut filters;
        let off = of_read.update(&read, h).dq - of_true.update(&q, h).dq;
        squares += off.component_mul(&off);
    }
    let deviation = squares.map(|sum| f64::sqrt(sum / f64::from(cycles)));
    let [_, reckoned] = link.rounding;
    // 140,000 draws: 0.3 % at one standard deviation.
    let ratio = deviation.component_div(&reckoned).mean();
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}
