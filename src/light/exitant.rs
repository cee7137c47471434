//! Exitant radiance Le(ωe) = ∫ f L cos θi dωi, its pre-filtered approximation, and radiosity.
//!
//! The directions are the host's and f the device's. The sphere of directions is cut into cells: blocks of texels, texels,
//! parts of texels. A cell has Gauss–Legendre's 2 × 2 nodes, and a fifth in its middle, which counts nothing and shows
//! what the four cannot. Of a block, the nodes' weights are what each texel's L Δω takes as a share of the four by linear
//! interpolation, so that no texel is missed, however small and bright; of a texel, where L is constant, they are
//! the rule's, and they sum to the exact solid angle. A texel that the horizon crosses has 3 × 3 nodes, on three meridians,
//! each where it is above the surface: f cos θi of a lobe that is seen at grazing angles is not 0 there.
//!
//! What a cell may be off is estimated from the spread s of f cos θi over its nodes, as a share of the largest: with L
//! constant the rule is exact to degree 3, and of e^{kx} it is off by s⁴/470; where L varies, linear interpolation is off by
//! s²/16 of what L deviates from its mean, and as texels deviate this way and that, such errors add up as their squares.
//! Cells with the largest are quartered until what is left of all is within the tolerance. Around the mirror direction,
//! where a lobe narrower than its cell would lie between the nodes unseen, cells are quartered until they are as
//! narrow as half of the lobe.
//!
//! Lambert's lobe needs none of this: f is constant, so Le = f E, which is exact. A mirror's is what it is defined to be:
//! Le(ωe) = F L(r), r the mirror direction of ωe.

use super::irradiance;
use super::{Disk, Environment, Frame, Light, Sky, direction, dot};
use crate::axis::{Axis, Mapping, Positions, Variable};
use crate::bake::{Evaluator, Observer, Stages, Unobserved};
use crate::check::Check;
use crate::error::{Error, Result};
use crate::models::Integral;
use crate::plan::{Lobe, TablePlan};
use crate::points::{Angles, Points};
use crate::quantity::{RHO_DH, RHO_HH};
use crate::scene::Scene;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A surface and where it is seen from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// The surface's frame in the world.
    pub frame: Frame,
    /// θe ∈ [0, π/2], rad.
    pub theta_e: f64,
    /// φe, rad, in the surface's frame.
    pub phi_e: f64,
}

impl View {
    /// Where a mirror would show: the mirror direction of ωe, in the world.
    pub fn mirror(&self) -> [f64; 3] {
        let [x, y, z] = direction(self.theta_e, self.phi_e);
        self.frame.to_world([-x, -y, z])
    }
}

/// An integral over incident light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrated {
    /// R, G, B.
    pub value: [f64; 3],
    /// What it may be off by its own estimate: of the mean of the channels.
    pub error: f64,
}

/// Le of a sum of lobes of three channels under a light, of each view. The tolerance is relative to Le.
///
/// # Errors
/// When a lobe needs a roughness, or the device fails.
pub fn radiance(
    evaluator: &Evaluator,
    lobes: &[Lobe],
    light: &Light,
    views: &[View],
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<Vec<Integrated>> {
    let mut all = vec![Integrated { value: [0.0; 3], error: 0.0 }; views.len()];
    let is_flat = |lobe: &&Lobe| lobe.model.name == "lambert" && lobe.factors.is_empty();
    let is_delta = |lobe: &&Lobe| lobe.model.is_delta_at(lobe.roughness.unwrap_or(0.0));
    let flat: Vec<_> = lobes.iter().filter(is_flat).collect();
    let deltas: Vec<_> = lobes.iter().filter(is_delta).collect();
    let rest: Vec<_> = lobes.iter().filter(|lobe| !is_flat(lobe) && !is_delta(lobe)).cloned().collect();

    if !flat.is_empty() {
        let normals: Vec<_> = views.iter().map(|view| view.frame.normal()).collect();
        let irradiances = irradiance_of(evaluator, light, &normals)?;
        for (one, e) in all.iter_mut().zip(&irradiances) {
            for lobe in &flat {
                (0..3).for_each(|c| one.value[c] += lobe.weights[c][0] * e[c] / PI);
            }
        }
    }
    for lobe in deltas {
        for (one, view) in all.iter_mut().zip(views) {
            let [a, b] = delta(lobe, view.theta_e)?;
            let seen = light.radiance(view.mirror());
            (0..3).for_each(|c| one.value[c] += seen[c] * (lobe.weights[c][0] * a + lobe.weights[c][1] * b));
        }
    }
    if !rest.is_empty() {
        let mut points = Points::new(evaluator, &rest)?;
        let mut f = |angles: &[Angles], values: &mut Vec<f32>| points.evaluate(angles, values);
        let width = rest.iter().map(width).fold(f64::INFINITY, f64::min);
        for (one, more) in all.iter_mut().zip(integrate(&mut f, width, light, views, tolerance, observer)?) {
            (0..3).for_each(|c| one.value[c] += more.value[c]);
            one.error += more.error;
        }
    }
    Ok(all)
}

/// What a delta reflects of L(r): A and B at θe, as its integrals have them.
fn delta(lobe: &Lobe, theta_e: f64) -> Result<[f64; 2]> {
    let (mu, setting) = (theta_e.cos().max(0.0), lobe.setting_at(None));
    match lobe.model.integral {
        Integral::Delta(directional) => Ok(directional(mu, &setting)),
        Integral::Slopes(slopes) => Ok((slopes.mirror_limit)(mu, &setting)),
        _ => Err(Error::input(format!("{} at this roughness is a delta; give it more", lobe.model.name))),
    }
}

/// About half the width of a lobe around the mirror direction, rad: α, and less where it is stretched.
fn width(lobe: &Lobe) -> f64 {
    let stretched = if lobe.model.is_anisotropic() { 0.1 } else { 1.0 };
    match (lobe.model.shape, lobe.roughness) {
        (Some(shape), Some(roughness)) => shape.measure(roughness).clamp(1e-6, 1.0) * stretched,
        _ => 1.0,
    }
}

/// LD, the pre-filtered radiance: Le over what a white sky would make of it, at n = v = r for each r, all weights 1.
/// Karis 2013, "Real shading in Unreal Engine 4", eq. 8, and Lagarde & de Rousiers 2014, eq. 54, have it of D cos θi alone;
/// here the lobe is f cos θi itself, at ωe = n.
///
/// # Errors
/// As [`radiance`]'s.
pub fn prefiltered(
    evaluator: &Evaluator,
    lobe: &Lobe,
    light: &Light,
    directions: &[[f64; 3]],
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<Vec<[f64; 3]>> {
    let plain = Lobe { weights: vec![[1.0; 2]; 3], ..lobe.clone() };
    let along = |&r: &[f64; 3]| {
        let (theta, phi) = super::angles(r);
        View { frame: Frame::new(theta, phi), theta_e: 0.0, phi_e: 0.0 }
    };
    let views: Vec<_> = directions.iter().map(along).collect();
    let lobes = std::slice::from_ref(&plain);
    let lit = radiance(evaluator, lobes, light, &views, tolerance, observer)?;
    let white = Light::Constant([1.0; 3]);
    let one = radiance(evaluator, lobes, &white, &views[..1.min(views.len())], tolerance, observer)?;
    let Some(whole) = one.first().map(|one| one.value) else { return Ok(Vec::new()) };
    Ok(lit.iter().map(|lit| std::array::from_fn(|c| lit.value[c] / whole[c])).collect())
}

/// What engines make of a lobe: LD(r) (F0·A + F90·B)(θe), and of a diffuse one, without a roughness, E(n)/π in place
/// of LD.
///
/// # Errors
/// As [`radiance`]'s.
pub fn split_sum(
    evaluator: &Evaluator,
    lobes: &[Lobe],
    light: &Light,
    views: &[View],
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<Vec<[f64; 3]>> {
    let mut all = vec![[0.0; 3]; views.len()];
    let white = Light::Constant([1.0; 3]);
    for lobe in lobes {
        // A and B hang on θe alone (and on φe where azimuths tell): each is integrated once.
        let mut own: Vec<View> = Vec::new();
        let at = |view: &View| View { frame: Frame::new(0.0, 0.0), ..*view };
        let same = |a: &View, b: &View| {
            a.theta_e == b.theta_e && (a.phi_e == b.phi_e || !lobe.model.is_anisotropic())
        };
        for view in views.iter().map(at) {
            if !own.iter().any(|known| same(known, &view)) {
                own.push(view);
            }
        }
        let terms = radiance(evaluator, std::slice::from_ref(lobe), &white, &own, tolerance, observer)?;
        let incident = if lobe.model.shape.is_some() || lobe.model.is_delta() {
            let mirrors: Vec<_> = views.iter().map(View::mirror).collect();
            prefiltered(evaluator, lobe, light, &mirrors, tolerance, observer)?
        } else {
            let normals: Vec<_> = views.iter().map(|view| view.frame.normal()).collect();
            irradiance_of(evaluator, light, &normals)?.into_iter().map(|e| e.map(|e| e / PI)).collect()
        };
        for ((sum, view), incident) in all.iter_mut().zip(views).zip(incident) {
            let found = own.iter().position(|known| same(known, &at(view)));
            let Some(term) = found.and_then(|k| terms.get(k)) else { continue };
            (0..3).for_each(|c| sum[c] += incident[c] * term.value[c]);
        }
    }
    Ok(all)
}

/// M = ∫ Le cos θe dωe of a material under a light, of each frame: by Fubini ∫ ρ_dh(ωi) L cos θi dωi. The tolerance is
/// relative to M.
///
/// # Errors
/// When the material varies or tells azimuths from each other, its integrals have no bound, or the device fails.
pub fn radiosity(
    evaluator: &Evaluator,
    (scene, material): (&Scene, &str),
    light: &Light,
    frames: &[Frame],
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<Vec<Integrated>> {
    if scene.material(material)?.is_anisotropic() {
        return Err(Error::input(format!(
            "{material}: radiosity of what tells azimuths from each other is not there; give equal α"
        )));
    }
    if let Light::Constant(radiance) = light {
        // ∫ ρ_dh cos θ dω = π ρ_hh.
        let rho = mean_albedo(evaluator, scene, material)?;
        let value = std::array::from_fn(|c| PI * radiance[c] * rho[c]);
        return Ok(vec![Integrated { value, error: 0.0 }; frames.len()]);
    }
    let albedo = Albedo::new(evaluator, scene, material)?;
    let mut f = |angles: &[Angles], values: &mut Vec<f32>| {
        values.clear();
        values.extend(angles.iter().flat_map(|angles| albedo.at(angles.theta_i).map(|rho| rho as f32)));
        Ok(())
    };
    let views: Vec<_> = frames.iter().map(|&frame| View { frame, theta_e: 0.0, phi_e: 0.0 }).collect();
    integrate(&mut f, 1.0, light, &views, tolerance, observer)
}

/// ρ_dh of a material over θ, R, G, B; between its samples it is interpolated.
struct Albedo {
    values: Vec<[f64; 3]>,
}

impl Albedo {
    /// Samples over θ in even steps: between them ρ is off by their square, 1e-7 over α², and less than that of f32.
    const SAMPLES: usize = 4097;

    fn new(evaluator: &Evaluator, scene: &Scene, material: &str) -> Result<Self> {
        let axis =
            Axis::new(Variable::ThetaI, Self::SAMPLES, [0.0, FRAC_PI_2], Positions::Nodes, Mapping::Linear)?;
        let plan = TablePlan::material(material, &RHO_DH, scene, material, vec![axis])?.with_tolerance(1e-5);
        let table = evaluator.bake(&plan, Check::Sample(0), &mut Stages::default(), &Unobserved)?;
        let values = (0..table.texels()).map(|k| std::array::from_fn(|c| table.value(k, c))).collect();
        Ok(Self { values })
    }

    fn at(&self, theta: f64) -> [f64; 3] {
        let last = self.values.len() - 1;
        let place = (theta / FRAC_PI_2).clamp(0.0, 1.0) * last as f64;
        let k = (place as usize).min(last - 1);
        let [a, b] = [self.values[k], self.values[k + 1]];
        std::array::from_fn(|c| a[c] + (b[c] - a[c]) * (place - k as f64))
    }
}

/// ρ_hh, R, G, B.
fn mean_albedo(evaluator: &Evaluator, scene: &Scene, material: &str) -> Result<[f64; 3]> {
    let plan = TablePlan::material(material, &RHO_HH, scene, material, Vec::new())?.with_tolerance(1e-7);
    let table = evaluator.bake(&plan, Check::Sample(0), &mut Stages::default(), &Unobserved)?;
    Ok(std::array::from_fn(|c| table.value(0, c)))
}

/// E of some normals, by whichever way the light has; neighbours that are equal are integrated once.
fn irradiance_of(evaluator: &Evaluator, light: &Light, normals: &[[f64; 3]]) -> Result<Vec<[f64; 3]>> {
    let mut own: Vec<[f64; 3]> = Vec::new();
    let mut places = Vec::with_capacity(normals.len());
    for &normal in normals {
        if own.last() != Some(&normal) {
            own.push(normal);
        }
        places.push(own.len() - 1);
    }
    let found = irradiance_of_each(evaluator, light, &own)?;
    Ok(places.into_iter().map(|place| found[place]).collect())
}

fn irradiance_of_each(evaluator: &Evaluator, light: &Light, normals: &[[f64; 3]]) -> Result<Vec<[f64; 3]>> {
    let Light::Map(map) = light else {
        let closed = |&normal: &[f64; 3]| irradiance::in_closed_form(light, normal).unwrap_or([f64::NAN; 3]);
        return Ok(normals.iter().map(closed).collect());
    };
    let map = irradiance::Prepared::new(map);
    map.of(evaluator, normals, 2, &|_| Ok(()))
}

/// f, R, G, B, at each pair of directions.
type Integrand<'a> = dyn FnMut(&[Angles], &mut Vec<f32>) -> Result<()> + 'a;

/// Cells of all views together are at most so many: 64 bytes each.
const MOST_CELLS: usize = 1 << 22;
/// Views that are refined together: their nodes fill a device, and fit its buffers.
const VIEWS: usize = 16;
/// Halvings of a texel's sides.
const DEPTH: u32 = 40;
/// Of the spread s to the fourth, what a rule of 2 × 2 is off where L is constant; with room for what is no exponential.
const SMOOTH: f64 = 1.0 / 100.0;
/// Of s², what linear interpolation is off where L varies.
const VARIED: f64 = 1.0 / 16.0;

fn integrate(
    f: &mut Integrand,
    width: f64,
    light: &Light,
    views: &[View],
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<Vec<Integrated>> {
    if let Light::Directional { direction, irradiance } = light {
        return directional(f, *direction, *irradiance, views);
    }
    let domain = Domain::new(light);
    let cells = domain.cells();
    let mut all = Vec::with_capacity(views.len());
    for group in views.chunks(VIEWS) {
        let views: Vec<_> = group.iter().map(|view| Local::new(view, &domain, width)).collect();
        all.extend(refine(f, &domain, &cells, &views, tolerance)?);
        observer.advance(group.len() as f64 / all.capacity().max(1) as f64)?;
    }
    Ok(all)
}

/// A delta of light: Le = f E cos θi.
fn directional(
    f: &mut Integrand,
    direction: [f64; 3],
    irradiance: [f64; 3],
    views: &[View],
) -> Result<Vec<Integrated>> {
    let place = |view: &View| {
        let local = view.frame.to_local(direction);
        let (theta_i, phi_i) = super::angles(local);
        let theta_i = theta_i.min(FRAC_PI_2);
        (Angles { theta_i, phi_i, theta_e: view.theta_e, phi_e: view.phi_e }, local[2].max(0.0))
    };
    let (angles, cosines): (Vec<_>, Vec<_>) = views.iter().map(place).unzip();
    let mut values = Vec::new();
    f(&angles, &mut values)?;
    let value = |(f, cos): (&[f32; 3], f64)| {
        let value = std::array::from_fn(|c| f64::from(f[c]) * irradiance[c] * cos);
        Integrated { value, error: 0.0 }
    };
    Ok(values.as_chunks::<3>().0.iter().zip(cosines).map(value).collect())
}

/// Where a light comes from, as latitudes and longitudes of a frame of its own.
struct Domain<'a> {
    kind: Kind<'a>,
    rows: usize,
    columns: usize,
    /// θ from 0 to here.
    end: f64,
}

enum Kind<'a> {
    Map(std::borrow::Cow<'a, Environment>),
    Sky(Sky),
    Disk(&'a Disk, Frame),
}

impl<'a> Domain<'a> {
    /// Rows and columns that cells begin from.
    const BEGIN: [usize; 2] = [32, 64];

    fn new(light: &'a Light) -> Self {
        let [rows, columns] = Self::BEGIN;
        let sky = |sky| Self { kind: Kind::Sky(sky), rows, columns, end: PI };
        match light {
            Light::Constant(l) => sky(Sky { zenith: *l, horizon: *l, ground: *l }),
            Light::Sky(own) => sky(*own),
            Light::Disk(disk) => {
                let (theta, phi) = super::angles(disk.direction);
                Self {
                    kind: Kind::Disk(disk, Frame::new(theta, phi)),
                    rows: 4,
                    columns: 16,
                    end: disk.radius,
                }
            }
            Light::Map(map) => {
                let map = map.at_least(columns, rows);
                let (rows, columns) = (map.height(), map.width());
                Self { kind: Kind::Map(std::borrow::Cow::Owned(map)), rows, columns, end: PI }
            }
            // It has no extent.
            Light::Directional { .. } => sky(Sky { zenith: [0.0; 3], horizon: [0.0; 3], ground: [0.0; 3] }),
        }
    }

    /// The cells that every view begins from.
    fn cells(&self) -> Vec<Cell> {
        let [down, across] =
            [self.rows.div_ceil(Self::BEGIN[0]), self.columns.div_ceil(Self::BEGIN[1])].map(|n| n.max(1));
        let rows = (0..self.rows).step_by(down).map(|row| [row, (row + down).min(self.rows)]);
        let block = |rows: [usize; 2], columns: [usize; 2]| self.block(rows, columns);
        rows.flat_map(|rows| {
            let columns = (0..self.columns).step_by(across);
            columns.map(move |column| block(rows, [column, (column + across).min(self.columns)]))
        })
        .collect()
    }

    fn block(&self, rows: [usize; 2], columns: [usize; 2]) -> Cell {
        Cell {
            theta: rows.map(|row| self.end * row as f64 / self.rows as f64),
            psi: columns.map(|column| TAU * column as f64 / self.columns as f64),
            rows: rows.map(|n| n as u32),
            columns: columns.map(|n| n as u32),
            depth: 0,
        }
    }

    fn quarters(&self, cell: &Cell) -> Vec<Cell> {
        let halves = |[a, b]: [u32; 2]| {
            let middle = a + (b - a) / 2;
            if middle == a { vec![[a, b]] } else { vec![[a, middle], [middle, b]] }
        };
        if !cell.is_flat() {
            let columns = halves(cell.columns);
            let of = |rows: [u32; 2]| {
                let wide = |n: [u32; 2]| n.map(|n| n as usize);
                columns.iter().map(move |&columns| self.block(wide(rows), wide(columns))).collect::<Vec<_>>()
            };
            return halves(cell.rows).into_iter().flat_map(of).collect();
        }
        let halves = |[a, b]: [f64; 2]| [[a, 0.5 * (a + b)], [0.5 * (a + b), b]];
        let of = |theta| halves(cell.psi).map(|psi| Cell { theta, psi, depth: cell.depth + 1, ..*cell });
        halves(cell.theta).into_iter().flat_map(of).collect()
    }

    /// A vector of the domain's frame in the world, or back.
    fn to_world(&self, v: [f64; 3]) -> [f64; 3] {
        match &self.kind {
            Kind::Map(map) => map.turn(v),
            Kind::Sky(_) => v,
            Kind::Disk(_, frame) => frame.to_world(v),
        }
    }

    fn to_domain(&self, v: [f64; 3]) -> [f64; 3] {
        match &self.kind {
            Kind::Map(map) => map.turn(v),
            Kind::Sky(_) => v,
            Kind::Disk(_, frame) => frame.to_local(v),
        }
    }

    /// L at a cosine of θ, in a cell where it is smooth.
    fn radiance(&self, cell: &Cell, cos: f64) -> [f64; 3] {
        match &self.kind {
            Kind::Map(map) => map.texel(cell.rows[0] as usize, cell.columns[0] as usize).map(f64::from),
            // The middle decides: borders of cells lie on the horizon.
            Kind::Sky(sky) if cell.theta[0] + cell.theta[1] > PI => sky.ground,
            Kind::Sky(sky) => {
                std::array::from_fn(|c| sky.horizon[c] + (sky.zenith[c] - sky.horizon[c]) * cos)
            }
            Kind::Disk(disk, _) => disk.radiance,
        }
    }

    /// L Δω of each texel of a block, as shares of its four nodes.
    fn shares(&self, cell: &Cell) -> [[f64; 3]; 4] {
        let mut shares = [[0.0; 3]; 4];
        let Kind::Map(map) = &self.kind else { return shares };
        let [rows, columns] = [cell.rows, cell.columns].map(|[a, b]| a as usize..b as usize);
        // The middle of texel k of n, in [−1, 1]; and the two linear functions that are 1 at one node and 0 at the other.
        let hats = |k: usize, n: usize| {
            let x = (2 * k + 1) as f64 / n as f64 - 1.0;
            [0.5 - 0.5 * x / NODE, 0.5 + 0.5 * x / NODE]
        };
        for (i, row) in rows.clone().enumerate() {
            let solid = map.cell(row, 0).solid_angle();
            let down = hats(i, rows.len());
            for (j, column) in columns.clone().enumerate() {
                let across = hats(j, columns.len());
                let texel = map.texel(row, column);
                for (k, share) in shares.iter_mut().enumerate() {
                    let weight = solid * down[k / 2] * across[k % 2];
                    (0..3).for_each(|c| share[c] += weight * f64::from(texel[c]));
                }
            }
        }
        shares
    }
}

/// Gauss–Legendre's two nodes are ± this.
const NODE: f64 = 0.577_350_269_189_625_8;

/// Some directions of a domain.
#[derive(Debug, Clone, Copy)]
struct Cell {
    theta: [f64; 2],
    psi: [f64; 2],
    /// Texels from the first to before the last; of less than one, that one.
    rows: [u32; 2],
    columns: [u32; 2],
    depth: u32,
}

impl Cell {
    /// Whether L is smooth in it.
    fn is_flat(&self) -> bool {
        self.rows[1] - self.rows[0] == 1 && self.columns[1] - self.columns[0] == 1
    }

    fn middle(&self) -> (f64, f64) {
        (0.5 * (self.theta[0] + self.theta[1]), 0.5 * (self.psi[0] + self.psi[1]))
    }

    fn half(&self) -> [f64; 2] {
        [0.5 * (self.theta[1] - self.theta[0]), 0.5 * (self.psi[1] - self.psi[0])]
    }

    /// How wide it is at most, rad.
    fn size(&self) -> f64 {
        let [t, p] = self.half();
        let sin = self.theta[1].min(PI - self.theta[0]).min(FRAC_PI_2).sin();
        2.0 * t.max(p * sin)
    }
}

/// A view with what cells ask of it.
struct Local {
    view: View,
    /// In the domain's frame.
    normal: [f64; 3],
    mirror: [f64; 3],
    width: f64,
}

impl Local {
    fn new(view: &View, domain: &Domain, width: f64) -> Self {
        let [normal, mirror] = [view.frame.normal(), view.mirror()].map(|v| domain.to_domain(v));
        Self { view: *view, normal, mirror, width }
    }

    /// What of a cell is above the surface.
    fn side(&self, cell: &Cell) -> Side {
        let (t, p) = cell.middle();
        let height = |theta, psi| dot(direction(theta, psi), self.normal);
        let corners: [f64; 4] = std::array::from_fn(|k| height(cell.theta[k / 2], cell.psi[k % 2]));
        let [low, _] = irradiance::range(&corners);
        if low >= 0.0 {
            return Side::Above;
        }
        // Corners may all be below where the middle of a side is not.
        if height(t, p) < -cell.size() { Side::Below } else { Side::Crossed }
    }

    /// What of a cell's meridian is above the surface, from θ to θ: n·ω = A cos θ + B sin θ > 0 within a quarter turn of its
    /// peak, which for θ ∈ [0, π] is one stretch. The first is the larger where nothing is.
    fn above(&self, cell: &Cell, psi: f64) -> [f64; 2] {
        let across = self.normal[0] * psi.cos() + self.normal[1] * psi.sin();
        let peak = across.atan2(self.normal[2]);
        let peak = if peak < -FRAC_PI_2 { peak + TAU } else { peak };
        [cell.theta[0].max(peak - FRAC_PI_2), cell.theta[1].min(peak + FRAC_PI_2)]
    }

    /// Whether the lobe's peak may lie between the nodes of a cell.
    fn hides_the_peak(&self, cell: &Cell) -> bool {
        let size = cell.size();
        let (t, p) = cell.middle();
        let middle = direction(t, p);
        let away = (0..3).map(|k| (middle[k] - self.mirror[k]).powi(2)).sum::<f64>().sqrt();
        size > 0.5 * self.width && away < size
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    Above,
    Below,
    Crossed,
}

/// A cell of a view with what it sends and what that may be off.
struct Leaf {
    view: usize,
    cell: Cell,
    value: [f64; 3],
    error: f64,
    /// Whether errors of its kind have no common sign.
    varied: bool,
}

fn refine(
    f: &mut Integrand,
    domain: &Domain,
    begin: &[Cell],
    views: &[Local],
    tolerance: f64,
) -> Result<Vec<Integrated>> {
    let mut pending: Vec<(usize, Cell)> =
        (0..views.len()).flat_map(|view| begin.iter().map(move |&cell| (view, cell))).collect();
    let mut leaves: Vec<Leaf> = Vec::new();
    loop {
        for piece in pending.chunks(1 << 15) {
            evaluate(f, domain, views, piece, &mut leaves)?;
        }
        let (totals, limits) = budgets(&leaves, views.len(), tolerance);
        let is_rough =
            |leaf: &Leaf| leaf.cell.depth < DEPTH && leaf.error > limits[leaf.view][usize::from(leaf.varied)];
        if leaves.len() >= MOST_CELLS || !leaves.iter().any(is_rough) {
            return Ok(totals);
        }
        let (rough, kept): (Vec<_>, Vec<_>) = leaves.into_iter().partition(is_rough);
        leaves = kept;
        let quarters = |leaf: &Leaf| {
            let view = leaf.view;
            domain.quarters(&leaf.cell).into_iter().map(move |cell| (view, cell)).collect::<Vec<_>>()
        };
        pending = rough.iter().flat_map(quarters).collect();
    }
}

/// What each view has so far, and what a smooth and a varied leaf of it may be off.
fn budgets(leaves: &[Leaf], views: usize, tolerance: f64) -> (Vec<Integrated>, Vec<[f64; 2]>) {
    let mut totals = vec![([0.0; 3], [0.0f64; 2], [0usize; 2]); views];
    for leaf in leaves {
        let (value, errors, counts) = &mut totals[leaf.view];
        (0..3).for_each(|c| value[c] += leaf.value[c]);
        if leaf.error > 0.0 {
            let kind = usize::from(leaf.varied);
            errors[kind] += if leaf.varied { leaf.error * leaf.error } else { leaf.error };
            counts[kind] += 1;
        }
    }
    let of = |&(value, [smooth, varied], [n, m]): &([f64; 3], [f64; 2], [usize; 2])| {
        let mean = value.iter().sum::<f64>() / 3.0;
        let allowed = 0.5 * tolerance * mean;
        let limits = if smooth + varied.sqrt() <= 2.0 * allowed {
            // What is left is little enough, whatever single cells are off.
            [f64::INFINITY; 2]
        } else {
            [allowed / n.max(1) as f64, allowed / (m.max(1) as f64).sqrt()]
        };
        (Integrated { value, error: smooth + varied.sqrt() }, limits)
    };
    totals.iter().map(of).unzip()
}

/// Nodes of a cell: angles, and for each the weight L Δω cos θi in R, G and B.
struct Nodes {
    angles: Vec<Angles>,
    weights: Vec<[f64; 3]>,
    cosines: Vec<f64>,
    /// What a coarser rule, of the outer nodes alone, weighs each with in place of 1.
    outer: Vec<f64>,
    side: Side,
    hides: bool,
}

/// Appends the leaves of some cells.
fn evaluate(
    f: &mut Integrand,
    domain: &Domain,
    views: &[Local],
    cells: &[(usize, Cell)],
    leaves: &mut Vec<Leaf>,
) -> Result<()> {
    let nodes: Vec<_> = cells.par_iter().map(|(view, cell)| nodes(domain, &views[*view], cell)).collect();
    let angles: Vec<_> = nodes.iter().flat_map(|nodes| nodes.angles.iter().copied()).collect();
    let mut values = Vec::new();
    if !angles.is_empty() {
        f(&angles, &mut values)?;
    }
    let mut rest = values.as_chunks::<3>().0;
    for (&(view, cell), nodes) in cells.iter().zip(&nodes) {
        let (own, more) = rest.split_at(nodes.angles.len());
        rest = more;
        if nodes.side == Side::Below {
            continue;
        }
        leaves.push(leaf(view, cell, nodes, own));
    }
    Ok(())
}

fn leaf(view: usize, cell: Cell, nodes: &Nodes, values: &[[f32; 3]]) -> Leaf {
    let mut value = [0.0; 3];
    // Of f cos θi in the mean of the channels; and of all that L could send with the largest of it.
    let (mut low, mut high, mut light) = (f64::INFINITY, 0.0f64, 0.0);
    let (mut sum, mut coarse) = (0.0, 0.0);
    let places = nodes.weights.iter().zip(&nodes.cosines).zip(&nodes.outer);
    for (f, ((weight, cos), outer)) in values.iter().zip(places) {
        let f = f.map(f64::from);
        (0..3).for_each(|c| value[c] += f[c] * weight[c] * cos);
        let mean = cos * f.iter().sum::<f64>() / 3.0;
        (low, high) = (low.min(mean), high.max(mean));
        let sent = (0..3).map(|c| f[c] * weight[c] * cos).sum::<f64>() / 3.0;
        (sum, coarse) = (sum + sent, coarse + outer * sent);
        light += weight.iter().map(|w| w.abs()).sum::<f64>() / 3.0;
    }
    let most = light * high;
    let spread = if high > 0.0 { ((high - low) / high).clamp(0.0, 1.0) } else { 0.0 };
    let error = match (cell.is_flat(), nodes.side == Side::Crossed) {
        _ if nodes.hides => f64::INFINITY,
        // Down to texels, which are cut.
        (false, true) => f64::INFINITY,
        (false, false) => VARIED * spread * spread * most,
        (true, true) => CUT * (sum - coarse).abs(),
        (true, false) => SMOOTH * spread.powi(4) * most,
    };
    let varied = !cell.is_flat();
    // What no light comes from needs no parts; of a block whose nodes are all below, that is not known.
    let unseen = !cell.is_flat() && nodes.side == Side::Crossed;
    let error = if light > 0.0 || unseen { error } else { 0.0 };
    Leaf { view, cell, value, error, varied }
}

/// Of what the rule of two outer nodes is off by, what that of three is. Of integrands that fall to 0 at the horizon
/// within c rad, as μ/(μ + c) does and lobes that are seen at grazing angles do, it was 0.35 at most: GGX under a white
/// map of 256 × 128, tilted by 60° and seen at 90°, 86° and 69°, against its ρ_dh.
const CUT: f64 = 0.4;

/// Gauss–Legendre's three nodes on [−1, 1], with weights that sum to 1, and what the rule of the two outer ones, exact
/// to degree 1, has in place of each weight, as a multiple of it.
const THREE: [(f64, f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 18.0, 1.8),
    (0.0, 4.0 / 9.0, 0.0),
    (0.774_596_669_241_483_4, 5.0 / 18.0, 1.8),
];

fn nodes(domain: &Domain, local: &Local, cell: &Cell) -> Nodes {
    let side = local.side(cell);
    let mut nodes = Nodes {
        angles: Vec::new(),
        weights: Vec::new(),
        cosines: Vec::new(),
        outer: Vec::new(),
        side,
        hides: false,
    };
    if side == Side::Below {
        return nodes;
    }
    nodes.hides = local.hides_the_peak(cell);
    let (t, p) = cell.middle();
    let half = cell.half();
    let frame = &local.view.frame;
    let mut take = |theta: f64, psi: f64, weight: [f64; 3], outer: f64| {
        let incident = frame.to_local(domain.to_world(direction(theta, psi)));
        if incident[2] > 0.0 {
            let (theta_i, phi_i) = super::angles(incident);
            let view = &local.view;
            let theta_i = theta_i.min(FRAC_PI_2);
            nodes.angles.push(Angles { theta_i, phi_i, theta_e: view.theta_e, phi_e: view.phi_e });
            nodes.weights.push(weight);
            nodes.cosines.push(incident[2]);
            nodes.outer.push(outer);
        }
    };
    if cell.is_flat() && side == Side::Crossed {
        for (x, wx, outer_x) in THREE {
            let psi = p + half[1] * x;
            let [low, high] = local.above(cell, psi);
            for (y, wy, outer_y) in THREE {
                let theta = 0.5 * (low + high) + 0.5 * (high - low) * y;
                let weight = wx * wy * 2.0 * half[1] * (high - low) * theta.sin();
                if weight > 0.0 {
                    let light = domain.radiance(cell, theta.cos());
                    take(theta, psi, light.map(|l| l * weight), outer_x * outer_y);
                }
            }
        }
        return nodes;
    }
    let at = |k: usize| [NODE, -NODE][usize::from(k == 0)];
    let place = |k: usize| (t + at(k / 2) * half[0], p + at(k % 2) * half[1]);
    if cell.is_flat() {
        // (cos θ₀ − cos θ₁) Δψ, shared out as sin θ is.
        let solid = 2.0 * t.sin() * half[0].sin() * 2.0 * half[1];
        let sines = [0, 2].map(|k| place(k).0.sin());
        for k in 0..4 {
            let (theta, psi) = place(k);
            let weight = 0.5 * solid * sines[k / 2] / (sines[0] + sines[1]);
            take(theta, psi, domain.radiance(cell, theta.cos()).map(|l| l * weight), 1.0);
        }
    } else {
        for (k, share) in domain.shares(cell).into_iter().enumerate() {
            let (theta, psi) = place(k);
            take(theta, psi, share, 1.0);
        }
    }
    take(t, p, [0.0; 3], 1.0);
    nodes
}
