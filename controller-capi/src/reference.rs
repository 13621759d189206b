//! What a level should do, as C writes it.

use controller_core::Target;
use controller_core::fault::{ORIENTATION_CODE, POSITION_CODE};
use controller_core::joint::Vector3;
use controller_core::ranges::QUATERNION_NORMS;
use controller_core::real::Real;

use crate::codes::{STRATUM_ERROR_ORIENTATION, STRATUM_ERROR_TARGET, StratumResult};
use crate::constants::{
    STRATUM_TARGET_HOLD, STRATUM_TARGET_ORIENTATION, STRATUM_TARGET_POSITION, StratumTargetKind,
};
use crate::scalar::{Scalar, finite};

/// Desired motion of one level, base-plate axes. All of it 0 is a hold: a reference
/// that nobody has filled moves nothing.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StratumReference {
    /// Position, m.
    pub x: [f64; 3],
    /// Orientation quaternion w x y z, norm 0.5 to 2; not read for a position.
    pub orientation: [f64; 4],
    /// Velocity, m/s, or angular velocity, rad/s.
    pub dx: [f64; 3],
    /// Acceleration, m/s2, or angular acceleration, rad/s2.
    pub ddx: [f64; 3],
    /// STRATUM_TARGET_POSITION or STRATUM_TARGET_ORIENTATION, as the level's task; or
    /// STRATUM_TARGET_HOLD with 0 in all other fields.
    pub kind: StratumTargetKind,
    /// Always 0.
    pub reserved: u32,
}

/// sizeof(StratumReference).
pub const STRATUM_REFERENCE_SIZE: usize = 112;
const _: () = assert!(size_of::<StratumReference>() == STRATUM_REFERENCE_SIZE);

// StratumStatus gives the kind of a wrong target as its value.
const _: () = assert!(STRATUM_TARGET_POSITION as f64 == POSITION_CODE);
const _: () = assert!(STRATUM_TARGET_ORIENTATION as f64 == ORIENTATION_CODE);

impl StratumReference {
    /// The target, if there is one of this kind with such numbers.
    pub(crate) fn target(&self) -> Result<Target<Scalar>, StratumResult> {
        let [x, dx, ddx] = [finite(self.x)?, finite(self.dx)?, finite(self.ddx)?];
        let q = finite(self.orientation)?;
        if self.reserved != 0 {
            return Err(STRATUM_ERROR_TARGET);
        }
        match self.kind {
            // Numbers without a kind: of a program for another version, or forgotten.
            STRATUM_TARGET_HOLD if *self == Self::default() => Ok(Target::Hold),
            STRATUM_TARGET_POSITION => Ok(Target::Position {
                x: x.into(),
                dx: dx.into(),
                ddx: ddx.into(),
            }),
            STRATUM_TARGET_ORIENTATION => {
                let [min, max] = QUATERNION_NORMS.map(|norm| Scalar::from_f64(norm * norm));
                let [w, x, y, z] = q;
                if !(min..=max).contains(&(w * w + x * x + y * y + z * z)) {
                    return Err(STRATUM_ERROR_ORIENTATION);
                }
                Ok(Target::Orientation {
                    q: q.into(),
                    w: dx.into(),
                    dw: ddx.into(),
                })
            }
            _ => Err(STRATUM_ERROR_TARGET),
        }
    }
}

impl From<&Target<Scalar>> for StratumReference {
    fn from(target: &Target<Scalar>) -> Self {
        let vector = |v: &Vector3<Scalar>| v.map(Real::to_f64).into();
        match target {
            Target::Hold => Self::default(),
            Target::Position { x, dx, ddx } => Self {
                kind: STRATUM_TARGET_POSITION,
                x: vector(x),
                orientation: [1.0, 0.0, 0.0, 0.0],
                dx: vector(dx),
                ddx: vector(ddx),
                ..Self::default()
            },
            Target::Orientation { q, w, dw } => Self {
                kind: STRATUM_TARGET_ORIENTATION,
                orientation: q.map(Real::to_f64).into(),
                dx: vector(w),
                ddx: vector(dw),
                ..Self::default()
            },
        }
    }
}

/// Level 1 is entry 0.
pub(crate) fn index(level: u32) -> Option<usize> {
    usize::try_from(level).ok()?.checked_sub(1)
}

/// The kind of a target.
pub(crate) fn kind(target: &Target<Scalar>) -> StratumTargetKind {
    match target {
        Target::Hold => STRATUM_TARGET_HOLD,
        Target::Position { .. } => STRATUM_TARGET_POSITION,
        Target::Orientation { .. } => STRATUM_TARGET_ORIENTATION,
    }
}
