//! There is no motion that is meant unless one is given.

use controller_core::Target;

fn main() {
    let _ = Target::<f64>::default();
}
