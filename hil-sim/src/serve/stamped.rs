//! When a datagram arrived: on Linux the kernel says it, so that a program that slept does
//! not take its own lateness for the client's. Elsewhere it arrives when it is read.

use std::io;
use std::net::UdpSocket;
use std::time::Duration;

use crate::robot::Stamp;

#[cfg(target_os = "linux")]
pub(super) use linux::Stamped;

#[cfg(not(target_os = "linux"))]
pub(super) use elsewhere::Stamped;

#[cfg(target_os = "linux")]
mod linux {
    use std::io::IoSliceMut;
    use std::os::fd::AsRawFd;
    use std::time::SystemTime;

    use nix::sys::socket::{
        ControlMessageOwned, MsgFlags, cmsg_space, recvmsg, setsockopt, sockopt,
    };
    use nix::sys::time::TimeSpec;

    use super::*;

    /// Room for one time.
    const SPACE: usize = cmsg_space::<TimeSpec>();

    /// Reads a socket, with the kernel's time of every datagram (SO_TIMESTAMPNS).
    pub struct Stamped {
        stamp: Stamp,
        control: [u8; SPACE],
    }

    impl Stamped {
        /// Asks for the times of `socket`; a kernel that refuses leaves the program's.
        pub fn on(socket: &UdpSocket) -> Self {
            let asked = setsockopt(socket, sockopt::ReceiveTimestampns, &true);
            Self {
                stamp: asked.map_or(Stamp::Program, |()| Stamp::Kernel),
                control: [0; SPACE],
            }
        }

        pub fn stamp(&self) -> Stamp {
            self.stamp
        }

        /// A datagram that is there: its length, and how long ago it came. None: the error
        /// `WouldBlock`.
        pub fn receive(
            &mut self,
            socket: &UdpSocket,
            buffer: &mut [u8],
        ) -> io::Result<(usize, Duration)> {
            let mut parts = [IoSliceMut::new(buffer)];
            let control = Some(&mut self.control[..]);
            let flags = MsgFlags::MSG_DONTWAIT;
            let message = recvmsg::<()>(socket.as_raw_fd(), &mut parts, control, flags)?;
            let now = SystemTime::now();
            let came = message.cmsgs()?.find_map(|control| match control {
                ControlMessageOwned::ScmTimestampns(time) => Some(Duration::from(time)),
                _ => None,
            });
            // The kernel's times are those of the wall clock. Set back meanwhile, it says
            // nothing, and the datagram counts as read at once.
            let waited = came
                .and_then(|came| now.duration_since(SystemTime::UNIX_EPOCH + came).ok())
                .unwrap_or_default();
            Ok((message.bytes, waited))
        }
    }
}

#[cfg(not(target_os = "linux"))]
mod elsewhere {
    use super::*;

    /// Reads a socket.
    pub struct Stamped;

    impl Stamped {
        pub fn on(_: &UdpSocket) -> Self {
            Self
        }

        pub fn stamp(&self) -> Stamp {
            Stamp::Program
        }

        /// A datagram that is there: its length. None: the error `WouldBlock`.
        pub fn receive(
            &mut self,
            socket: &UdpSocket,
            buffer: &mut [u8],
        ) -> io::Result<(usize, Duration)> {
            socket.set_nonblocking(true)?;
            let received = socket.recv(buffer);
            socket.set_nonblocking(false)?;
            Ok((received?, Duration::ZERO))
        }
    }
}
