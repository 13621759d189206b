//! `hil-sim gains`: what it proposes against runs, closed forms and simulated arms.

mod command;
mod loops;
mod scenarios;
