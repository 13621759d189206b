//! Parameter tables of 7-joint arms, one file per arm: constants for
//! [`controller_core`]. Each file says where its numbers come from, of what kind they are,
//! and what is not known. Beside its table an arm may have a [`Realistic`]: what is known of how a
//! true one departs from it.

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
pub mod realistic;

pub use fr3::{FR3, FR3_REALISTIC};
pub use gen3::GEN3;
pub use iiwa_7::IIWA_7;
pub use iiwa_14::{IIWA_14, IIWA_14_REALISTIC};
pub use lwr_iv::{LWR_IV, LWR_IV_DAMPING, LWR_IV_FLANGE, LWR_IV_REALISTIC, LWR_IV_STIFFNESS};
pub use openarm_v10::{OPENARM_V10_LEFT, OPENARM_V10_REALISTIC, OPENARM_V10_RIGHT};
pub use openarm_v20::{OPENARM_V20_LEFT, OPENARM_V20_REALISTIC, OPENARM_V20_RIGHT};
pub use panda::PANDA;
pub use panda_identified::PANDA_IDENTIFIED;
pub use realistic::Realistic;

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

/// What is known of how a true arm of this name departs from its table; none where nothing is,
/// and for any other name.
#[must_use]
pub fn realistic_by_name(name: &str) -> Option<&'static Realistic> {
    match name {
        "lwr_iv" => Some(&LWR_IV_REALISTIC),
        "iiwa_14" => Some(&IIWA_14_REALISTIC),
        "fr3" => Some(&FR3_REALISTIC),
        "openarm_v10_left" | "openarm_v10_right" => Some(&OPENARM_V10_REALISTIC),
        "openarm_v20_left" | "openarm_v20_right" => Some(&OPENARM_V20_REALISTIC),
        _ => None,
    }
}
