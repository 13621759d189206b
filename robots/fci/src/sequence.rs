//! Which states count: those that are newer than all before.

/// How a state stands to those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub enum Arrival {
    /// The first one: any id.
    First,
    /// Newer than all before it; so many between them have not come.
    Next {
        /// 0 if it is the very next.
        lost: u64,
    },
    /// Not newer: it is dropped.
    Old,
}

impl Arrival {
    /// Whether the state counts.
    #[must_use]
    pub fn is_fresh(self) -> bool {
        self != Self::Old
    }
}

/// The ids of the states of one connection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub struct Sequence {
    newest: Option<u64>,
}

impl Sequence {
    /// Nothing has come.
    #[must_use]
    pub const fn new() -> Self {
        Self { newest: None }
    }

    /// Takes the id of a state that has passed its check.
    pub fn receive(&mut self, message_id: u64) -> Arrival {
        let arrival = match self.newest {
            None => Arrival::First,
            Some(newest) => match message_id.checked_sub(newest) {
                None | Some(0) => Arrival::Old,
                Some(ahead) => Arrival::Next { lost: ahead - 1 },
            },
        };
        if arrival.is_fresh() {
            self.newest = Some(message_id);
        }
        arrival
    }

    /// The newest id, which a command answers.
    #[must_use]
    pub fn newest(&self) -> Option<u64> {
        self.newest
    }
}
