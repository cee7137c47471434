//! The threads that share the work of the CPU.

use crate::base::error::{Error, Result};
use std::thread;

/// Starts as many threads as there are cores, or fewer where the system gives no more.
///
/// # Errors
/// When it does not give one.
pub fn start() -> Result<()> {
    let spawn = |thread: rayon::ThreadBuilder| {
        let is_first = thread.index() == 0;
        match thread::Builder::new().spawn(|| thread.run()) {
            Err(error) if is_first => Err(error),
            _ => Ok(()), // the others do the work
        }
    };
    rayon::ThreadPoolBuilder::new().spawn_handler(spawn).build_global().map_err(|error| {
        Error::input(format!("cannot start a thread: {error}; raise the limit on processes (ulimit -u) or on memory (ulimit -v)"))
    })
}
