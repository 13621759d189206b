//! Values of options, as both programs read them. Errors say what is allowed.

use std::net::{IpAddr, SocketAddr, ToSocketAddrs};

use crate::ranges::{Number, Range};

/// The reader of numbers in a range.
///
/// # Errors
/// No number, or one that is not in the range.
pub fn number(range: Range<f64>) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| read(text, range).ok_or_else(|| range.to_string())
}

/// The reader of whole numbers in a range.
///
/// # Errors
/// No whole number, or one that is not in the range.
pub fn whole<T: Number>(range: Range<T>) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| read(text, range).ok_or_else(|| format!("whole numbers {range}"))
}

fn read<T: Number>(text: &str, range: Range<T>) -> Option<T> {
    text.parse().ok().filter(|number| range.contains(*number))
}

/// A processor, counted from 0.
///
/// # Errors
/// No whole number.
pub fn processor(text: &str) -> Result<usize, String> {
    text.parse()
        .map_err(|_| "whole numbers from 0 to the last processor".to_string())
}

/// An address of this PC, also 0.0.0.0 for all of its networks.
///
/// # Errors
/// No address, or a name that has none.
pub fn address(text: &str) -> Result<SocketAddr, String> {
    resolve(text).map_err(|()| "ADDRESS:PORT, such as 127.0.0.1:49938".to_string())
}

/// The address of one other program.
///
/// # Errors
/// No address, a name that has none, or one that nothing can be sent to.
pub fn peer(text: &str) -> Result<SocketAddr, String> {
    resolve(text)
        .ok()
        .filter(|address| address.port() != 0 && !address.ip().is_unspecified())
        .ok_or_else(|| "ADDRESS:PORT, such as 192.168.0.150:49938".to_string())
}

/// The address of one other device, whose port is known.
///
/// # Errors
/// No address, a name that has none, or one that nothing can be sent to.
pub fn device(text: &str) -> Result<IpAddr, String> {
    resolve((text, 1))
        .ok()
        .map(|address| address.ip())
        .filter(|address| !address.is_unspecified())
        .ok_or_else(|| "an address without a port, such as 172.16.0.2".to_string())
}

/// The first address of a name, IPv4 first: the robot speaks nothing else.
fn resolve(name: impl ToSocketAddrs) -> Result<SocketAddr, ()> {
    let all: Vec<_> = name.to_socket_addrs().map_err(|_| ())?.collect();
    let v4 = all.iter().find(|address| address.is_ipv4());
    v4.or(all.first()).copied().ok_or(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_numbers_or_names() {
        let local: SocketAddr = ([127, 0, 0, 1], 49_938).into();
        assert_eq!(address("127.0.0.1:49938"), Ok(local));
        assert_eq!(peer("localhost:49938"), Ok(local));
        assert!(address("0.0.0.0:49938").is_ok());
        for nowhere in ["0.0.0.0:49938", "127.0.0.1:0", "127.0.0.1", "", "x y:1"] {
            assert!(peer(nowhere).is_err(), "{nowhere}");
        }
    }

    #[test]
    fn a_device_has_no_port() {
        let local: IpAddr = [127, 0, 0, 1].into();
        assert_eq!(device("127.0.0.1"), Ok(local));
        assert_eq!(device("localhost"), Ok(local));
        for nowhere in ["127.0.0.1:1337", "0.0.0.0", "", "x y"] {
            assert!(device(nowhere).is_err(), "{nowhere}");
        }
    }

    #[test]
    fn numbers_have_a_range() {
        let cycles = whole(Range::new(0, 8));
        assert_eq!(cycles("8"), Ok(8));
        for wrong in ["9", "-1", "1.5", "300", ""] {
            let allowed = Err("whole numbers 0 to 8".to_string());
            assert_eq!(cycles(wrong), allowed, "{wrong}");
        }
        let time = number(Range::above(0.0, 0.5));
        assert_eq!(time("0.5"), Ok(0.5));
        for wrong in ["0", "-1", "0.6", "NaN", "inf", "ten", ""] {
            let allowed = Err("above 0, at most 0.5".to_string());
            assert_eq!(time(wrong), allowed, "{wrong}");
        }
    }
}
