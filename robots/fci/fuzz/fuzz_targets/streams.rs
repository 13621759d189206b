//! Any stream to both ends, cut where its first byte says, in the version that its second one
//! says: no panic, whole messages as without the cut, and requests come back byte by byte.
//!
//! ```sh
//! cd robots/fci && cargo +nightly fuzz run streams
//! ```

#![no_main]

use fci::stream::REQUEST_LEN_MAX;
use fci::{Reply, Request, Stream, Version};
use libfuzzer_sys::fuzz_target;

/// Code, id and payload of the messages in pieces of a stream.
fn messages(pieces: &[&[u8]], version: Version) -> Vec<(u32, u32, Vec<u8>)> {
    let mut stream = Stream::new([0; REQUEST_LEN_MAX], 4096).expect("room for a header");
    let mut found = Vec::new();
    for piece in pieces {
        let mut rest = *piece;
        while let Ok(Some(message)) = stream.next(&mut rest) {
            found.push((message.code, message.id, message.payload.to_vec()));
            if let Ok(request) = Request::parse(version, &message) {
                let mut room = [0; REQUEST_LEN_MAX];
                let sent = request.emit(version, message.id, &mut room);
                assert_eq!(sent.map(|it| &it[12..]), Ok(message.payload));
                let _ = request.check();
            }
            let _ = Reply::parse(version, &message);
        }
    }
    found
}

fuzz_target!(|bytes: &[u8]| {
    let [cut, version, bytes @ ..] = bytes else {
        return;
    };
    let version = Version::ALL[usize::from(*version) % Version::ALL.len()];
    let (first, second) = bytes.split_at(usize::from(*cut).min(bytes.len()));
    assert_eq!(
        messages(&[first, second], version),
        messages(&[bytes], version)
    );
});
