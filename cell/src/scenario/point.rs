//! Points of the arm in files: by name, or on any link.

use arms::{LWR_IV, LWR_IV_FLANGE};
use controller_core::{Link, LinkPoint};
use serde::Deserialize;

use crate::invalid::Invalid;
use crate::ranges::{LINK, OFFSET_M};

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

/// A point given in the DH frame of a link.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OnLink {
    /// 1..=7.
    pub link: usize,
    /// Position \[m\] in that frame.
    pub offset_m: [f64; 3],
}

impl PointSpec {
    /// Checks name, link and offset.
    ///
    /// # Errors
    /// What cannot be used.
    pub fn validate(&self) -> Result<(), Invalid> {
        match self {
            Self::Name(name) => {
                if LWR_IV.point(name).is_some() {
                    return Ok(());
                }
                let known: Vec<_> = LWR_IV.points.iter().map(|point| point.name).collect();
                Err(Invalid::name("point", name, &known))
            }
            Self::OnLink(OnLink { link, offset_m }) => {
                LINK.check("link", *link)?;
                offset_m
                    .iter()
                    .try_for_each(|&x| OFFSET_M.check("offset_m", x).map(drop))
            }
        }
    }

    /// The point. An invalid name counts as the flange, an invalid link as the last.
    #[must_use]
    pub fn resolve(&self) -> LinkPoint {
        match self {
            Self::Name(name) => LWR_IV.point(name).unwrap_or(LWR_IV_FLANGE),
            Self::OnLink(OnLink { link, offset_m }) => LinkPoint {
                link: Link::from_number(*link).unwrap_or(Link::L7),
                offset: *offset_m,
            },
        }
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
