//! The projection alone, against the conditions that make a point the nearest one: with the
//! compliance T by a dense route of its own, and wishes far beyond the bounds.

use arms::LWR_IV;
use controller_core::cycle::stages::StageName;
use controller_core::cycle::{Data, Input};
use controller_core::joint::{DOF, JointMatrix, JointState, JointVector};
use controller_core::ranges::PIVOTS;
use controller_core::real::Real;
use controller_core::task::LevelLimits;
use controller_core::{Axes, Controller, Measurement, Task};
use nalgebra::SMatrix;
use stratum_tests::config::{FLANGE, REFERENCE_GAINS, WRIST, with_tasks};
use stratum_tests::random::States;

fn controller<T: Real>() -> Controller<T> {
    let flange = Task::position(FLANGE, Axes::XYZ, REFERENCE_GAINS);
    let wrist = Task::position(WRIST, Axes::XY, REFERENCE_GAINS);
    Controller::new(&LWR_IV, &with_tasks(&[flange, wrist])).expect("valid")
}

/// Results up to the bounds.
fn prepared<T: Real>(controller: &Controller<T>, joints: &JointState<f64>) -> Data<T> {
    let measurement = Measurement {
        q: joints.q.map(T::from_f64),
        dq: joints.dq.map(T::from_f64),
        interval_s: T::from_f64(0.002),
    };
    let reference = controller.rest_reference(&measurement.q);
    let mut data = Data::new();
    let input = Input {
        measurement: &measurement,
        reference: &reference,
    };
    controller.evaluate_until(StageName::Bounds, &input, &mut data);
    data
}

/// Runs the projection on a wish of its own.
fn project<T: Real>(controller: &Controller<T>, data: &mut Data<T>, wish: &JointVector<f64>) {
    data.wish.acceleration = wish.map(T::from_f64);
    let (measurement, reference) = (
        Measurement {
            q: data.joints.q,
            dq: data.joints.dq,
            interval_s: T::from_f64(0.002),
        },
        controller.rest_reference(&data.joints.q),
    );
    let input = Input {
        measurement: &measurement,
        reference: &reference,
    };
    let (_, stage) = Controller::STAGES
        .into_iter()
        .find(|(name, _)| *name == StageName::Projection)
        .expect("a stage");
    stage(controller, &input, data);
}

/// What a whitened vector has left below the levels so far, and how it gives.
struct Levels {
    left: JointMatrix<f64>,
    gives: JointMatrix<f64>,
}

impl Levels {
    /// Adds a level by its whitened rows.
    fn add<const ROWS: usize>(&mut self, rows: SMatrix<f64, ROWS, DOF>, limits: &LevelLimits)
    where
        nalgebra::Const<ROWS>: nalgebra::DimSub<nalgebra::U1>,
        nalgebra::DefaultAllocator:
            nalgebra::allocator::Allocator<nalgebra::DimDiff<nalgebra::Const<ROWS>, nalgebra::U1>>,
    {
        let rest = rows * self.left;
        let mobility = rest * rows.transpose();
        let eigen = ((mobility + mobility.transpose()) * 0.5).symmetric_eigen();
        let along = eigen.eigenvectors.transpose() * rest;
        for (k, &z) in eigen.eigenvalues.iter().enumerate() {
            let (zr, zw) = (limits.release_mobility, limits.stiff_mobility);
            let z = z.max(0.0);
            let keep = if z < zr { (2.0 - z / zr) / zr } else { 1.0 / z };
            let held = z * z / (z.powi(3) + zw.powi(3));
            let square = along.row(k).transpose() * along.row(k);
            self.left -= square * keep;
            self.gives -= square * held;
        }
    }
}

/// T of levels that were not disturbed before.
fn compliance(data: &Data<f64>) -> JointMatrix<f64> {
    let factor = data.dynamics.mass_matrix.cholesky().expect("positive").l();
    let inverse = factor.try_inverse().expect("regular");
    let row = |k: usize| inverse * data.rows.jacobian[k];
    let mut levels = Levels {
        left: JointMatrix::identity(),
        gives: JointMatrix::identity(),
    };
    let flange = SMatrix::<f64, 3, DOF>::from_fn(|k, j| row(k)[j]);
    levels.add(flange, &LevelLimits::FIRST);
    let wrist = SMatrix::<f64, 2, DOF>::from_fn(|k, j| row(3 + k)[j]);
    levels.add(wrist, &LevelLimits::BELOW);
    inverse.transpose() * levels.gives * inverse
}

/// How far a point is from being the nearest to a wish: the largest force T^-1 (a - a*) that no
/// bound takes up, as a share of the largest that the wish is worth.
fn residual(
    compliance: &JointMatrix<f64>,
    wish: &JointVector<f64>,
    point: &JointVector<f64>,
    bounds: [&JointVector<f64>; 2],
) -> f64 {
    let stiff = compliance.cholesky().expect("positive");
    let force = stiff.solve(&(point - wish));
    let scale = stiff.solve(wish).amax().max(1.0);
    let [least, greatest] = bounds;
    let mut largest = 0.0f64;
    for i in 0..DOF {
        let (at_least, at_greatest) = (point[i] <= least[i], point[i] >= greatest[i]);
        let free = match (at_least, at_greatest) {
            (true, true) => 0.0,
            (true, false) => force[i].min(0.0),
            (false, true) => force[i].max(0.0),
            (false, false) => force[i],
        };
        largest = largest.max(free.abs());
    }
    largest / scale
}

/// Largest wish and largest bound of the joints \[rad/s2\].
const ALPHA: [f64; DOF] = [20.0, 20.0, 25.0, 25.0, 90.0, 90.0, 200.0];

/// One random problem, and what the precision T makes of it.
struct Problem<T: Real> {
    /// In double precision, up to the bounds.
    exact: Data<f64>,
    wish: JointVector<f64>,
    /// Up to the projection.
    data: Data<T>,
}

impl<T: Real> Problem<T> {
    fn point(&self) -> JointVector<f64> {
        self.data.projection.acceleration.map(T::to_f64)
    }
}

/// 20000 of them, with how many are unresolved; what `judge` says of the others, in order.
fn judged<T: Real>(mut judge: impl FnMut(Problem<T>) -> f64) -> (usize, Vec<f64>) {
    let (truth, own) = (controller::<f64>(), controller::<T>());
    let mut states = States::new(11);
    let mut pivots = [0; PIVOTS as usize + 1];
    let (mut unresolved, mut judged) = (0, Vec::new());
    for _ in 0..20_000 {
        let mut joints = states.state();
        joints.q *= 0.98;
        joints.dq *= 0.5;
        let mut exact = prepared(&truth, &joints);
        let mut data = prepared(&own, &joints);
        // Up to ten times what the bounds may be, often less.
        let size = 10f64.powf(0.75 * states.signed() + 0.25);
        let mut wish = states.vector().component_mul(&JointVector::from(ALPHA)) * size;
        for i in 0..DOF {
            wish[i] = T::from_f64(wish[i]).to_f64();
            // A fifth of the joints are nearly held.
            if states.signed() < -0.6 {
                let width = data.bounds.greatest[i] - data.bounds.least[i];
                let share = T::from_f64(0.5 + 0.5 * states.signed());
                data.bounds.greatest[i] = data.bounds.least[i] + width * share * share * share;
            }
        }
        exact.bounds.least = data.bounds.least.map(T::to_f64);
        exact.bounds.greatest = data.bounds.greatest.map(T::to_f64);
        project(&own, &mut data, &wish);
        pivots[usize::from(data.projection.pivots)] += 1;
        let problem = Problem { exact, wish, data };
        let (point, bounds) = (problem.point(), &problem.exact.bounds);
        for i in 0..DOF {
            assert!(point[i] >= bounds.least[i] && point[i] <= bounds.greatest[i]);
        }
        if problem.data.projection.unresolved {
            unresolved += 1;
        } else {
            judged.push(judge(problem));
        }
    }
    // Every number of pivots occurs, the most as well.
    assert!(pivots.iter().all(|&count| count > 0));
    judged.sort_by(f64::total_cmp);
    println!(
        "{unresolved} unresolved, the others half below {:.1e}, 99 % {:.1e}, all {:.1e}; pivots {pivots:?}",
        judged[judged.len() / 2],
        judged[judged.len() * 99 / 100],
        judged[judged.len() - 1],
    );
    (unresolved, judged)
}

#[test]
fn the_point_is_the_nearest_within_the_bounds() {
    let (unresolved, residuals) = judged::<f64>(|problem| {
        let Problem { exact, wish, .. } = &problem;
        let bounds = [&exact.bounds.least, &exact.bounds.greatest];
        residual(&compliance(exact), wish, &problem.point(), bounds)
    });
    // Rounding, 1e-16, times how much stiffer than the arm its easiest direction is, the cube of
    // z/zw: 2e6 for 5 /kg.
    assert!(residuals[residuals.len() - 1] <= 4e-10);
    assert!(unresolved <= 200);
}

#[test]
fn in_single_precision_it_costs_as_little_as_in_double_precision() {
    let truth = controller::<f64>();
    let (unresolved, excesses) = judged::<f32>(|problem| {
        let mut exact = problem.exact.clone();
        project(&truth, &mut exact, &problem.wish);
        let stiff = compliance(&exact).cholesky().expect("positive");
        let cost = |point: JointVector<f64>| {
            let away = point - problem.wish;
            away.dot(&stiff.solve(&away))
        };
        cost(problem.point()) / cost(exact.projection.acceleration) - 1.0
    });
    // The stiffness of most directions is known to some hundred times the rounding of 6e-8, that
    // of the easiest ones, 2e6 times that of the arm, to a tenth; the cost knows little of it.
    assert!(excesses[excesses.len() * 99 / 100] <= 2e-4);
    assert!(excesses[excesses.len() - 1] <= 1e-2);
    assert!(unresolved <= 200);
}

#[test]
fn whatever_is_wished_the_point_is_a_number_within_the_bounds() {
    let controller = controller::<f64>();
    let mut states = States::new(5);
    let odd = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        1e300,
        -1e300,
        1e-310,
        0.0,
    ];
    for turn in 0..2000 {
        let joints = states.state();
        let mut data = prepared(&controller, &joints);
        let mut wish = states.vector() * 100.0;
        for i in 0..DOF {
            let choice = ((states.signed() + 1.0) * 7.0) as usize;
            if let Some(&odd) = odd.get(choice) {
                wish[i] = odd;
            }
            let (least, greatest) = (&mut data.bounds.least, &mut data.bounds.greatest);
            match (turn + i) % 4 {
                0 => greatest[i] = least[i],
                1 => core::mem::swap(&mut greatest[i], &mut least[i]),
                _ => {}
            }
        }
        project(&controller, &mut data, &wish);
        for i in 0..DOF {
            let a = data.projection.acceleration[i];
            let (least, greatest) = (data.bounds.least[i], data.bounds.greatest[i]);
            assert!(
                a.is_finite() && a <= greatest,
                "{a}, allowed {least} to {greatest}"
            );
            assert!(a >= least || greatest < least);
        }
        assert!(data.projection.pivots <= PIVOTS);
    }
}
