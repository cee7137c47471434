//! Ctrl-C and SIGTERM end the process at once, whatever its threads are doing: no loop has to ask. Only the commit of outputs
//! is waited for, which takes a moment; temporary files are removed.

use crate::base::error::Error;
use crate::cli::{fail, warn, watch};
use crate::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

/// The exit code of a command that was asked to stop.
const INTERRUPTED: u8 = 130;

/// Whether the user asked to stop.
static ASKED: AtomicBool = AtomicBool::new(false);

/// Listens to Ctrl-C and SIGTERM from now on.
pub fn listen() {
    // Where no thread can listen, a signal kills the process. Files are safe then too.
    if thread::Builder::new().spawn(|| ()).is_err() {
        return;
    }
    let _ = ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::SeqCst) {
            end(INTERRUPTED);
        }
        // On a thread of its own, so that a second signal is heard.
        if thread::Builder::new().spawn(stop).is_err() {
            stop();
        }
    });
}

fn stop() {
    let is_written = io::abandon();
    watch::clear();
    match is_written {
        true => warn("interrupted after the files were written"),
        false => fail(&Error::Interrupted),
    }
    end(INTERRUPTED);
}

/// Leaves it to the thread that stops the process to end it, if there is one.
pub fn wait_if_asked() {
    while ASKED.load(Ordering::SeqCst) {
        thread::park();
    }
}

/// Ends the process without a word to its threads and libraries: a driver that is in the middle of something would hold it.
pub fn end(code: u8) -> ! {
    #[cfg(unix)]
    signal_hook::low_level::exit(code.into());
    #[cfg(not(unix))]
    std::process::exit(code.into())
}
