//! The threads that share the work of the CPU.

use crate::base::error::{Error, Result};
use std::sync::mpsc;
use std::thread;

/// Starts as many threads as there are cores, or fewer where the system gives no more.
///
/// # Errors
/// When it does not give one.
pub fn start() -> Result<()> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let builder = match can_start(cores) {
        all if all == cores => rayon::ThreadPoolBuilder::new(),
        // One remains for a driver.
        some => rayon::ThreadPoolBuilder::new().num_threads(some.saturating_sub(1).max(1)),
    };
    builder.build_global().map_err(|error| {
        Error::input(format!(
            "cannot start a thread: {error}; raise the limit on processes (ulimit -u) or on memory (ulimit -v)"
        ))
    })
}

/// The number of threads that can be started at once, up to `most`. A pool that gets fewer than it asks for cannot be mended.
fn can_start(most: usize) -> usize {
    let mut started = Vec::new();
    while started.len() < most {
        let (end, ended) = mpsc::channel::<()>();
        match thread::Builder::new().spawn(move || ended.recv()) {
            Ok(thread) => started.push((thread, end)),
            Err(_) => break,
        }
    }
    let count = started.len();
    for (thread, end) in started {
        drop(end);
        let _ = thread.join();
    }
    count
}
