//! Several senders on the port of the reference stream.

use std::net::UdpSocket;
use std::thread;
use std::time::{Duration, Instant};

use arms::{LWR_IV, LWR_IV_FLANGE};
use bridge::source::ReferenceSource;
use cell::scenario::EquippedArm;
use controller_core::{Axes, Reference, Target, Task, TaskGains, TaskSet};
use firmware_host::stream::Stream;

/// Longer than the test: the stream does not go stale in it.
const NEVER: Duration = Duration::from_secs(600);

/// Two planners at once would tear the arm to and fro: the first, or the one that is named.
#[test]
fn one_sender_is_obeyed_and_the_others_are_counted() {
    let flange = Task::position(LWR_IV_FLANGE, Axes::XYZ, TaskGains::uniform(400.0, 40.0));
    let tasks = TaskSet::new(&[flange]).expect("one task");
    let arm = EquippedArm::of(&LWR_IV);
    let planners = [0, 1].map(|_| UdpSocket::bind("127.0.0.1:0").expect("a port"));
    for (named, obeyed) in [(None, 0), (Some(1), 1)] {
        let address = {
            let free = UdpSocket::bind("127.0.0.1:0").expect("a port");
            free.local_addr().expect("an address")
        };
        let local = |index: usize| planners[index].local_addr().expect("an address");
        let mut stream = Stream::listen(address, named.map(local), &tasks, &arm, NEVER, None)
            .expect("a free port");
        stream.start(&Reference::hold(1, [0.0; 7]));
        assert!(stream.sample(0.0).is_none(), "the motion begins");
        let deadline = Instant::now() + Duration::from_secs(20);
        for (sent, (index, y)) in (1..).zip([(0, 0.1), (1, 0.2), (0, 0.3), (1, 0.4)]) {
            let text = format!("-0.5 {y} 0.5 0 0 0 0 0 0");
            planners[index]
                .send_to(text.as_bytes(), address)
                .expect("sent");
            while stream.figures().taken + stream.figures().strangers < sent {
                assert!(Instant::now() < deadline, "{:?}", stream.figures());
                thread::sleep(Duration::from_millis(1));
            }
        }
        let figures = stream.figures();
        assert_eq!((figures.taken, figures.strangers), (2, 2));
        assert_eq!(figures.sender, Some(local(obeyed)));
        let text = figures.to_string();
        assert!(text.contains("2 of other senders"), "{text}");
        let reference = stream.sample(0.0).expect("a reference");
        let place = Target::position([-0.5, [0.3, 0.4][obeyed], 0.5]);
        assert_eq!(reference.targets(), [place]);
    }
}
