//! Tables of what light does: quantity × axes × light, or light on a material, in the same [`Table`] as all others.

mod harmonics;
mod irradiance;
mod radiance;
mod radiosity;

use crate::bake::{Evaluator, Observer};
use crate::base::error::{Error, Result};
use crate::base::precision::Precision;
use crate::base::timings::Stopwatch;
use crate::check::{Check, ErrorTally, reference_of_model, sample};
use crate::light::exitant::Integrated;
use crate::light::{Frame, Light};
use crate::model::lobe::Lobe;
use crate::scene::planner::constant_lobes;
use crate::scene::{Distribution, Material};
use crate::table::axis::Axis;
use crate::table::quantity::Quantity;
use crate::table::storage::Storage;
use crate::table::{Table, TableError};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Relative errors are taken of the value or of this share of the largest in the table, whichever is more: where no
/// light comes from, nothing is relative to it.
pub const FLOOR: f64 = 1e-3;

/// Texels of a table at most. Each is integrated, and takes some hundred bytes until the table is written.
const MAX_TABLE: usize = 1 << 22;

/// What share of the tolerance integrals are asked to meet: at grazing angles their estimates are up to five times too small,
/// measured.
const MARGIN: f64 = 0.1;

/// What is baked, and how well.
pub struct Order<'a> {
    /// What evaluates.
    pub evaluator: &'a Evaluator,
    /// The light.
    pub light: &'a Light,
    /// What it is called: a file, or the words that describe it.
    pub name: &'a str,
    /// Relative, with [`FLOOR`].
    pub tolerance: f64,
    /// How many texels to compare with the reference.
    pub check: Check,
    /// Who watches.
    pub observer: &'a dyn Observer,
}

/// Values of a table before it is one.
struct RgbValues {
    rgb: Vec<[f64; 3]>,
    rule: String,
    precision: Precision,
    estimate: Option<f64>,
    seconds: f64,
}

/// What some texels really are, R, G and B.
type Truths = Vec<(usize, [f64; 3])>;

impl Order<'_> {
    fn precision(&self) -> Precision {
        match self.evaluator {
            Evaluator::Device(_) => Precision::F32,
            Evaluator::Cpu => Precision::F64,
        }
    }

    /// What the texels that are to be compared really are; none of a material without a reference.
    fn truths(
        &self,
        axes: &[Axis],
        lobes: &[Lobe],
        truth: &(impl Fn(usize) -> [f64; 3] + Sync),
    ) -> Result<Truths> {
        let shape: Vec<_> = axes.iter().map(Axis::len).collect();
        let texels = match self.check {
            _ if lobes.iter().any(|lobe| reference_of_model(lobe.model()).is_none()) => Vec::new(),
            Check::All => (0..shape.iter().product()).collect(),
            Check::Sample(n) => sample(&shape, n),
        };
        let share = 1.0 / texels.len().max(1) as f64;
        let found = texels.into_par_iter().map(|texel| {
            let truth = truth(texel);
            self.observer.advance(share)?;
            Ok((texel, truth))
        });
        found.collect()
    }

    /// The table of a quantity of a subject, compared with what is known of it, relative to the value or to `floor` of
    /// the largest.
    ///
    /// # Errors
    /// When a value is one that the quantity cannot have.
    fn table(
        &self,
        quantity: &'static Quantity,
        subject: &str,
        axes: &[Axis],
        values: RgbValues,
        floor: f64,
        truths: &[(usize, [f64; 3])],
    ) -> Result<Table> {
        let RgbValues { rgb: values, rule, precision, estimate, seconds } = values;
        let floor = floor * largest(&values);
        let stored: Vec<f32> = values.as_flattened().iter().map(|&x| x as f32).collect();
        let mut tally = ErrorTally::new(TableError::unmeasured(quantity.error, Some(floor), estimate));
        for (texel, truth) in truths {
            let channels = stored[3 * texel..].iter().map(|&x| f64::from(x));
            tally.add(axes, *texel, truth.iter().zip(channels).map(|(&truth, value)| (value, truth)));
        }
        let table = Table {
            name: quantity.name.into(),
            quantity,
            subject: subject.into(),
            parameters: BTreeMap::new(),
            axes: axes.to_vec(),
            channels: ["R", "G", "B"].map(String::from).to_vec(),
            values: stored.into(),
            rule,
            storage: Storage::F32,
            bilinear: None,
            precision,
            error: tally.finish(),
            seconds,
        };
        table.check_sane()?;
        Ok(table)
    }

    /// Whether a table meets the tolerance, as far as it was measured. Of an approximation nothing is promised.
    ///
    /// # Errors
    /// [`Error::Promise`] with the worst texel.
    pub fn within_tolerance(&self, table: &Table) -> Result<()> {
        let is_off = |off: &f64| *off > self.tolerance && table.quantity.is_promised;
        let TableError { measured_max, estimate, worst, .. } = &table.error;
        let what = match (measured_max.filter(is_off), estimate.filter(is_off)) {
            (None, None) => return Ok(()),
            (Some(off), _) => {
                let place: Vec<_> = worst.iter().map(|(name, value)| format!("{name} = {value}")).collect();
                format!("its error is {off:.3e} at {}", place.join(", "))
            }
            (None, Some(off)) => format!("its error may be {off:.3e} by its estimate"),
        };
        Err(Error::Promise(format!(
            "table {}: {what}, where {:e} is allowed; allow more, or compute it on the CPU, in f64",
            table.name, self.tolerance
        )))
    }
}

/// Refuses a table that is too large, before memory is taken.
fn check_size(axes: &[Axis], settings: usize) -> Result<()> {
    let texels = axes.iter().map(Axis::len).try_fold(settings, usize::checked_mul);
    if texels.is_some_and(|texels| texels <= MAX_TABLE) {
        return Ok(());
    }
    let words: Vec<_> =
        axes.iter().map(|axis| format!("{} {}", axis.len(), axis.variable().name())).collect();
    Err(Error::input(format!(
        "{} make a table of more than the {MAX_TABLE} texels that a light fills; take fewer",
        words.join(" × ")
    )))
}

/// The lobes of a material, at a roughness if one is given in place of its own.
///
/// # Errors
/// When it varies.
pub fn lobes_of(material: &Material, roughness: Option<f64>) -> Result<Vec<Lobe>> {
    let mut material = material.clone();
    for lobe in &mut material.lobes {
        if let (Some(own), Some(given)) = (&mut lobe.roughness, roughness) {
            *own = Distribution::constant(given);
        }
    }
    constant_lobes(&material).map_err(|why| Error::input(format!("{}: {why}", material.name)))
}

/// Does something, and adds the seconds that it took.
fn timed<T>(seconds: &mut f64, act: impl FnOnce() -> T) -> T {
    let start = Stopwatch::start();
    let done = act();
    *seconds += start.seconds();
    done
}

fn normals(axes: &[Axis; 2]) -> Vec<[f64; 3]> {
    frames(&axes[0], &axes[1]).iter().map(Frame::normal).collect()
}

fn frames(theta: &Axis, phi: &Axis) -> Vec<Frame> {
    let row = |&theta: &f64| phi.values().iter().map(move |&phi| Frame::new(theta, phi));
    theta.values().iter().flat_map(row).collect()
}

/// The reference's own frames of the same normals, in the same order.
fn reference_frames(theta: &Axis, phi: &Axis) -> Vec<gonio_reference::light::Frame> {
    let row =
        |&theta: &f64| phi.values().iter().map(move |&phi| gonio_reference::light::Frame::new(theta, phi));
    theta.values().iter().flat_map(row).collect()
}

/// The largest share of a value that is in doubt.
fn estimate(values: &[Integrated]) -> f64 {
    let mean = |one: &Integrated| one.value.iter().sum::<f64>() / 3.0;
    let floor = FLOOR * values.iter().map(mean).fold(0.0, f64::max);
    let share = |one: &Integrated| one.error / mean(one).max(floor).max(f64::MIN_POSITIVE);
    values.iter().map(share).fold(0.0, f64::max)
}

fn largest(values: &[[f64; 3]]) -> f64 {
    values.as_flattened().iter().map(|x| x.abs()).fold(f64::MIN_POSITIVE, f64::max)
}
