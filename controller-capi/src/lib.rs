//! The C interface of the core: `include/stratum.h` and `libstratum.a`.
//!
//! The caller owns all storage, opaque and of constant size; nothing is
//! allocated, every function is total: it answers a code and never panics. The
//! header is generated from this crate by `controller-capi/check.sh header`.
//!
//! Numbers cross the border as `double` whatever the library computes in; with
//! the feature `single` it computes in `f32`.

#![cfg_attr(target_os = "none", no_std)]
// The contract of all pointers is one: `border`.
#![allow(clippy::missing_safety_doc)]
// What cbindgen reads in comments looks like links.
#![allow(rustdoc::broken_intra_doc_links)]

use core::ffi::{CStr, c_char};
use core::mem::MaybeUninit;

use controller_core::arm::ArmParameters;
use controller_core::fault::Status;
use controller_core::joint::JointVector;
use controller_core::real::Real;
use controller_core::{Controller, Measurement, Step};

mod border;
mod codes;
pub mod constants;
pub mod header;
mod scalar;
// The header has their sizes in this order.
mod storage;

mod status;

mod arm;
mod changes;
mod reference;
mod settings;

pub use arm::*;
pub use changes::*;
pub use codes::*;
pub use constants::*;
pub use reference::{STRATUM_REFERENCE_SIZE, StratumReference};
pub use scalar::Scalar;
pub use settings::*;
pub use status::*;
pub use storage::*;

use border::Held;
use codes::code;
use reference::index;
use scalar::finite;

const VERSION: &CStr =
    match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(version) => version,
        Err(_) => c"",
    };

/// Version of the library, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn stratum_version() -> *const c_char {
    VERSION.as_ptr()
}

/// Version of the library's interface: STRATUM_ABI_VERSION of its header.
#[unsafe(no_mangle)]
pub extern "C" fn stratum_abi_version() -> u32 {
    STRATUM_ABI_VERSION
}

/// Bits of the numbers the library computes in: 64 or 32.
#[unsafe(no_mangle)]
pub extern "C" fn stratum_precision() -> u32 {
    Scalar::default().to_bits().count_zeros()
}

/// Name of a code or limit, such as "STRATUM_ERROR_NULL"; never null.
#[unsafe(no_mangle)]
pub extern "C" fn stratum_error_name(result: StratumResult) -> *const c_char {
    codes::name(result).as_ptr()
}

/// Text of a code or limit; never null.
#[unsafe(no_mangle)]
pub extern "C" fn stratum_error_text(result: StratumResult) -> *const c_char {
    codes::text(result).as_ptr()
}

/// The built-in arm of this name; all names are in the text of STRATUM_ERROR_PRESET.
unsafe fn arm_of_name(name: *const c_char) -> Result<&'static ArmParameters, StratumResult> {
    for arm in arms::ALL {
        // SAFETY: the contract of the header.
        if unsafe { border::is_name(name, arm.name) }? {
            return Ok(arm);
        }
    }
    Err(STRATUM_ERROR_PRESET)
}

/// Tables of a built-in arm, such as "lwr_iv" or "fr3"; all names are in the text of
/// STRATUM_ERROR_PRESET. To start from, or to change how it is mounted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_arm_preset(
    name: *const c_char,
    arm: *mut StratumArm,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe { arm_of_name(name).and_then(|table| border::put(arm, StratumArm::new(table))) })
}

/// Settings to start from: the LWR IV+ without tool, its flange in x, y, z as the one level
/// (all seven are prepared alike), compliant null space, cycle of 2 ms. `abi` is
/// STRATUM_ABI_VERSION of the header that the caller was compiled with.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_settings_default(
    abi: u32,
    settings: *mut StratumSettings,
) -> StratumResult {
    if abi != STRATUM_ABI_VERSION {
        return STRATUM_ERROR_ABI;
    }
    // SAFETY: the contract of the header.
    code(unsafe { border::put(settings, StratumSettings::LWR_IV) })
}

/// The same of a built-in arm, as in stratum_arm_preset; the damping of another arm than the
/// LWR IV+ is STRATUM_DAMPING_INERTIA. Apart from stratum_settings_default, so that a program
/// which names no arm is linked with one table.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_settings_of_arm(
    abi: u32,
    name: *const c_char,
    settings: *mut StratumSettings,
) -> StratumResult {
    if abi != STRATUM_ABI_VERSION {
        return STRATUM_ERROR_ABI;
    }
    // SAFETY: the contract of the header.
    code(unsafe {
        arm_of_name(name).and_then(|table| {
            border::put(settings, StratumSettings::LWR_IV)?;
            border::get_mut(settings).map(|settings| settings.set_arm(table))
        })
    })
}

/// Says of settings what stratum_controller_init says, and why: thing, value and
/// what is allowed, as a text of at most size - 1 characters; empty for good settings.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_settings_text(
    settings: *const StratumSettings,
    text: *mut c_char,
    size: usize,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe {
        let mut place = MaybeUninit::uninit();
        border::get(settings).and_then(|settings| {
            match settings.controller(Controller::new, &mut place) {
                Ok(_) => border::write_text(text, size, ""),
                Err(refusal) => border::write_text(text, size, refusal).and(Err(refusal.code())),
            }
        })
    })
}

/// Validates the settings and makes a controller of them. After an error the
/// storage holds no controller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_controller_init(
    controller: *mut StratumController,
    settings: *const StratumSettings,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe {
        border::fill(controller, |place| {
            let made = border::get(settings)?.controller(Controller::new, place);
            made.map_err(|refusal| refusal.code())
        })
    })
}

/// The same with the exact law, which knows nothing of singularities, ranges and speed limits.
/// A program that never calls stratum_controller_init is linked with this law alone.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_controller_init_exact(
    controller: *mut StratumController,
    settings: *const StratumSettings,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe {
        border::fill(controller, |place| {
            let made = border::get(settings)?.controller(Controller::exact, place);
            made.map_err(|refusal| refusal.code())
        })
    })
}

/// Before the first cycle: nothing observed, no fault; the references keep every
/// level and the null space at the posture `q` in rad, which must be one that the arm can
/// have (STRATUM_FAULT_IMPLAUSIBLE).
/// cbindgen:ptrs-as-arrays=[[q;STRATUM_JOINTS]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_state_init(
    state: *mut StratumState,
    controller: *const StratumController,
    q: *const f64,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe {
        border::fill(state, |place| {
            let controller = border::held(controller)?;
            let q = posture(controller, border::array(q)?)?;
            let held = Held::new(place);
            held.rest(controller, &q);
            Ok(held)
        })
    })
}

/// A posture that an arm can have, as a cycle would believe it.
fn posture(
    controller: &Controller<Scalar>,
    q: [f64; STRATUM_JOINTS],
) -> Result<JointVector<Scalar>, StratumResult> {
    let q = finite(q)?.into();
    match controller.believe_posture(&q) {
        Ok(()) => Ok(q),
        Err(fault) => Err(codes::of_fault(fault.kind)),
    }
}

impl Held {
    /// References that rest in the posture `q`.
    fn rest(&mut self, controller: &Controller<Scalar>, q: &JointVector<Scalar>) {
        self.reference = controller.rest_reference_of(&self.state, q);
        self.kinds = [STRATUM_TARGET_HOLD; STRATUM_LEVELS];
        for (kind, target) in self.kinds.iter_mut().zip(self.reference.targets()) {
            *kind = reference::kind(target);
        }
    }
}

/// Sets all references to rest where the posture `q` in rad puts them, one that the arm can
/// have (STRATUM_FAULT_IMPLAUSIBLE).
/// cbindgen:ptrs-as-arrays=[[q;STRATUM_JOINTS]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_reference_hold(
    state: *mut StratumState,
    controller: *const StratumController,
    q: *const f64,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe { border::held_mut(state) }.and_then(|held| {
        // SAFETY: likewise.
        let (controller, q) = unsafe { (border::held(controller)?, border::array(q)?) };
        held.rest(controller, &posture(controller, q)?);
        Ok(())
    }))
}

/// Sets the reference of a level, from the next step on. One of another kind than the
/// level's task is refused, and so is a hold with numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_reference_set(
    state: *mut StratumState,
    level: u32,
    reference: *const StratumReference,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe { border::held_mut(state) }.and_then(|held| {
        // SAFETY: likewise.
        let reference = unsafe { border::get(reference) }?;
        let index = index(level).ok_or(STRATUM_ERROR_LEVEL)?;
        let places = held
            .reference
            .targets_mut()
            .get_mut(index)
            .zip(held.kinds.get(index));
        let (place, &followed) = places.ok_or(STRATUM_ERROR_LEVEL)?;
        let target = reference.target()?;
        let kind = reference::kind(&target);
        if kind != STRATUM_TARGET_HOLD && kind != followed {
            return Err(STRATUM_ERROR_WRONG_TARGET);
        }
        *place = target;
        Ok(())
    }))
}

/// The reference of a level as it is set: after stratum_state_init where the level
/// is, to start a motion from.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_reference_get(
    state: *const StratumState,
    level: u32,
    reference: *mut StratumReference,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe { border::held(state) }.and_then(|held| {
        let set = index(level)
            .and_then(|index| held.reference.targets().get(index))
            .ok_or(STRATUM_ERROR_LEVEL)?;
        // SAFETY: likewise.
        unsafe { border::put(reference, set.into()) }
    }))
}

/// Sets the posture in rad towards which the null space is compliant.
/// cbindgen:ptrs-as-arrays=[[posture;STRATUM_JOINTS]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_posture_set(
    state: *mut StratumState,
    posture: *const f64,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe { border::held_mut(state) }.and_then(|held| {
        // SAFETY: likewise.
        held.reference.posture =
            finite::<STRATUM_JOINTS>(unsafe { border::array(posture) }?)?.into();
        Ok(())
    }))
}

/// One cycle: posture in rad, speeds in rad/s, time since the last measurement in s
/// (the nominal cycle at first); torque in Nm, always finite and within limits.
/// A measurement that cannot be true latches a fault: its number is answered, the
/// torque brakes the arm and holds it, see STRATUM_MODE_BRAKING and behind, until
/// stratum_reset. On an argument error the torque is zero and the state is as
/// before. q, dq and torque may be the same array.
/// cbindgen:ptrs-as-arrays=[[q;STRATUM_JOINTS], [dq;STRATUM_JOINTS], [torque;STRATUM_JOINTS]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_step(
    controller: *const StratumController,
    state: *mut StratumState,
    q: *const f64,
    dq: *const f64,
    interval_s: f64,
    torque: *mut f64,
) -> StratumResult {
    let torque = torque.cast::<[f64; STRATUM_JOINTS]>();
    // SAFETY: the contract of the header. The measurement is copied before the
    // torque is written.
    unsafe {
        let measured = border::array(q).and_then(|q| Ok((q, border::array(dq)?)));
        if let Err(error) = border::put(torque, [0.0; STRATUM_JOINTS]) {
            return error;
        }
        let (controller, held, (q, dq)) =
            match (border::held(controller), border::held_mut(state), measured) {
                (Ok(controller), Ok(held), Ok(measured)) => (controller, held, measured),
                (Err(error), ..) | (_, Err(error), _) | (.., Err(error)) => return error,
            };
        if controller.level_count() != held.reference.targets().len() {
            return STRATUM_ERROR_MISMATCH;
        }
        let measurement = Measurement {
            q: q.map(Scalar::from_f64).into(),
            dq: dq.map(Scalar::from_f64).into(),
            interval_s: Scalar::from_f64(interval_s),
        };
        held.step = controller.step(&mut held.state, &measurement, &held.reference);
        torque.write(held.step.torque.map(Real::to_f64).into());
        held.step
            .status
            .fault
            .map_or(STRATUM_OK, |fault| codes::of_fault(fault.kind))
    }
}

/// What limited or degraded the last cycle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_status(
    state: *const StratumState,
    status: *mut StratumStatus,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe { border::held(state) }.and_then(|held| {
        let Status {
            mode,
            fault,
            saturated,
            rank,
            rate_limited,
            joining,
            degraded,
            released,
            shaped,
            scaled,
            at_least,
            at_greatest,
            unresolved,
            stuck,
            changing,
            stale,
            pivots,
        } = held.step.status;
        let mut answer = StratumStatus {
            saturated: u32::from(saturated.0),
            rank: u32::from(rank.0),
            torque_rate: u32::from(rate_limited.0),
            mode: u32::from(mode.number()),
            joining: u32::from(joining.0),
            degraded: u32::from(degraded.0),
            released: u32::from(released.0),
            shaped: u32::from(shaped.0),
            scaled: u32::from(scaled.0),
            at_least: u32::from(at_least.0),
            at_greatest: u32::from(at_greatest.0),
            unresolved: u32::from(unresolved),
            stuck: u32::from(stuck.0),
            changing: u32::from(changing.0),
            stale: u32::from(stale.0),
            pivots: u32::from(pivots),
            ..StratumStatus::default()
        };
        if let Some(fault) = fault {
            answer.fault = codes::of_fault(fault.kind);
            answer.fault_index = u32::from(fault.index);
            answer.fault_value = fault.value;
            answer.fault_min = fault.min;
            answer.fault_max = fault.max;
        }
        // SAFETY: likewise.
        unsafe { border::put(status, answer) }
    }))
}

/// The latched fault as a text of at most size - 1 characters: quantity, value, what
/// is allowed; empty if there is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_fault_text(
    state: *const StratumState,
    text: *mut c_char,
    size: usize,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe {
        border::held(state).and_then(|held| match held.state.fault() {
            Some(fault) => border::write_text(text, size, fault),
            None => border::write_text(text, size, ""),
        })
    })
}

/// One joint vector of the last cycle.
unsafe fn last(
    state: *const StratumState,
    values: *mut f64,
    pick: fn(&Step<Scalar>) -> [Scalar; STRATUM_JOINTS],
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe {
        border::held(state).and_then(|held| {
            let values = values.cast::<[f64; STRATUM_JOINTS]>();
            border::put(values, pick(&held.step).map(Real::to_f64))
        })
    })
}

/// Residual of the last cycle in Nm, tends to minus the torque that the arm exerts
/// on its environment; zero while a fault is latched.
/// cbindgen:ptrs-as-arrays=[[residual;STRATUM_JOINTS]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_residual(
    state: *const StratumState,
    residual: *mut f64,
) -> StratumResult {
    // SAFETY: the contract of the header.
    unsafe { last(state, residual, |step| step.residual.into()) }
}

/// Gravity torque of the last cycle in Nm, contained in the torque: to be taken off
/// for a robot that adds gravity itself.
/// cbindgen:ptrs-as-arrays=[[gravity;STRATUM_JOINTS]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_gravity(
    state: *const StratumState,
    gravity: *mut f64,
) -> StratumResult {
    // SAFETY: the contract of the header.
    unsafe { last(state, gravity, |step| step.gravity.into()) }
}

/// Coriolis and centrifugal torque of the last cycle in Nm, contained in the torque.
/// cbindgen:ptrs-as-arrays=[[coriolis;STRATUM_JOINTS]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_coriolis(
    state: *const StratumState,
    coriolis: *mut f64,
) -> StratumResult {
    // SAFETY: the contract of the header.
    unsafe { last(state, coriolis, |step| step.coriolis.into()) }
}

/// Tells the observer that `torque` in Nm has acted since the last cycle instead of
/// the one it assumes: for links that round, scale or lose torques.
/// cbindgen:ptrs-as-arrays=[[torque;STRATUM_JOINTS]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_applied(
    state: *mut StratumState,
    torque: *const f64,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe { border::held_mut(state) }.and_then(|held| {
        // SAFETY: likewise.
        let torque = finite::<STRATUM_JOINTS>(unsafe { border::array(torque) }?)?;
        held.state.set_applied_torque(&torque.into());
        Ok(())
    }))
}

/// The next cycle comes after a gap that is too long to be an interval, or is the first with
/// a controller of the same arm with another tool: the observer keeps its residual and takes
/// the momentum anew.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_skip(state: *mut StratumState) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe { border::held_mut(state) }.map(|held| held.state.resume_after_gap()))
}

/// The next references are followed as they are: a jump is not joined. For callers whose
/// references start where the arm is, or who join them themselves.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_follow_at_once(state: *mut StratumState) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe { border::held_mut(state) }.map(|held| held.state.follow_at_once()))
}

/// Clears a latched fault; the observer starts anew, the references stay.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_reset(state: *mut StratumState) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe { border::held_mut(state) }.map(|held| {
        held.state.reset();
        held.step = Held::IDLE;
    }))
}

/// Nothing in this library panics; the compiler wants a handler nevertheless.
#[cfg(all(feature = "panic-handler", target_os = "none", not(test)))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
