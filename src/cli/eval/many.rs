//! Evaluates a list of pairs of directions, from file to file in pieces, so that memory does not grow with the
//! list.

use crate::bake::points::Points;
use crate::bake::{Evaluator, Observer};
use crate::base::angles::Angles;
use crate::base::error::{Error, Result};
use crate::base::timings::Stopwatch;
use crate::cli::eval::{Args, is_sane, subject};
use crate::cli::watch::Watch;
use crate::cli::{HEADING, open, print, print_json};
use crate::io::{List, Pairs};
use serde_json::json;
use std::path::Path;

/// Pairs read, evaluated and written at a time: 32 MiB of angles.
const PIECE: usize = 1 << 20;

pub fn run(args: &Args, pairs: &Path, out: &Path) -> Result<()> {
    // Only the plan's lobes and channels are used: the directions come from the list.
    let plan = subject(args, &Angles { theta_i: 0.0, phi_i: 0.0, theta_e: 0.0, phi_e: 0.0 })?;
    let mut list = Pairs::open(pairs)?;
    if let (Ok(from), Ok(to)) = (pairs.canonicalize(), out.canonicalize())
        && from == to
    {
        return Err(Error::input(format!(
            "{}: --out would replace the list; give another file",
            out.display()
        )));
    }
    let mut values_file = List::create(out, plan.channels())?;
    let (evaluator, line) = open(&args.device)?;
    let mut points = Points::new(evaluator, plan.lobes())?;

    let watch = Watch::new(1);
    watch.begin(&format!("evaluating {}", plan.subject()));
    let (mut angles, mut values) = (Vec::new(), Vec::new());
    let mut seconds = Seconds::default();
    let (mut done, mut insane, mut first) = (0u64, 0u64, None);
    let start = Stopwatch::start();
    loop {
        Seconds::add(&mut seconds.read, || list.next(PIECE, &mut angles))?;
        if angles.is_empty() {
            break;
        }
        Seconds::add(&mut seconds.evaluate, || points.evaluate(&angles, &mut values))?;
        for (k, value) in (done..).zip(values.chunks_exact(plan.channels().len())) {
            if !value.iter().copied().all(is_sane) {
                insane += 1;
                first.get_or_insert(k);
            }
        }
        Seconds::add(&mut seconds.write, || values_file.write(&values))?;
        done += angles.len() as u64;
        watch.advance(list.count.map_or(0.0, |count| angles.len() as f64 / count as f64))?;
    }
    Seconds::add(&mut seconds.write, || values_file.finish())?;
    watch.finish();
    let all = start.seconds();

    let precision = if matches!(evaluator, Evaluator::Cpu) { "f64" } else { "f32" };
    if args.json {
        print_json(&json!({
            "subject": plan.subject(), "parameters": plan.parameters(), "unit": plan.quantity().unit,
            "channels": plan.channels(), "device": line, "precision": precision,
            "pairs": pairs, "out": out, "points": done, "not_finite_or_negative": insane, "first": first,
            "seconds": { "all": all, "read": seconds.read, "evaluate": seconds.evaluate, "write": seconds.write },
        }))?;
    } else {
        print(&format!("{HEADING}device{HEADING:#}  {line}"))?;
        print(&format!(
            "f({}) at {done} pairs in {}: {all:.2} s (read {:.2}, evaluate {:.2}, write {:.2})",
            plan.subject(),
            out.display(),
            seconds.read,
            seconds.evaluate,
            seconds.write
        ))?;
    }
    match first {
        None => Ok(()),
        Some(first) => Err(Error::Promise(format!(
            "{}: {insane} of {done} values are not finite, or negative; the first is in row {first}, from 0",
            out.display()
        ))),
    }
}

/// Seconds spent reading, evaluating and writing.
#[derive(Default)]
struct Seconds {
    read: f64,
    evaluate: f64,
    write: f64,
}

impl Seconds {
    fn add<T>(to: &mut f64, work: impl FnOnce() -> T) -> T {
        let start = Stopwatch::start();
        let result = work();
        *to += start.seconds();
        result
    }
}
