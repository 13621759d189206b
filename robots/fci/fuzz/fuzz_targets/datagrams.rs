//! Any bytes as state and command of every version: no panic, and what is accepted comes back
//! byte by byte, but for NaN in binary32.
//!
//! Needs nightly and cargo-fuzz; the corpus begins with datagrams of both kinds:
//!
//! ```sh
//! cd robots/fci && cargo +nightly fuzz run datagrams
//! ```

#![no_main]

use fci::state::{FIELDS, LEN_MAX};
use fci::{Command, State, StatePacket, Version, command};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for version in Version::ALL {
        if let Ok(packet) = StatePacket::new_checked(version, bytes) {
            let mut room = [0xFF; LEN_MAX];
            let sent = State::parse(&packet).emit(version, &mut room);
            if version < Version::V10 || packet.check_finite(&FIELDS).is_ok() {
                assert_eq!(sent, Ok(bytes));
            }
        }
        if let Ok(command) = Command::parse(version, bytes) {
            let mut room = [0xFF; command::LEN_MAX];
            assert_eq!(command.emit(version, &mut room), bytes);
            let _ = command.check();
        }
    }
});
