//! More targets than a controller can have levels.

use controller_core::{Reference, Target};

fn main() {
    let _ = Reference::new([Target::<f64>::Hold; 8], [0.0; 7]);
}
