//! What the machine keeps of a stream.

use std::mem::size_of;

use fci::client::{Client, MODEL_LEN_MAX, ModelSink, Phase};
use fci::{Kind, Version};

/// A message with code, id, payload.
fn message(code: u32, id: u32, payload: &[u8]) -> Vec<u8> {
    let size = 12 + payload.len() as u32;
    let header = [code, id, size].into_iter().flat_map(u32::to_le_bytes);
    header.chain(payload.iter().copied()).collect()
}

/// A stream without an end of a message keeps no more than a few bytes of it.
#[test]
fn memory_is_bounded() {
    assert!(size_of::<Client>() < 2048, "{}", size_of::<Client>());

    struct Count(usize);
    impl ModelSink for Count {
        fn piece(&mut self, urdf: &[u8]) {
            self.0 += urdf.len();
        }
    }
    let mut client = Client::new(true);
    client.connected(1);
    let code = |kind: Kind| kind.code(Version::V10).expect("a code");
    client.receive(&message(code(Kind::Connect), 0, &[0, 10, 0]), &mut ());
    assert_eq!(client.phase(), Phase::Reading);
    // The longest model there may be, and then one byte more.
    for (more, fine) in [(0, true), (1, false)] {
        let (mut client, mut count) = (client.clone(), Count(0));
        let size = 13 + MODEL_LEN_MAX as u32 + more;
        let header = [code(Kind::GetRobotModel), 1, size];
        let header: Vec<u8> = header.iter().flat_map(|it| it.to_le_bytes()).collect();
        client.receive(&header, &mut count);
        client.receive(&[0], &mut count);
        for _ in 0..MODEL_LEN_MAX / 4096 {
            client.receive(&[b'x'; 4096], &mut count);
        }
        assert_eq!(client.stopped().is_none(), fine);
        assert_eq!(count.0, if fine { MODEL_LEN_MAX } else { 0 });
    }
    // Nobody reads on behind an end.
    client.receive(&message(99, 1, &[0]), &mut ());
    assert_eq!((client.strays(), client.phase()), (1, Phase::Reading));
    client.closed();
    let stop = client.stopped();
    client.receive(&message(code(Kind::GetRobotModel), 1, &[0; 64]), &mut ());
    assert_eq!((client.strays(), client.stopped()), (1, stop));
}
