//! The Pareto front.

/// Which points nobody beats: for (seconds, error, takes part), those than which none is at least as fast
/// and at least as exact, and better in one of the two. Who does not take part is never on it.
pub fn front(points: &[(f64, f64, bool)]) -> Vec<bool> {
    let beats = |a: &(f64, f64, bool), b: &(f64, f64, bool)| {
        a.2 && a.0 <= b.0 && a.1 <= b.1 && (a.0 < b.0 || a.1 < b.1)
    };
    points.iter().map(|point| point.2 && !points.iter().any(|other| beats(other, point))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_what_nobody_beats() {
        let points = [
            (1.0, 1e-1, true),
            (2.0, 1e-3, true),
            (3.0, 1e-2, true), // slower and worse than the one before
            (2.0, 1e-2, true), // as fast, but worse
            (4.0, 1e-3, true), // as exact, but slower
            (9.0, 1e-6, true),
            (0.5, 1e-9, false), // extrapolated: neither on the front nor in anybody's way
        ];
        assert_eq!(front(&points), [true, true, false, false, false, true, false]);
    }

    #[test]
    fn equals_stand_together_and_nan_is_not_there() {
        assert_eq!(front(&[(1.0, 1.0, true), (1.0, 1.0, true)]), [true, true]);
        assert_eq!(front(&[(1.0, 1.0, true), (2.0, f64::INFINITY, true)]), [true, false]);
        assert!(front(&[]).is_empty());
    }

    /// A front by error alone would pass a check that only asks for the most exact point.
    #[test]
    fn a_wrong_front_is_seen() {
        let points = [(1.0, 1e-1, true), (2.0, 1e-3, true)];
        let by_error_alone: Vec<_> = points.iter().map(|p| p.1 <= 1e-3).collect();
        assert_ne!(front(&points), by_error_alone);
    }
}
