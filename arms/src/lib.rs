//! Parameter tables of 7-joint arms, one file per arm: constants for
//! [`controller_core`]. Each file says where its numbers come from, of what kind they are,
//! and what is not known.

#![no_std]

pub mod lwr_iv;

pub use lwr_iv::{LWR_IV, LWR_IV_DAMPING, LWR_IV_FLANGE, LWR_IV_STIFFNESS};

use controller_core::arm::ArmParameters;

/// Every arm that has a table here.
pub const ALL: [&ArmParameters; 1] = [&LWR_IV];

/// The arm with this name; none for any other. The names are those of [`ALL`].
#[must_use]
pub fn by_name(name: &str) -> Option<&'static ArmParameters> {
    ALL.into_iter().find(|arm| arm.name == name)
}
