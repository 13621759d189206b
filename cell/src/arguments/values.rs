//! Values of options, as both programs read them. Errors say what is allowed.

use std::net::{SocketAddr, ToSocketAddrs};

use controller_core::ranges::DEAD_CYCLES_MAX;

/// A seed.
///
/// # Errors
/// Anything but a whole number that fits.
pub fn seed(text: &str) -> Result<u64, String> {
    text.parse()
        .map_err(|_| format!("whole numbers 0 to {}", u64::MAX))
}

/// Cycles between a torque and its effect.
///
/// # Errors
/// More than the plant can delay, or no whole number.
pub fn dead_cycles(text: &str) -> Result<u8, String> {
    let cycles = text.parse().ok();
    cycles
        .filter(|cycles| *cycles <= DEAD_CYCLES_MAX)
        .ok_or_else(|| format!("whole numbers 0 to {DEAD_CYCLES_MAX}"))
}

/// Any number, NaN and infinity among them: its range is checked where it is used.
///
/// # Errors
/// No number.
pub fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "a number".to_string())
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

/// The first address of a name, IPv4 first: the robot speaks nothing else.
fn resolve(text: &str) -> Result<SocketAddr, ()> {
    let all: Vec<_> = text.to_socket_addrs().map_err(|_| ())?.collect();
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
    fn whole_numbers_have_a_range() {
        assert_eq!(dead_cycles("8"), Ok(8));
        for wrong in ["9", "-1", "1.5", "300", ""] {
            assert_eq!(
                dead_cycles(wrong),
                Err("whole numbers 0 to 8".to_string()),
                "{wrong}"
            );
        }
    }
}
