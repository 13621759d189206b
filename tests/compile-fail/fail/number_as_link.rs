//! A link is no number: one that does not exist cannot be written down.

use controller_core::LinkPoint;

fn main() {
    let _ = LinkPoint {
        link: 8,
        offset: [0.0, 0.0, 0.078],
    };
}
