//! Any bytes as what the robot of the FCI is told, in any order: what must never be stands at
//! `machines/robot.rs`, which a test of the crate drives too.
//!
//! ```sh
//! cd robots/fci && cargo +nightly fuzz run robot
//! ```

#![no_main]

#[path = "../machines/robot.rs"]
mod machine;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    machine::robot(bytes);
});
