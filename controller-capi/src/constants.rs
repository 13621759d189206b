//! The constants of the header that are names for numbers: each is declared once, here
//! or in the core's registry of faults and limits, and becomes a Rust constant where
//! tests need one, a row for stratum_error_name and stratum_error_text, and a line of
//! `include/stratum.h` (`examples/numbers.rs`).
//!
//! In C they are enumerators, but fields and arguments are integers of fixed size: their
//! layout does not depend on the compiler's choice for an enumeration, and a number that
//! no name stands for is a number like any other, to be refused.

use core::ffi::CStr;

/// A name for a number.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    /// The number.
    pub number: i32,
    /// The name.
    pub name: &'static CStr,
    /// What it means.
    pub text: &'static CStr,
}

/// An integer type of the header and the names for its numbers.
#[derive(Clone, Copy, Debug)]
pub struct Names {
    /// The type.
    pub kind: &'static str,
    /// What it is in C.
    pub integer: &'static str,
    /// What its numbers are.
    pub about: &'static str,
    /// The names.
    pub constants: &'static [&'static [Constant]],
}

/// A C string from a literal with a zero at its end.
pub(crate) const fn c(text: &'static str) -> &'static CStr {
    match CStr::from_bytes_with_nul(text.as_bytes()) {
        Ok(text) => text,
        Err(_) => panic!("a text with one zero, at its end"),
    }
}

/// Rust constants, and the list of them.
macro_rules! constants {
    ($list:ident: $kind:ident { $($name:ident = $number:literal, $text:literal;)* }) => {
        $(#[doc = $text] pub const $name: $kind = $number;)*

        /// All of them.
        pub const $list: &[$crate::constants::Constant] = &[$($crate::constants::Constant {
            number: $number,
            name: $crate::constants::c(concat!(stringify!($name), "\0")),
            text: $crate::constants::c(concat!($text, "\0")),
        }),*];
    };
}
pub(crate) use constants;

/// Choices: an integer type, its constants, and what the header says of them.
macro_rules! choices {
    ($(#[doc = $about:literal] $list:ident: $kind:ident $constants:tt)*) => {
        $(
            #[doc = $about]
            pub type $kind = u32;
            constants! { $list: $kind $constants }
        )*

        pub(crate) const CHOICES: &[Names] = &[$(Names {
            kind: stringify!($kind),
            integer: "uint32_t",
            about: $about,
            constants: &[$list],
        }),*];
    };
}

choices! {
    /// What a level tracks.
    TASK_KINDS: StratumTaskKind {
        STRATUM_TASK_POSITION = 0, "the position of the point";
        STRATUM_TASK_ORIENTATION = 1, "the orientation of the frame; the offset is not read";
    }
    /// Axes that a level controls, base plate: a sum of at least one.
    AXES: StratumAxes {
        STRATUM_AXIS_X = 1, "along x, for an orientation about x";
        STRATUM_AXIS_Y = 2, "along y";
        STRATUM_AXIS_Z = 4, "along z";
    }
    /// Damping of the null space.
    DAMPING_KINDS: StratumDampingKind {
        STRATUM_DAMPING_JOINT = 0, "a constant matrix: null_damping";
        STRATUM_DAMPING_INERTIA = 1, "the mass matrix times null_damping_rate";
    }
    /// Posture towards which the null space is compliant.
    POSTURE_KINDS: StratumPostureKind {
        STRATUM_POSTURE_CONSTANT = 0, "the posture that was set";
        STRATUM_POSTURE_INTEGRAL_COUPLED = 1, "the integral of the task motion, with coupling";
        STRATUM_POSTURE_INTEGRAL_UNCOUPLED = 2,
            "the integral of the task motion, without coupling";
    }
    /// What a level does that came to rest because its reference is too old.
    STALE_KINDS: StratumStaleKind {
        STRATUM_STALE_HOLD = 0, "it stays";
        STRATUM_STALE_RELEASE = 1, "it goes until there is a fresh one";
    }
    /// What a cycle is part of; a fault is latched from STRATUM_MODE_BRAKING on.
    MODES: StratumMode {
        STRATUM_MODE_RUNNING = 0, "the law moves the arm";
        STRATUM_MODE_LIMITED = 1, "the law moves the arm, and a limit was active";
        STRATUM_MODE_BRAKING = 2, "a fault, and the arm moves: it is braked";
        STRATUM_MODE_RESTING = 3, "a fault, and the arm rests: it is held by gravity torque";
        STRATUM_MODE_BLIND = 4,
            "a fault, and no measurement can be followed: the torque fades, the drives should \
             close their brakes";
        STRATUM_MODE_STOPPED = 5, "the torque has faded to zero; only a reset leads out";
    }
    /// What a reference asks of its level.
    TARGET_KINDS: StratumTargetKind {
        STRATUM_TARGET_HOLD = 0,
            "rest where the level is in the first cycle of holding; for every task";
        STRATUM_TARGET_POSITION = 1,
            "a position with velocity and acceleration: x, dx, ddx; for STRATUM_TASK_POSITION";
        STRATUM_TARGET_ORIENTATION = 2,
            "an orientation with angular velocity and acceleration: orientation, dx, ddx; for \
             STRATUM_TASK_ORIENTATION";
    }
}
