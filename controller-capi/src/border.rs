//! Every access through a pointer of the caller, and nothing else.
//!
//! All functions check null and alignment. What they cannot check is the
//! contract of the header: a pointer that is neither null nor misaligned points
//! to an object of its type, and no other thread or interrupt handler uses this
//! object during the call.

use core::ffi::c_char;
use core::fmt::{self, Write};
use core::mem::MaybeUninit;
use core::slice;

use controller_core::fault::Status;
use controller_core::joint::zeros;
use controller_core::{Controller, Reference, State, Step};

use crate::codes::{
    STRATUM_ERROR_MISALIGNED, STRATUM_ERROR_NULL, STRATUM_ERROR_TEXT_SIZE,
    STRATUM_ERROR_UNINITIALISED, StratumResult,
};
use crate::constants::{STRATUM_TARGET_HOLD, StratumTargetKind};
use crate::scalar::Scalar;
use crate::settings::{STRATUM_ABI_VERSION, STRATUM_LEVELS};
use crate::storage::{StratumController, StratumState};

/// A state with what it was last told and what it last answered.
pub(crate) struct Held {
    pub state: State<Scalar>,
    pub reference: Reference<Scalar>,
    /// The kinds of targets that the levels can follow.
    pub kinds: [StratumTargetKind; STRATUM_LEVELS],
    pub step: Step<Scalar>,
}

impl Held {
    /// Before the first cycle and after a reset.
    pub(crate) const IDLE: Step<Scalar> = Step {
        torque: zeros(),
        residual: zeros(),
        gravity: zeros(),
        coriolis: zeros(),
        status: Status::CLEAR,
    };

    /// Before the first cycle, without levels. A call of its own: its stack is free again
    /// when the references are made.
    #[inline(never)]
    pub(crate) fn new(place: &mut MaybeUninit<Self>) -> &mut Self {
        let held = place.as_mut_ptr();
        // SAFETY: `held` points to a place for the fields; all four are written.
        unsafe {
            (&raw mut (*held).state).write(State::new());
            (&raw mut (*held).reference).write(Reference::hold(0, zeros()));
            (&raw mut (*held).kinds).write([STRATUM_TARGET_HOLD; STRATUM_LEVELS]);
            (&raw mut (*held).step).write(Self::IDLE);
            place.assume_init_mut()
        }
    }
}

/// What lies in a storage: a word that says so, then the content.
#[repr(C)]
pub(crate) struct Slot<T> {
    magic: u64,
    content: MaybeUninit<T>,
}

/// A storage of the header and what it holds.
pub(crate) trait Storage: Sized {
    type Content;
    /// Distinct per type, precision and version of the interface.
    const MAGIC: u64;
}

/// Lowest byte: version of the interface; next: bytes of the scalar.
const KIND: u64 = STRATUM_ABI_VERSION as u64 | (size_of::<Scalar>() as u64) << 8;

impl Storage for StratumController {
    type Content = Controller<Scalar>;
    const MAGIC: u64 = 0x5374_7261_436f_0000 | KIND;
}

impl Storage for StratumState {
    type Content = Held;
    const MAGIC: u64 = 0x5374_7261_5374_0000 | KIND;
}

/// A slot fits into its storage, or this does not compile.
const fn fits<S: Storage>() -> bool {
    size_of::<Slot<S::Content>>() <= size_of::<S>()
        && align_of::<Slot<S::Content>>() <= align_of::<S>()
}
const _: () = assert!(fits::<StratumController>(), "STRATUM_CONTROLLER_WORDS");
const _: () = assert!(fits::<StratumState>(), "STRATUM_STATE_WORDS");

fn check<T>(pointer: *const T) -> Result<(), StratumResult> {
    if pointer.is_null() {
        Err(STRATUM_ERROR_NULL)
    } else if pointer.is_aligned() {
        Ok(())
    } else {
        Err(STRATUM_ERROR_MISALIGNED)
    }
}

/// An argument that is read. Only for types of which every bit pattern is valid.
pub(crate) unsafe fn get<'a, T: Copy>(pointer: *const T) -> Result<&'a T, StratumResult> {
    check(pointer)?;
    // SAFETY: not null, aligned; the caller's contract is the rest.
    Ok(unsafe { &*pointer })
}

/// A result that is changed in its place. Only for what was written before.
pub(crate) unsafe fn get_mut<'a, T: Copy>(pointer: *mut T) -> Result<&'a mut T, StratumResult> {
    check(pointer)?;
    // SAFETY: not null, aligned, written; the caller's contract is the rest.
    Ok(unsafe { &mut *pointer })
}

/// An array that is read, by value: it may be the one that is written later.
pub(crate) unsafe fn array<const N: usize>(pointer: *const f64) -> Result<[f64; N], StratumResult> {
    // SAFETY: an array of f64 is aligned as one; the caller's contract is the rest.
    unsafe { get(pointer.cast::<[f64; N]>()) }.copied()
}

/// A result that is written.
pub(crate) unsafe fn put<T: Copy>(pointer: *mut T, value: T) -> Result<(), StratumResult> {
    check(pointer)?;
    // SAFETY: not null, aligned; the caller's contract is the rest.
    unsafe { pointer.write(value) };
    Ok(())
}

/// Fills a storage, or empties it on a refusal. `write` writes the content in its place:
/// a second one would not fit on the stack of many a task.
pub(crate) unsafe fn fill<S: Storage>(
    storage: *mut S,
    write: impl for<'a> FnOnce(
        &'a mut MaybeUninit<S::Content>,
    ) -> Result<&'a mut S::Content, StratumResult>,
) -> Result<(), StratumResult> {
    check(storage)?;
    let slot = storage.cast::<Slot<S::Content>>();
    // SAFETY: not null and aligned for the storage, hence large and aligned
    // enough for the slot (`fits`); the fields are written, never dropped. The content
    // is there when the magic word says so: `write` answers with it.
    unsafe {
        (&raw mut (*slot).magic).write(0);
        write(&mut (*slot).content)?;
        (&raw mut (*slot).magic).write(S::MAGIC);
    }
    Ok(())
}

/// The content of a storage that is filled.
unsafe fn content<S: Storage>(
    storage: *const S,
) -> Result<*mut MaybeUninit<S::Content>, StratumResult> {
    check(storage)?;
    let slot = storage.cast_mut().cast::<Slot<S::Content>>();
    // SAFETY: as in `fill`.
    unsafe {
        match (&raw const (*slot).magic).read() == S::MAGIC {
            true => Ok(&raw mut (*slot).content),
            false => Err(STRATUM_ERROR_UNINITIALISED),
        }
    }
}

/// What a storage holds.
pub(crate) unsafe fn held<'a, S: Storage>(
    storage: *const S,
) -> Result<&'a S::Content, StratumResult> {
    // SAFETY: with the magic word `fill` has written the content.
    unsafe { Ok((*content(storage)?).assume_init_ref()) }
}

/// What a storage holds, to change it.
pub(crate) unsafe fn held_mut<'a, S: Storage>(
    storage: *mut S,
) -> Result<&'a mut S::Content, StratumResult> {
    // SAFETY: as in `held`; nobody else uses the storage during the call.
    unsafe { Ok((*content(storage)?).assume_init_mut()) }
}

/// Whether a C string is `expected`; reads no further than the first difference.
pub(crate) unsafe fn is_name(name: *const c_char, expected: &str) -> Result<bool, StratumResult> {
    check(name)?;
    let name = name.cast::<u8>();
    for (i, byte) in expected.bytes().chain([0]).enumerate() {
        // SAFETY: all bytes before were equal and none of them was the end.
        if unsafe { name.add(i).read() } != byte {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Writes a text, cut to `size` bytes and always ended by a zero.
pub(crate) unsafe fn write_text(
    pointer: *mut c_char,
    size: usize,
    text: impl fmt::Display,
) -> Result<(), StratumResult> {
    check(pointer)?;
    if size == 0 {
        return Err(STRATUM_ERROR_TEXT_SIZE);
    }
    // SAFETY: not null; by the caller's contract `size` bytes may be written.
    // They are, before a slice of them is made.
    let bytes = unsafe {
        pointer.write_bytes(0, size);
        slice::from_raw_parts_mut(pointer.cast::<u8>(), size)
    };
    let mut buffer = Text {
        // The last byte stays the end.
        free: bytes.split_last_mut().map_or(&mut [], |(_, free)| free),
    };
    // Fails only where `text` does: the buffer cuts silently.
    let _ = write!(buffer, "{text}");
    Ok(())
}

/// What is left of a buffer.
struct Text<'a> {
    free: &'a mut [u8],
}

impl Write for Text<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let count = text.len().min(self.free.len());
        let (to, free) = core::mem::take(&mut self.free)
            .split_at_mut_checked(count)
            .unwrap_or_default();
        for (to, from) in to.iter_mut().zip(text.bytes()) {
            *to = from;
        }
        self.free = free;
        Ok(())
    }
}
