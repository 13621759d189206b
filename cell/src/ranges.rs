//! What files and options may ask for, declared once for validation, help and messages.
//! The core's own ranges are in [`controller_core::ranges`].

use controller_core::ranges::CYCLE_RANGE_S;

/// Longest experiment, and latest time of anything in it \[s\].
pub const DURATION_MAX_S: f64 = 3600.0;

/// Shortest and longest cycle \[ms\].
pub const CYCLE_RANGE_MS: [f64; 2] = [CYCLE_RANGE_S[0] * 1e3, CYCLE_RANGE_S[1] * 1e3];

/// Largest gain a file may ask for; far beyond any use, far below overflow.
pub const GAIN_MAX: f64 = 1e6;
