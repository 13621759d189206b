//! Precisions do not mix.

use controller_core::{Controller, Measurement, Reference, State, Target};

fn step(controller: &Controller<f64>, state: &mut State<f64>, measurement: &Measurement<f64>) {
    let reference = Reference::new([Target::<f32>::Hold], [0.0; 7]);
    let _ = controller.step(state, measurement, &reference);
}

fn main() {}
