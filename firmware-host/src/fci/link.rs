//! The sockets around the client's machine: bytes to and fro, states in, commands out.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{IpAddr, SocketAddr, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use cell::timing::Times;
use fci::client::{Client, Duty, Facts, ModelSink, Phase, Start};
use fci::state::LEN_MAX;
use fci::{Error, StatePacket, Version};

/// TCP port of every robot.
pub const PORT: u16 = 1337;

/// How often the loop looks up while nothing arrives.
const LOOK_UP: Duration = Duration::from_millis(20);

/// Silence after which the robot is taken for gone, as by the vendor's client.
const SILENCE: Duration = Duration::from_secs(1);

/// How often a connection that is refused is tried.
const RETRY: Duration = Duration::from_millis(500);

/// Where the robot is and how long it is waited for.
#[derive(Debug)]
pub struct Endpoint<'a> {
    /// Its address.
    pub robot: IpAddr,
    /// How long to try to connect.
    pub wait: Duration,
    /// Set from outside: come to rest and end.
    pub stop: &'a AtomicBool,
}

/// What a host wishes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Nothing yet.
    GoOn,
    /// The end, in good order.
    Finish,
}

/// Who makes the commands.
pub trait Host {
    /// A connection begins, with this version until the robot names another one.
    fn connected(&mut self, version: Version);

    /// Everything is read; `urdf` is the robot's model if it has given one. What is set before the
    /// motion; none where there is to be no motion.
    fn ready(&mut self, version: Version, urdf: Option<&[u8]>) -> Option<Start>;

    /// A state that has passed its check, and what is to be done: the command, if there is one.
    fn state(&mut self, state: &StatePacket<&[u8]>, bytes: &[u8], duty: Duty) -> Option<&[u8]>;

    /// What is wished after that; `stop` is set from outside.
    fn wish(&mut self, stop: bool) -> Wish;
}

/// What a loop has counted.
#[derive(Clone, Debug, Default)]
pub struct Counts {
    /// Commands sent.
    pub commands: u64,
    /// Datagrams of other addresses.
    pub strangers: u64,
    /// Datagrams of the robot that are no states.
    pub rejected: u64,
    /// Why the last of them is none.
    pub last_rejected: Option<Error>,
    /// States that waited behind newer ones and were not looked at.
    pub overtaken: u64,
    /// From the arrival of a state to the finished command.
    pub compute: Times,
    /// The same to the end of sending.
    pub latency: Times,
}

/// The URDF that the robot gives, as far as it has come.
#[derive(Debug, Default)]
struct Model(Vec<u8>);

impl ModelSink for Model {
    fn piece(&mut self, urdf: &[u8]) {
        self.0.extend_from_slice(urdf);
    }
}

/// A connection.
#[derive(Debug)]
struct Sockets {
    tcp: TcpStream,
    udp: UdpSocket,
}

impl Sockets {
    /// Connects, again and again until `wait` is over.
    fn open(end: &Endpoint<'_>) -> io::Result<Self> {
        let (robot, begin) = (SocketAddr::new(end.robot, PORT), Instant::now());
        let tcp = loop {
            let left = end.wait.saturating_sub(begin.elapsed());
            match TcpStream::connect_timeout(&robot, left.clamp(LOOK_UP, SILENCE)) {
                Ok(tcp) => break tcp,
                Err(error) if end.stop.load(Ordering::Relaxed) || left <= RETRY => {
                    return Err(error);
                }
                Err(_) => thread::sleep(RETRY),
            }
        };
        tcp.set_nonblocking(true)?;
        tcp.set_nodelay(true)?;
        // States go to the address that the connection comes from.
        let udp = UdpSocket::bind((tcp.local_addr()?.ip(), 0))?;
        udp.set_read_timeout(Some(LOOK_UP))?;
        Ok(Self { tcp, udp })
    }

    /// Sends what there is. What the system does not take now goes with the next turn.
    fn send(&mut self, client: &mut Client) {
        while !client.transmit().is_empty() {
            match self.tcp.write(client.transmit()) {
                Ok(count) => client.transmitted(count),
                Err(error) if is_pause(&error) => return,
                Err(_) => return client.closed(),
            }
        }
    }

    fn receive(&mut self, client: &mut Client, model: &mut Model) {
        let mut bytes = [0; 4096];
        loop {
            match self.tcp.read(&mut bytes) {
                Ok(0) => return client.closed(),
                Ok(count) => client.receive(bytes.get(..count).unwrap_or_default(), model),
                Err(error) if is_pause(&error) => return,
                Err(_) => return client.closed(),
            }
        }
    }

    /// Waits for a state and takes the newest one: its bytes and where it comes from.
    fn state(
        &mut self,
        bytes: &mut [u8],
        counts: &mut Counts,
    ) -> io::Result<Option<(usize, SocketAddr)>> {
        let mut newest = match self.udp.recv_from(bytes) {
            Ok(newest) => newest,
            Err(error) if is_pause(&error) => return Ok(None),
            Err(error) => return Err(error),
        };
        self.udp.set_nonblocking(true)?;
        while let Ok(newer) = self.udp.recv_from(bytes) {
            newest = newer;
            counts.overtaken += 1;
        }
        self.udp.set_nonblocking(false)?;
        Ok(Some(newest))
    }
}

/// Whether a socket has nothing for now: the robot's port may also be closed for a while.
fn is_pause(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

/// Leads the conversation until it is over: [`Client::stopped`] says why.
///
/// # Errors
/// No connection can be made.
pub fn converse(
    end: &Endpoint<'_>,
    client: &mut Client,
    host: &mut impl Host,
) -> io::Result<Counts> {
    let mut counts = Counts::default();
    let mut model = Model::default();
    let mut sockets = Sockets::open(end)?;
    client.connected(sockets.udp.local_addr()?.port());
    host.connected(client.version());
    // Longer than every state: one that is too long shows.
    let mut bytes = [0; LEN_MAX + 1];
    let (mut heard, mut asked) = (Instant::now(), false);
    // There are robots that send from another address than they listen at: then the first one
    // that sends a state counts, unless the robot's own sends one.
    let mut source: Option<SocketAddr> = None;
    while client.stopped().is_none() {
        if client.wants_new_connection() {
            drop(sockets);
            model.0.clear();
            sockets = Sockets::open(end)?;
            client.connected(sockets.udp.local_addr()?.port());
            host.connected(client.version());
            heard = Instant::now();
            source = None;
        }
        sockets.send(client);
        let state = sockets.state(&mut bytes, &mut counts)?;
        let begin = Instant::now();
        sockets.receive(client, &mut model);
        if let Some((length, from)) = state {
            let datagram = bytes.get(..length).unwrap_or_default();
            let own = from.ip() == end.robot;
            if !own && source.is_some_and(|source| source != from) {
                counts.strangers += 1;
            } else {
                match StatePacket::new_checked(client.version(), datagram) {
                    Err(error) => {
                        counts.rejected += 1;
                        counts.last_rejected = Some(error);
                    }
                    Ok(packet) => {
                        source = Some(from);
                        heard = begin;
                        let duty = client.state(&Facts::of(&packet));
                        let command = host.state(&packet, datagram, duty);
                        if let Some(command) = command.filter(|_| duty != Duty::Listen) {
                            counts.compute.add(begin.elapsed());
                            sockets.udp.send_to(command, from)?;
                            counts.commands += 1;
                            counts.latency.add(begin.elapsed());
                        }
                    }
                }
            }
        }
        if client.phase() == Phase::Ready && !asked {
            asked = true;
            let urdf = Some(&model.0[..]).filter(|urdf| !urdf.is_empty());
            if let Some(start) = host.ready(client.version(), urdf) {
                client.start(&start);
            }
            // The model may have taken a while to be looked at.
            heard = Instant::now();
        }
        if host.wish(end.stop.load(Ordering::Relaxed)) == Wish::Finish {
            client.finish();
        }
        if heard.elapsed() > SILENCE {
            client.silent();
        }
    }
    Ok(counts)
}
