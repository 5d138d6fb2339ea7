//! Ctrl-C handling. The first Ctrl-C asks the command to stop where its results are complete; the
//! second ends the process.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Exit code that shells report for a process ended by Ctrl-C.
const EXIT_SIGINT: i32 = 130;

/// Listens for Ctrl-C. Where listening is not possible, Ctrl-C ends the process at once.
pub fn listen() {
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::SeqCst) {
            std::process::exit(EXIT_SIGINT);
        }
        eprintln!("stopping; press Ctrl-C again to stop at once");
    });
}

/// Whether Ctrl-C was pressed.
pub fn requested() -> bool {
    INTERRUPTED.load(Ordering::SeqCst)
}

/// Tells a progress callback whether to continue.
pub fn check() -> ControlFlow<()> {
    if requested() {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}
