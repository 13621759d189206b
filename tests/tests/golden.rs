//! The core's kinematics and dynamics against Pinocchio at 200 states, both
//! precisions.

use arms::LWR_IV;
use controller_core::LinkPoint;
use controller_core::arm::ArmModel;
use controller_core::joint::{JointState, JointVector};
use controller_core::real::Real;
use stratum_tests::golden::{Golden, GoldenArm, Worst};
use stratum_tests::{evaluate, relative};

/// Errors relative to the largest entry. The sums behind an entry have about a
/// hundred terms of its size: 100 units of rounding of the precision.
fn check<T: Real>(arm: &GoldenArm, epsilon: f64) {
    let model = ArmModel::<T>::new(&arm.arm.parameters()).expect("golden tables are valid");
    let tolerance = 100.0 * epsilon;
    let mut mass_matrix = Worst::new("mass matrix");
    let mut coriolis_matrix = Worst::new("Coriolis matrix");
    let mut coriolis = Worst::new("C dq");
    let mut gravity = Worst::new("gravity");
    let mut torque = Worst::new("M ddq + C dq + g");
    let mut points = Worst::new("points, J and dJ/dt");
    for golden in &arm.states {
        let state = JointState {
            q: JointVector::from(golden.q.map(T::from_f64)),
            dq: JointVector::from(golden.dq.map(T::from_f64)),
        };
        let (kinematics, dynamics) = evaluate(&model, &state);
        let wide = dynamics.mass_matrix.map(Real::to_f64);
        mass_matrix.add(relative(&wide, &golden.mass_matrix(), 1e-3));
        if let Some(expected) = &golden.coriolis_matrix {
            let rows = dynamics.coriolis_matrix.transpose().map(Real::to_f64);
            coriolis_matrix.add(relative(&rows, expected.as_flattened(), 1.0));
        }
        // Pinocchio gives C dq + g and g: their difference has the rounding of g.
        let weight = golden.gravity.iter().fold(1.0f64, |a, g| a.max(g.abs()));
        coriolis.add(relative(
            &dynamics.coriolis.map(Real::to_f64),
            &golden.coriolis,
            weight,
        ));
        gravity.add(relative(
            &dynamics.gravity.map(Real::to_f64),
            &golden.gravity,
            1.0,
        ));
        let ddq = JointVector::from(golden.ddq_in.map(T::from_f64));
        let inverse = dynamics.mass_matrix * ddq + dynamics.coriolis + dynamics.gravity;
        torque.add(relative(&inverse.map(Real::to_f64), &golden.rnea, 1.0));

        for point in LWR_IV.points {
            let Some(expected) = golden.points.get(point.name) else {
                continue;
            };
            let LinkPoint { link, offset } = point.point;
            let motion = kinematics.point(link, &offset.map(T::from_f64).into());
            let rows = kinematics.point_jacobian(link, &motion);
            points.add(relative(
                &motion.x.map(Real::to_f64),
                &expected.position,
                1.0,
            ));
            for axis in 0..3 {
                points.add(relative(
                    &rows.jacobian[axis].map(Real::to_f64),
                    &expected.jacobian[axis],
                    1.0,
                ));
                points.add(relative(
                    &rows.jacobian_dot[axis].map(Real::to_f64),
                    &expected.jacobian_dot[axis],
                    1.0,
                ));
            }
        }
    }
    for worst in [
        mass_matrix,
        coriolis_matrix,
        coriolis,
        gravity,
        torque,
        points,
    ] {
        worst.within(tolerance);
    }
}

#[test]
fn the_core_agrees_with_pinocchio_in_double_precision() {
    let golden = Golden::read();
    assert_eq!(golden.nominal.states.len(), 200);
    check::<f64>(&golden.nominal, f64::EPSILON);
    check::<f64>(&golden.mismatched, f64::EPSILON);
}

#[test]
fn the_core_agrees_with_pinocchio_in_single_precision() {
    let golden = Golden::read();
    check::<f32>(&golden.nominal, f32::EPSILON.into());
    check::<f32>(&golden.mismatched, f32::EPSILON.into());
}
