//! Any bytes to both readers: no panic, and what is accepted comes back byte by
//! byte, apart from the fill.
//!
//! Needs nightly and cargo-fuzz; the corpus begins with one datagram of each kind:
//!
//! ```sh
//! cd fri && cargo +nightly fuzz run datagrams
//! ```

#![no_main]

use fri::{Command, CommandPacket, Measurement, MeasurementPacket};
use libfuzzer_sys::fuzz_target;

/// Offset of the 16 bits that have no meaning.
const FILL: usize = 138;

fn same(sent: &[u8], came: &[u8]) {
    assert_eq!(sent[..FILL], came[..FILL]);
    assert_eq!(sent[FILL..FILL + 2], [0, 0]);
    assert_eq!(sent[FILL + 2..], came[FILL + 2..]);
}

fuzz_target!(|bytes: &[u8]| {
    if let Ok(packet) = MeasurementPacket::new_checked(bytes) {
        let value = Measurement::parse(&packet);
        let mut sent = [0xFF; Measurement::LEN];
        value.emit(&mut sent);
        same(&sent, bytes);
        // Sums of finite numbers may be infinite, not more.
        assert!(value.total_commanded_position().iter().all(|q| !q.is_nan()));
    }
    if let Ok(packet) = CommandPacket::new_checked(bytes) {
        let mut sent = [0xFF; Command::LEN];
        Command::parse(&packet).emit(&mut sent);
        same(&sent, bytes);
    }
});
