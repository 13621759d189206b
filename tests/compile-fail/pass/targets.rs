//! Targets from arrays and vectors, at rest and moving, in either precision.

use controller_core::joint::Vector3;
use controller_core::task::orientation::{Quaternion, identity};
use controller_core::{Reference, Target};

fn main() {
    let x = Vector3::from([0.5, 0.0, 0.4]);
    let moving = Target::Position {
        x,
        dx: Vector3::from([0.1, 0.0, 0.0]),
        ddx: Vector3::from([0.0; 3]),
    };
    let turning = Target::Orientation {
        q: identity(),
        w: Vector3::from([0.0, 0.0, 0.1]),
        dw: Vector3::from([0.0; 3]),
    };
    let targets = [
        Target::position([0.5, 0.0, 0.4]),
        Target::position(x),
        moving,
        Target::orientation([1.0, 0.0, 0.0, 0.0]),
        Target::orientation(Quaternion::from([1.0, 0.0, 0.0, 0.0])),
        turning,
        Target::Hold,
    ];
    let reference = Reference::new(targets, [0.0; 7]);
    assert_eq!(reference.targets(), targets);

    let single: Target<f32> = Target::position([0.5, 0.0, 0.4]);
    assert_eq!(Target::position([0.5, 0.0, 0.4f32 as f64]).cast(), single);
}
