//! The arm has seven links.

use controller_core::Link;

fn main() {
    let _ = Link::L8;
}
