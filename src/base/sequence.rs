//! Low-discrepancy steps through an index range.

/// The step of a golden-section walk through 0 … n − 1. It has no common factor with n, so the walk visits every index
/// before it repeats one.
pub(crate) fn stride(n: usize) -> usize {
    let golden = (n as f64 * 0.618_033_988_749_894_9) as usize;
    (golden.max(1)..).find(|&step| gcd(step, n) == 1).unwrap_or(1)
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}
