//! The directions of a cell that f is evaluated at, and their weights.
//!
//! A cell has Gauss–Legendre's 2 × 2 nodes, and a fifth in its middle, which counts nothing and shows what the four cannot. Of
//! a block of texels, the nodes' weights are what each texel's L Δω takes as a share of the four by linear interpolation, so
//! that no texel is missed, however small and bright; of a texel, where L is constant, they are the rule's, and they
//! sum to the exact solid angle. A texel that the horizon crosses has 3 × 3 nodes, on three meridians, each where it is
//! above the surface: f cos θi of a lobe that is seen at grazing angles is not 0 there.

use crate::base::angles::Angles;
use crate::light::exitant::View;
use crate::light::exitant::domain::{Domain, DomainCell};
use crate::light::irradiance::range;
use crate::light::{angles, direction, dot};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Gauss–Legendre's two nodes are ± this.
pub(super) const NODE: f64 = 0.577_350_269_189_625_8;

/// A view with what cells ask of it.
pub(super) struct Local {
    view: View,
    /// In the domain's frame.
    normal: [f64; 3],
    mirror: [f64; 3],
    width: f64,
}

impl Local {
    pub fn new(view: &View, domain: &Domain, width: f64) -> Self {
        let [normal, mirror] = [view.frame.normal(), view.mirror()].map(|v| domain.to_domain(v));
        Self { view: *view, normal, mirror, width }
    }

    /// What of a cell is above the surface.
    fn side(&self, cell: &DomainCell) -> HorizonSide {
        let [low, _] = range(&corners(cell).map(|at| self.height(at)));
        if low >= 0.0 {
            return HorizonSide::Above;
        }
        // Corners may all be below where the middle of a side is not.
        if self.height(cell.middle()) < -cell.size() { HorizonSide::Below } else { HorizonSide::Crossed }
    }

    /// The corner that is the farthest above the surface, or the least below.
    fn highest_corner(&self, cell: &DomainCell) -> (f64, f64) {
        let higher = |a, b| if self.height(b) >= self.height(a) { b } else { a };
        let [first, rest @ ..] = corners(cell);
        rest.into_iter().fold(first, higher)
    }

    /// n·ω at (θ, ψ).
    fn height(&self, (theta, psi): (f64, f64)) -> f64 {
        dot(direction(theta, psi), self.normal)
    }

    /// What of a cell's meridian is above the surface, from θ to θ: n·ω = A cos θ + B sin θ > 0 within a quarter turn of its
    /// peak, which for θ ∈ [0, π] is one stretch. The first is the larger where nothing is.
    fn above(&self, cell: &DomainCell, psi: f64) -> [f64; 2] {
        let across = self.normal[0] * psi.cos() + self.normal[1] * psi.sin();
        let peak = across.atan2(self.normal[2]);
        let peak = if peak < -FRAC_PI_2 { peak + TAU } else { peak };
        [cell.theta[0].max(peak - FRAC_PI_2), cell.theta[1].min(peak + FRAC_PI_2)]
    }

    /// Whether the lobe's peak may lie between the nodes of a cell.
    fn hides_the_peak(&self, cell: &DomainCell) -> bool {
        let size = cell.size();
        let (t, p) = cell.middle();
        let middle = direction(t, p);
        let away = (0..3).map(|k| (middle[k] - self.mirror[k]).powi(2)).sum::<f64>().sqrt();
        size > 0.5 * self.width && away < size
    }
}

/// (θ, ψ) of a cell's corners.
fn corners(cell: &DomainCell) -> [(f64, f64); 4] {
    std::array::from_fn(|k| (cell.theta[k / 2], cell.psi[k % 2]))
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum HorizonSide {
    Above,
    Below,
    Crossed,
}

/// Nodes of a cell: angles, and for each the weight L Δω cos θi in R, G and B.
pub(super) struct CellNodes {
    pub angles: Vec<Angles>,
    pub weights: Vec<[f64; 3]>,
    pub cosines: Vec<f64>,
    /// L Δω, the mean of the channels, of a cell where a corner is above the surface and one of the meridians is not: what
    /// lies between them is not seen. The last node is then that corner, which counts nothing.
    pub unseen: f64,
    /// What a coarser rule, of the outer nodes alone, weighs each with in place of 1.
    pub outer: Vec<f64>,
    pub side: HorizonSide,
    /// Whether a lobe's peak may lie between them.
    pub hides: bool,
}

/// Gauss–Legendre's three nodes on [−1, 1], with weights that sum to 1, and what the rule of the two outer ones, exact
/// to degree 1, has in place of each weight, as a multiple of it.
const THREE: [(f64, f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 18.0, 1.8),
    (0.0, 4.0 / 9.0, 0.0),
    (0.774_596_669_241_483_4, 5.0 / 18.0, 1.8),
];

pub(super) fn nodes(domain: &Domain, local: &Local, cell: &DomainCell) -> CellNodes {
    let side = local.side(cell);
    let mut nodes = CellNodes {
        angles: Vec::new(),
        weights: Vec::new(),
        cosines: Vec::new(),
        unseen: 0.0,
        outer: Vec::new(),
        side,
        hides: false,
    };
    if side == HorizonSide::Below {
        return nodes;
    }
    nodes.hides = local.hides_the_peak(cell);
    let (t, p) = cell.middle();
    let half = cell.half();
    // (cos θ₀ − cos θ₁) Δψ
    let solid = 2.0 * t.sin() * half[0].sin() * 2.0 * half[1];
    let frame = &local.view.frame;
    let mut take = |theta: f64, psi: f64, weight: [f64; 3], outer: f64| {
        let incident = frame.to_local(domain.to_world(direction(theta, psi)));
        if incident[2] > 0.0 {
            let (theta_i, phi_i) = angles(incident);
            let view = &local.view;
            let theta_i = theta_i.min(FRAC_PI_2);
            nodes.angles.push(Angles { theta_i, phi_i, theta_e: view.theta_e, phi_e: view.phi_e });
            nodes.weights.push(weight);
            nodes.cosines.push(incident[2]);
            nodes.outer.push(outer);
        }
    };
    if cell.is_flat() && side == HorizonSide::Crossed {
        let mut is_seen = true;
        for (x, wx, outer_x) in THREE {
            let psi = p + half[1] * x;
            let [low, high] = local.above(cell, psi);
            is_seen &= low < high;
            for (y, wy, outer_y) in THREE {
                let theta = 0.5 * (low + high) + 0.5 * (high - low) * y;
                let weight = wx * wy * 2.0 * half[1] * (high - low) * theta.sin();
                if weight > 0.0 {
                    let light = domain.radiance(cell, theta.cos());
                    take(theta, psi, light.map(|l| l * weight), outer_x * outer_y);
                }
            }
        }
        if !is_seen {
            let (theta, psi) = local.highest_corner(cell);
            take(theta, psi, [0.0; 3], 1.0);
            nodes.unseen = solid * domain.radiance(cell, t.cos()).iter().sum::<f64>() / 3.0;
        }
        return nodes;
    }
    let at = |k: usize| [NODE, -NODE][usize::from(k == 0)];
    let place = |k: usize| (t + at(k / 2) * half[0], p + at(k % 2) * half[1]);
    if cell.is_flat() {
        // Shared out as sin θ is.
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
