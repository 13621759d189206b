//! Both datagrams against the wire format: every field, every byte, and what is
//! derived from them. All numbers in the data are exact in binary32, apart from
//! the periods, which are the binary32 next to their decimals: every comparison
//! here is for equality.

mod data;

use fri::bytes::{f32s_at, get, i32s_at, put, put_f32s, put_i32s, u16_at, u32_at};
use fri::measurement::{Drives, Statistics};
use fri::{
    Command, CommandPacket, ControlScheme, DOF, Flags, Frame, Header, InterfaceState, Measurement,
    MeasurementPacket, Quality, UserData, command, measurement, position,
};

/// CRC-32 as in zlib, of the whole datagram.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg())
        })
    })
}

/// Numbers `first`, `first` + 1 .. of the measurement's series behind offset 216.
fn series<const N: usize>(first: usize) -> [f32; N] {
    std::array::from_fn(|i| 0.25 * (first + i) as f32 - 10.0)
}

/// The same of the command's series behind offset 144.
fn command_series<const N: usize>(first: usize) -> [f32; N] {
    std::array::from_fn(|i| 1.0 - (first + i) as f32 / 8.0)
}

/// What the measurement says.
fn expected_measurement() -> Measurement {
    Measurement {
        header: Header {
            counter: 4660,
            reflected: 65534,
        },
        user: UserData {
            real: std::array::from_fn(|i| i as f32 + 0.5),
            int: std::array::from_fn(|i| -1000 * i as i32),
            bool: 0xA5C3,
        },
        timestamp_s: 12.5,
        state: InterfaceState::Command,
        quality: Quality::Perfect,
        period_s: 0.002,
        command_period_s: 0.004,
        safety_limits: 0.75,
        statistics: Statistics {
            answer_rate: 0.96875,
            latency_s: 2f32.powi(-11),
            jitter_s: 2f32.powi(-13),
            miss_rate: 0.03125,
            missed: 70000,
        },
        drives: Drives {
            power: 0x7F,
            control: ControlScheme::JointImpedance,
            error: 4,
            warning: 0x40,
            temperature: std::array::from_fn(|i| 30.0 + i as f32 / 2.0),
        },
        joint_position: series(0),
        frame: series(7),
        commanded_position: series(19),
        fri_offset: series(26),
        commanded_frame: series(33),
        fri_frame_offset: series(45),
        joint_torque: series(57),
        external_torque: series(64),
        external_wrench: series(71),
        jacobian: std::array::from_fn(|row| series(77 + DOF * row)),
        mass_matrix: std::array::from_fn(|row| series(119 + DOF * row)),
        gravity: series(168),
    }
}

/// What the command says.
fn expected_command() -> Command {
    Command {
        header: Header {
            counter: 65535,
            reflected: 4660,
        },
        user: UserData {
            real: std::array::from_fn(|i| -(i as f32 + 0.5)),
            int: std::array::from_fn(|i| 1000 * i as i32),
            bool: 0x0F01,
        },
        flags: Flags(0x35),
        joint_position: command_series(0),
        frame: command_series(7),
        joint_torque: command_series(19),
        wrench: command_series(26),
        joint_stiffness: command_series(32),
        joint_damping: command_series(39),
        cartesian_stiffness: command_series(46),
        cartesian_damping: command_series(52),
    }
}

#[test]
fn the_data_are_what_they_were() {
    // The check value of CRC-32.
    assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
    assert_eq!(crc32(&data::measurement()), 0x3B06_BBDA);
    assert_eq!(crc32(&data::command()), 0x2DC2_8BFC);
}

#[test]
fn lengths_and_ids() {
    assert_eq!((measurement::LEN, measurement::ID), (916, 0x2006));
    assert_eq!((command::LEN, command::ID), (376, 0x1005));
    assert_eq!((Measurement::LEN, Command::LEN), (916, 376));
}

#[test]
fn header_offsets() {
    let bytes = data::measurement();
    let at = |at| u16_at(&bytes, at);
    assert_eq!([at(0), at(2), at(4), at(6)], [4660, 65534, 916, 0x2006]);
    let bytes = data::command();
    let at = |at| u16_at(&bytes, at);
    assert_eq!([at(0), at(2), at(4), at(6)], [65535, 4660, 376, 0x1005]);
}

#[test]
fn every_field_of_the_measurement() {
    let packet = MeasurementPacket::new_checked(data::measurement()).expect("valid");
    let value = Measurement::parse(&packet);
    assert_eq!(value, expected_measurement());
    // Landmarks of the series, written out: the oracle itself is right.
    assert_eq!(value.joint_position[0], -10.0);
    assert_eq!(value.frame[0], -8.25);
    assert_eq!(value.joint_torque[0], 4.25);
    assert_eq!(value.jacobian[0][0], 9.25);
    assert_eq!(value.mass_matrix[0][0], 19.75);
    assert_eq!(value.gravity[0], 32.0);
    assert_eq!(value.gravity[6], 33.5);
}

#[test]
fn every_accessor_of_the_measurement() {
    let bytes = data::measurement();
    let packet = MeasurementPacket::new_checked(&bytes[..]).expect("valid");
    let expected = expected_measurement();
    assert_eq!(packet.header(), expected.header);
    assert_eq!(packet.user(), expected.user);
    assert_eq!(packet.state(), expected.state);
    assert_eq!(packet.quality(), expected.quality);
    assert_eq!(packet.control(), expected.drives.control);
    assert_eq!(packet.power(), expected.drives.power);
    assert_eq!(packet.period_s(), expected.period_s);
    assert_eq!(packet.joint_position(), expected.joint_position);
    assert_eq!(packet.commanded_position(), expected.commanded_position);
    assert_eq!(packet.fri_offset(), expected.fri_offset);
    assert_eq!(packet.jacobian(), expected.jacobian);
    assert_eq!(packet.mass_matrix(), expected.mass_matrix);
    assert_eq!(packet.gravity(), expected.gravity);
}

#[test]
fn every_field_of_the_command() {
    let packet = CommandPacket::new_checked(data::command()).expect("valid");
    let value = Command::parse(&packet);
    let expected = expected_command();
    assert_eq!(value, expected);
    assert_eq!(value.joint_torque[0], -1.375);
    assert_eq!(value.cartesian_damping[5], -6.125);

    assert_eq!(packet.header(), expected.header);
    assert_eq!(packet.user(), expected.user);
    assert_eq!(packet.flags(), expected.flags);
    assert_eq!(packet.joint_position(), expected.joint_position);
    assert_eq!(packet.joint_torque(), expected.joint_torque);
}

#[test]
fn emit_writes_every_byte() {
    // Whatever was in the buffer before.
    for before in [0x00, 0x55, 0xFF] {
        let mut bytes = [before; measurement::LEN];
        expected_measurement().emit(&mut bytes);
        assert_eq!(bytes, data::measurement());
        let mut bytes = [before; command::LEN];
        expected_command().emit(&mut bytes);
        assert_eq!(bytes, data::command());
    }
}

#[test]
fn rotational_rows_turned_round() {
    let value = expected_measurement();
    let [x, y, z, about_z, about_y, about_x] = value.jacobian;
    assert_eq!(
        value.jacobian_xyz(),
        [x, y, z, about_x, about_y, about_z],
        "rows 3 and 5 are exchanged, the others stay"
    );
    // By position: row 3 begins at offset 524 + 3 * 28, row 5 at 524 + 5 * 28.
    let bytes = data::measurement();
    assert_eq!(value.jacobian_xyz()[5], f32s_at(&bytes, 524 + 3 * 28));
    assert_eq!(value.jacobian_xyz()[3], f32s_at(&bytes, 524 + 5 * 28));
}

#[test]
fn total_commanded_position_is_the_sum() {
    // 0.25 (19 + i) - 10 + 0.25 (26 + i) - 10
    let expected: [f32; DOF] = std::array::from_fn(|i| 0.5 * i as f32 - 8.75);
    assert_eq!(expected_measurement().total_commanded_position(), expected);
}

#[test]
fn position_of_a_frame() {
    let frame: Frame = std::array::from_fn(|i| i as f32);
    assert_eq!(position(&frame), [3.0, 7.0, 11.0]);
    // Numbers 7 + 3, 7 + 7, 7 + 11 of the series.
    assert_eq!(position(&expected_measurement().frame), [-7.5, -6.5, -5.5]);
}

#[test]
fn flags_and_their_sum() {
    let joint_impedance = [
        Flags::JOINT_POSITION,
        Flags::JOINT_TORQUE,
        Flags::JOINT_STIFFNESS,
        Flags::JOINT_DAMPING,
    ];
    let cartesian = [
        Flags::FRAME,
        Flags::WRENCH,
        Flags::CARTESIAN_STIFFNESS,
        Flags::CARTESIAN_DAMPING,
    ];
    assert_eq!(joint_impedance.map(|flag| flag.0), [0x01, 0x04, 0x10, 0x20]);
    assert_eq!(cartesian.map(|flag| flag.0), [0x100, 0x400, 0x1000, 0x2000]);
    let sum = joint_impedance.iter().fold(0, |sum, flag| sum | flag.0);
    assert_eq!(Flags::JOINT_IMPEDANCE.0, sum);
    assert!(joint_impedance.map(|flag| Flags(0x35).contains(flag)) == [true; 4]);
    assert!(cartesian.map(|flag| Flags(0x35).contains(flag)) == [false; 4]);
    // All of them, not one of them.
    assert!(!Flags::JOINT_POSITION.contains(Flags::JOINT_IMPEDANCE));
    assert!(Flags::default().contains(Flags::default()));
}

#[test]
fn defaults_can_be_sent_and_read() {
    let mut bytes = [0xFF; measurement::LEN];
    Measurement::default().emit(&mut bytes);
    let packet = MeasurementPacket::new_checked(bytes).expect("valid");
    assert_eq!(Measurement::parse(&packet), Measurement::default());
    assert_eq!(packet.state(), InterfaceState::Off);
    let mut bytes = [0xFF; command::LEN];
    Command::default().emit(&mut bytes);
    let packet = CommandPacket::new_checked(bytes).expect("valid");
    assert_eq!(Command::parse(&packet), Command::default());
}

#[test]
fn numbers_at_offsets() {
    let bytes: Vec<u8> = (1..=8).collect();
    assert_eq!(get::<3>(&bytes, 5), [6, 7, 8]);
    assert_eq!(u16_at(&bytes, 1), 0x0302);
    assert_eq!(u32_at(&bytes, 4), 0x0807_0605);
    assert_eq!(i32s_at::<2>(&bytes, 0), [0x0403_0201, 0x0807_0605]);
    assert_eq!(f32s_at::<1>(&bytes, 0)[0].to_bits(), 0x0403_0201);
}

/// Every offset at and beyond the end, the largest of the machine included.
#[test]
fn beyond_the_end_is_zero_and_dropped() {
    let bytes: Vec<u8> = (1..=8).collect();
    for at in (7..40).chain(usize::MAX - 40..=usize::MAX) {
        assert_eq!(u16_at(&bytes, at), 0, "{at}");
        assert_eq!(u32_at(&bytes, at), 0, "{at}");
        assert_eq!(f32s_at::<16>(&bytes, at), [0.0; 16], "{at}");
        assert_eq!(i32s_at::<16>(&bytes, at), [0; 16], "{at}");
        let mut written = bytes.clone();
        put(&mut written, at, [0xFF; 2]);
        put_f32s(&mut written, at, &[1.0; 16]);
        put_i32s(&mut written, at, &[-1; 16]);
        assert_eq!(written, bytes, "{at}");
    }
    // A number counts as a whole: what only begins inside is not there.
    assert_eq!(f32s_at::<2>(&bytes, 4)[1], 0.0);
    assert_eq!(u32_at(&bytes, 5), 0);
}

/// The blocks can be read from anything: what is not there is zero.
#[test]
fn blocks_of_short_bytes() {
    let bytes = data::measurement();
    for length in 0..=bytes.len() {
        let (header, user) = (
            Header::read(&bytes[..length]),
            UserData::read(&bytes[..length]),
        );
        let expected = expected_measurement();
        assert_eq!(header.counter, if length < 2 { 0 } else { 4660 });
        assert_eq!(header.reflected, if length < 4 { 0 } else { 65534 });
        for i in 0..16 {
            let real = if length < 12 + 4 * i {
                0.0
            } else {
                expected.user.real[i]
            };
            let int = if length < 76 + 4 * i {
                0
            } else {
                expected.user.int[i]
            };
            assert_eq!((user.real[i], user.int[i]), (real, int), "{length} {i}");
        }
        assert_eq!(user.bool, if length < 138 { 0 } else { 0xA5C3 });
    }
}
