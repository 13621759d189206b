//! The way into command state: what the link, the robot program and the client's order
//! must have come to.

use controller_core::joint::{DOF, JointVector};
use fri::{ControlScheme, Quality};

use super::{Krc, Now, Order};
use crate::robot::options::{Krl, cycles, scheme_of_strategy};

impl Krc {
    /// In monitor state: whether command state begins with the next measurement.
    pub(super) fn consider(&mut self, now: &Now<'_>) {
        if self.commands || self.left {
            return;
        }
        let Some(order) = self.order else { return };
        let wish = self.options.krl == Krl::Auto || order.wants_command;
        let link = matches!(now.rating.quality(), Quality::Ok | Quality::Perfect);
        if !link || self.age > 0 || !wish {
            // One missing answer does not begin the wait anew; a bad link does.
            if !link || !wish {
                self.good = 0;
            }
            return;
        }
        self.good += 1;
        if self.good <= cycles(self.options.good_for_s, self.cycle_s) {
            return;
        }
        self.good = 0;
        match self.entry(&order, now) {
            Err(message) => self.tell_once(&message),
            Ok(scheme) => {
                self.scheme = scheme;
                self.commands = true;
                self.flags = order.flags;
                self.rate = JointVector::zeros();
                self.commanded = self.hold;
                self.passage.begin(self.last, JointVector::zeros());
                self.entries += 1;
                self.told.clear();
                self.say(format!("command state, cmdFlags {:#06x}", order.flags));
            }
        }
    }

    /// The checks before command state, in the client's terms.
    fn entry(&self, order: &Order, now: &Now<'_>) -> Result<ControlScheme, String> {
        let options = &self.options;
        let scheme = match options.krl {
            Krl::Auto => options.scheme,
            Krl::Handshake => scheme_of_strategy(order.strategy)?,
        };
        if !now.drives_on {
            return Err("drives are off".into());
        }
        if order.position.is_none() && scheme == ControlScheme::Position {
            return Err("cmdFlags do not set jntPos (0x0001), which this scheme needs".into());
        }
        for joint in 0..DOF {
            let off = order
                .position
                .map_or(0.0, |q| (q[joint] - self.hold[joint]).abs());
            if off > options.entry_position_rad {
                return Err(format!(
                    "jntPos of joint {} is {:.1} mrad from the commanded position; allowed: {:.1}",
                    joint + 1,
                    off * 1e3,
                    options.entry_position_rad * 1e3
                ));
            }
        }
        for joint in 0..DOF {
            let torque = order.torque.map_or(0.0, |torque| torque[joint]);
            if torque.abs() > options.entry_torque_nm {
                return Err(format!(
                    "addJntTrq of joint {} is {torque:.2} Nm; allowed: {:.2}",
                    joint + 1,
                    options.entry_torque_nm
                ));
            }
        }
        Ok(scheme)
    }

    /// Why command state does not begin, once per reason in a row.
    pub(super) fn tell_once(&mut self, reason: &str) {
        if reason != self.told {
            self.told = reason.to_string();
            self.say(format!("no command state: {reason}"));
        }
    }
}
