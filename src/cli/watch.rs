//! The progress bar.

use crate::bake::Observer;
use crate::base::error::Result;
use crate::base::timings::Stopwatch;
use crate::base::words::printable;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::{Mutex, PoisonError};

/// The bar that is shown, to be removed when the process ends.
static SHOWN: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// Removes the bar that is shown.
pub fn clear() {
    if let Some(bar) = &*SHOWN.lock().unwrap_or_else(PoisonError::into_inner) {
        bar.finish_and_clear();
    }
}

/// Shows a progress bar after a second, on a terminal only.
pub struct Watch {
    bar: ProgressBar,
    start: Stopwatch,
    step: Mutex<ProgressLine>,
}

/// Counts the steps begun, and the share done of the last.
struct ProgressLine {
    count: u64,
    share: f64,
}

/// The bar's resolution within a step.
const TICKS: u64 = 100;
/// Seconds after which the bar appears.
const PATIENCE: f64 = 1.0;

impl Watch {
    /// Expects this number of steps.
    pub fn new(steps: usize) -> Self {
        let bar = ProgressBar::with_draw_target(Some(steps as u64 * TICKS), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}  {elapsed}") {
            bar.set_style(style);
        }
        Self { bar, start: Stopwatch::start(), step: Mutex::new(ProgressLine { count: 0, share: 0.0 }) }
    }

    /// Prints while the bar is hidden.
    pub fn hide<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Observer for Watch {
    fn begin(&self, what: &str) {
        self.bar.set_message(printable(what).into_owned());
        let mut step = self.step.lock().unwrap_or_else(PoisonError::into_inner);
        *step = ProgressLine { count: step.count + 1, share: 0.0 };
        self.bar.set_position((step.count - 1) * TICKS);
    }

    fn advance(&self, share: f64) -> Result<()> {
        if self.bar.is_hidden() && self.start.seconds() > PATIENCE {
            // indicatif draws on a terminal only.
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
            *SHOWN.lock().unwrap_or_else(PoisonError::into_inner) = Some(self.bar.clone());
        }
        let mut step = self.step.lock().unwrap_or_else(PoisonError::into_inner);
        // Two tables may be under way, of which the bar shows one.
        step.share = (step.share + share).min(1.0);
        let position = (step.count.max(1) - 1) * TICKS + (step.share * TICKS as f64) as u64;
        if position > self.bar.position() {
            self.bar.set_position(position);
        }
        Ok(())
    }
}
