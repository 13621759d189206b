//! Properties that hold at every state, near singular ones included, and for
//! every input, however wrong. 2000 cases each from a fixed seed.

#[path = "properties/any_input.rs"]
mod any_input;

use std::cell::{Cell, RefCell};

use arms::LWR_IV;
use controller_core::Target;
use controller_core::cycle::Data;
use controller_core::joint::{DOF, JointState, JointVector};
use controller_core::law::control::{Control, TorqueDemand};
use controller_core::task::Tracked;
use controller_core::{Controller, ControllerConfig};
use hil_sim::plant::PlantModel;
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use stratum_tests::controller;
use stratum_tests::golden::Worst;
use stratum_tests::oracle::matrix::Matrix;
use stratum_tests::oracle::sample::{SPLITS, Sample, Wish, configuration};
use stratum_tests::oracle::{Oracle, Variant};
use stratum_tests::random::States;

const CASES: u32 = 2000;

fn for_all<S: Strategy>(strategy: S, test: impl Fn(S::Value)) {
    let config = ProptestConfig {
        cases: CASES,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(2018),
        ..ProptestConfig::default()
    };
    let outcome = TestRunner::new(config).run(&strategy, |value| {
        test(value);
        Ok(())
    });
    if let Err(error) = outcome {
        panic!("{error}");
    }
}

/// A split, a state, and a seed for the wish.
type Case = (usize, JointState<f64>, u64);

/// Random states of which the joints in `aligned` (by bits: q2 shoulder, q4
/// elbow, q6 wrist, all singular at zero) are 10^-`decades` rad from alignment.
fn states(
    aligned: impl Strategy<Value = u8>,
    decades: std::ops::Range<f64>,
) -> impl Strategy<Value = Case> {
    let unit = || prop::array::uniform7(-1.0..1.0f64);
    (
        0..SPLITS.len(),
        unit(),
        unit(),
        aligned,
        decades,
        any::<u64>(),
    )
        .prop_map(|(split, q, dq, aligned, decades, seed)| {
            let links = &LWR_IV.links;
            let mut state = JointState {
                q: JointVector::from_fn(|i, _| q[i] * links[i].position_range[1]),
                dq: JointVector::from_fn(|i, _| dq[i] * links[i].speed_limit),
            };
            for (bit, joint) in [1, 3, 5].into_iter().enumerate() {
                if aligned >> bit & 1 == 1 {
                    state.q[joint] = libm::exp10(-decades).copysign(q[joint]);
                }
            }
            (split, state, seed)
        })
}

/// Near every mixture of singularities, at distances of 1e-1 to 1e-7.
fn near_singular() -> impl Strategy<Value = Case> {
    states(0..8u8, 1.0..7.0)
}

/// At most one joint aligned, 1e-1 to 1e-2 rad away: states in which the printed
/// formulas, which square the conditioning, keep some digits.
fn regular() -> impl Strategy<Value = Case> {
    states(prop::sample::select(vec![0u8, 1, 2, 4]), 1.0..2.0)
}

/// The configuration of every split and its controller.
struct Splits(Vec<(ControllerConfig, Controller<f64>)>);

impl Splits {
    fn new() -> Self {
        let configs = SPLITS.map(|(_, split)| configuration(split));
        Self(
            configs
                .map(|config| (config.clone(), controller(&config)))
                .into(),
        )
    }

    fn wish(&self, (split, joints, seed): &Case) -> Wish {
        Wish::random(&self.0[*split].1, joints, &mut States::new(*seed))
    }

    fn sample(&self, case: &Case, residual: f64) -> Sample {
        let mut wish = self.wish(case);
        wish.residual *= residual;
        Sample::new(&self.0[case.0].1, case.1, &wish)
    }
}

/// Eq (22), eq (23), eq (24), eq (25): which products of Jbar and Jbar^# vanish, the
/// null space included. Each error is divided by the sizes
/// of its factors in whitened coordinates, times ||L|| ||L^-1|| = 126 for the
/// way back: rounding is left.
#[test]
fn levels_and_null_space_are_orthogonal_however_near_a_singularity() {
    let splits = Splits::new();
    let worst = [
        "Jbar_i Jbar_i^# - 1",
        "Jbar_i Jbar_j^#",
        "J_i Jbar_j^#, j > i",
        "J Z^T",
        "Jbar_l Jbar_i^#",
        "Z M Z^T - 1",
        "sum of Jbar^# Jbar - 1",
    ]
    .map(|name| RefCell::new(Worst::new(name)));
    let deficient = Cell::new(0);
    for_all(near_singular(), |case| {
        let Data {
            hierarchy,
            dynamics,
            rows,
            ..
        } = splits.sample(&case, 1.0).data;
        let cholesky = &dynamics.cholesky;
        let mass = Matrix::of(&dynamics.mass_matrix);
        let jacobian = Matrix::from_rows(&rows.jacobian[..rows.count()]);
        let z = Matrix::from_rows(&hierarchy.null_basis(cholesky));
        let null_map = &z * &mass;
        let whole = |level: usize| {
            hierarchy
                .level_range(level)
                .all(|row| !hierarchy.deficient().contains(row))
        };
        deficient.set(deficient.get() + u32::from(hierarchy.deficient().any()));
        let levels: Vec<_> = (0..hierarchy.levels())
            .map(|level| {
                let jbar = Matrix::from_rows(&hierarchy.jbar(level, cholesky));
                let pinv = Matrix::from_rows(&hierarchy.jbar_pinv(level, cholesky)).t();
                (jbar, pinv)
            })
            .collect();
        let size = |a: &Matrix, b: &Matrix| 126.0 * (a.amax() * b.amax()).max(1.0);
        for (i, (jbar, own)) in levels.iter().enumerate() {
            for (j, (_, pinv)) in levels.iter().enumerate() {
                let product = jbar * pinv;
                if i != j {
                    (worst[1].borrow_mut()).add(product.amax() / size(jbar, pinv));
                } else if whole(i) {
                    let unit = Matrix::identity(product.rows());
                    (worst[0].borrow_mut()).add((product - unit).amax() / size(jbar, pinv));
                }
                if j > i {
                    let range = hierarchy.level_range(i);
                    let seen = Matrix::from_rows(&rows.jacobian[range]) * pinv;
                    (worst[2].borrow_mut()).add(seen.amax() / size(&jacobian, pinv));
                }
            }
            (worst[4].borrow_mut()).add((&null_map * own).amax() / size(&null_map, own));
        }
        (worst[3].borrow_mut()).add((&jacobian * &z.t()).amax() / size(&jacobian, &z));
        let inertia = &null_map * &z.t() - Matrix::identity(z.rows());
        (worst[5].borrow_mut()).add(inertia.amax() / size(&null_map, &z));
        if !hierarchy.deficient().any() {
            let mut scale = size(&z, &null_map);
            let sum = levels.iter().fold(&z.t() * &null_map, |sum, (jbar, pinv)| {
                scale = scale.max(size(pinv, jbar));
                sum + pinv * jbar
            });
            (worst[6].borrow_mut()).add((sum - Matrix::identity(DOF)).amax() / scale);
        }
    });
    // Singular enough to be a test, regular enough for the sum to be one.
    let share = f64::from(deficient.get()) / f64::from(CASES);
    assert!((0.1..0.6).contains(&share), "{share}");
    for worst in worst {
        worst.into_inner().within(1e-15);
    }
}

/// Eq (19): N and the projectors of the tasks are idempotent, N is symmetric in
/// the metric of M, and no level sees what N leaves.
#[test]
fn the_projectors_project() {
    let splits = Splits::new();
    let worst =
        ["N N - N", "M N - (M N)^T", "J N", "w of n"].map(|name| RefCell::new(Worst::new(name)));
    for_all(near_singular(), |case| {
        let Data {
            hierarchy,
            dynamics,
            rows,
            motion,
            ..
        } = splits.sample(&case, 1.0).data;
        let n = Matrix::of::<7, 7>(&hierarchy.null_projector(&dynamics.cholesky));
        let mass = Matrix::of(&dynamics.mass_matrix);
        let jacobian = Matrix::from_rows(&rows.jacobian[..rows.count()]);
        // Entries of N reach ||L^-1|| ||L|| = 126.
        let size = 126.0 * n.amax().max(1.0);
        (worst[0].borrow_mut()).add((&n * &n - &n).amax() / size);
        let weighted = &mass * &n;
        (worst[1].borrow_mut()).add((&weighted - weighted.t()).amax() / size);
        (worst[2].borrow_mut()).add((&jacobian * &n).amax() / size);
        // The null-space part of dq has no task part.
        let null_velocity = Matrix::of(&motion.null_velocity);
        let left = &null_velocity - &n * &null_velocity;
        (worst[3].borrow_mut()).add(left.amax() / size / case.1.dq.amax().max(1e-3));
    });
    for worst in worst {
        // Rounding, a few times.
        worst.into_inner().within(1e-15);
    }
}

/// Eq (33), eq (34): with any basis T(t) Z of the null space the printed law gives
/// the same torque, and it is the core's. K_l,d = Z D Z^T is what makes it so.
/// The error is divided by the conditioning of what the formulas invert.
#[test]
fn the_torque_does_not_depend_on_the_basis() {
    let splits = Splits::new();
    let worst = RefCell::new(Worst::new("torque with another basis"));
    let skipped = Cell::new(0u32);
    for_all(regular(), |case| {
        let sample = splits.sample(&case, 1.0);
        if sample.data.hierarchy.deficient().any() {
            skipped.set(skipped.get() + 1);
            return;
        }
        let oracle = Oracle::new(sample.terms());
        let size = oracle.basis.z.rows();
        let mut random = States::new(case.2 ^ 1);
        let numbers: Vec<f64> = (0..2 * size * size).map(|_| random.signed()).collect();
        // Diagonally dominant, so well-conditioned; not orthogonal.
        let turn = Matrix::from_fn(size, size, |i, j| {
            numbers[i * size + j] / 8.0 + f64::from(u8::from(i == j))
        });
        let rate = Matrix::from_fn(size, size, |i, j| 3.0 * numbers[size * (size + i) + j]);
        let basis = oracle.basis.transformed(&turn, &rate);
        let other = Oracle::with_basis(oracle.terms.clone(), basis);
        let torque = Matrix::of(&sample.data.demand.0);
        let error = (other.torque(Variant::EXACT) - &torque).amax();
        (worst.borrow_mut()).add(error / torque.amax() / oracle.conditioning());
    });
    assert!(skipped.get() <= CASES / 20, "{}", skipped.get());
    worst.into_inner().within(1e-15);
}

/// The same near singularities, where only orthogonality is left to rely on: the
/// null-space torque through any rotated basis is that of the core.
#[test]
fn the_null_space_torque_is_that_of_any_rotated_basis() {
    let splits = Splits::new();
    let worst = RefCell::new(Worst::new("N^T f"));
    for_all(near_singular(), |case| {
        let data = splits.sample(&case, 0.0).data;
        let (dynamics, hierarchy) = (&data.dynamics, &data.hierarchy);
        let bias = Matrix::of(&(dynamics.coriolis + dynamics.gravity));
        let z = Matrix::from_rows(&hierarchy.null_basis(&dynamics.cholesky));
        let mut random = States::new(case.2 ^ 2);
        let numbers: Vec<f64> = (0..z.rows() * z.rows()).map(|_| random.signed()).collect();
        let turn = Matrix::from_fn(z.rows(), z.rows(), |i, j| {
            numbers[i * z.rows() + j] / 8.0 + f64::from(u8::from(i == j))
        });
        let z = turn * &z;
        let mass = Matrix::of(&dynamics.mass_matrix);
        let force = Matrix::of(&data.control.null_force);
        let coordinates = (&z * &mass * &z.t()).inverse() * (&z * &force);
        let expected = &mass * &z.t() * coordinates + &bias;
        let resting = Control {
            task_acceleration: JointVector::zeros(),
            ..data.control
        };
        let residual = data.residual();
        let demand = TorqueDemand::compensating(dynamics, hierarchy, &resting, residual).0;
        let error = (Matrix::of(&demand) - expected).amax();
        // L and L^-1 magnify by 126.
        (worst.borrow_mut()).add(error / (force.amax() + bias.amax()) / 126.0);
    });
    worst.into_inner().within(1e-15);
}

/// Eq (8), eq (12), eq (26): the plant, an independent algorithm, accelerates every
/// resolvable row exactly as commanded, whatever the rows above do, near
/// singularities too. Errors are relative to the largest joint acceleration:
/// rounding of sums of seven, magnified by ||L|| ||L^-1|| = 126.
#[test]
fn the_plant_accelerates_every_resolvable_row_as_commanded() {
    let (splits, plant) = (Splits::new(), PlantModel::new(&LWR_IV));
    let worst = RefCell::new(Worst::new("J ddq + (dJ/dt) dq - commanded"));
    let rows_checked = Cell::new(0);
    for_all(near_singular(), |case| {
        let Data {
            joints: JointState { q, dq },
            rows,
            hierarchy,
            demand,
            ..
        } = splits.sample(&case, 0.0).data;
        let ddq = plant.articulated_bodies(&q, &dq, &demand.0, &JointVector::zeros());
        for row in 0..rows.count() {
            if hierarchy.deficient().contains(row) {
                continue;
            }
            let achieved = rows.jacobian[row].dot(&ddq) + rows.bias[row];
            let error = (achieved - rows.commanded[row]).abs();
            (worst.borrow_mut()).add(error / (ddq.amax() + 1.0));
            rows_checked.set(rows_checked.get() + 1);
        }
    });
    assert!(rows_checked.get() > 4 * CASES);
    worst.into_inner().within(1e-13);
}

/// Eq (12) without any of the core's rows: velocities of the plant's points
/// along the motion, against the gains of the configuration axis by axis. The
/// error is divided by that of a central difference with a step of 1e-6 s:
/// rounding, 1e-14 m/s / 1e-6 s, and the step squared times the next derivative,
/// (ddq + dq^2)^2.
#[test]
fn the_plants_points_accelerate_as_the_gains_say() {
    const STEP: f64 = 1e-6;
    let (splits, plant) = (Splits::new(), PlantModel::new(&LWR_IV));
    let worst = RefCell::new(Worst::new("(ddx - (12)) / expected error"));
    for_all(regular(), |case| {
        let (config, wish) = (&splits.0[case.0].0, splits.wish(&case));
        let sample = splits.sample(&case, 0.0);
        if sample.data.hierarchy.deficient().any() {
            return;
        }
        let JointState { q, dq } = case.1;
        let ddq = plant.articulated_bodies(&q, &dq, &sample.data.demand.0, &JointVector::zeros());
        for (task, target) in config.tasks.tasks().iter().zip(wish.reference.targets()) {
            let (Tracked::Position(point), Target::Position { x, dx, ddx }) =
                (task.tracked, target)
            else {
                continue;
            };
            let at = |t: f64| {
                let state = JointState {
                    q: q + dq * t + ddq * (t * t / 2.0),
                    dq: dq + ddq * t,
                };
                plant.point(&state, point.link.number(), &point.offset.into())
            };
            let now = at(0.0);
            let achieved = (at(STEP).1 - at(-STEP).1) / (2.0 * STEP);
            for i in (0..3).filter(|&i| task.axes.contains(i)) {
                let controlled = (0..3).filter(|&j| task.axes.contains(j));
                let commanded = ddx[i]
                    + controlled
                        .map(|j| {
                            task.gains.damping[i][j] * (dx[j] - now.1[j])
                                + task.gains.stiffness[i][j] * (x[j] - now.0[j])
                        })
                        .sum::<f64>();
                let fourth = (ddq.amax() + dq.amax() * dq.amax()).powi(2);
                let expected = 1e-8 + STEP * STEP * fourth;
                (worst.borrow_mut()).add((achieved[i] - commanded).abs() / expected);
            }
        }
    });
    worst.into_inner().within(1.0);
}

/// Eq (33) with the plus, which is eq (39) while pushed: the plant's null-space
/// motion obeys
/// Lambda dv/dt + mu v + Z D Z^T v = Z (K_q q~ - tau_ext).
#[test]
fn the_plants_null_space_is_the_wanted_spring_and_damper() {
    let (splits, plant) = (Splits::new(), PlantModel::new(&LWR_IV));
    let worst = RefCell::new(Worst::new("null-space equation"));
    let skipped = Cell::new(0u32);
    for_all(regular(), |case| {
        let sample = splits.sample(&case, 1.0);
        if sample.data.hierarchy.deficient().any() {
            skipped.set(skipped.get() + 1);
            return;
        }
        let JointState { q, dq } = &sample.data.joints;
        let tau_ext = States::new(case.2 ^ 3).vector() * 10.0;
        let torque = sample.data.demand.0;
        let ddq = plant.articulated_bodies(q, dq, &(torque - tau_ext), &JointVector::zeros());
        let oracle = Oracle::new(sample.terms());
        let (null, terms) = (&oracle.null, &oracle.terms);
        let v_dot = &null.jbar * Matrix::of(&ddq) + &null.jbar_dot * &terms.dq;
        let pushed = &oracle.basis.z * Matrix::of(&tau_ext);
        let left = &null.lambda * &v_dot - oracle.null_momentum_rate(1.0) + &pushed;
        let size = terms.mass.amax() * ddq.amax() + torque.amax() + tau_ext.amax();
        (worst.borrow_mut()).add(left.amax() / size);
    });
    assert!(skipped.get() <= CASES / 20, "{}", skipped.get());
    // Rounding of the forces, a hundred terms.
    worst.into_inner().within(1e-13);
}
