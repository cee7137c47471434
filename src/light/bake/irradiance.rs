//! Irradiance over normals.

use crate::bake::Evaluator;
use crate::base::error::Result;
use crate::base::precision::Precision;
use crate::base::timings::Stopwatch;
use crate::base::timings::Timings;
use crate::light::bake::{
    FLOOR, Order, RgbValues, Truths, check_size, largest, normals, reference_frames, timed,
};
use crate::light::irradiance::{PreparedMap, in_closed_form};
use crate::light::{Environment, Light};
use crate::table::Table;
use crate::table::axis::Axis;
use crate::table::quantity::IRRADIANCE;
use gonio_reference::light as reference;

/// What storage as f32 rounds by.
const STORED: f64 = 0.5 / (1 << 23) as f64;
/// Pieces of a column that the horizon crosses, at most.
const FINEST_SPLIT: u32 = 16;

impl Order<'_> {
    /// E over normals: `axes` are θn and φn.
    ///
    /// # Errors
    /// When the device fails, or a value is negative or not finite.
    pub fn irradiance(&self, axes: [Axis; 2], stages: &mut Timings) -> Result<Table> {
        check_size(&axes, 1)?;
        self.observer.begin("irradiance");
        let normals = normals(&axes);
        let values = timed(&mut stages.dispatch, || match self.light {
            Light::Map(map) => self.over_map(map, &normals),
            light => Ok(closed(light, &normals)),
        })?;
        self.observer.begin("checking irradiance");
        timed(&mut stages.check, || {
            let truths = self.irradiance_truths(&axes)?;
            self.table(&IRRADIANCE, self.name, &axes, values, FLOOR, &truths)
        })
    }

    /// E of some texels by the reference.
    pub(super) fn irradiance_truths(&self, axes: &[Axis; 2]) -> Result<Truths> {
        let light = self.light.to_reference()?;
        let meridians = match light {
            reference::Light::Map(map) => Some(reference::Meridians::new(map)),
            _ => None,
        };
        let frames = reference_frames(&axes[0], &axes[1]);
        self.truths(axes, &[], &|texel| match &meridians {
            Some(meridians) => meridians.irradiance(frames[texel].normal()),
            None => reference::irradiance(&light, frames[texel].normal()),
        })
    }

    /// By twice finer and finer pieces of columns at the horizon, until two agree to half the tolerance. Normals that see so
    /// little of the light that roundings of f32 would cost more than the other half are computed in f64 on the CPU.
    fn over_map(&self, map: &Environment, normals: &[[f64; 3]]) -> Result<RgbValues> {
        let start = Stopwatch::start();
        let map = PreparedMap::new(map);
        let evaluator = if map.fits_f32() { self.evaluator } else { &Evaluator::Cpu };
        let is_f32 = matches!(evaluator, Evaluator::Device(_));
        let tick = |share: f64| self.observer.advance(0.25 * share);
        let rough = map.of(evaluator, normals, 1, &tick)?;
        let floor = FLOOR * largest(&rough);
        let [single, double] = [24, 53].map(|bits| map.roundings(0.5f64.powi(bits)));
        let is_faint = |e: &[f64; 3]| (0..3).any(|c| single[c] > 0.5 * self.tolerance * e[c].max(floor));
        let (faint, clear): (Vec<_>, Vec<_>) =
            (0..normals.len()).partition(|&k| is_f32 && is_faint(&rough[k]));

        let mut all = Refined { rgb: rough, estimate: 0.0, split: 1 };
        let f64_of = |places: &[usize]| map.of(&Evaluator::Cpu, &chosen(normals, places), 1, &tick);
        let groups = [
            (evaluator, &clear, chosen(&all.rgb, &clear), if is_f32 { single } else { double }),
            (&Evaluator::Cpu, &faint, f64_of(&faint)?, double),
        ];
        for (evaluator, places, rough, roundings) in groups {
            let normals = chosen(normals, places);
            let found = self.refined(evaluator, &map, &normals, rough, (floor, roundings))?;
            places.iter().zip(found.rgb).for_each(|(&k, rgb)| all.rgb[k] = rgb);
            all.estimate = all.estimate.max(found.estimate);
            all.split = all.split.max(found.split);
        }
        let mut rule = format!("cells, {} × 2 nodes where the horizon crosses them", all.split);
        if !faint.is_empty() {
            rule += &format!("; {} of {} normals in f64", faint.len(), normals.len());
        }
        Ok(RgbValues {
            rgb: all.rgb,
            rule,
            precision: if is_f32 && !clear.is_empty() { Precision::F32 } else { Precision::F64 },
            estimate: Some(all.estimate),
            seconds: start.seconds(),
        })
    }

    /// E of some normals, from that with undivided columns to pieces fine enough; with the largest error by the difference of
    /// two and by roundings.
    fn refined(
        &self,
        evaluator: &Evaluator,
        map: &PreparedMap,
        normals: &[[f64; 3]],
        mut rgb: Vec<[f64; 3]>,
        (floor, roundings): (f64, [f64; 3]),
    ) -> Result<Refined> {
        let tick = |share: f64| self.observer.advance(0.25 * share);
        let mut split = 1;
        loop {
            let finer = map.of(evaluator, normals, 2 * split, &tick)?;
            let worst = |roundings: [f64; 3]| {
                let of_texel = |(a, b): (&[f64; 3], &[f64; 3])| {
                    let share = |c: usize| ((a[c] - b[c]).abs() + roundings[c]) / b[c].max(floor);
                    (0..3).map(share).fold(0.0, f64::max)
                };
                rgb.iter().zip(&finer).map(of_texel).fold(0.0, f64::max)
            };
            let (apart, estimate) = (worst([0.0; 3]), worst(roundings) + STORED);
            (split, rgb) = (2 * split, finer);
            if apart <= 0.5 * self.tolerance || split >= FINEST_SPLIT {
                return Ok(Refined { rgb, estimate, split });
            }
        }
    }
}

fn chosen(all: &[[f64; 3]], places: &[usize]) -> Vec<[f64; 3]> {
    places.iter().map(|&k| all[k]).collect()
}

/// E of some normals.
struct Refined {
    rgb: Vec<[f64; 3]>,
    /// Relative, with [`FLOOR`].
    estimate: f64,
    /// Pieces of a column.
    split: u32,
}

/// By closed forms.
fn closed(light: &Light, normals: &[[f64; 3]]) -> RgbValues {
    let start = Stopwatch::start();
    let rgb = normals.iter().map(|&n| in_closed_form(light, n).unwrap_or([f64::NAN; 3])).collect();
    RgbValues {
        rgb,
        rule: "closed form".into(),
        precision: Precision::F64,
        // Roundings of products and of an arc cosine.
        estimate: Some(1e-12 + STORED),
        seconds: start.seconds(),
    }
}
