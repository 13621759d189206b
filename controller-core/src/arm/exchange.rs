//! Right angles of twist as an exchange of axes, with and without a length a.

/// What a link does to what is carried over it: its turn, and whether a shift along x
/// follows. A right angle only exchanges axes; a length does not change that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisExchange(pub u8);

impl AxisExchange {
    pub const NONE: u8 = 0;
    /// + 90 deg.
    pub const RIGHT: u8 = 1;
    /// - 90 deg.
    pub const LEFT: u8 = 2;
    /// Added to a turn where there is a length a.
    const LENGTH: u8 = 4;
    pub const RIGHT_WITH_LENGTH: u8 = Self::RIGHT + Self::LENGTH;
    pub const LEFT_WITH_LENGTH: u8 = Self::LEFT + Self::LENGTH;
    /// Any twist, any length.
    pub const OTHER: u8 = 3 + Self::LENGTH;

    /// Of a link with this sine and cosine of its twist and this length a \[m\].
    pub fn new(sine: f64, cosine: f64, a: f64) -> Self {
        let length = if a != 0.0 { Self::LENGTH } else { 0 };
        Self(if (sine, cosine) == (1.0, 0.0) {
            Self::RIGHT + length
        } else if (sine, cosine) == (-1.0, 0.0) {
            Self::LEFT + length
        } else if (sine, cosine, a) == (0.0, 1.0, 0.0) {
            Self::NONE
        } else {
            Self::OTHER
        })
    }

    /// NONE, RIGHT, LEFT; another number where the axes are not only exchanged.
    #[inline(always)]
    pub const fn turn(class: u8) -> u8 {
        class % Self::LENGTH
    }

    /// Whether a shift along x follows the turn.
    #[inline(always)]
    pub const fn has_length(class: u8) -> bool {
        class >= Self::LENGTH
    }
}
