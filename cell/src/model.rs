//! Arms of others: a URDF as a chain of seven joints, and a table held against it.
//!
//! Bottom-up: [`frame`] and [`body`], what is put together; [`urdf`], the file as data; [`tree`],
//! how its links hang together; [`chain`], seven joints in a row with what they move; [`motion`],
//! their dynamics; [`table`], the same as a DH table; [`agreement`], how far a table is from a
//! chain.

pub mod agreement;
pub mod body;
pub mod chain;
pub mod frame;
pub mod motion;
pub mod table;
pub mod tree;
pub mod urdf;
