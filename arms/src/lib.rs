//! Parameter tables of 7-joint arms, one file per arm: constants for
//! [`controller_core`]. Each file says where its numbers come from, of what kind they are,
//! and what is not known.

#![no_std]

pub mod fr3;
pub mod gen3;
pub mod iiwa_14;
pub mod iiwa_7;
pub mod lwr_iv;
mod openarm;
pub mod openarm_v10;
pub mod openarm_v20;
pub mod panda;
pub mod panda_identified;

pub use fr3::FR3;
pub use gen3::GEN3;
pub use iiwa_7::IIWA_7;
pub use iiwa_14::IIWA_14;
pub use lwr_iv::{LWR_IV, LWR_IV_DAMPING, LWR_IV_FLANGE, LWR_IV_STIFFNESS};
pub use openarm_v10::{OPENARM_V10_LEFT, OPENARM_V10_RIGHT};
pub use openarm_v20::{OPENARM_V20_LEFT, OPENARM_V20_RIGHT};
pub use panda::PANDA;
pub use panda_identified::PANDA_IDENTIFIED;

use controller_core::arm::ArmParameters;

/// Every arm that has a table here.
pub const ALL: [&ArmParameters; 11] = [
    &LWR_IV,
    &IIWA_7,
    &IIWA_14,
    &PANDA,
    &PANDA_IDENTIFIED,
    &FR3,
    &GEN3,
    &OPENARM_V10_LEFT,
    &OPENARM_V10_RIGHT,
    &OPENARM_V20_LEFT,
    &OPENARM_V20_RIGHT,
];

/// The arm with this name; none for any other. The names are those of [`ALL`].
#[must_use]
pub fn by_name(name: &str) -> Option<&'static ArmParameters> {
    ALL.into_iter().find(|arm| arm.name == name)
}
