//! Low-discrepancy steps through an index range.

/// A step of the golden section through 0 … n − 1: without a common factor, so that it visits all before it repeats one.
pub(crate) fn stride(n: usize) -> usize {
    let golden = (n as f64 * 0.618_033_988_749_894_9) as usize;
    (golden.max(1)..).find(|&step| gcd(step, n) == 1).unwrap_or(1)
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}
