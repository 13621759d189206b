//! `include/stratum.h` against what its numbers are made from.

use std::collections::BTreeMap;
use std::ffi::CStr;

use controller_core::fault::{FaultKind, LimitKind};
use stratum::header::HEADER;
use stratum::{stratum_error_name, stratum_error_text};

/// The enumerators of the header.
fn enumerators() -> BTreeMap<&'static str, i32> {
    let mut found = BTreeMap::new();
    for line in include_str!("../include/stratum.h").lines() {
        let line = line.trim().strip_suffix(',');
        let Some((name, number)) = line.and_then(|line| line.split_once(" = ")) else {
            continue;
        };
        if name.starts_with("STRATUM_") {
            let number = number.parse().expect("a number");
            assert_eq!(found.insert(name, number), None, "{name} twice");
        }
    }
    found
}

/// What the core's registry says, and nothing else, begins with `prefix`.
fn same_as_the_core(prefix: &str, kinds: impl Iterator<Item = (u8, &'static str)>) {
    let core: BTreeMap<_, _> = kinds
        .map(|(number, name)| (prefix.to_owned() + &name.to_uppercase(), i32::from(number)))
        .collect();
    let header: BTreeMap<_, _> = enumerators()
        .into_iter()
        .filter(|(name, _)| name.starts_with(prefix))
        .map(|(name, number)| (name.to_owned(), number))
        .collect();
    assert_eq!(header, core, "controller-capi/check.sh header");
}

fn word(pointer: *const std::ffi::c_char) -> &'static str {
    // SAFETY: names and texts are constants.
    unsafe { CStr::from_ptr(pointer) }.to_str().expect("ASCII")
}

#[test]
fn faults_and_limits_are_those_of_the_core() {
    let faults = FaultKind::ALL.iter();
    same_as_the_core(
        "STRATUM_FAULT_",
        faults.map(|kind| (kind.number(), kind.name())),
    );
    let limits = LimitKind::ALL.iter();
    same_as_the_core(
        "STRATUM_LIMIT_",
        limits.map(|kind| (kind.number(), kind.name())),
    );
    for kind in FaultKind::ALL {
        assert!(word(stratum_error_text(kind.number().into())).contains(kind.meaning()));
    }
    for kind in LimitKind::ALL {
        assert!(word(stratum_error_text(kind.number().into())).contains(kind.meaning()));
    }
}

#[test]
fn every_constant_is_in_the_header_with_its_number() {
    let crates: BTreeMap<_, _> = HEADER
        .into_iter()
        .flatten()
        .flat_map(|names| names.constants.iter().copied().flatten())
        .map(|constant| (constant.name.to_str().expect("ASCII"), constant.number))
        .collect();
    assert_eq!(enumerators(), crates, "controller-capi/check.sh header");
}

/// Version 1 had these names with these numbers.
#[test]
fn no_name_of_version_1_is_gone_or_stands_for_another_number() {
    #[rustfmt::skip]
    const OLD: [(&str, i32); 41] = [
        ("STRATUM_OK", 0), ("STRATUM_ERROR_NULL", 1), ("STRATUM_ERROR_MISALIGNED", 2),
        ("STRATUM_ERROR_UNINITIALISED", 3), ("STRATUM_ERROR_NON_FINITE", 4),
        ("STRATUM_ERROR_LEVEL", 5), ("STRATUM_ERROR_ORIENTATION", 6),
        ("STRATUM_ERROR_MISMATCH", 7), ("STRATUM_ERROR_ABI", 8), ("STRATUM_ERROR_PRESET", 9),
        ("STRATUM_ERROR_TEXT_SIZE", 10), ("STRATUM_FAULT_IMPLAUSIBLE", 32),
        ("STRATUM_FAULT_NON_FINITE_TORQUE", 33), ("STRATUM_CONFIG_OTHER", 128),
        ("STRATUM_CONFIG_LEVELS", 129), ("STRATUM_CONFIG_CHOICE", 130),
        ("STRATUM_CONFIG_ROWS", 131), ("STRATUM_CONFIG_NO_AXIS", 132),
        ("STRATUM_CONFIG_POINT_LINK", 133), ("STRATUM_CONFIG_POINT_OFFSET", 134),
        ("STRATUM_CONFIG_GAIN_VALUE", 135), ("STRATUM_CONFIG_GAIN_SYMMETRY", 136),
        ("STRATUM_CONFIG_GAIN_DEFINITE", 137), ("STRATUM_CONFIG_OBSERVER_GAIN", 138),
        ("STRATUM_CONFIG_CYCLE", 139), ("STRATUM_CONFIG_DEAD_CYCLES", 140),
        ("STRATUM_CONFIG_INERTIA_DAMPING", 141), ("STRATUM_CONFIG_DAMPING", 142),
        ("STRATUM_CONFIG_ARM_NON_FINITE", 160), ("STRATUM_CONFIG_ARM_NOT_POSITIVE", 161),
        ("STRATUM_CONFIG_ARM_INERTIA", 162), ("STRATUM_TASK_POSITION", 0),
        ("STRATUM_TASK_ORIENTATION", 1), ("STRATUM_AXIS_X", 1), ("STRATUM_AXIS_Y", 2),
        ("STRATUM_AXIS_Z", 4), ("STRATUM_DAMPING_JOINT", 0), ("STRATUM_DAMPING_INERTIA", 1),
        ("STRATUM_POSTURE_CONSTANT", 0), ("STRATUM_POSTURE_INTEGRAL_COUPLED", 1),
        ("STRATUM_POSTURE_INTEGRAL_UNCOUPLED", 2),
    ];
    let header = enumerators();
    for (name, number) in OLD {
        assert_eq!(header.get(name), Some(&number), "{name}");
    }
}

#[test]
fn every_code_has_a_name_and_a_text_of_its_own() {
    let mut texts = std::collections::HashSet::new();
    for (name, number) in enumerators() {
        let kinds = [
            "STRATUM_OK",
            "STRATUM_ERROR_",
            "STRATUM_FAULT_",
            "STRATUM_LIMIT_",
            "STRATUM_CONFIG_",
        ];
        if kinds.iter().any(|kind| name.starts_with(kind)) {
            assert_eq!(word(stratum_error_name(number)), name);
            assert!(texts.insert(word(stratum_error_text(number))));
        }
    }
    for number in [-1, 31, 95, 127, i32::MAX, i32::MIN] {
        assert_eq!(word(stratum_error_name(number)), "unknown");
        assert_eq!(word(stratum_error_text(number)), "no such code");
    }
}
