//! Strategies: all that can be sent.

use fri::measurement::{Drives, Statistics};
use fri::{
    Command, ControlScheme, DOF, Flags, Frame, Header, InterfaceState, Measurement, Quality,
    UserData,
};
use proptest::prelude::*;

/// Any pattern of 32 bits that is finite, both zeros and subnormal numbers included.
fn finite() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(|bits| f32::from_bits(make_finite(bits)))
}

/// The same bits where they are a finite number, otherwise with a smaller exponent.
pub fn make_finite(bits: u32) -> u32 {
    if f32::from_bits(bits).is_finite() {
        bits
    } else {
        bits & !0x0080_0000
    }
}

fn header() -> impl Strategy<Value = Header> {
    any::<(u16, u16)>().prop_map(|(counter, reflected)| Header { counter, reflected })
}

fn user() -> impl Strategy<Value = UserData> {
    (
        prop::array::uniform16(finite()),
        any::<[i32; 16]>(),
        any::<u16>(),
    )
        .prop_map(|(real, int, bool)| UserData { real, int, bool })
}

/// The first `N` numbers, which are taken away.
fn take<const N: usize>(numbers: &mut &[f32]) -> [f32; N] {
    let (first, rest) = numbers.split_first_chunk().expect("numbers left");
    *numbers = rest;
    *first
}

/// Every code that means something.
pub fn codes() -> impl Strategy<Value = (InterfaceState, Quality, ControlScheme)> {
    let or_invalid =
        |codes: std::ops::RangeInclusive<u16>| prop_oneof![4 => codes, 1 => Just(0xFFFF)];
    (or_invalid(0..=2), or_invalid(0..=3), or_invalid(0..=3)).prop_map(
        |(state, quality, control)| {
            (
                InterfaceState::from_code(state).expect("state"),
                Quality::from_code(quality).expect("quality"),
                ControlScheme::from_code(control).expect("control scheme"),
            )
        },
    )
}

/// Any value that can be sent.
pub fn any_measurement() -> impl Strategy<Value = Measurement> {
    // 15 reals before offset 216, 175 behind it.
    let numbers = prop::collection::vec(finite(), 15 + 175);
    let bits = any::<(u32, u16, u16, u16)>();
    (header(), user(), codes(), bits, numbers).prop_map(
        |(header, user, (state, quality, control), (missed, power, error, warning), numbers)| {
            let rest = &mut &numbers[..];
            let [timestamp_s, period_s, command_period_s, safety_limits] = take(rest);
            let [answer_rate, latency_s, jitter_s, miss_rate] = take(rest);
            let value = Measurement {
                header,
                user,
                timestamp_s,
                state,
                quality,
                period_s,
                command_period_s,
                safety_limits,
                statistics: Statistics {
                    answer_rate,
                    latency_s,
                    jitter_s,
                    miss_rate,
                    missed,
                },
                drives: Drives {
                    power,
                    control,
                    error,
                    warning,
                    temperature: take(rest),
                },
                joint_position: take(rest),
                frame: take(rest),
                commanded_position: take(rest),
                fri_offset: take(rest),
                commanded_frame: take(rest),
                fri_frame_offset: take(rest),
                joint_torque: take(rest),
                external_torque: take(rest),
                external_wrench: take(rest),
                jacobian: [(); 6].map(|()| take(rest)),
                mass_matrix: [(); DOF].map(|()| take(rest)),
                gravity: take(rest),
            };
            assert!(rest.is_empty());
            value
        },
    )
}

/// Any value that can be sent.
pub fn any_command() -> impl Strategy<Value = Command> {
    let numbers = prop::collection::vec(finite(), 58);
    (header(), user(), any::<u32>(), numbers).prop_map(|(header, user, flags, numbers)| {
        let rest = &mut &numbers[..];
        let value = Command {
            header,
            user,
            flags: Flags(flags),
            joint_position: take(rest),
            frame: take::<{ size_of::<Frame>() / 4 }>(rest),
            joint_torque: take(rest),
            wrench: take(rest),
            joint_stiffness: take(rest),
            joint_damping: take(rest),
            cartesian_stiffness: take(rest),
            cartesian_damping: take(rest),
        };
        assert!(rest.is_empty());
        value
    })
}
