// A thin film on a base, as KHR_materials_iridescence has it: Belcour & Barla 2017, with Schlick's reflectances at both
// interfaces, for one channel of linear sRGB. With R12 above the film, R23 below it, T = 1 − R12 and r = √(R12 R23),
//     I = R12 + Rs + 2 (Rs − T) Σ_m (−s r)ᵐ S(m),  m = 1, 2,  Rs = T² R23/(1 − R12 R23),  s = sign of the step below
//     S(m) = Σ_k w_k cos(2π m p_k o) exp(−a_k (m o)²),  o = 2 η d cosθ₂, the optical path in the film
//     F = (I + √(I² + ε²))/2, for max(I, 0), of which f32 keeps no digits where I = 0
// Without a difference that loses digits, by 1 − R12 R23 = T + R12 (1 − R23) and Rs − T = −T (1 − R23 T/(T + …)).

/// (F, 0) for c = ωi·ωm and x = 1 − c.
fn fresnel(c: real, x: real) -> real2 {
    return real2(film(c, x), 0.0);
}

/// For integrals: F …
fn fresnel_whole(c: real4) -> real4 {
    let x = 1.0 - c;
    return real4(film(c.x, x.x), film(c.y, x.y), film(c.z, x.z), film(c.w, x.w));
}

/// … and what of it is not A: nothing.
fn fresnel_complement(c: real4) -> real4 {
    return real4();
}

fn film(c: real, x: real) -> real {
    let e = parameter(5u); // η² − 1, in place of η, of which f32 would lose η − 1
    let step = parameter(6u); // (η₃ − η)/(η₃ + η), in place of f0
    let n2 = 1.0 + e;
    let above = e / ((1.0 + sqrt(n2)) * (1.0 + sqrt(n2))); // (η − 1)/(η + 1)
    let c2 = sqrt((e + c * c) / n2);
    let x2 = x * (1.0 + c) / (n2 * (1.0 + c2)); // 1 − c2
    let t12 = (1.0 - above * above) * transmitted(c, x);
    let t23 = (1.0 - step) * (1.0 + step) * transmitted(c2, x2);
    let r12 = above * above + (1.0 - above * above) * fifth_power(x);
    let r23 = step * step + (1.0 - step) * (1.0 + step) * fifth_power(x2);
    // Rs = T R23 share; 0/0 where both interfaces reflect all.
    let share = r23 * t12 / max(t12 + r12 * t23, NOTHING);
    let r = sqrt(r12 * r23);
    // The four Gaussians of the eye's response side by side; cos 2x and e⁻⁴ˣ from cos x and e⁻ˣ.
    let o = parameter(4u) * c2; // 2 η d in µm, in place of d
    let cosine = cos_turns(o * PEAK);
    let decay = exp_neg(o * o * WIDTH);
    let decay2 = decay * decay;
    let w = sensitivity();
    let s1 = dot(w, cosine * decay);
    let s2 = dot(w, (2.0 * cosine * cosine - 1.0) * (decay2 * decay2));
    let swing = 2.0 * t12 * (1.0 - share) * r * (select(s1, -s1, step < 0.0) - r * s2);
    return positive(r12 + t12 * share + swing);
}

/// 1 − x⁵ for c = 1 − x.
fn transmitted(c: real, x: real) -> real {
    let x2 = x * x;
    return c * (1.0 + x + x2 * (1.0 + x + x2));
}

fn fifth_power(x: real) -> real {
    let x2 = x * x;
    return x2 * x2 * x;
}

/// (I + √(I² + ε²))/2.
fn positive(i: real) -> real {
    let sum = abs(i) + sqrt(i * i + FLOOR * FLOOR);
    return 0.5 * select(sum, FLOOR * FLOOR / sum, i < 0.0);
}

/// What the channel weighs the four Gaussians with; between two channels, their mix.
fn sensitivity() -> real4 {
    let channel = parameter(7u);
    let r = max(1.0 - channel, 0.0);
    let b = max(channel - 1.0, 0.0);
    return r * RED + (1.0 - r - b) * GREEN + b * BLUE;
}

// The eye's response to wave numbers: x̄ as two Gaussians, ȳ and z̄ as one each. Turns of the phase in 1 µm of path,
// (2π)² of their variance in µm⁻², and their weights in linear sRGB.
const PEAK = real4(1.681, 1.7953, 2.2084, 2.2399);
const WIDTH = real4(0.17085469570813808, 0.3673308844415041, 0.2610352450417717, 0.1787661705960513);
const RED = real4(2.743336128642896, -1.5374795811707604, -0.4990909943782536, 0.49860320008640424);
const GREEN = real4(-0.8205709051728567, 1.8764270747599021, 0.0416026460166455, -0.14913931798046975);
const BLUE = real4(0.047107146134183334, -0.2040711720381654, 1.0584119201914826, 0.008561755726616296);
const FLOOR: real = 0.00390625;
/// Far below any T but that of grazing, where 0/0 is 0; its square is a normal number.
const NOTHING: real = 1e-18;
