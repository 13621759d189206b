//! Any bytes as what the client of the FCI is told, in any order: what must never be stands at
//! `machines/client.rs`, which a test of the crate drives too.
//!
//! ```sh
//! cd robots/fci && cargo +nightly fuzz run client
//! ```

#![no_main]

#[path = "../machines/client.rs"]
mod machine;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    machine::client(bytes);
});
