// A pair of directions with all that a lobe takes of it.

struct Point {
    hz2: real,    // the factors of a Pair
    dt2: real,
    ss: real,
    sd: real,
    mu_i: real,
    mu_e: real,
    sin2: real,   // and of an Azimuth
    cos2: real,
    back: real,
    weight: real, // of f here, in an integral
    st: real,     // what tells azimuths from each other
    dt: real,
    cp: real,
    cm: real,
    sp: real,
    sm: real,
}

fn pair_of(p: Point) -> Pair {
    return Pair(p.hz2, p.dt2, p.ss, p.sd, p.mu_i, p.mu_e, 0.0, 0.0, p.st, p.dt);
}

fn azimuth_of(p: Point) -> Azimuth {
    return Azimuth(p.sin2, p.cos2, p.back, 0.0, 0.0, p.cp, p.cm, p.sp, p.sm);
}
