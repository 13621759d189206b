//! What the robot says: its measurement datagram.

use controller_core::joint::{DOF, JointMatrix};
use fri::measurement::{Drives, Statistics};
use fri::{Frame, Header, Measurement, UserData};
use nalgebra::Matrix3;

use super::krc::Krc;
use super::order::wire;
use super::rating::Rating;
use crate::robot::control_box::Surroundings;
use crate::robot::model::{self, Jacobian, RobotModel};

/// Power bits with the drives on: one per joint.
const POWER: u16 = 0x7F;

/// The measurement of a cycle, by a controller on a link that is rated so.
pub fn measurement(
    krc: &Krc,
    rating: &Rating,
    around: &Surroundings<'_>,
    header: Header,
) -> Measurement {
    let (seen, model) = (around.seen, around.model);
    let q = &seen.measured.q;
    let (own, offset) = krc.positions();
    let jacobian = model.jacobian(q);
    let wrench = RobotModel::flange_wrench(&jacobian, &seen.contact);
    let frame = model.frame(q);
    let (before, total) = (model.frame(&own), model.frame(&(own + offset)));
    let averages = rating.statistics();
    let mut user = UserData::default();
    user.int[1] = krc.answer_int();
    Measurement {
        header,
        user,
        timestamp_s: (around.cycle as f64 * around.cycle_s) as f32,
        state: krc.state(),
        quality: rating.quality(),
        period_s: around.cycle_s as f32,
        command_period_s: around.cycle_s as f32,
        safety_limits: 1.0,
        statistics: Statistics {
            answer_rate: averages.answer_rate as f32,
            latency_s: averages.latency_s as f32,
            jitter_s: averages.jitter_s as f32,
            miss_rate: averages.miss_rate as f32,
            missed: rating.missed() as u32,
        },
        drives: Drives {
            power: if around.drives_on { POWER } else { 0 },
            control: krc.scheme(),
            error: 0,
            warning: 0,
            temperature: [0.0; DOF],
        },
        joint_position: wire(q),
        frame: narrow(&frame),
        commanded_position: wire(&own),
        fri_offset: wire(&offset),
        commanded_frame: narrow(&before),
        fri_frame_offset: narrow(&relative(&before, &total)),
        // Of the cycle before: the sensors know nothing of what comes.
        joint_torque: wire(around.applied.unwrap_or(&seen.gravity)),
        external_torque: wire(&seen.contact),
        external_wrench: std::array::from_fn(|i| wrench[i] as f32),
        jacobian: rows_of_jacobian(&jacobian),
        mass_matrix: rows_of_matrix(&seen.mass_matrix),
        gravity: wire(&seen.gravity),
    }
}

fn narrow(frame: &model::Frame) -> Frame {
    frame.map(|value| value as f32)
}

/// The frame which, after `first`, gives `second`.
fn relative(first: &model::Frame, second: &model::Frame) -> model::Frame {
    let parts = |f: &model::Frame| {
        let rotation = Matrix3::new(f[0], f[1], f[2], f[4], f[5], f[6], f[8], f[9], f[10]);
        (rotation, nalgebra::Vector3::new(f[3], f[7], f[11]))
    };
    let ((r1, p1), (r2, p2)) = (parts(first), parts(second));
    let (r, p) = (r1.transpose() * r2, r1.transpose() * (p2 - p1));
    std::array::from_fn(|i| {
        if i % 4 == 3 {
            p[i / 4]
        } else {
            r[(i / 4, i % 4)]
        }
    })
}

fn rows_of_jacobian(jacobian: &Jacobian) -> [[f32; DOF]; 6] {
    std::array::from_fn(|row| std::array::from_fn(|column| jacobian[(row, column)] as f32))
}

fn rows_of_matrix(matrix: &JointMatrix<f64>) -> [[f32; DOF]; DOF] {
    std::array::from_fn(|row| std::array::from_fn(|column| matrix[(row, column)] as f32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller_core::joint::JointVector;

    #[test]
    fn a_frame_after_another_gives_the_second() {
        let model = RobotModel::new(&arms::LWR_IV);
        let first = model.frame(&JointVector::repeat(0.3));
        let second = model.frame(&JointVector::repeat(0.4));
        let step = relative(&first, &second);
        let x: f64 = (0..3).map(|k| first[k] * step[4 * k + 3]).sum::<f64>() + first[3];
        assert!((x - second[3]).abs() < 1e-12);
        let same = relative(&first, &first);
        assert!((same[0] - 1.0).abs() < 1e-12 && same[3].abs() < 1e-12);
    }
}
