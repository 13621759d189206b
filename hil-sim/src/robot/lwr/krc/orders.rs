//! Which answers may act, and what they change.

use std::fmt;

use controller_core::joint::{DOF, JointVector};
use fri::ControlScheme;

use super::{Krc, Order, Refusal};

impl Krc {
    /// An answer of this cycle, newer than those before, with the arm at `q` \[rad\].
    ///
    /// # Errors
    /// It is not used; in command state changed flags end that state.
    pub fn accept(&mut self, order: &Order, q: &JointVector<f64>) -> Result<(), Refusal> {
        let checked = if self.commands {
            self.check(order, q)
        } else {
            Ok(())
        };
        self.refusing &= checked.is_err();
        self.refused = checked.err();
        if checked.is_ok() {
            self.take(order);
        }
        checked
    }

    fn check(&mut self, order: &Order, q: &JointVector<f64>) -> Result<(), Refusal> {
        if order.flags != self.flags {
            return Err(Refusal::Flags);
        }
        self.check_torque(order)?;
        let Some(position) = &order.position else {
            return Ok(());
        };
        // The last order was good for one cycle and every one bridged since.
        let elapsed = f64::from(self.age + 1);
        for joint in 0..DOF {
            let (moved, allowed) = if self.follows(order, joint) {
                // Half a unit of the last place of binary32 at 3 rad, twice.
                let reach = self.reach[joint] * elapsed + 5e-7;
                ((position[joint] - self.last_position(joint)).abs(), reach)
            } else {
                ((position[joint] - q[joint]).abs(), self.options.jump_rad)
            };
            if moved > allowed {
                let name = self.joints[joint];
                self.refuse(format_args!(
                    "jntPos of {name} jumps by {:.1} mrad; allowed: {:.1}",
                    moved * 1e3,
                    allowed * 1e3
                ));
                return Err(Refusal::Jump);
            }
        }
        Ok(())
    }

    fn check_torque(&mut self, order: &Order) -> Result<(), Refusal> {
        let Some(torque) = &order.torque else {
            return Ok(());
        };
        for (index, joint) in self.joints.into_iter().enumerate() {
            let (torque, bound) = (torque[index], self.torque_bound[index]);
            // What is no number is not meant either.
            let meant = torque.abs() <= bound;
            if !meant {
                self.refuse(format_args!(
                    "addJntTrq of {joint} is {torque:.1} Nm; allowed: {bound:.0}"
                ));
                return Err(Refusal::Torque);
            }
        }
        Ok(())
    }

    /// Tells why an answer is not used; a row of them is one event.
    fn refuse(&mut self, why: fmt::Arguments<'_>) {
        if !std::mem::replace(&mut self.refusing, true) {
            self.say(format!("{why}; answer not used"));
        }
    }

    /// Whether jntPos moves this joint.
    fn follows(&self, order: &Order, joint: usize) -> bool {
        self.scheme == ControlScheme::Position
            || order
                .stiffness
                .map_or(self.options.stiffness, |stiffness| stiffness[joint])
                > 0.0
    }

    /// jntPos of the order that acts; where it gave none, the commanded position.
    fn last_position(&self, joint: usize) -> f64 {
        let given = self.order.as_ref().and_then(|order| order.position);
        given.map_or(self.commanded[joint], |position| position[joint])
    }

    fn take(&mut self, order: &Order) {
        if self.commands
            && let Some(position) = order.position
        {
            let before = JointVector::from_fn(|i, _| self.last_position(i));
            self.rate = (position - before) / f64::from(self.age + 1);
            self.commanded = position;
        }
        if !self.commands && self.order.is_some_and(|last| last.flags != order.flags) {
            // Flags have to be chosen before command state: wait anew.
            if self.good > 0 {
                self.tell_once("cmdFlags changed while waiting; choose them before command state");
            }
            self.good = 0;
        }
        self.order = Some(*order);
        self.fresh = true;
    }
}
