//! All names for numbers that `include/stratum.h` has.

use crate::codes::{CONFIG_ERRORS, ERRORS, FAULTS, LIMITS};
use crate::constants::{CHOICES, Names};

const CODES: &[Names] = &[
    Names {
        kind: "StratumResult",
        integer: "int32_t",
        about: "What a function answers: STRATUM_OK, an argument error (1 to 31), a latched \
                fault (32 to 95) or a configuration error (from 128). The numbers are stable.",
        constants: &[ERRORS, FAULTS, CONFIG_ERRORS],
    },
    Names {
        kind: "StratumLimit",
        integer: "int32_t",
        about: "What limited or degraded a cycle whose torque is valid, for logs: \
                StratumStatus has a field for each. The numbers are stable and none is a \
                StratumResult.",
        constants: &[LIMITS],
    },
];

/// Everything that the header has of this, in its order.
pub const HEADER: [&[Names]; 2] = [CODES, CHOICES];
