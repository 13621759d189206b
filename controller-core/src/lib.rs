//! Strict-priority torque control with null-space compliance for 7-joint arms.
//!
//! Several points of the arm follow references in strict priority, what they
//! leave free is a spring and damper, and external torque is estimated from
//! momentum and compensated where tasks are tracked. One call of
//! [`controller::Controller::step`] is one control cycle: a measurement and a
//! reference in, a finite torque within limits and a status out. It never
//! fails, never panics, allocates nothing and iterates a number of times that
//! depends on the configuration only.
//!
//! The modules, bottom-up, and who reads them:
//!
//! - [`real`]: the scalar, `f32` or `f64`, with its own sine, cosine and
//!   exponential; [`joint`]: vectors, matrices and the joint state; [`linalg`]:
//!   Cholesky factor and triangular solves. For whoever asks about bits.
//! - [`model`]: the arm's tables and the KUKA LWR IV+; [`kinematics`]: frames,
//!   points and Jacobian rows; [`dynamics`]: M, C, g of the equation of motion
//!   (6). For whoever brings another arm.
//! - [`task`]: levels, gains and the stacked rows; [`trajectory`]: reference
//!   motions. For whoever decides what the arm does.
//! - [`hierarchy`]: all priorities from one factorisation; [`observer`]: the
//!   residual (30); [`law`]: the torque demanded; [`limits`]: the torque that
//!   may reach the motors. The control law itself.
//! - [`measurement`]: what enters a cycle and when it is believed; [`velocity`]:
//!   joint speeds where the robot reports positions only; [`fault`]:
//!   faults and limit flags; [`config`] and [`damping`]: what a controller is
//!   made of, validated once; [`record`]: the last cycles, in the caller's
//!   storage; [`mod@controller`]: the cycle. For whoever links the core into a
//!   program.
//!
//! Numbers in brackets are equations of Karami, Sadeghian, Keshmiri, Oriolo,
//! Mechatronics 55 (2018) 171-179. SI units, positions in the base-plate frame
//! with z up. Signs follow (6), M ddq + C dq + g = tau - tau_ext: the torque
//! tau_ext is what the arm exerts on its environment, and the residual r tends
//! to -tau_ext. docs/notation.md is the glossary, docs/hierarchy.md derives the
//! law, docs/architecture.md follows a cycle through these modules.

#![no_std]

pub mod config;
pub mod controller;
pub mod damping;
pub mod dynamics;
pub mod fault;
pub mod hierarchy;
pub mod joint;
pub mod kinematics;
pub mod law;
pub mod limits;
pub mod linalg;
pub mod measurement;
pub mod model;
pub mod observer;
pub mod orientation;
pub mod real;
pub mod record;
mod spatial;
pub mod task;
pub mod trajectory;
pub mod velocity;

/// The example of the README is a test.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
