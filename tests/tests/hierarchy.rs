//! The core's factorisation and law against the paper's explicit formulas, on
//! random states of every split of 1 to 7 rows. Only quantities that do not
//! depend on the choice of a basis are compared directly.

use controller_core::cycle::{Data, Input};
use controller_core::joint::{JointMatrix, JointState, JointVector};
use controller_core::law::hierarchy::Hierarchy;
use controller_core::law::null_space::Posture;
use controller_core::linalg::Cholesky;
use controller_core::{Measurement, Reference, TaskSet};
use stratum_tests::controller;
use stratum_tests::golden::Worst;
use stratum_tests::oracle::matrix::Matrix;
use stratum_tests::oracle::sample::{SPLITS, Sample, Spec, Wish, configuration};
use stratum_tests::oracle::{Oracle, Variant};
use stratum_tests::random::States;

/// States per split.
const STATES: usize = 300;

/// Both ways lose what the conditioning takes: the explicit formulas invert
/// J M^-1 J^T and M. Errors are divided by [`Oracle::conditioning`]; what is left is
/// rounding, 1e-16, times a few for the length of the products.
const TOLERANCE: f64 = 1e-15;

/// |a - b| relative to the largest entry of b.
fn distance(core: &Matrix, oracle: &Matrix) -> f64 {
    (core - oracle).amax() / oracle.amax().max(1e-3)
}

fn joint(vector: &JointVector<f64>) -> Matrix {
    Matrix::of(vector)
}

fn every_split(seed: u64, mut check: impl FnMut(&str, &Sample, &Oracle, f64)) {
    for (index, (name, split)) in SPLITS.iter().enumerate() {
        let controller = controller(&configuration(split));
        let mut random = States::new(seed + index as u64);
        let (mut checked, mut singular) = (0, 0);
        while checked < STATES {
            let joints = random.state();
            let wish = Wish::random(&controller, &joints, &mut random);
            let sample = Sample::new(&controller, joints, &wish);
            // The printed formulas know no rank rule.
            if sample.data.hierarchy.deficient().any() {
                singular += 1;
                assert!(
                    singular <= STATES / 100,
                    "{name}: {singular} singular states"
                );
                continue;
            }
            let oracle = Oracle::new(sample.terms());
            let conditioning = oracle.conditioning();
            check(name, &sample, &oracle, conditioning);
            checked += 1;
        }
    }
}

fn rows(split: &[Spec]) -> usize {
    split.iter().map(|(_, axes)| axes.len()).sum()
}

#[test]
fn the_splits_cover_every_number_of_rows_and_are_levels_of_the_core() {
    let mut counts: Vec<usize> = SPLITS.iter().map(|(_, split)| rows(split)).collect();
    counts.sort_unstable();
    counts.dedup();
    assert_eq!(counts, [1, 2, 3, 4, 5, 6, 7]);
    every_split(100, |name, sample, oracle, _| {
        let hierarchy = &sample.data.hierarchy;
        let lengths: Vec<String> = (0..hierarchy.levels())
            .map(|level| hierarchy.level_range(level).len().to_string())
            .collect();
        assert_eq!(lengths.join("+"), name);
        assert_eq!(oracle.levels.len(), lengths.len());
        assert!(hierarchy.level_range(lengths.len()).is_empty());
    });
}

/// Level by level. Covers eq (17), eq (18), eq (19), eq (21).
#[test]
fn projected_jacobians_inverses_and_inertias_are_the_printed_ones() {
    let mut worst = [
        Worst::new("Jbar_i"),
        Worst::new("Jbar_i^#"),
        Worst::new("Lambda_i"),
    ];
    every_split(200, |_, sample, oracle, conditioning| {
        let (hierarchy, cholesky) = (&sample.data.hierarchy, &sample.data.dynamics.cholesky);
        for (level, expected) in oracle.levels.iter().enumerate() {
            let jbar = Matrix::from_rows(&hierarchy.jbar(level, cholesky));
            let pinv = Matrix::from_rows(&hierarchy.jbar_pinv(level, cholesky)).t();
            let inertia = hierarchy.task_inertia(level);
            let size = expected.lambda.rows();
            let lambda = Matrix::from_fn(size, size, |i, j| inertia[(i, j)]);
            let padding = inertia.iter().filter(|x| **x != 0.0).count();
            assert!(padding <= size * size, "zeros behind the block");
            worst[0].add(distance(&jbar, &expected.jbar) / conditioning);
            worst[1].add(distance(&pinv, &expected.jbar_pinv) / conditioning);
            worst[2].add(distance(&lambda, &expected.lambda) / conditioning);
        }
    });
    for worst in worst {
        worst.within(TOLERANCE);
    }
}

/// Z of eq (20) and the core's basis span the same space: the projectors and the
/// null-space motion agree, and each basis is a combination of the other. Z^T v
/// takes Jbar_l of eq (21).
#[test]
fn the_null_space_is_that_of_the_printed_basis() {
    let mut worst = [
        Worst::new("N"),
        Worst::new("Z^T v"),
        Worst::new("Z in the span of (20)"),
        Worst::new("Z M Z^T - 1"),
    ];
    every_split(300, |_, sample, oracle, conditioning| {
        let (hierarchy, cholesky) = (&sample.data.hierarchy, &sample.data.dynamics.cholesky);
        let projector = Matrix::of::<7, 7>(&hierarchy.null_projector(cholesky));
        let basis = Matrix::from_rows(&hierarchy.null_basis(cholesky));
        let velocity = hierarchy.null_velocity(cholesky, &sample.data.joints.dq);
        let velocity = Matrix::column(&velocity);
        assert_eq!(basis.rows(), 7 - hierarchy.count());
        assert_eq!(velocity.rows(), basis.rows());
        let expected = oracle.null_projector();
        worst[0].add((&projector - &expected).amax() / conditioning);
        let motion = &oracle.basis.z.t() * oracle.null_velocity();
        worst[1].add(distance(&(basis.t() * &velocity), &motion) / conditioning);
        // Z = T Z_(20) with T = Z Jbar_l^T.
        let combination = &basis * oracle.null.jbar.t() * &oracle.basis.z;
        worst[2].add(distance(&basis, &combination) / conditioning);
        let unit = &basis * &oracle.terms.mass * &basis.t();
        worst[3].add((unit - Matrix::identity(basis.rows())).amax() / conditioning);
    });
    for worst in worst {
        worst.within(TOLERANCE);
    }
}

/// Eq (48) and the momenta of the tasks.
#[test]
fn the_motion_splits_as_printed_with_the_coupling() {
    let mut worst = [Worst::new("w"), Worst::new("n"), Worst::new("F")];
    every_split(400, |_, sample, oracle, conditioning| {
        let motion = &sample.data.motion;
        let dq = oracle.terms.dq.amax();
        let w = oracle.task_velocity();
        let n = &oracle.basis.z.t() * oracle.null_velocity();
        worst[0].add((joint(&motion.task_velocity) - w).amax() / dq / conditioning);
        worst[1].add((joint(&motion.null_velocity) - n).amax() / dq / conditioning);
        // F = (J M^-1 J^T)^-1 J dq of the plain stack.
        let (jacobian, _) = oracle.terms.stacked(oracle.levels.len());
        let inertia = (&jacobian * &oracle.mass_inverse * &jacobian.t()).inverse();
        let expected = inertia * &jacobian * &oracle.terms.dq;
        let count = sample.data.hierarchy.count();
        let momentum = Matrix::column(&motion.task_momentum[..count]);
        worst[2].add(distance(&momentum, &expected) / conditioning);
        assert!(motion.task_momentum[count..].iter().all(|f| *f == 0.0));
    });
    for worst in worst {
        worst.within(TOLERANCE);
    }
}

/// Eq (34) with the task accelerations of eq (32), the coupling of eq (8) and
/// eq (33) with the plus is the core's law.
#[test]
fn the_torque_is_that_of_the_corrected_printed_law() {
    let mut worst = Worst::new("torque");
    let mut plain = Worst::new("torque, not divided by the conditioning, below 1e6");
    every_split(500, |_, sample, oracle, conditioning| {
        let expected = oracle.torque(Variant::EXACT);
        let error = distance(&joint(&sample.data.demand.0), &expected);
        worst.add(error / conditioning);
        if conditioning < 1e6 {
            plain.add(error);
        }
    });
    worst.within(TOLERANCE);
    // Rounding times 1e6.
    plain.within(1e-10);
}

/// What q_d moves by in one second at this state: the second of two cycles that see
/// the same motion, by the trapezoidal rule.
fn posture_rate(split: &str, posture: Posture, joints: &JointState<f64>) -> Matrix {
    let (_, split) = SPLITS[SPLITS.iter().position(|(name, _)| *name == split).unwrap()];
    let mut config = configuration(split);
    config.null_space.posture = posture;
    let controller = controller(&config);
    let measurement = Measurement {
        q: joints.q,
        dq: joints.dq,
        interval_s: 1.0,
    };
    let input = Input {
        measurement: &measurement,
        reference: &Reference::hold(controller.level_count(), JointVector::zeros()),
    };
    let mut data = Data::new();
    controller.evaluate(&input, &mut data);
    assert_eq!(data.posture.amax(), 0.0, "the first q_d is the reference's");
    controller.evaluate(&input, &mut data);
    joint(&data.posture)
}

/// dq_d of eq (51): with the coupling it is w, as printed it is the sum of
/// Jbar_i^# dx_i.
#[test]
fn both_rates_of_the_integrated_posture_are_as_defined() {
    let mut worst = [Worst::new("coupled"), Worst::new("as printed")];
    every_split(600, |name, sample, oracle, conditioning| {
        let rate = |posture| posture_rate(name, posture, &sample.data.joints);
        let dq = &oracle.terms.dq;
        let levels = oracle.levels.iter().zip(&oracle.terms.levels);
        let printed = levels.fold(Matrix::zeros(7, 1), |sum, (level, terms)| {
            sum + &level.jbar_pinv * &terms.jacobian * dq
        });
        let coupled = rate(Posture::IntegralCoupled);
        worst[0].add(distance(&coupled, &oracle.task_velocity()) / conditioning);
        worst[1].add(distance(&rate(Posture::IntegralUncoupled), &printed) / conditioning);
        assert_eq!(rate(Posture::Constant).amax(), 0.0);
    });
    for worst in worst {
        worst.within(TOLERANCE);
    }
}

/// At full rank priorities do not show: the order of the levels leaves the
/// torque as it is.
#[test]
fn the_order_of_the_levels_does_not_change_the_torque_at_full_rank() {
    let mut worst = Worst::new("torque of the reversed order");
    for (index, (_, split)) in SPLITS.iter().enumerate() {
        let mut config = configuration(split);
        let forward = controller(&config);
        let tasks: Vec<_> = config.tasks.tasks().iter().rev().copied().collect();
        config.tasks = TaskSet::new(&tasks).expect("the same tasks");
        let backward = controller(&config);
        let mut random = States::new(700 + index as u64);
        for _ in 0..STATES {
            let joints = random.state();
            let wish = Wish::random(&forward, &joints, &mut random);
            let sample = Sample::new(&forward, joints, &wish);
            if sample.data.hierarchy.deficient().any() {
                continue;
            }
            let mut turned = wish.clone();
            turned.reference.targets_mut().reverse();
            let other = Sample::new(&backward, joints, &turned);
            assert!(!other.data.hierarchy.deficient().any());
            let conditioning = Oracle::new(sample.terms()).conditioning();
            let torques = [&other, &sample].map(|sample| joint(&sample.data.demand.0));
            let error = distance(&torques[0], &torques[1]);
            worst.add(error / conditioning);
        }
    }
    worst.within(TOLERANCE);
}

/// [`controller_core::linalg::Cholesky::identity`] instead of the mass matrix
/// gives the Moore-Penrose hierarchy.
#[test]
fn without_weighting_the_inverse_is_that_of_moore_and_penrose() {
    let mut worst = Worst::new("J^#");
    every_split(800, |name, sample, oracle, conditioning| {
        if name != "3" {
            return;
        }
        let identity = Cholesky::identity();
        let mut hierarchy = Hierarchy::new();
        hierarchy.update(&sample.data.rows, &identity);
        let pinv = Matrix::from_rows(&hierarchy.jbar_pinv(0, &identity)).t();
        let j = &oracle.terms.levels[0].jacobian;
        let expected = j.t() * (j * &j.t()).inverse();
        worst.add(distance(&pinv, &expected) / conditioning);
        assert_eq!(identity.factor(), &JointMatrix::identity());
    });
    worst.within(TOLERANCE);
}
