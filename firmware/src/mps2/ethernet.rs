//! Datagrams over UDP on the board's Ethernet.

use bridge::transport::DatagramLink;
use smoltcp::iface::{Config, Interface, SocketHandle, SocketSet, SocketStorage};
use smoltcp::socket::udp::{self, PacketBuffer, PacketMetadata, RecvError, SendError};
use smoltcp::time::Instant;
use smoltcp::wire::{EthernetAddress, IpAddress, IpCidr, IpEndpoint, Ipv4Address};

use super::lan9118::Lan9118;

/// Hardware address, of the locally administered kind.
const HARDWARE: [u8; 6] = [0x02, 0, 0, 0, 0, 0x01];

/// Address of the board on QEMU's own network, and of the host there.
const ADDRESS: Ipv4Address = Ipv4Address::new(10, 0, 2, 15);
const HOST: Ipv4Address = Ipv4Address::new(10, 0, 2, 2);

/// Port of the client's side of FRI.
pub const PORT: u16 = 49_938;

/// Datagrams that may wait, each way.
const WAITING: usize = 4;

/// Their bytes.
const BYTES: usize = 4096;

/// What the sockets live in; in a `static`.
pub struct Memory {
    sockets: [SocketStorage<'static>; 1],
    receive: [u8; BYTES],
    send: [u8; BYTES],
    received: [PacketMetadata; WAITING],
    sent: [PacketMetadata; WAITING],
}

impl Default for Memory {
    fn default() -> Self {
        Self::new()
    }
}

impl Memory {
    /// Empty.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            sockets: [SocketStorage::EMPTY],
            receive: [0; BYTES],
            send: [0; BYTES],
            received: [PacketMetadata::EMPTY; WAITING],
            sent: [PacketMetadata::EMPTY; WAITING],
        }
    }
}

/// Why the link fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// The datagram is longer than the buffer.
    Receive(RecvError),
    /// Nobody to send to, or no room.
    Send(SendError),
}

/// The board on the network, with one peer: whoever was heard last.
pub struct Ethernet {
    device: Lan9118,
    interface: Interface,
    sockets: SocketSet<'static>,
    socket: SocketHandle,
    peer: Option<IpEndpoint>,
    milliseconds: i64,
}

impl Ethernet {
    /// Turns the network on and listens at [`PORT`]; none without a controller.
    #[must_use]
    pub fn start(memory: &'static mut Memory) -> Option<Self> {
        let mut device = Lan9118::start(HARDWARE)?;
        let config = Config::new(EthernetAddress(HARDWARE).into());
        let mut interface = Interface::new(config, &mut device, Instant::ZERO);
        interface.update_ip_addrs(|addresses| {
            // The only one: there is room.
            let _ = addresses.push(IpCidr::new(IpAddress::Ipv4(ADDRESS), 24));
        });
        let _ = interface.routes_mut().add_default_ipv4_route(HOST);
        let mut sockets = SocketSet::new(&mut memory.sockets[..]);
        let mut socket = udp::Socket::new(
            PacketBuffer::new(&mut memory.received[..], &mut memory.receive[..]),
            PacketBuffer::new(&mut memory.sent[..], &mut memory.send[..]),
        );
        socket.bind(PORT).ok()?;
        let socket = sockets.add(socket);
        Some(Self {
            device,
            interface,
            sockets,
            socket,
            peer: None,
            milliseconds: 0,
        })
    }

    /// Time for the network's own needs \[ms\].
    pub fn set_time(&mut self, milliseconds: i64) {
        self.milliseconds = milliseconds;
    }

    fn poll(&mut self) {
        let now = Instant::from_millis(self.milliseconds);
        self.interface
            .poll(now, &mut self.device, &mut self.sockets);
    }
}

impl DatagramLink for Ethernet {
    type Error = Trouble;

    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, Trouble> {
        self.poll();
        let socket = self.sockets.get_mut::<udp::Socket<'_>>(self.socket);
        match socket.recv_slice(buffer) {
            Ok((length, from)) => {
                self.peer = Some(from.endpoint);
                Ok(Some(length))
            }
            Err(RecvError::Exhausted) => Ok(None),
            Err(error) => Err(Trouble::Receive(error)),
        }
    }

    fn send(&mut self, datagram: &[u8]) -> Result<(), Trouble> {
        let Some(peer) = self.peer else {
            return Ok(());
        };
        let socket = self.sockets.get_mut::<udp::Socket<'_>>(self.socket);
        let sent = socket.send_slice(datagram, peer);
        self.poll();
        sent.map_err(Trouble::Send)
    }
}
