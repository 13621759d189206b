//! Joints and frames, as both datagrams have them.

/// Joints of the arm.
pub const DOF: usize = 7;

/// A frame: three rows of a homogenous matrix, r11 r12 r13 px r21 .. pz, \[m\].
pub type Frame = [f32; 12];

/// Position of a frame \[m\].
#[must_use]
pub fn position(frame: &Frame) -> [f32; 3] {
    let [_, _, _, x, _, _, _, y, _, _, _, z] = *frame;
    [x, y, z]
}
