//! Numbers of the caller in the precision of the library.

use controller_core::real::Real;

use crate::codes::{STRATUM_ERROR_NON_FINITE, StratumResult};

/// What the library computes in.
#[cfg(not(feature = "single"))]
pub type Scalar = f64;
/// What the library computes in.
#[cfg(feature = "single")]
pub type Scalar = f32;

/// Numbers that the library can compute with.
pub(crate) fn finite<const N: usize>(values: [f64; N]) -> Result<[Scalar; N], StratumResult> {
    let values = values.map(Scalar::from_f64);
    if values.iter().all(|value| value.finite()) {
        Ok(values)
    } else {
        Err(STRATUM_ERROR_NON_FINITE)
    }
}
