//! Evaluates what a picture of a BRDF shows: lobes in the plane of incidence and over the hemisphere, a sphere under a
//! point light and under a uniform one, and ρ_dh, each at several settings.

pub(crate) mod light;
pub(crate) mod picture;

use crate::bake::points::Points;
use crate::bake::{Evaluator, Observer, within_tolerance};
use crate::base::angles::Angles;
use crate::base::error::{Error, Result};
use crate::base::timings::Timings;
use crate::check::Check;
use crate::model::Integral;
use crate::model::lobe::Lobe;
use crate::plan::TablePlan;
use crate::scene::Scene;
use crate::scene::planner::constant_lobes;
use crate::table::axis::{Axis, Mapping, Positions, Variable};
use crate::table::quantity::RHO_DH;
use std::f64::consts::{FRAC_PI_2, PI};

/// Pixels along a side of each map and of each sphere. Their discs touch all four sides.
pub(crate) const SIDE: usize = 360;
/// Samples along each side of a sphere's pixel under the point light.
const SAMPLES: usize = 2;
/// Samples of ρ_dh over θ. Between them it is interpolated; it bends most where μ ~ α, and at the fineness of
/// 8 bits (4e-3) lines of 0.09° are as good as it.
const THETAS: usize = 1025;
/// Texels of ρ_dh that are compared with the reference.
const CHECKED: usize = 16;

/// The unit vector from the sphere towards the distant point light: x right, y up, z to the eye.
const LIGHT: [f64; 3] = [-0.5, 0.5, std::f64::consts::FRAC_1_SQRT_2];

/// The subject of a picture: a constant material of a scene, and its label.
pub(crate) struct FigureSubject {
    pub label: String,
    pub scene: Scene,
    pub material: String,
}

/// A BRDF at one setting. Colours are R, G, B.
pub(crate) struct Figure {
    pub label: String,
    /// The lobes that are no delta; `None` if all are.
    pub values: Option<FigureValues>,
    /// Whether there is a delta, which the values lack.
    pub has_delta: bool,
    /// ρ_dh, or why it has no bound.
    pub rho: Result<Reflectance, &'static str>,
}

/// Values of f for the panels of a picture.
pub(crate) struct FigureValues {
    /// For each θi.
    pub lobes: Vec<Lobes>,
    /// π f cos θi over a sphere that the point light shines on, row by row from the top: the radiance for an
    /// irradiance of π at normal incidence, so that a white Lambert sphere is 1 where it faces the light.
    /// Samples, several to a pixel along each side; zero beyond the sphere and in the shadow.
    pub sphere: Vec<[f32; 3]>,
}

/// f for one θi; φi = π, so that light comes from the left and is mirrored to the right.
pub(crate) struct Lobes {
    /// θe in the plane of incidence, below 0 on the side of ωi, and f cos θe.
    pub plane: Vec<(f64, [f64; 3])>,
    /// f over the hemisphere seen along the normal, (x, y) = sin θe (cos φe, sin φe), row by row from the
    /// top; NaN beyond the horizon. A pixel has f at its middle, and that with the mirror direction f there.
    pub hemisphere: Vec<[f32; 3]>,
}

/// ρ_dh over θ in even steps from 0 to 90°.
pub(crate) struct Reflectance {
    values: Vec<[f64; 3]>,
    /// The largest difference from the reference, where it was compared.
    pub measured: Option<f64>,
    /// The largest difference allowed.
    pub tolerance: f64,
    /// The arithmetic.
    pub precision: String,
}

impl Figure {
    /// Evaluates a subject for light from each of `thetas`.
    ///
    /// # Errors
    /// When the material varies, the device fails, or ρ_dh misses its tolerance.
    pub fn evaluate(
        subject: &FigureSubject,
        thetas: &[f64],
        evaluator: &Evaluator,
        observer: &dyn Observer,
    ) -> Result<Self> {
        observer.begin(&subject.label);
        let FigureSubject { label, scene, material } = subject;
        let lobes = constant_lobes(scene.material(material)?)
            .map_err(|why| Error::input(format!("{material}: {why}")))?;
        let unbounded = lobes.iter().find_map(|lobe| match lobe.model().integral {
            Integral::Unbounded(why) => Some(why),
            _ => None,
        });
        let rho = match unbounded {
            Some(why) => Err(why),
            None => Ok(Reflectance::of(subject, evaluator)?),
        };
        observer.advance(0.2)?;
        let (deltas, finite): (Vec<_>, Vec<_>) = lobes.into_iter().partition(is_delta);
        let values = match finite[..] {
            [] => None,
            _ => Some(FigureValues::of(&finite, thetas, evaluator, observer)?),
        };
        Ok(Self { label: label.clone(), values, has_delta: !deltas.is_empty(), rho })
    }
}

fn is_delta(lobe: &Lobe) -> bool {
    lobe.is_delta()
}

impl Reflectance {
    fn of(FigureSubject { label, scene, material }: &FigureSubject, evaluator: &Evaluator) -> Result<Self> {
        let axis = Axis::new(Variable::ThetaI, THETAS, [0.0, FRAC_PI_2], Positions::Nodes, Mapping::Linear)?;
        // Anisotropic models: in the plane of the tangent.
        let anisotropic = scene.material(material)?.is_anisotropic();
        let about = anisotropic.then(|| Axis::listed(Variable::PhiI, vec![0.0])).transpose()?;
        let axes = [axis].into_iter().chain(about).collect();
        let plan = TablePlan::material(label, &RHO_DH, scene, material, axes)?;
        let table = evaluator.bake(
            &plan,
            Check::Sample(CHECKED),
            &mut Timings::default(),
            &crate::bake::Unobserved,
        )?;
        within_tolerance(&plan, &table)?;
        let values = (0..table.texels()).map(|k| std::array::from_fn(|c| table.value(k, c))).collect();
        Ok(Self {
            values,
            measured: table.error.measured_max,
            tolerance: plan.tolerance(),
            precision: table.precision.to_string(),
        })
    }

    /// Every sample, with its θ.
    pub fn samples(&self) -> impl Iterator<Item = (f64, [f64; 3])> {
        let step = FRAC_PI_2 / (self.values.len() - 1) as f64;
        self.values.iter().enumerate().map(move |(k, &rho)| (k as f64 * step, rho))
    }

    /// ρ_dh(θ), between its samples.
    pub fn at(&self, theta: f64) -> [f64; 3] {
        let last = self.values.len() - 1;
        let place = (theta / FRAC_PI_2).clamp(0.0, 1.0) * last as f64;
        let k = (place as usize).min(last - 1);
        let [a, b] = [self.values[k], self.values[k + 1]];
        std::array::from_fn(|c| a[c] + (b[c] - a[c]) * (place - k as f64))
    }
}

impl FigureValues {
    fn of(lobes: &[Lobe], thetas: &[f64], evaluator: &Evaluator, observer: &dyn Observer) -> Result<Self> {
        let mut f = Brdf { points: Points::new(evaluator, lobes)?, observer };
        let share = 0.8 / (thetas.len() + 4) as f64;
        let lobes = thetas.iter().map(|&theta_i| {
            Ok(Lobes { plane: plane(&mut f, theta_i)?, hemisphere: hemisphere(&mut f, theta_i, share)? })
        });
        let lobes = lobes.collect::<Result<_>>()?;
        Ok(Self { lobes, sphere: sphere(&mut f, 4.0 * share)? })
    }
}

/// f at lists of directions, R, G, B.
struct Brdf<'a> {
    points: Points<'a>,
    observer: &'a dyn Observer,
}

impl Brdf<'_> {
    fn at(&mut self, angles: &[Angles], share: f64) -> Result<Vec<[f32; 3]>> {
        const PIECE: usize = 1 << 16;
        let (mut all, mut values) = (Vec::with_capacity(angles.len()), Vec::new());
        for piece in angles.chunks(PIECE) {
            self.points.evaluate(piece, &mut values)?;
            all.extend(values.chunks_exact(3).map(|f| [f[0], f[1], f[2]]));
            self.observer.advance(share * piece.len() as f64 / angles.len() as f64)?;
        }
        Ok(all)
    }
}

/// Even steps, and closer and closer ones around the mirror direction, so that no lobe falls between.
fn plane(f: &mut Brdf, theta_i: f64) -> Result<Vec<(f64, [f64; 3])>> {
    const EVEN: usize = 720;
    let even = (0..=EVEN).map(|k| (k as f64 / EVEN as f64 - 0.5) * PI);
    // 10⁻⁷ to 10⁻¹ rad, twenty to a decade.
    let steps = (0..=120).map(|k| 10f64.powf(f64::from(k) / 20.0 - 7.0));
    let near = steps.flat_map(|step| [theta_i - step, theta_i + step]);
    let mut thetas: Vec<_> = even.chain(near).chain([theta_i]).filter(|t| t.abs() <= FRAC_PI_2).collect();
    thetas.sort_by(f64::total_cmp);
    thetas.dedup();
    let angles: Vec<_> = thetas
        .iter()
        .map(|&t| Angles { theta_i, phi_i: PI, theta_e: t.abs(), phi_e: if t < 0.0 { PI } else { 0.0 } })
        .collect();
    let values = f.at(&angles, 0.0)?;
    let scaled = |(&theta, f): (&f64, [f32; 3])| (theta, f.map(|f| f64::from(f) * theta.cos().max(0.0)));
    Ok(thetas.iter().zip(values).map(scaled).collect())
}

/// Isotropic models are alike on both sides of the plane of incidence: the upper half is evaluated.
fn hemisphere(f: &mut Brdf, theta_i: f64, share: f64) -> Result<Vec<[f32; 3]>> {
    let middle = |k: usize| (2 * k + 1) as f64 / SIDE as f64 - 1.0;
    let mut pixels = Vec::new();
    let mut angles = Vec::new();
    let cell = |x: f64| ((x + 1.0) * 0.5 * SIDE as f64) as usize;
    for row in 0..SIDE / 2 {
        for column in 0..SIDE {
            let (x, y) = (middle(column), -middle(row));
            let r = x.hypot(y);
            if r <= 1.0 {
                // The mirror direction lies on the border of the two halves.
                let is_mirror = row + 1 == SIDE / 2 && column == cell(theta_i.sin());
                let (theta_e, phi_e) = if is_mirror { (theta_i, 0.0) } else { (r.asin(), y.atan2(x)) };
                pixels.push((row, column));
                angles.push(Angles { theta_i, phi_i: PI, theta_e, phi_e });
            }
        }
    }
    let values = f.at(&angles, share)?;
    let mut all = vec![[f32::NAN; 3]; SIDE * SIDE];
    for ((row, column), value) in pixels.into_iter().zip(values) {
        all[row * SIDE + column] = value;
        all[(SIDE - 1 - row) * SIDE + column] = value;
    }
    Ok(all)
}

fn sphere(f: &mut Brdf, share: f64) -> Result<Vec<[f32; 3]>> {
    const FINE: usize = SAMPLES * SIDE;
    let [lx, ly, lz] = LIGHT;
    let middle = |k: usize| (2 * k + 1) as f64 / FINE as f64 - 1.0;
    let (mut places, mut angles) = (Vec::new(), Vec::new());
    for row in 0..FINE {
        for column in 0..FINE {
            // The normal; the eye is at z.
            let (x, y) = (middle(column), -middle(row));
            let r2 = x * x + y * y;
            if r2 > 1.0 {
                continue;
            }
            let z = (1.0 - r2).sqrt();
            let mu_i = x * lx + y * ly + z * lz;
            if mu_i <= 0.0 {
                continue;
            }
            // The azimuth between both: its sine is n·(l × v), its cosine l·v − (n·l)(n·v), up to a factor.
            let phi_e = (x * ly - y * lx).atan2(lz - mu_i * z);
            places.push((row * FINE + column, mu_i));
            angles.push(Angles {
                theta_i: mu_i.min(1.0).acos(),
                phi_i: 0.0,
                theta_e: r2.sqrt().asin(),
                phi_e,
            });
        }
    }
    let values = f.at(&angles, share)?;
    let mut all = vec![[0.0; 3]; FINE * FINE];
    for ((at, mu_i), value) in places.into_iter().zip(values) {
        all[at] = value.map(|f| (PI * mu_i) as f32 * f);
    }
    Ok(all)
}

/// What a pixel of a sphere has of something given for its samples: the mean.
pub(crate) fn pixel(
    samples: &[[f32; 3]],
    row: usize,
    column: usize,
    of: impl Fn([f32; 3]) -> [f32; 3],
) -> [f32; 3] {
    let mut sum = [0.0; 3];
    for dy in 0..SAMPLES {
        for dx in 0..SAMPLES {
            let sample = of(samples[(row * SAMPLES + dy) * SAMPLES * SIDE + column * SAMPLES + dx]);
            sum = std::array::from_fn(|c| sum[c] + sample[c] / (SAMPLES * SAMPLES) as f32);
        }
    }
    sum
}
