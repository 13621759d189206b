//! A position is no orientation.

use controller_core::Target;

fn main() {
    let _: Target<f64> = Target::orientation([0.5, 0.0, 0.4]);
}
