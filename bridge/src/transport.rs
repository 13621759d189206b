//! What carries datagrams: a link that is polled.

use embedded_io::{Read, ReadReady, Write};

use crate::framing::{self, Deframer, Fed};

/// A way for datagrams to one peer and back.
pub trait DatagramLink {
    /// Why the link itself fails; a datagram that does not come is no error.
    type Error;

    /// A datagram that has arrived, if one has: its bytes go to `buffer`, its length
    /// is returned. What does not fit is cut.
    ///
    /// # Errors
    /// The link fails.
    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, Self::Error>;

    /// Sends a datagram to the peer that was heard last.
    ///
    /// # Errors
    /// The link fails.
    fn send(&mut self, datagram: &[u8]) -> Result<(), Self::Error>;
}

/// Datagrams in frames on a byte stream, [`framing`].
#[derive(Debug)]
pub struct SerialLink<P> {
    port: P,
    deframer: Deframer,
    damaged: u32,
}

impl<P> SerialLink<P> {
    /// At the start of a stream.
    #[must_use]
    pub const fn new(port: P) -> Self {
        Self {
            port,
            deframer: Deframer::new(),
            damaged: 0,
        }
    }

    /// Frames that were damaged; the count wraps around.
    #[must_use]
    pub fn damaged(&self) -> u32 {
        self.damaged
    }
}

impl<P: Read + ReadReady + Write> DatagramLink for SerialLink<P> {
    type Error = P::Error;

    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, P::Error> {
        let mut bytes = [0];
        while self.port.read_ready()? {
            if self.port.read(&mut bytes)? == 0 {
                break;
            }
            let [byte] = bytes;
            match self.deframer.feed(byte) {
                Fed::More => {}
                Fed::Damaged => self.damaged = self.damaged.wrapping_add(1),
                Fed::Datagram(length) => {
                    let datagram = self.deframer.datagram(length).iter();
                    let copied = buffer
                        .iter_mut()
                        .zip(datagram)
                        .map(|(to, from)| *to = *from);
                    return Ok(Some(copied.count()));
                }
            }
        }
        Ok(None)
    }

    fn send(&mut self, datagram: &[u8]) -> Result<(), P::Error> {
        if let Some((frame, length)) = framing::encode(datagram) {
            self.port.write_all(frame.get(..length).unwrap_or(&[]))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::convert::Infallible;
    use std::collections::VecDeque;

    /// A wire from its sender to its receiver.
    #[derive(Default)]
    struct Wire(VecDeque<u8>);

    impl embedded_io::ErrorType for Wire {
        type Error = Infallible;
    }

    impl Read for Wire {
        fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
            let mut count = 0;
            for place in buffer {
                let Some(byte) = self.0.pop_front() else {
                    break;
                };
                *place = byte;
                count += 1;
            }
            Ok(count)
        }
    }

    impl ReadReady for Wire {
        fn read_ready(&mut self) -> Result<bool, Infallible> {
            Ok(!self.0.is_empty())
        }
    }

    impl Write for Wire {
        fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
            self.0.extend(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> Result<(), Infallible> {
            Ok(())
        }
    }

    #[test]
    fn datagrams_pass_one_by_one_and_damage_is_counted() {
        let mut link = SerialLink::new(Wire::default());
        let mut buffer = [0; 916];
        assert_eq!(link.receive(&mut buffer), Ok(None));
        for length in [376, 916] {
            link.send(&std::vec![7; length]).expect("a wire");
        }
        assert_eq!(link.receive(&mut buffer), Ok(Some(376)));
        link.port.0[100] ^= 4;
        link.send(&[1, 0, 2]).expect("a wire");
        assert_eq!(link.receive(&mut buffer), Ok(Some(3)));
        assert_eq!(buffer[..3], [1, 0, 2]);
        assert_eq!((link.receive(&mut buffer), link.damaged()), (Ok(None), 1));
    }
}
