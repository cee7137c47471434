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

/// cos 2πx, x in turns, of which whole ones are taken off exactly: 1 − 2 sin²(πt), the sine by its Taylor series for at
/// most π/2, whose rest is 1e-18.
fn cos_turns(x: real4) -> real4 {
    let t = x - round(x);
    let y = t * t;
    var p = real4(5.392664662608125e-10); // π²¹/21!
    p = fma(p, y, real4(-2.2948428997269856e-8));
    p = fma(p, y, real4(7.952054001475508e-7));
    p = fma(p, y, real4(-2.1915353447830204e-5));
    p = fma(p, y, real4(4.6630280576761234e-4));
    p = fma(p, y, real4(-7.370430945714348e-3));
    p = fma(p, y, real4(8.214588661112819e-2));
    p = fma(p, y, real4(-0.5992645293207919));
    p = fma(p, y, real4(2.550164039877345));
    p = fma(p, y, real4(-5.167712780049969));
    p = fma(p, y, real4(3.141592653589793));
    let sine = p * t;
    return 1.0 - 2.0 * sine * sine;
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
