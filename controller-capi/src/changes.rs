//! Changes of levels and gains while the arm moves.

use controller_core::{Change, Controller, Order, Target, TaskGains};

use crate::border::{self, Held};
use crate::codes::{
    self, STRATUM_ERROR_LEVEL, STRATUM_ERROR_ORDER, STRATUM_ERROR_PLACE, StratumResult, code,
};
use crate::reference::{self, index};
use crate::scalar::{Scalar, finite};
use crate::settings::{STRATUM_LEVELS, StratumSettings};
use crate::storage::{StratumController, StratumState};

/// Checks a change and begins it.
fn begin(
    held: &mut Held,
    controller: &Controller<Scalar>,
    change: &Change,
    duration_s: f64,
) -> Result<(), StratumResult> {
    let transition = controller.transition(change, duration_s);
    let begun = transition.and_then(|transition| controller.begin(&mut held.state, &transition));
    begun.map_err(|error| codes::of_change(&error))
}

/// Both ends of a call, to change the state.
///
/// # Safety
/// The contract of the header.
unsafe fn both<'a>(
    controller: *const StratumController,
    state: *mut StratumState,
) -> Result<(&'a Controller<Scalar>, &'a mut Held), StratumResult> {
    // SAFETY: as above.
    unsafe { Ok((border::held(controller)?, border::held_mut(state)?)) }
}

/// A level that is not there comes, in duration_s (0.05 to 60): the one of the settings with this
/// number, at this place among those that are there (1: above all). Its reference is a hold until
/// one is set. Between two steps; what cannot be changes nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_level_add(
    controller: *const StratumController,
    state: *mut StratumState,
    settings: *const StratumSettings,
    level: u32,
    place: u32,
    duration_s: f64,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(
        unsafe { both(controller, state) }.and_then(|(controller, held)| {
            let slot = index(level).ok_or(STRATUM_ERROR_LEVEL)?;
            // SAFETY: likewise.
            let task = unsafe { border::get(settings) }?.task(slot);
            let change = Change::Add {
                slot,
                task: task.map_err(|refusal| refusal.code())?,
                place: index(place).ok_or(STRATUM_ERROR_PLACE)?,
            };
            begin(held, controller, &change, duration_s)?;
            let q = held.state.data().joints.q;
            let rest = controller.rest_reference_of(&held.state, &q);
            if let (Some(kind), Some(target), Some(place)) = (
                held.kinds.get_mut(slot),
                rest.targets().get(slot),
                held.reference.targets_mut().get_mut(slot),
            ) {
                *kind = reference::kind(target);
                *place = Target::Hold;
            }
            Ok(())
        }),
    )
}

/// A level that is there goes, in duration_s. The last one may, too: then all of the arm is
/// compliant.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_level_remove(
    controller: *const StratumController,
    state: *mut StratumState,
    level: u32,
    duration_s: f64,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(
        unsafe { both(controller, state) }.and_then(|(controller, held)| {
            let slot = index(level).ok_or(STRATUM_ERROR_LEVEL)?;
            begin(held, controller, &Change::Remove { slot }, duration_s)
        }),
    )
}

/// A level that is there gets other gains, in duration_s.
/// cbindgen:ptrs-as-arrays=[[stiffness;9], [damping;9]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_level_gains(
    controller: *const StratumController,
    state: *mut StratumState,
    level: u32,
    stiffness: *const f64,
    damping: *const f64,
    duration_s: f64,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(
        unsafe { both(controller, state) }.and_then(|(controller, held)| {
            // SAFETY: likewise.
            let (stiffness, damping) =
                unsafe { (border::array(stiffness)?, border::array(damping)?) };
            let change = Change::Gains {
                slot: index(level).ok_or(STRATUM_ERROR_LEVEL)?,
                gains: TaskGains {
                    stiffness: by_rows::<3, 9>(stiffness),
                    damping: by_rows::<3, 9>(damping),
                },
            };
            begin(held, controller, &change, duration_s)
        }),
    )
}

/// The levels that are there get another order: their numbers, highest priority first, count of
/// them. A level that goes up goes and comes back, each in duration_s.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_level_order(
    controller: *const StratumController,
    state: *mut StratumState,
    levels: *const u32,
    count: u32,
    duration_s: f64,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(
        unsafe { both(controller, state) }.and_then(|(controller, held)| {
            let count = usize::try_from(count)
                .ok()
                .filter(|count| *count <= STRATUM_LEVELS);
            let count = count.ok_or(STRATUM_ERROR_ORDER)?;
            let mut slots = [0; STRATUM_LEVELS];
            let used = slots.get_mut(..count).unwrap_or(&mut []);
            for (entry, slot) in used.iter_mut().enumerate() {
                // SAFETY: likewise; so many numbers are there.
                let level = unsafe { border::get(levels.wrapping_add(entry)) }?;
                *slot = index(*level).ok_or(STRATUM_ERROR_LEVEL)?;
            }
            let order = Order::new(used).ok_or(STRATUM_ERROR_ORDER)?;
            begin(held, controller, &Change::Reorder(order), duration_s)
        }),
    )
}

/// The null space gets the stiffness and damping of the settings, in duration_s. A damping matrix is
/// searched through for its fastest mode, which takes far longer than a cycle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_null_space(
    controller: *const StratumController,
    state: *mut StratumState,
    settings: *const StratumSettings,
    duration_s: f64,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(
        unsafe { both(controller, state) }.and_then(|(controller, held)| {
            // SAFETY: likewise.
            let null_space = unsafe { border::get(settings) }?.null_space();
            let change = Change::NullSpace(null_space.map_err(|refusal| refusal.code())?);
            begin(held, controller, &change, duration_s)
        }),
    )
}

/// Sets how old the reference of a level is, s, 0 unless said otherwise; what that means the
/// settings say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stratum_reference_age(
    state: *mut StratumState,
    level: u32,
    age_s: f64,
) -> StratumResult {
    // SAFETY: the contract of the header.
    code(unsafe { border::held_mut(state) }.and_then(|held| {
        let slot = index(level).filter(|slot| *slot < held.reference.targets().len());
        let slot = slot.ok_or(STRATUM_ERROR_LEVEL)?;
        let [age_s] = finite([age_s])?;
        held.reference.set_age(slot, age_s);
        Ok(())
    }))
}

/// A matrix from its numbers, row by row.
fn by_rows<const N: usize, const ALL: usize>(numbers: [f64; ALL]) -> [[f64; N]; N] {
    let mut rows = [[0.0; N]; N];
    for (entry, number) in rows.iter_mut().flatten().zip(numbers) {
        *entry = number;
    }
    rows
}
