//! Integrals over cells that are quartered until what is left in doubt is within the tolerance.
//!
//! What a cell may be off is estimated from the spread s of f cos θi over its nodes, as a share of the largest: with L
//! constant the rule is exact to degree 3, and of e^{kx} it is off by s⁴/470; where L varies, linear interpolation is off by
//! s²/16 of what L deviates from its mean, and as texels deviate this way and that, such errors add up as their squares.
//! Cells with the largest are quartered until what is left of all is within the tolerance. Around the mirror direction,
//! where a lobe narrower than its cell would lie between the nodes unseen, cells are quartered until they are as
//! narrow as half of the lobe.

use crate::bake::Observer;
use crate::base::angles::Angles;
use crate::base::error::Result;
use crate::light::exitant::domain::{Domain, DomainCell};
use crate::light::exitant::nodes::{CellNodes, HorizonSide, Local, nodes};
use crate::light::exitant::{Integrated, View};
use crate::light::{Light, angles};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;

/// f, R, G, B, at each pair of directions.
pub(super) type Integrand<'a> = dyn FnMut(&[Angles], &mut Vec<f32>) -> Result<()> + 'a;

/// Cells of all views together are at most so many: 64 bytes each.
const MOST_CELLS: usize = 1 << 22;
/// Views that are refined together: their nodes fill a device, and fit its buffers.
const VIEWS: usize = 16;
/// Halvings of a texel's sides.
const DEPTH: u32 = 40;
/// Of the spread s to the fourth, what a rule of 2 × 2 is off where L is constant. Peaks of lobes that are seen at grazing
/// angles are no exponentials, and what all their cells are off has one sign: with 1/100 GGX of α = 0.01 seen at 90° under a
/// sky is off by 3.5 times each tolerance from 1e-2 to 1e-4, with this by at most a third.
const SMOOTH: f64 = 1.0 / 10.0;
/// Of s², what linear interpolation is off where L varies.
const VARIED: f64 = 1.0 / 16.0;

/// ∫ f L cos θi dωi of each view; `width` is about that of the lobe of f around the mirror direction, rad.
pub(super) fn integrate(
    f: &mut Integrand,
    width: f64,
    light: &Light,
    views: &[View],
    tolerance: f64,
    observer: &dyn Observer,
) -> Result<Vec<Integrated>> {
    if let Light::Directional(sun) = light {
        return directional(f, sun.direction(), sun.irradiance(), views);
    }
    let domain = Domain::new(light);
    let cells = domain.cells();
    let mut all = Vec::with_capacity(views.len());
    for group in views.chunks(VIEWS) {
        let views: Vec<_> = group.iter().map(|view| Local::new(view, &domain, width)).collect();
        all.extend(refine(f, &domain, &cells, &views, tolerance)?.into_iter().map(not_negative));
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
    let local_angles = |view: &View| {
        let local = view.frame.to_local(direction);
        let (theta_i, phi_i) = angles(local);
        let theta_i = theta_i.min(FRAC_PI_2);
        (Angles { theta_i, phi_i, theta_e: view.theta_e, phi_e: view.phi_e }, local[2].max(0.0))
    };
    let (angles, cosines): (Vec<_>, Vec<_>) = views.iter().map(local_angles).unzip();
    let mut values = Vec::new();
    f(&angles, &mut values)?;
    let value = |(f, cos): (&[f32; 3], f64)| {
        let value = std::array::from_fn(|c| f64::from(f[c]) * irradiance[c] * cos);
        Integrated { value, error: 0.0 }
    };
    Ok(values.as_chunks::<3>().0.iter().zip(cosines).map(value).collect())
}

/// Takes a channel below 0, which f L cos θi never is, as 0. Blocks of texels are interpolated beyond their nodes, and so a
/// channel that sends next to nothing may be. What is taken is an error that was made.
fn not_negative(one: Integrated) -> Integrated {
    let taken = one.value.iter().map(|x| (-x).max(0.0)).sum::<f64>() / 3.0;
    Integrated { value: one.value.map(|x| x.max(0.0)), error: one.error.max(taken) }
}

/// A cell of a view with what it sends and what that may be off.
struct Leaf {
    view: usize,
    cell: DomainCell,
    value: [f64; 3],
    error: f64,
    /// Whether errors of its kind have no common sign.
    varied: bool,
}

fn refine(
    f: &mut Integrand,
    domain: &Domain,
    begin: &[DomainCell],
    views: &[Local],
    tolerance: f64,
) -> Result<Vec<Integrated>> {
    let mut pending: Vec<(usize, DomainCell)> =
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
    let limited = |&(value, [smooth, varied], [n, m]): &([f64; 3], [f64; 2], [usize; 2])| {
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
    totals.iter().map(limited).unzip()
}

/// Appends the leaves of some cells.
fn evaluate(
    f: &mut Integrand,
    domain: &Domain,
    views: &[Local],
    cells: &[(usize, DomainCell)],
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
        if nodes.side == HorizonSide::Below {
            continue;
        }
        leaves.push(leaf(view, cell, nodes, own));
    }
    Ok(())
}

fn leaf(view: usize, cell: DomainCell, nodes: &CellNodes, values: &[[f32; 3]]) -> Leaf {
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
    // Of a corner that is above between meridians that are not; none is there if it is below as well.
    let corner = values.last().zip(nodes.cosines.last()).filter(|_| nodes.unseen > 0.0);
    let corner = corner.map_or(0.0, |(f, cos)| cos * f.iter().map(|&f| f64::from(f)).sum::<f64>() / 3.0);
    let unseen = nodes.unseen * corner;
    let largest = light * high;
    let spread = if high > 0.0 { ((high - low) / high).clamp(0.0, 1.0) } else { 0.0 };
    let error = match (cell.is_flat(), nodes.side == HorizonSide::Crossed) {
        _ if nodes.hides => f64::INFINITY,
        // Down to texels, which are cut.
        (false, true) => f64::INFINITY,
        (false, false) => VARIED * spread * spread * largest,
        (true, true) => CUT * (sum - coarse).abs() + UNSEEN * unseen,
        (true, false) => SMOOTH * spread.powi(4) * largest,
    };
    let varied = !cell.is_flat();
    // What no light comes from needs no parts; of a block whose nodes are all below, that is not known.
    let unknown = !cell.is_flat() && nodes.side == HorizonSide::Crossed;
    let error = if light > 0.0 || unseen > 0.0 || unknown { error } else { 0.0 };
    Leaf { view, cell, value, error, varied }
}

/// Of what the rule of two outer nodes is off by, what that of three is. Of integrands that fall to 0 at the horizon
/// within c rad, as μ/(μ + c) does and lobes that are seen at grazing angles do, it was 0.35 at most: GGX under a white
/// map of 256 × 128, tilted by 60° and seen at 90°, 86° and 69°, against its ρ_dh.
const CUT: f64 = 0.4;
/// Of L Δω f cos θi at a corner that alone is above, what the cell sends: a third of the corner's height is the mean over
/// its triangle, which is less than half of the cell, and in the mean less than that.
const UNSEEN: f64 = 0.1;
