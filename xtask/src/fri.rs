//! The controller on the emulated board, for `hil-sim serve` in another terminal.

use crate::board::{self, Board, Medium};
use crate::tools::{Outcome, QEMU, find};

/// Runs the image until the motion is over, the emergency stop is pulled or the
/// robot is gone. What it says is printed as it comes.
pub fn run(medium: Medium) -> Outcome {
    find(&[QEMU])?;
    let mut board = Board::start(medium)?;
    println!("emergency stop: touch {}", board.stop_file().display());
    while let Some(line) = board.line() {
        println!("{line}");
        if let Some(options) = board::serve_options(&line) {
            println!(
                "in another terminal: cargo run --release -p hil-sim -- \
                 serve --scenario two-level --lockstep {}",
                options.join(" ")
            );
        }
    }
    Ok(board.end()?)
}
