//! A demanded torque becomes one that may reach the motors.

use super::control::TorqueDemand;
use crate::cells::Cells;
use crate::fault::{Fault, FaultKind, IndexSet, Quantity};
use crate::joint::{DOF, JointVector, all_finite, zeros};
use crate::real::Real;

/// A torque within the limits of the arm. It is also what the next one starts from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Allocation<T: Real> {
    /// Joint torque \[Nm\], each joint cut to its limit and to its rate; finite where
    /// `finite` is true.
    pub torque: JointVector<T>,
    /// Joints that were cut to their limit.
    pub saturated: IndexSet,
    /// Joints that were cut to their rate.
    pub rate_limited: IndexSet,
    /// Whether the demand was finite.
    pub finite: bool,
    /// Whether `torque` acts now: without a torque to start from the first one is as it is.
    acts: bool,
}

/// What an allocation must keep.
#[derive(Clone, Copy, Debug)]
pub struct TorqueLimits<'a, T: Real> {
    /// Largest |torque| \[Nm\].
    pub limit: &'a JointVector<T>,
    /// Largest |change| from the torque of the last cycle \[Nm\].
    pub step: &'a JointVector<T>,
}

impl<T: Real> Allocation<T> {
    /// Nothing allocated yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            torque: zeros(),
            saturated: IndexSet::NONE,
            rate_limited: IndexSet::NONE,
            finite: true,
            acts: false,
        }
    }

    /// Cuts each joint to its limit, and to its rate from the torque of the last cycle. A
    /// demand that is not finite leaves that torque as it is. Behind a call: it is in the flash once.
    #[inline(never)]
    pub fn update(&mut self, demand: &TorqueDemand<T>, limits: &TorqueLimits<'_, T>) {
        self.finite = all_finite(&demand.0);
        (self.saturated, self.rate_limited) = (IndexSet::NONE, IndexSet::NONE);
        if !self.finite {
            return;
        }
        // Farther than any torque where nothing acts yet.
        let free = if self.acts {
            T::ZERO
        } else {
            T::from_f64(1e30)
        };
        for index in 0..DOF {
            let (demanded, last) = (demand.0[index], self.torque[index]);
            let (limit, step) = (limits.limit[index], limits.step[index] + free);
            let cut = demanded.most(-limit).least(limit);
            let torque = cut.most(last - step).least(last + step);
            self.torque[index] = torque;
            self.saturated.0 |= u8::from(cut != demanded) << index;
            self.rate_limited.0 |= u8::from(torque != cut) << index;
        }
        self.acts = true;
    }

    /// What it remembers and tells.
    pub(crate) fn visit(&mut self, cells: &mut impl Cells<T>) {
        cells.numbers("torque", self.torque.as_mut_slice());
        cells.set("saturated", &mut self.saturated.0);
        cells.set("rate_limited", &mut self.rate_limited.0);
        cells.flag("finite", &mut self.finite);
        cells.flag("acts", &mut self.acts);
    }

    /// The next torque starts from `acting` \[Nm\].
    pub fn start_from(&mut self, acting: &JointVector<T>) {
        // Number by number: a vector from elsewhere is moved by a call.
        for i in 0..DOF {
            self.torque[i] = acting[i];
        }
        self.acts = true;
    }

    /// The next torque starts from nothing known.
    pub fn forget(&mut self) {
        self.acts = false;
    }

    /// The fault of a `demand` that was not finite.
    #[must_use]
    pub fn fault(&self, demand: &TorqueDemand<T>) -> Option<Fault> {
        if self.finite {
            return None;
        }
        let mut joints = (1..).zip(&demand.0);
        let (index, value) = joints
            .find(|(_, torque)| !torque.finite())
            .map_or((0, f64::NAN), |(index, torque)| (index, torque.to_f64()));
        Some(Fault {
            kind: FaultKind::NonFiniteTorque,
            quantity: Quantity::Torque,
            index,
            value,
            min: f64::MIN,
            max: f64::MAX,
        })
    }
}

impl<T: Real> Default for Allocation<T> {
    fn default() -> Self {
        Self::new()
    }
}
