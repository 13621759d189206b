//! What a level tracks.

use serde::Deserialize;

use crate::keys::words::plain_choice;

/// What a level tracks.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum TaskSpec {
    /// The position of the point.
    #[default]
    Position,
    /// The orientation of the frame that turns with the point ([`PointSpec::frame`](super::PointSpec::frame)).
    Orientation,
}

plain_choice!(TaskSpec);
