//! Ctrl-C: the first asks the command to stop where its results are whole, the second ends the
//! process.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Exit code of a process ended by Ctrl-C, as shells report it.
const EXIT_SIGINT: i32 = 130;

/// Listens for Ctrl-C. Where that is not possible Ctrl-C ends the process at once, as ever.
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

/// For progress callbacks.
pub fn check() -> ControlFlow<()> {
    if requested() {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}
