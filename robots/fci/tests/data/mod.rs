//! The wire format as data, written down a second time: offsets, sizes, codes, and
//! messages made of them without the codec.
#![allow(dead_code)] // each test uses its part

use fci::Version;

/// Fields of reals of the state: name, numbers, offset up to version 9, in version 10.
pub const REALS: [(&str, usize, Option<usize>, usize); 42] = [
    ("O_T_EE", 16, Some(8), 8),
    ("O_T_EE_d", 16, Some(136), 72),
    ("F_T_EE", 16, Some(264), 136),
    ("EE_T_K", 16, Some(392), 200),
    ("F_T_NE", 16, Some(520), 264),
    ("NE_T_EE", 16, Some(648), 328),
    ("m_ee", 1, Some(776), 392),
    ("I_ee", 9, Some(784), 396),
    ("F_x_Cee", 3, Some(856), 432),
    ("m_load", 1, Some(880), 444),
    ("I_load", 9, Some(888), 448),
    ("F_x_Cload", 3, Some(960), 484),
    ("elbow", 2, Some(984), 496),
    ("elbow_d", 2, Some(1000), 504),
    ("tau_J", 7, Some(1016), 512),
    ("tau_J_d", 7, Some(1072), 540),
    ("dtau_J", 7, Some(1128), 568),
    ("q", 7, Some(1184), 596),
    ("q_d", 7, Some(1240), 624),
    ("dq", 7, Some(1296), 652),
    ("dq_d", 7, Some(1352), 680),
    ("ddq_d", 7, Some(1408), 708),
    ("joint_contact", 7, Some(1464), 736),
    ("cartesian_contact", 6, Some(1520), 764),
    ("joint_collision", 7, Some(1568), 788),
    ("cartesian_collision", 6, Some(1624), 816),
    ("tau_ext_hat_filtered", 7, Some(1672), 840),
    ("O_F_ext_hat_K", 6, Some(1728), 868),
    ("K_F_ext_hat_K", 6, Some(1776), 892),
    ("O_dP_EE_d", 6, Some(1824), 916),
    ("O_ddP_O", 3, Some(1872), 940),
    ("elbow_c", 2, Some(1896), 952),
    ("delbow_c", 2, Some(1912), 960),
    ("ddelbow_c", 2, Some(1928), 968),
    ("O_T_EE_c", 16, Some(1944), 976),
    ("O_dP_EE_c", 6, Some(2072), 1040),
    ("O_ddP_EE_c", 6, Some(2120), 1064),
    ("theta", 7, Some(2168), 1088),
    ("dtheta", 7, Some(2224), 1116),
    ("accelerometer_top", 18, None, 1144),
    ("accelerometer_bottom", 18, None, 1216),
    ("control_command_success_rate", 1, Some(2365), 1373),
];

/// The state in one precision.
pub struct StateLayout {
    pub len: usize,
    /// Bytes of a real.
    pub real: usize,
    pub motion_generator_mode: usize,
    pub controller_mode: usize,
    pub errors: usize,
    pub reflex_reason: usize,
    pub robot_mode: usize,
}

pub const DOUBLE: StateLayout = StateLayout {
    len: 2373,
    real: 8,
    motion_generator_mode: 2280,
    controller_mode: 2281,
    errors: 2282,
    reflex_reason: 2323,
    robot_mode: 2364,
};

pub const SINGLE: StateLayout = StateLayout {
    len: 1377,
    real: 4,
    motion_generator_mode: 1288,
    controller_mode: 1289,
    errors: 1290,
    reflex_reason: 1331,
    robot_mode: 1372,
};

pub fn layout(version: Version) -> StateLayout {
    if version == Version::V10 {
        SINGLE
    } else {
        DOUBLE
    }
}

/// Largest motion generator mode.
pub fn generator_mode_max(version: Version) -> u8 {
    if version == Version::V5 { 4 } else { 5 }
}

/// Number `index` of a field: all different, exact in binary32.
pub fn number(name: &str, index: usize) -> f64 {
    let field = REALS.iter().position(|it| it.0 == name).expect("a field");
    (32 * field + index) as f64 + 0.25
}

/// A state of these numbers: message_id 0x0102030405060708, joint velocity, external, move,
/// every third error, every fifth reflex reason.
pub fn state(version: Version) -> Vec<u8> {
    let layout = layout(version);
    let mut bytes = vec![0; layout.len];
    bytes[..8].copy_from_slice(&0x0102_0304_0506_0708_u64.to_le_bytes());
    for (name, count, double, single) in REALS {
        for index in 0..count {
            let value = number(name, index);
            if layout.real == 4 {
                let at = single + 4 * index;
                bytes[at..at + 4].copy_from_slice(&(value as f32).to_le_bytes());
            } else if let Some(first) = double {
                let at = first + 8 * index;
                bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
            }
        }
    }
    bytes[layout.motion_generator_mode] = 2;
    bytes[layout.controller_mode] = 2;
    bytes[layout.robot_mode] = 2;
    for i in 0..41 {
        bytes[layout.errors + i] = u8::from(i % 3 == 0);
        bytes[layout.reflex_reason + i] = u8::from(i % 5 == 0);
    }
    bytes
}

/// Truth values of a command.
pub fn command_bools(version: Version) -> &'static [usize] {
    match version {
        Version::V5 | Version::V6 => &[312, 313],
        _ => &[312, 313, 370],
    }
}

/// A command: message_id 7, reals 0.5, 1.5 .. in the order of the wire, every second truth value.
pub fn command(version: Version) -> Vec<u8> {
    let mut bytes = 7u64.to_le_bytes().to_vec();
    let reals =
        |range: std::ops::Range<u32>| range.flat_map(|i| (f64::from(i) + 0.5).to_le_bytes());
    bytes.extend(reals(0..38));
    bytes.extend([1, 0]);
    bytes.extend(reals(38..45));
    if command_bools(version).len() == 3 {
        bytes.push(1);
    }
    bytes
}

/// A request and its replies.
pub struct Exchange {
    pub name: &'static str,
    /// Codes in version 5, in 6 and 7, in 8 and 9, in 10.
    codes: [Option<u32>; 4],
    /// Bytes of the request's payload before version 10, in it.
    len: [usize; 2],
    /// Truth values of the request in version 10; behind the end of the others there are none.
    pub bools: &'static [usize],
    /// Codes in the request: offset, bytes, largest in version 5, later.
    pub fields: &'static [(usize, usize, u8, u8)],
    /// Least bytes of a reply's payload.
    pub reply_len: usize,
    /// Truth value of the reply.
    pub reply_bool: Option<usize>,
    /// Largest status in version 5, later.
    statuses: [u8; 2],
    /// Whether everything behind the status belongs to the reply.
    pub is_open: bool,
}

const fn plain(
    name: &'static str,
    codes: [Option<u32>; 4],
    len: usize,
    statuses: [u8; 2],
) -> Exchange {
    Exchange {
        name,
        codes,
        len: [len, len],
        bools: &[],
        fields: &[],
        reply_len: 1,
        reply_bool: None,
        statuses,
        is_open: false,
    }
}

const SETTER: [u8; 2] = [2, 3];

pub const EXCHANGES: [Exchange; 15] = [
    Exchange {
        reply_len: 3,
        ..plain("Connect", [Some(0); 4], 4, [1, 1])
    },
    Exchange {
        len: [56, 113],
        bools: &[56],
        fields: &[(0, 4, 2, 2), (4, 4, 3, 4)],
        ..plain("Move", [Some(1); 4], 56, [9, 11])
    },
    plain("StopMove", [Some(2); 4], 0, [4, 5]),
    Exchange {
        reply_len: 154,
        reply_bool: Some(153),
        ..plain("GetCartesianLimit", [Some(3), None, None, None], 4, SETTER)
    },
    plain(
        "SetCollisionBehavior",
        [Some(4), Some(3), Some(3), Some(3)],
        416,
        SETTER,
    ),
    plain(
        "SetJointImpedance",
        [Some(5), Some(4), Some(4), Some(4)],
        56,
        SETTER,
    ),
    plain(
        "SetCartesianImpedance",
        [Some(6), Some(5), Some(5), Some(5)],
        48,
        SETTER,
    ),
    Exchange {
        bools: &[0, 1, 2, 3, 4, 5, 6],
        ..plain(
            "SetGuidingMode",
            [Some(7), Some(6), Some(6), Some(6)],
            7,
            SETTER,
        )
    },
    plain(
        "SetEEToK",
        [Some(8), Some(7), Some(7), Some(7)],
        128,
        SETTER,
    ),
    plain(
        "SetNEToEE",
        [Some(9), Some(8), Some(8), Some(8)],
        128,
        SETTER,
    ),
    plain(
        "SetLoad",
        [Some(10), Some(9), Some(9), Some(9)],
        104,
        SETTER,
    ),
    plain("SetFilters", [Some(11), None, None, None], 40, SETTER),
    plain(
        "AutomaticErrorRecovery",
        [Some(12), Some(10), Some(10), Some(10)],
        0,
        [5, 6],
    ),
    Exchange {
        fields: &[(0, 1, 3, 3), (1, 1, 1, 1)],
        is_open: true,
        ..plain(
            "LoadModelLibrary",
            [Some(13), Some(11), Some(11), None],
            2,
            [1, 1],
        )
    },
    Exchange {
        is_open: true,
        ..plain("GetRobotModel", [None, None, Some(12), Some(11)], 0, [2, 2])
    },
];

impl Exchange {
    pub fn code(&self, version: Version) -> Option<u32> {
        self.codes[match version.number() {
            5 => 0,
            6 | 7 => 1,
            8 | 9 => 2,
            _ => 3,
        }]
    }

    pub fn request_len(&self, version: Version) -> usize {
        self.len[usize::from(version == Version::V10)]
    }

    pub fn status_max(&self, version: Version) -> u8 {
        self.statuses[usize::from(version > Version::V5)]
    }

    pub fn field_max(version: Version, field: &(usize, usize, u8, u8)) -> u8 {
        if version == Version::V5 {
            field.2
        } else {
            field.3
        }
    }
}

/// The one with this code.
pub fn exchange(version: Version, code: u32) -> Option<&'static Exchange> {
    const ALL: &[Exchange] = &EXCHANGES;
    ALL.iter().find(|it| it.code(version) == Some(code))
}

/// A message.
pub fn message(code: u32, id: u32, payload: &[u8]) -> Vec<u8> {
    let size = 12 + payload.len() as u32;
    let header = [code, id, size].into_iter().flat_map(u32::to_le_bytes);
    header.chain(payload.iter().copied()).collect()
}

/// The payload of a request: its reals, 1.25, 2.25 .., its truth values and codes 1.
pub fn request(exchange: &Exchange, version: Version) -> Vec<u8> {
    let len = exchange.request_len(version);
    let mut payload = vec![0; len];
    // Reals begin behind codes and other integers; in Move there is a truth value among them.
    let mut at = match exchange.name {
        "Connect" | "GetCartesianLimit" => {
            payload.copy_from_slice(&[10, 0, 0x39, 0x05]);
            len
        }
        _ => exchange
            .fields
            .iter()
            .map(|it| it.0 + it.1)
            .max()
            .unwrap_or(0),
    };
    for &(at, ..) in exchange.fields {
        payload[at] = 1;
    }
    let mut value = 1.25f64;
    while at < len {
        if exchange.bools.contains(&at) {
            payload[at] = 1;
            at += 1;
        } else {
            payload[at..at + 8].copy_from_slice(&value.to_le_bytes());
            value += 1.0;
            at += 8;
        }
    }
    payload
}

/// The payload of a reply with a status, and `more` bytes behind what it must have.
pub fn reply(exchange: &Exchange, status: u8, more: usize) -> Vec<u8> {
    let mut payload = vec![status];
    let len = exchange.reply_len;
    // One real after the other, then the truth value: GetCartesianLimit.
    let reals = (1..).flat_map(|i: u32| f64::from(i).to_le_bytes());
    payload.extend(reals.take(len.saturating_sub(2)));
    payload.resize(len, 1);
    payload.extend((0..more).map(|i| b'a' + (i % 26) as u8));
    payload
}
