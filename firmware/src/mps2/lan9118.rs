//! The Ethernet controller LAN9118 of the board, polled: one frame in, one out.

use smoltcp::phy::{Device, DeviceCapabilities, Medium, RxToken, TxToken};
use smoltcp::time::Instant;

use super::register::{read, write};

/// Addresses of registers.
mod at {
    pub const RX_DATA: usize = 0xa000_0000;
    pub const TX_DATA: usize = 0xa000_0020;
    pub const RX_STATUS: usize = 0xa000_0040;
    pub const TX_STATUS: usize = 0xa000_0048;
    pub const BYTE_TEST: usize = 0xa000_0064;
    pub const RX_CONFIG: usize = 0xa000_006c;
    pub const TX_CONFIG: usize = 0xa000_0070;
    pub const HARDWARE_CONFIG: usize = 0xa000_0074;
    pub const RX_COUNT: usize = 0xa000_007c;
    pub const TX_COUNT: usize = 0xa000_0080;
    pub const MAC_COMMAND: usize = 0xa000_00a4;
    pub const MAC_DATA: usize = 0xa000_00a8;
}

/// Registers behind the MAC command register.
mod mac {
    pub const CONTROL: u32 = 1;
    pub const ADDRESS_HIGH: u32 = 2;
    pub const ADDRESS_LOW: u32 = 3;
    pub const BUSY: u32 = 1 << 31;
    /// Full duplex is the emulation's business: receiver and transmitter on, all
    /// frames of any address.
    pub const ON: u32 = 0x10_000c;
}

/// Longest Ethernet frame with its checksum, in whole words.
const FRAME: usize = 1536;

/// The controller.
pub struct Lan9118 {
    frame: [u8; FRAME],
}

impl Lan9118 {
    /// Turns it on with a hardware address; none if it is not there.
    #[must_use]
    pub fn start(address: [u8; 6]) -> Option<Self> {
        const PATTERN: u32 = 0x8765_4321;
        if read(at::BYTE_TEST) != PATTERN {
            return None;
        }
        write(at::HARDWARE_CONFIG, 0x5_0000);
        let [a, b, c, d, e, f] = address;
        set_mac(mac::ADDRESS_LOW, u32::from_le_bytes([a, b, c, d]));
        set_mac(mac::ADDRESS_HIGH, u32::from_le_bytes([e, f, 0, 0]));
        set_mac(mac::CONTROL, mac::ON);
        write(at::RX_CONFIG, 0);
        write(at::TX_CONFIG, 2);
        Some(Self { frame: [0; FRAME] })
    }

    /// The next sound frame, in `self.frame`: its length.
    fn take(&mut self) -> Option<usize> {
        const ERROR: u32 = 1 << 15;
        const CHECKSUM: usize = 4;
        while (read(at::RX_COUNT) >> 16) & 0xff > 0 {
            let status = read(at::RX_STATUS);
            let bytes = ((status >> 16) & 0x3fff) as usize;
            for word in 0..bytes.div_ceil(4) {
                let data = read(at::RX_DATA).to_le_bytes();
                let place = self.frame.get_mut(word * 4..word * 4 + 4);
                if let Some(place) = place {
                    place.copy_from_slice(&data);
                }
            }
            let fits = bytes <= FRAME && bytes > CHECKSUM;
            if status & ERROR == 0 && fits {
                return Some(bytes - CHECKSUM);
            }
        }
        None
    }

    fn put(frame: &[u8]) {
        const FIRST_AND_LAST: u32 = 0x3000;
        let length = frame.len() as u32;
        write(at::TX_DATA, FIRST_AND_LAST | length);
        write(at::TX_DATA, length);
        for chunk in frame.chunks(4) {
            let mut word = [0; 4];
            for (to, from) in word.iter_mut().zip(chunk) {
                *to = *from;
            }
            write(at::TX_DATA, u32::from_le_bytes(word));
        }
        while (read(at::TX_COUNT) >> 16) & 0xff > 0 {
            read(at::TX_STATUS);
        }
    }
}

fn set_mac(index: u32, value: u32) {
    write(at::MAC_DATA, value);
    write(at::MAC_COMMAND, mac::BUSY | index);
    while read(at::MAC_COMMAND) & mac::BUSY != 0 {}
}

/// A frame that has come.
pub struct Received<'a>(&'a [u8]);

/// Leave to send a frame.
pub struct Sending;

impl RxToken for Received<'_> {
    fn consume<R, F: FnOnce(&[u8]) -> R>(self, f: F) -> R {
        f(self.0)
    }
}

impl TxToken for Sending {
    fn consume<R, F: FnOnce(&mut [u8]) -> R>(self, length: usize, f: F) -> R {
        let mut frame = [0; FRAME];
        // The capabilities below ask for no more than fits.
        let frame = &mut frame[..length.min(FRAME)];
        let result = f(frame);
        Lan9118::put(frame);
        result
    }
}

impl Device for Lan9118 {
    type RxToken<'a> = Received<'a>;
    type TxToken<'a> = Sending;

    fn receive(&mut self, _: Instant) -> Option<(Received<'_>, Sending)> {
        let length = self.take()?;
        let frame = self.frame.get(..length)?;
        Some((Received(frame), Sending))
    }

    fn transmit(&mut self, _: Instant) -> Option<Sending> {
        Some(Sending)
    }

    fn capabilities(&self) -> DeviceCapabilities {
        let mut capabilities = DeviceCapabilities::default();
        capabilities.medium = Medium::Ethernet;
        capabilities.max_transmission_unit = 1514;
        capabilities
    }
}
