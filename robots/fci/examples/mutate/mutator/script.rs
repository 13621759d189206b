//! Conversations in good order, of which every place can be attacked.

use fci::Version;
use fci::client::Client;
use fci::robot::Robot;

use hostile::{Random, Table};

use super::datagrams::{self, Datagram};
use super::pair::{Machine, Pair, Place, Places, ToClient, URDF};
use super::streams;

/// Versions of the robot: both layouts of the state, with and without the byte that ends a torque,
/// with and without a model.
pub const VERSIONS: [Version; 3] = [Version::V5, Version::V8, Version::V10];

/// Answers before something happens.
const ANSWERS: u32 = 4;

/// Cycles behind the end of the client's conversation.
const AFTER: u32 = 4;

/// Of the events behind an attack so many are told, and in one of [`WHOLE`] cases all.
const FOLLOWED: usize = 6;
const WHOLE: usize = 256;

/// A conversation of one end.
pub struct Script<M: Machine> {
    /// Column of the tables: its version.
    pub column: usize,
    pub version: Version,
    pub places: Vec<Place<M>>,
}

impl<M: Machine> Script<M> {
    /// Goes on from a place with an end that has borne something there: it must say what it would
    /// have said without, byte by byte. `heard` is what the other one still gets through.
    pub fn follow(
        &self,
        at: usize,
        mut machine: M,
        random: &mut Random,
        heard: impl Fn(&M::Event) -> bool,
    ) -> Result<(), String> {
        let count = match random.below(WHOLE) {
            0 => usize::MAX,
            _ => FOLLOWED,
        };
        for (behind, place) in self.places[at..].iter().take(count).enumerate() {
            if !heard(&place.event) {
                break;
            }
            let said = machine.tell(&place.event);
            if said != place.said {
                let (expected, version) = (&place.said, self.version.number());
                return Err(format!(
                    "version {version}, place {at}: {behind} events behind it {said:02x?}; \
                     expected: {expected:02x?}"
                ));
            }
        }
        Ok(())
    }
}

/// What happens in a motion.
const PLOTS: [fn(&mut Pair); 8] = [
    |pair| {
        pair.tell_client(ToClient::Finish);
    },
    |pair| {
        pair.tell_client(ToClient::Halt);
    },
    |pair| pair.torque = 1.5,
    |pair| pair.gone = 20,
    |pair| pair.operator.user_stop = true,
    // An arm beyond its range, which no recovery leads back from.
    |pair| pair.arm.q[3] = 0.5,
    |pair| pair.arm.tau_ext[1] = 60.0,
    |pair| pair.operator.ready = false,
];

/// Conversations of either end.
#[derive(Default)]
pub struct Scripts {
    pub clients: Vec<Script<Client>>,
    pub robots: Vec<Script<Robot<&'static [u8]>>>,
}

/// Every plot in every version, from before Connect to behind the end; version 10 also with a robot
/// that has no model.
pub fn conversations() -> Scripts {
    let mut scripts = Scripts::default();
    for (column, version) in VERSIONS.into_iter().enumerate() {
        for (number, plot) in PLOTS.into_iter().enumerate() {
            let bare = version == Version::V10 && number == 0;
            let model = if bare { b"" } else { URDF };
            let may_recover = number % 2 == 1;
            let mut pair = Pair::new(version, may_recover, model, Some(Places::default()));
            pair.moving(ANSWERS);
            plot(&mut pair);
            pair.end();
            for _ in 0..AFTER {
                pair.cycle();
            }
            let Places { client, robot } = pair.places.take().expect("kept from the first one on");
            let places = client;
            scripts.clients.push(Script {
                column,
                version,
                places,
            });
            let places = robot;
            scripts.robots.push(Script {
                column,
                version,
                places,
            });
        }
    }
    scripts
}

/// The number of a state or a command.
pub fn message_id(datagram: &[u8]) -> Option<u64> {
    datagram.first_chunk().map(|id| u64::from_le_bytes(*id))
}

/// Damages of a datagram.
const DAMAGES: [&str; 7] = {
    let [bits, bytes, length, kind, real, code] = datagrams::DAMAGES;
    [bits, bytes, length, kind, real, code, "number"]
};

/// Place in the list above of [`renumber`].
pub const NUMBER: usize = 6;

/// What is done to datagrams of this name, and to streams.
pub fn damages(datagram: &str) -> [Table; 2] {
    [
        Table::new("damage of a datagram", &DAMAGES).with(datagram, &[]),
        Table::new("damage of a stream", &streams::DAMAGES).with("stream", &[]),
    ]
}

/// Gives a datagram another number, mostly near `id`.
pub fn renumber(datagram: &mut Datagram, id: u64, random: &mut Random) {
    let any = u64::from(random.bits()) << 32 | u64::from(random.bits());
    let ids = [
        id,
        id.wrapping_sub(1),
        id.wrapping_add(1),
        id.wrapping_add(19),
        0,
        u64::MAX,
        any,
    ];
    datagram.put(0, &random.pick(&ids).to_le_bytes());
}
