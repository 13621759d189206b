//! There is no motion that is meant unless one is given.

use controller_core::Reference;

fn main() {
    let _ = Reference::<f64>::default();
}
