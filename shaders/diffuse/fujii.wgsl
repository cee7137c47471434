// Fujii's form of Oren–Nayar: f = A (1 + σ s/t)/π, A = 1/(1 + k σ), k = 1/2 − 2/(3π). alpha is o = σ/(1 − σ),
// so that f = ((1 − σ) + σ (1 + s/t)) A/π = (1 + o (1 + s/t))/(1 + (1 + k) o)/π has no difference.

const ONE_PLUS_K: real = 1.2877934092108063;

fn lobe(p: Pair, a: Azimuth, alpha: real, row: real) -> real2 {
    return real2(row * (1.0 + alpha * one_plus_s_over_t(p, a)), 0.0);
}

fn lobe_row(p: Pair, alpha: real) -> real {
    return INV_PI / (1.0 + ONE_PLUS_K * alpha);
}
