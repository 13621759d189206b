//! A quaternion is no position.

use controller_core::Target;

fn main() {
    let _: Target<f64> = Target::position([1.0, 0.0, 0.0, 0.0]);
}
