//! Right angles of twist as an exchange of axes.

/// What the twist of a link does to what is carried over it: right angles without a
/// length a only exchange axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisExchange(pub u8);

impl AxisExchange {
    pub const NONE: u8 = 0;
    /// + 90 deg.
    pub const RIGHT: u8 = 1;
    /// - 90 deg.
    pub const LEFT: u8 = 2;
    pub const OTHER: u8 = 3;

    /// Of a link with this sine and cosine of its twist and this length a \[m\].
    pub fn new(sine: f64, cosine: f64, a: f64) -> Self {
        let (zero, one) = (0.0, 1.0);
        Self(if a != zero {
            Self::OTHER
        } else if (sine, cosine) == (zero, one) {
            Self::NONE
        } else if (sine, cosine) == (one, zero) {
            Self::RIGHT
        } else if (sine, cosine) == (-one, zero) {
            Self::LEFT
        } else {
            Self::OTHER
        })
    }
}
