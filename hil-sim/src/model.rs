//! Arms of others: a URDF becomes a table, a table is looked at.
//!
//! Bottom-up: [`frame`] and [`body`], what is put together; [`urdf`], the file as data; [`tree`],
//! how its links hang together; [`chain`], seven joints in a row with what they move; [`motion`],
//! their dynamics; [`table`], the same as a DH table; [`agreement`], how far the two are apart;
//! [`at_rest`], an arm in a posture; [`search`], postures that are the worst in something;
//! [`import`](mod@import), the whole way; [`figures`], what a table is like; [`rust`] and [`c`], a
//! table as source text.

pub mod agreement;
pub mod at_rest;
pub mod body;
pub mod c;
pub mod chain;
pub mod figures;
pub mod frame;
pub mod import;
pub mod motion;
pub mod rust;
pub mod search;
pub mod table;
pub mod tree;
pub mod urdf;
