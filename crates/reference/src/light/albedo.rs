//! ρ_dh between directions at which it was integrated.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// ρ_dh(θi), R, G, B, as polynomials through Chebyshev's points of intervals that are halved until between the points
/// they are what is integrated there.
pub struct Albedo {
    pieces: Vec<Piece>,
}

struct Piece {
    theta: [f64; 2],
    /// The points, in [−1, 1].
    points: [f64; POINTS],
    values: [[f64; 3]; POINTS],
}

/// Chebyshev's points of an interval, both ends included.
const POINTS: usize = 12;
/// What ρ cos θ sin θ Δθ of an interval may be off: of M = ∫ ρ_dh L cos θi dωi it is less than that share.
const ACCURATE: f64 = 1e-9;
/// No interval is narrower, rad: beyond, ρ has no digits left either.
const NARROW: f64 = 1e-9;

impl Albedo {
    /// Of what integrates it at θi.
    pub fn new(rho: &(dyn Fn(f64) -> [f64; 3] + Sync)) -> Self {
        let mut pending = vec![[0.0, FRAC_PI_2]];
        let mut pieces = Vec::new();
        let points: [f64; POINTS] = std::array::from_fn(|k| -(PI * k as f64 / (POINTS - 1) as f64).cos());
        while let Some([a, b]) = pending.pop() {
            let theta = |x: f64| 0.5 * (a + b) + 0.5 * (b - a) * x;
            let values = in_parallel(|k| rho(theta(points[k])));
            let piece = Piece { theta: [a, b], points, values };
            let between = |k: usize| {
                let theta = theta((PI * (k as f64 + 0.5) / (POINTS - 1) as f64).cos());
                let (found, truth) = (piece.at(theta), rho(theta));
                (0..3).map(|c| (found[c] - truth[c]).abs()).fold(0.0, f64::max)
            };
            let off = in_parallel(|k| if k + 1 < POINTS { between(k) } else { 0.0 })
                .into_iter()
                .fold(0.0, f64::max);
            // sin θ cos θ, at most, over the interval.
            let weight = a.cos() * b.sin() * (b - a);
            if off * weight <= ACCURATE || b - a <= NARROW {
                pieces.push(piece);
            } else {
                let middle = 0.5 * (a + b);
                // The lower half comes first.
                pending.extend([[middle, b], [a, middle]]);
            }
        }
        Self { pieces }
    }

    /// ρ_dh at θi ∈ [0, π/2].
    pub fn at(&self, theta: f64) -> [f64; 3] {
        let k = self.pieces.partition_point(|piece| piece.theta[1] < theta);
        self.pieces[k.min(self.pieces.len() - 1)].at(theta)
    }
}

/// f of each point's number, by as many threads as the machine runs at once.
fn in_parallel<T: Copy + Default + Send>(f: impl Fn(usize) -> T + Sync) -> [T; POINTS] {
    let next = AtomicUsize::new(0);
    let found = Mutex::new([T::default(); POINTS]);
    let work = || {
        loop {
            let k = next.fetch_add(1, Ordering::Relaxed);
            if k >= POINTS {
                return;
            }
            let value = f(k);
            if let Ok(mut found) = found.lock() {
                found[k] = value;
            }
        }
    };
    let threads = thread::available_parallelism().map_or(1, usize::from).min(POINTS);
    thread::scope(|scope| {
        // Where the system gives no more threads, fewer do the work: this one at least.
        (1..threads).for_each(|_| drop(thread::Builder::new().spawn_scoped(scope, work)));
        work();
    });
    found.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner())
}

impl Piece {
    /// The barycentric formula of Chebyshev's points of the second kind: Berrut & Trefethen 2004, eq. 5.4, weights (−1)ᵏ,
    /// halved at both ends.
    fn at(&self, theta: f64) -> [f64; 3] {
        let [a, b] = self.theta;
        let x = (2.0 * theta - a - b) / (b - a);
        let (mut above, mut below) = ([0.0; 3], 0.0);
        for (k, (point, value)) in self.points.into_iter().zip(&self.values).enumerate() {
            if x == point {
                return *value;
            }
            let end = if k == 0 || k == POINTS - 1 { 0.5 } else { 1.0 };
            let weight = if k % 2 == 0 { end } else { -end } / (x - point);
            (0..3).for_each(|c| above[c] += weight * value[c]);
            below += weight;
        }
        above.map(|sum| sum / below)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As narrow as a lobe's at grazing, it is what it is between the points too.
    #[test]
    fn what_changes_at_grazing_is_followed_there() {
        let rho = |theta: f64| {
            let mu = theta.cos();
            [mu / (mu + 1e-3), 1.0, theta]
        };
        let albedo = Albedo::new(&rho);
        for k in 0..10_000 {
            let theta = FRAC_PI_2 * f64::from(k) / 9_999.0;
            for (found, truth) in albedo.at(theta).into_iter().zip(rho(theta)) {
                assert!((found - truth).abs() * theta.cos() < 1e-8, "{theta}: {found}, {truth}");
            }
        }
    }
}
