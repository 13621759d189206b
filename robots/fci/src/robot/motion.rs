//! A motion: which one, the command that acts, and how many have come.

use crate::command::Command;
use crate::modes::{Controller, Generator};
use crate::robot::settings::LOST_MAX;
use crate::state::{DOF, State};

/// Cycles that the success rate is about.
const WINDOW: u32 = 100;

/// A motion that has been accepted.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    /// Of the Move.
    pub(super) id: u32,
    pub(super) controller: Controller,
    pub(super) generator: Generator,
    /// The state shows it.
    pub(super) shown: bool,
    /// What acts.
    pub(super) command: Command,
    /// The first command has come.
    pub(super) armed: bool,
    /// The command to the last state has come.
    pub(super) answered: bool,
    pub(super) commands: u64,
    pub(super) lost: u64,
    lost_in_a_row: u32,
    /// A bit per cycle, the last one first: whether its command came.
    window: u128,
    cycles: u32,
}

impl Motion {
    pub(super) fn new(id: u32, controller: Controller, generator: Generator) -> Self {
        Self {
            id,
            controller,
            generator,
            shown: false,
            command: Command::default(),
            armed: false,
            answered: false,
            commands: 0,
            lost: 0,
            lost_in_a_row: 0,
            window: 0,
            cycles: 0,
        }
    }

    /// Whether the client gives the torque.
    pub(super) fn is_torque(&self) -> bool {
        self.controller == Controller::External
    }

    /// The joint torque that acts \[Nm\].
    pub(super) fn torque(&self) -> [f64; DOF] {
        self.command.tau_j_d
    }

    /// Whether the command to the last state is still to come. Before the first one the client
    /// rightly answers nothing.
    pub(super) fn waits(&self) -> bool {
        self.armed && !self.answered
    }

    /// What is commanded, as the state has it. Under torque control the desired positions stay
    /// those of the start.
    pub(super) fn desire(&self, state: &mut State) {
        let command = &self.command;
        match self.generator {
            Generator::None => {}
            Generator::JointPosition => state.q_d = command.q_c,
            Generator::JointVelocity => state.dq_d = command.dq_c,
            Generator::CartesianPosition => {
                state.o_t_ee_d = command.o_t_ee_c;
                state.o_t_ee_c = command.o_t_ee_c;
            }
            Generator::CartesianVelocity => {
                state.o_dp_ee_d = command.o_dp_ee_c;
                state.o_dp_ee_c = command.o_dp_ee_c;
            }
        }
        if command.valid_elbow {
            state.elbow_c = command.elbow_c;
        }
    }

    /// A command to the last state.
    pub(super) fn answer(&mut self, command: &Command) {
        self.command = *command;
        self.armed = true;
        self.answered = true;
        self.commands += 1;
        self.lost_in_a_row = 0;
    }

    /// Ends a cycle: whether too many commands in a row are missing.
    pub(super) fn end_cycle(&mut self) -> bool {
        if !self.armed {
            return false;
        }
        if !self.answered {
            self.lost += 1;
            self.lost_in_a_row += 1;
        }
        self.window = self.window << 1 | u128::from(self.answered);
        self.cycles = (self.cycles + 1).min(WINDOW);
        self.answered = false;
        self.lost_in_a_row >= LOST_MAX
    }

    /// Share of the last 100 cycles whose command came, of fewer at the beginning; 0 before
    /// the first.
    pub(super) fn success_rate(&self) -> f64 {
        let came = (self.window & ((1 << WINDOW) - 1)).count_ones();
        f64::from(came) / f64::from(self.cycles.max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_that_of_the_last_hundred_cycles() {
        let mut motion = Motion::new(0, Controller::External, Generator::None);
        // The client reads on: nothing is missing yet.
        for _ in 0..50 {
            assert!(!motion.end_cycle());
        }
        assert_eq!((motion.success_rate(), motion.lost), (0.0, 0));
        let mut run = |answers: &dyn Fn(u32) -> bool, count| {
            for i in 0..count {
                if answers(i) {
                    motion.answer(&Command::default());
                }
                assert!(!motion.end_cycle());
            }
            (motion.success_rate(), motion.lost)
        };
        assert_eq!(run(&|_| true, 4), (1.0, 0));
        assert_eq!(run(&|i| i > 0, 4), (0.875, 1));
        assert_eq!(run(&|_| true, 92), (0.99, 1));
        // The miss leaves the window behind 99 cycles more.
        assert_eq!(run(&|_| true, 4), (0.99, 1));
        assert_eq!(run(&|_| true, 1), (1.0, 1));
        assert_eq!(run(&|i| i % 4 != 3, 100), (0.75, 26));
    }

    #[test]
    fn the_twentieth_in_a_row_is_one_too_many() {
        let mut motion = Motion::new(0, Controller::External, Generator::None);
        for _ in 0..3 {
            motion.answer(&Command::default());
            assert!(!motion.end_cycle());
            assert!((0..19).all(|_| !motion.end_cycle()));
        }
        assert!(motion.end_cycle());
    }
}
