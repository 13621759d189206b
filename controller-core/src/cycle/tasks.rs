//! The tasks in force, and how they become those that are wanted.
//!
//! A change begun between two cycles says what is wanted: which slots, in which order, with which
//! gains. Each cycle goes a step towards it.
//!
//! ```text
//! h        rises where a level is wanted where it stands, else falls; smooth, in the time given
//! h = 0    the level is not there: it may be put elsewhere, and rises again
//! K        goes from the gains in force to the wanted ones; between them, positive definite
//! ```
//!
//! Whoever is wanted above a level that stands above it falls, is put there and rises: upper
//! levels stay as they are. A level that is turned round on its way goes back from where it is.

use crate::fault::IndexSet;
use crate::law::limits::spectrum::Spectrum;
use crate::law::null_space::Compliance;
use crate::ranges::{CHANGE_S, MAX_LEVELS, MAX_ROWS, PACE, PACED_NEARNESS, SLOWEST_PACE};
use crate::real::Real;
use crate::task::{Clock, Followed, Level, LevelGains, Levels, Order, smoothstep};

/// Bit of the null space beside those of the slots in [`ActiveTasks::changing`].
pub(super) const NULL_SPACE_BIT: usize = MAX_LEVELS;

/// What is in force until a change is begun: a controller's own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Own<'a, T: Real> {
    pub levels: &'a Levels<T>,
    pub compliance: &'a Compliance<T>,
    /// Whether levels may go.
    pub releases: bool,
}

/// How far a level has come, and how fast it comes or goes.
#[derive(Clone, Copy, Debug)]
struct Fade<T: Real> {
    /// 0 to 1, at a constant rate.
    share: T,
    /// \[1/s\].
    rate: T,
}

/// Gains on their way.
#[derive(Clone, Copy, Debug)]
struct Slew<T: Real, G> {
    to: G,
    clock: Clock<T>,
}

impl<T: Real, G> Slew<T, G> {
    /// A cycle more. Returns the share of what was left to go in the cycle before that is still
    /// left: with it no gains of the beginning need be kept.
    fn advance(&mut self, interval_s: T) -> T {
        let left = |clock: &Clock<T>| {
            let share = if clock.runs() { clock.share() } else { T::ONE };
            T::ONE - smoothstep(share)
        };
        let before = left(&self.clock);
        self.clock.advance(interval_s);
        if before > T::ZERO {
            left(&self.clock) / before
        } else {
            T::ZERO
        }
    }
}

/// The tasks and gains of a state. Until a change is begun they are the controller's own.
#[derive(Clone, Debug)]
pub struct ActiveTasks<T: Real> {
    /// Whether a change was begun: then `levels` and `compliance` are in force.
    changed: bool,
    levels: Levels<T>,
    compliance: Compliance<T>,
    wanted: Order,
    fades: [Fade<T>; MAX_LEVELS],
    slews: [Slew<T, LevelGains<T>>; MAX_LEVELS],
    null_slew: Slew<T, Compliance<T>>,
    /// Slots on their way, and the null space.
    changing: IndexSet,
    /// Slots whose reference is too old.
    stale: IndexSet,
    /// Slots that were released therefore.
    away: IndexSet,
    pace: Pace<T>,
}

/// How fast levels may come and go: where they take the motion of levels below, slower than asked.
#[derive(Clone, Copy, Debug)]
struct Pace<T: Real> {
    /// Share of the rates, at most 1.
    share: T,
    /// Of each row in the cycle before, see [`Spectrum::nearness`].
    nearness: [T; MAX_ROWS],
}

impl<T: Real> Pace<T> {
    const FULL: Self = Self {
        share: T::ONE,
        nearness: [T::ZERO; MAX_ROWS],
    };

    /// By how the mobilities went since the cycle before. Commands along a direction get a limit at
    /// nearness 1, infinite there: whoever comes there must come slowly.
    fn set(&mut self, nearness: &[T; MAX_ROWS]) {
        let [low, high] = PACED_NEARNESS.map(T::from_f64);
        let mut fastest = T::from_f64(1e-9);
        for (now, before) in nearness.iter().zip(&self.nearness) {
            if *now > low && *now < high {
                fastest = fastest.most((*now - *before).magnitude());
            }
        }
        let allowed = self.share * T::from_f64(PACE) / fastest;
        let share = allowed.least(self.share * T::from_f64(1.25));
        self.share = share.limited(T::from_f64(SLOWEST_PACE), T::ONE);
        self.nearness = *nearness;
    }
}

impl<T: Real> ActiveTasks<T> {
    /// Those of any controller.
    pub(super) const fn new() -> Self {
        Self {
            changed: false,
            levels: Levels::NONE,
            compliance: Compliance::NONE,
            wanted: Order::NONE,
            fades: [Fade {
                share: T::ZERO,
                rate: T::ZERO,
            }; MAX_LEVELS],
            slews: [Slew {
                to: LevelGains::NONE,
                clock: Clock::ENDED,
            }; MAX_LEVELS],
            null_slew: Slew {
                to: Compliance::NONE,
                clock: Clock::ENDED,
            },
            changing: IndexSet::NONE,
            stale: IndexSet::NONE,
            away: IndexSet::NONE,
            pace: Pace::FULL,
        }
    }

    /// The levels in force.
    #[inline(always)]
    pub(super) fn levels<'a>(&'a self, own: &'a Levels<T>) -> &'a Levels<T> {
        if self.changed { &self.levels } else { own }
    }

    /// The compliance in force.
    #[inline(always)]
    pub(super) fn compliance<'a>(&'a self, own: &'a Compliance<T>) -> &'a Compliance<T> {
        if self.changed { &self.compliance } else { own }
    }

    /// Slots on their way to be what is wanted; bit 7, the eighth, is the null space.
    #[must_use]
    #[inline(always)]
    pub fn changing(&self) -> IndexSet {
        self.changing
    }

    /// Slots whose reference is too old.
    #[must_use]
    #[inline(always)]
    pub fn stale(&self) -> IndexSet {
        self.stale
    }

    /// The slots that are wanted, highest priority first; those of a controller's own levels
    /// where no change was begun.
    pub(super) fn wanted(&self, own: &Levels<T>) -> Order {
        if self.changed {
            self.wanted
        } else {
            own.order()
        }
    }

    /// From now on apart from those of the controller.
    #[cold]
    #[inline(never)]
    fn part_from(&mut self, own: &Own<'_, T>) {
        if self.changed {
            return;
        }
        self.wanted = self.wanted(own.levels);
        self.levels = *own.levels;
        self.compliance = *own.compliance;
        for fade in &mut self.fades {
            (fade.share, fade.rate) = (T::ONE, T::from_f64(1.0 / CHANGE_S));
        }
        for slew in &mut self.slews {
            slew.clock.end();
        }
        self.null_slew.clock.end();
        self.away = IndexSet::NONE;
        self.pace = Pace::FULL;
        self.changed = true;
    }

    /// Rows of all slots that are wanted or still in force but `slot`.
    pub(super) fn rows_beside(&self, own: &Own<'_, T>, slot: usize) -> usize {
        let wanted = self.wanted(own.levels);
        let levels = self.levels(own.levels);
        let takes = |level: &&Level<T>| {
            level.slot != slot && (wanted.contains(level.slot) || levels.is_in_force(level.slot))
        };
        levels
            .all()
            .iter()
            .filter(takes)
            .map(|level| level.size)
            .sum()
    }

    /// A task in a slot, new or on its way out, at a place among the wanted ones.
    #[inline(never)]
    pub(super) fn add(&mut self, own: &Own<'_, T>, level: &Level<T>, at: (usize, T)) {
        let (place, rate) = at;
        self.part_from(own);
        let slot = level.slot;
        if self.levels.is_in_force(slot) {
            self.set_gains(own, slot, &level.gains, T::ONE / rate);
        } else if let Some(own) = self.levels.slot_mut(slot) {
            *own = *level;
            self.slews[slot % MAX_LEVELS].clock.end();
        }
        self.wanted.insert(place, slot);
        self.away.remove(slot);
        self.fades[slot % MAX_LEVELS].rate = rate;
        self.changing.insert_if(slot, true);
    }

    /// The task of a slot goes.
    pub(super) fn remove(&mut self, own: &Own<'_, T>, slot: usize, rate: T) {
        self.part_from(own);
        self.wanted.remove(slot);
        self.away.remove(slot);
        self.fades[slot % MAX_LEVELS].rate = rate;
        self.changing.insert_if(slot, true);
    }

    /// The wanted slots in another order.
    pub(super) fn reorder(&mut self, own: &Own<'_, T>, order: &Order, rate: T) {
        self.part_from(own);
        self.wanted = *order;
        for slot in order.slots() {
            self.fades[slot % MAX_LEVELS].rate = rate;
            self.changing.insert_if(slot, true);
        }
    }

    /// Other gains of the task of a slot.
    pub(super) fn set_gains(
        &mut self,
        own: &Own<'_, T>,
        slot: usize,
        gains: &LevelGains<T>,
        duration_s: T,
    ) {
        self.part_from(own);
        let slew = &mut self.slews[slot % MAX_LEVELS];
        (slew.to, slew.clock) = (*gains, Clock::new(duration_s));
        self.changing.insert_if(slot, true);
    }

    /// Another compliance of the null space.
    pub(super) fn set_compliance(
        &mut self,
        own: &Own<'_, T>,
        compliance: &Compliance<T>,
        duration_s: T,
    ) {
        self.part_from(own);
        self.compliance.make_room_for(compliance);
        let slew = &mut self.null_slew;
        (slew.to, slew.clock) = (*compliance, Clock::new(duration_s));
        self.changing.insert_if(NULL_SPACE_BIT, true);
    }

    /// Everything is at once what is wanted.
    pub(super) fn arrive(&mut self) {
        if self.changed {
            self.away = IndexSet::NONE;
            for fade in &mut self.fades {
                fade.rate = T::ONE;
            }
            for slew in &mut self.slews {
                slew.clock.shorten(T::ONE);
            }
            self.null_slew.clock.shorten(T::ONE);
            while self.levels.take(0) {}
            // As if the second that it takes now had passed.
            let _ = self.go(T::ONE, T::ONE);
        }
    }

    /// Looks at the age of the references.
    #[inline(always)]
    pub(super) fn watch(
        &mut self,
        own: &Own<'_, T>,
        ages_s: &[T; MAX_LEVELS],
        followed: &Followed<T>,
    ) {
        if self.levels(own.levels).watched {
            self.find_stale(own, ages_s, followed);
        }
    }

    #[inline(never)]
    fn find_stale(&mut self, own: &Own<'_, T>, ages_s: &[T; MAX_LEVELS], followed: &Followed<T>) {
        let (mut stale, mut released) = (IndexSet::NONE, IndexSet::NONE);
        let wanted = self.wanted(own.levels);
        let releases = own.releases;
        for level in self.levels(own.levels).all() {
            let slot = level.slot;
            let (Some(age_s), Some(of_slot)) = (ages_s.get(slot), followed.of_slots().get(slot))
            else {
                continue;
            };
            let watched = level.stale_after_s > T::ZERO && wanted.contains(slot);
            // Also what is not a number.
            let fresh = *age_s <= level.stale_after_s;
            stale.insert_if(slot, watched && !fresh);
            let gone = self.away.contains(slot) || of_slot.rests();
            let goes = watched && !fresh && level.stale_releases && releases && gone;
            released.insert_if(slot, goes);
        }
        self.stale = stale;
        if released != self.away {
            self.part_from(own);
            self.changing.0 |= released.0 | self.away.0;
            self.away = released;
        }
    }

    /// A step towards what is wanted. Returns the slots whose levels came or went.
    #[inline(never)]
    pub(super) fn advance(&mut self, interval_s: T, spectrum: &Spectrum<T>) -> IndexSet {
        self.pace.set(&spectrum.nearness(&self.levels));
        self.go(interval_s, interval_s * self.pace.share)
    }

    /// A step of `interval_s` for gains and of `paced_s` for levels that come and go.
    fn go(&mut self, interval_s: T, paced_s: T) -> IndexSet {
        let mut met = IndexSet::NONE;
        let movers = self.movers();
        let mut changing = IndexSet::NONE;
        let mut place = 0;
        while let Some(level) = self.levels.in_order_mut().get_mut(place) {
            let slot = level.slot;
            let stays =
                self.wanted.contains(slot) && !self.away.contains(slot) && !movers.contains(slot);
            let fade = &mut self.fades[slot % MAX_LEVELS];
            fade.advance(paced_s, stays);
            level.activation = smoothstep(fade.share);
            if stays || fade.share > T::ZERO {
                place += 1;
            } else {
                met.insert_if(slot, true);
                self.levels.take(place);
            }
        }
        if !self.movers().any() {
            met.0 |= self.bring_wanted(paced_s).0;
        }
        let wanted = self.wanted;
        for slot in wanted.slots() {
            let waits = !self.levels.is_in_force(slot) && !self.away.contains(slot);
            changing.insert_if(slot, waits);
        }
        for level in self.levels.in_order() {
            changing.insert_if(level.slot, level.activation < T::ONE);
        }
        changing.0 |= self.adjust(interval_s).0;
        self.changing = changing;
        met
    }

    /// Those in force that are wanted above a level that stands above them.
    fn movers(&self) -> IndexSet {
        let (mut movers, mut lowest) = (IndexSet::NONE, 0);
        for level in self.levels.in_order() {
            if let Some(rank) = self.wanted.place(level.slot)
                && !self.away.contains(level.slot)
            {
                movers.insert_if(level.slot, rank < lowest);
                lowest = lowest.max(rank);
            }
        }
        movers
    }

    /// Brings those that are wanted and not in force, each to its place, and begins to raise them.
    fn bring_wanted(&mut self, paced_s: T) -> IndexSet {
        let (mut met, wanted) = (IndexSet::NONE, self.wanted);
        for (rank, slot) in wanted.slots().enumerate() {
            if self.levels.is_in_force(slot) || self.away.contains(slot) {
                continue;
            }
            let stands_above = |level: &Level<T>| {
                let above = wanted.place(level.slot);
                above.is_some_and(|above| above < rank)
            };
            let last_above = self.levels.in_order().iter().rposition(stands_above);
            let place = last_above.map_or(0, |last| last + 1);
            let fade = &mut self.fades[slot % MAX_LEVELS];
            fade.share = T::ZERO;
            fade.advance(paced_s, true);
            if let Some(level) = self.levels.slot_mut(slot) {
                level.activation = smoothstep(fade.share);
            }
            self.levels.bring(slot, place);
            met.insert_if(slot, true);
        }
        met
    }

    /// Gains, and thresholds by what stands above. Returns whose gains are on their way.
    fn adjust(&mut self, interval_s: T) -> IndexSet {
        let (mut changing, mut above, mut fades) = (IndexSet::NONE, T::ZERO, false);
        for level in self.levels.in_order_mut() {
            let slew = &mut self.slews[level.slot % MAX_LEVELS];
            let mut gains = level.gains;
            if slew.clock.runs() {
                let left = slew.advance(interval_s);
                gains.approach(&slew.to, left);
                changing.insert_if(level.slot, slew.clock.runs());
            }
            level.adjust(&gains, above);
            above = above.most(level.activation);
            fades |= level.activation < T::ONE;
        }
        self.levels.fades = fades;
        if self.null_slew.clock.runs() {
            let left = self.null_slew.advance(interval_s);
            self.compliance.approach(&self.null_slew.to, left);
            changing.insert_if(NULL_SPACE_BIT, self.null_slew.clock.runs());
        }
        changing
    }
}

impl<T: Real> Fade<T> {
    /// A cycle more, up or down.
    fn advance(&mut self, interval_s: T, rises: bool) {
        let step = self.rate * interval_s;
        let share = if rises {
            self.share + step
        } else {
            self.share - step
        };
        self.share = share.limited(T::ZERO, T::ONE);
    }
}
