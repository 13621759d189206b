//! Ctrl-C and its kin (SIGINT, SIGTERM, SIGHUP): a run that is told to end stops, and
//! what there is of it is written.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::sample::Stop;

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// From now on a signal does not end the program: the runs of this process stop.
pub fn heed() {
    // Without a handler the signal ends the program, which is what it did before.
    let _ = ctrlc::set_handler(|| REQUESTED.store(true, Ordering::Relaxed));
}

/// The reason to stop, once a signal came.
#[must_use]
pub fn stop() -> Option<Stop> {
    let requested = REQUESTED.load(Ordering::Relaxed);
    requested.then_some(Stop::Interrupted)
}
