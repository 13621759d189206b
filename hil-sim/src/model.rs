//! Arms of others: a URDF becomes a table, a table is looked at. Reading a URDF is
//! [`cell::model`]'s.
//!
//! Bottom-up: [`at_rest`], an arm in a posture; [`search`], postures that are the worst in
//! something; [`import`](mod@import), the whole way; [`figures`], what a table is like; [`rust`]
//! and [`c`], a table as source text.

pub mod at_rest;
pub mod c;
pub mod figures;
pub mod import;
pub mod rust;
pub mod search;
