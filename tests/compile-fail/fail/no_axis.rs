//! A task controls at least one axis.

use controller_core::Axes;

fn main() {
    let _ = Axes(0);
}
