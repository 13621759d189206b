//! Studies: many runs of one kind, and what the law must keep in all of them.
//!
//! [`limits`]: the law near and beyond what an arm can do.

pub mod limits;
