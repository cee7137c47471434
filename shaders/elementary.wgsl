// Elementary functions by arithmetic alone, right to the last bits in f32 and f64 alike: the built-ins lose
// digits in f32 on some drivers, and there are none in f64.

/// e⁻ˣ for x ≥ 0; 0 from x = 87 on, where f32 ends. With n = round(x / ln 2), e⁻ˣ = 2⁻ⁿ e^(n ln 2 − x), the latter
/// by its Taylor series for at most ln 2 / 2; n ln 2 in two parts, so that the difference keeps its digits.
fn exp_neg(x: real4) -> real4 {
    let n = round(min(x, real4(87.0)) * 1.4426950408889634);
    let r = (n * 0.693359375 - x) - n * 2.121944400546905828e-4;
    var p = real4(1.6059043836821613e-10); // 1/13!
    p = fma(p, r, real4(2.08767569878681e-9));
    p = fma(p, r, real4(2.505210838544172e-8));
    p = fma(p, r, real4(2.7557319223985893e-7));
    p = fma(p, r, real4(2.7557319223985893e-6));
    p = fma(p, r, real4(2.48015873015873e-5));
    p = fma(p, r, real4(1.984126984126984e-4));
    p = fma(p, r, real4(1.388888888888889e-3));
    p = fma(p, r, real4(8.333333333333333e-3));
    p = fma(p, r, real4(4.1666666666666664e-2));
    p = fma(p, r, real4(0.16666666666666666));
    p = fma(p, r, real4(0.5));
    p = fma(p, r, real4(1.0));
    p = fma(p, r, real4(1.0));
    return select(p * half_power(vec4u(n)), real4(), x > real4(87.0));
}

/// 2⁻ⁿ for n < 128, by the bits of n.
fn half_power(n: vec4u) -> real4 {
    let one = real4(1.0);
    var p = select(one, real4(0.5), (n & vec4u(1u)) != vec4u());
    p *= select(one, real4(0.25), (n & vec4u(2u)) != vec4u());
    p *= select(one, real4(0.0625), (n & vec4u(4u)) != vec4u());
    p *= select(one, real4(3.90625e-3), (n & vec4u(8u)) != vec4u());
    p *= select(one, real4(1.52587890625e-5), (n & vec4u(16u)) != vec4u());
    p *= select(one, real4(2.3283064365386963e-10), (n & vec4u(32u)) != vec4u());
    return p * select(one, real4(5.421010862427522e-20), (n & vec4u(64u)) != vec4u());
}

/// e^(a²) erfc a for a = x/y, x ≥ 0, y ≥ 0, not both 0: a polynomial in (3 − a)/(3 + a), by interpolation at 23
/// Chebyshev points; off by 5e-17.
fn erfcx(x: real4, y: real4) -> real4 {
    let z = (3.0 * y - x) / (3.0 * y + x);
    var p = real4(6.64600336868902482e-10);
    p = fma(p, z, real4(8.07188332772663987e-11));
    p = fma(p, z, real4(-7.13672163644283761e-9));
    p = fma(p, z, real4(1.73792450195424319e-9));
    p = fma(p, z, real4(4.44260054612182701e-8));
    p = fma(p, z, real4(-3.24188601841105752e-8));
    p = fma(p, z, real4(-2.32463352012317046e-7));
    p = fma(p, z, real4(2.97322501085048395e-7));
    p = fma(p, z, real4(1.25123255576462661e-6));
    p = fma(p, z, real4(-2.12189112403884135e-6));
    p = fma(p, z, real4(-7.97765502995170468e-6));
    p = fma(p, z, real4(1.28611845396775844e-5));
    p = fma(p, z, real4(6.40564402886566145e-5));
    p = fma(p, z, real4(-4.52554611347997453e-5));
    p = fma(p, z, real4(-5.97061931538900391e-4));
    p = fma(p, z, real4(-7.07746415182294912e-4));
    p = fma(p, z, real4(4.26913633144050011e-3));
    p = fma(p, z, real4(2.43924993167297744e-2));
    p = fma(p, z, real4(7.16658371980315794e-2));
    p = fma(p, z, real4(0.150115936500851078));
    p = fma(p, z, real4(0.245603801712330275));
    p = fma(p, z, real4(0.326233560043036393));
    return fma(p, z, real4(0.17900115118138995));
}

/// ln(1 + b/a) for a ≥ 0, b ≥ 0, not both 0; past 88, where f32 ends, it is no more than that. With (1 + b/a) = 2ⁿ m and
/// m within √2 of 1, it is n ln 2 + 2 artanh s, s = (m − 1)/(m + 1) = b/(2a + b) where n = 0: no digit is lost where
/// b ≪ a. |s| ≤ 0.172, so that the series' first term left out is 2 s²³/23 < 1e-18 s. In units of f32's 2⁻²⁴ of the
/// result: at n = 0 the sum and the quotient round three times, the series and its product three; else m − a has lost
/// 2⁻²⁴ of m twice, where the result is at least 0.34: six and another two for n ln 2, which is 0.69 and more.
fn log1p_quotient(b: real4, a: real4) -> real4 {
    var m = a + b;
    var n = real4();
    halve(&m, &n, a * 13043817825332783104.0, 5.421010862427522e-20, 64.0);
    halve(&m, &n, a * 3037000499.97605, 2.3283064365386963e-10, 32.0);
    halve(&m, &n, a * 46340.95001184158, 1.52587890625e-5, 16.0);
    halve(&m, &n, a * 181.01933598375618, 3.90625e-3, 8.0);
    halve(&m, &n, a * 11.313708498984761, 0.0625, 4.0);
    halve(&m, &n, a * 2.8284271247461903, 0.25, 2.0);
    halve(&m, &n, a * 1.4142135623730951, 0.5, 1.0);
    let is_small = n == real4();
    let s = select(m - a, b, is_small) / (m + a);
    let s2 = s * s;
    var p = real4(9.523809523809523e-2); // 2/21
    p = fma(p, s2, real4(0.10526315789473684));
    p = fma(p, s2, real4(0.11764705882352941));
    p = fma(p, s2, real4(0.13333333333333333));
    p = fma(p, s2, real4(0.15384615384615385));
    p = fma(p, s2, real4(0.18181818181818182));
    p = fma(p, s2, real4(0.2222222222222222));
    p = fma(p, s2, real4(0.2857142857142857));
    p = fma(p, s2, real4(0.4));
    p = fma(p, s2, real4(0.6666666666666666));
    p = fma(p, s2, real4(2.0));
    return fma(n, real4(0.6931471805599453), p * s);
}

/// Takes 2ᵏ from m where it is above the limit a 2^(k − 1/2).
fn halve(m: ptr<function, real4>, n: ptr<function, real4>, limit: real4, power: real, k: real) {
    let is_more = *m > limit;
    *m *= select(real4(1.0), real4(power), is_more);
    *n += select(real4(), real4(k), is_more);
}

/// (1 − e⁻ˣ)/x for x ≥ 0: its mean over [0, x]. By the series below x = 1/2, whose first term left out is below 4e-18;
/// above, the difference is at least 0.39: two roundings of the result.
fn mean_exp_neg(x: real) -> real {
    let z = -x;
    var p = real(7.647163731819816e-13); // 1/15!
    p = fma(p, z, real(1.1470745597729725e-11));
    p = fma(p, z, real(1.6059043836821613e-10));
    p = fma(p, z, real(2.08767569878681e-9));
    p = fma(p, z, real(2.505210838544172e-8));
    p = fma(p, z, real(2.7557319223985893e-7));
    p = fma(p, z, real(2.7557319223985893e-6));
    p = fma(p, z, real(2.48015873015873e-5));
    p = fma(p, z, real(1.984126984126984e-4));
    p = fma(p, z, real(1.388888888888889e-3));
    p = fma(p, z, real(8.333333333333333e-3));
    p = fma(p, z, real(4.1666666666666664e-2));
    p = fma(p, z, real(0.16666666666666666));
    p = fma(p, z, real(0.5));
    p = fma(p, z, real(1.0));
    return select((1.0 - exp_neg(real4(x)).x) / max(x, 0.5), p, x < 0.5);
}
