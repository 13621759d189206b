//! The way to encoders and drives, which only the board's maker knows.

use core::hint::black_box;

use controller_core::joint::{JointState, JointVector};

/// Encoders and drives of the seven joints.
pub trait Joints {
    /// Positions \[rad\] and speeds \[rad/s\] at this instant; none where the bus has
    /// brought nothing new, which turns the drives off. Where encoders give no speed,
    /// `controller_core::cycle::velocity` estimates it.
    fn measure(&mut self) -> Option<JointState<f64>>;

    /// Torque \[Nm\] to apply until the next cycle, within the arm's limits; zero
    /// while the drives are off. For a robot that adds gravity itself: less `gravity`.
    fn send(&mut self, torque: &JointVector<f64>, gravity: &JointVector<f64>);
}

/// No bus yet: nothing is measured, so that the drives stay off.
#[derive(Clone, Copy, Debug)]
pub struct NotConnected;

impl Joints for NotConnected {
    fn measure(&mut self) -> Option<JointState<f64>> {
        // Unknown to the compiler, which would leave the whole cycle out.
        black_box(None)
    }

    fn send(&mut self, _: &JointVector<f64>, _: &JointVector<f64>) {}
}
