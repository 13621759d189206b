//! Points of the arm in files: by name, or on any link.

use controller_core::{Link, LinkFrame, LinkPoint};
use serde::Deserialize;

use super::arm::{EquippedArm, TOOL_POINT};
use crate::invalid::Invalid;
use crate::keys::keys;
use crate::ranges::{LINK, OFFSET_M};

/// Name of the point in which the frame of the flange has its origin, of every arm.
const FLANGE_POINT: &str = "flange";

/// What a point may be.
pub(super) const POINT: &str = "a [point of the arm](#arms-that-have-a-name), `\"tool\"` where there is one, or a table with \
     `link` and `offset_m`";

/// A point fixed to a link.
#[derive(Clone, Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a point name or { link = 1..7, offset_m = [x, y, z] }"
)]
pub enum PointSpec {
    /// A named point of the arm.
    Name(String),
    /// A point given in the DH frame of a link.
    OnLink(OnLink),
}

keys! {
    /// A point given in the DH frame of a link.
    #[derive(Clone, Debug)]
    pub struct OnLink {
        /// Number of the link, base to flange.
        pub link: usize, "", LINK;
        /// Where the point is in the DH frame of the link.
        pub offset_m: [f64; 3], "m", OFFSET_M;
    }
}

impl PointSpec {
    /// Checks name, link and offset: the names are those of `arm`.
    ///
    /// # Errors
    /// What cannot be used.
    pub fn validate(&self, arm: &EquippedArm) -> Result<(), Invalid> {
        match self {
            Self::Name(name) if arm.point(name).is_some() => Ok(()),
            Self::Name(name) => Err(Invalid::name("point", name, &arm.point_names())),
            Self::OnLink(point) => point.check_keys(),
        }
    }

    /// The point of `arm`. An invalid name counts as the flange, an invalid link as the last.
    #[must_use]
    pub fn resolve(&self, arm: &EquippedArm) -> LinkPoint {
        match self {
            Self::Name(name) => {
                let named = arm.point(name);
                named.unwrap_or_else(|| arm.parameters.flange_point())
            }
            Self::OnLink(OnLink { link, offset_m }) => LinkPoint {
                link: Link::from_number(*link).unwrap_or(Link::L7),
                offset: *offset_m,
            },
        }
    }

    /// The frame of `arm` that turns with the point: of the points `flange` and `tool` those of
    /// flange and tool, of others the DH frame of their link.
    #[must_use]
    pub fn frame(&self, arm: &EquippedArm) -> LinkFrame {
        let own = match self {
            Self::Name(name) if name == TOOL_POINT => arm.tool_frame(),
            Self::Name(name) if name == FLANGE_POINT => Some(arm.parameters.flange_frame()),
            _ => None,
        };
        own.unwrap_or_else(|| self.resolve(arm).link.frame())
    }

    /// Its name, or "link N".
    #[must_use]
    pub fn label(&self) -> String {
        match self {
            Self::Name(name) => name.clone(),
            Self::OnLink(point) => format!("link {}", point.link),
        }
    }
}
