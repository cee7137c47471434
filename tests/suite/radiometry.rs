//! Radiometry: closed forms against other closed forms, against sums, and what a beam keeps along its way.

use gonio::base::quadrature::gauss_legendre;
use gonio::base::radiometry::{
    Beam, DirectionCell, HEMISPHERE, LIGHT_SPEED, PLANCK, Rectangle, SPHERE, apparent, cone, photon_energy,
    photons, polygon, projected_cone, projected_polygon, triangle,
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Gauss–Legendre of 40 nodes in θ and φ of the definition: exact to rounding for a cell below π wide.
fn sum(cell: &DirectionCell, f: impl Fn([f64; 3]) -> f64) -> f64 {
    let rule = gauss_legendre(40);
    let at = |[a, b]: [f64; 2], x: f64| a + (b - a) * x;
    let size = (cell.theta[1] - cell.theta[0]) * (cell.phi[1] - cell.phi[0]);
    let terms = rule.iter().flat_map(|t| rule.iter().map(move |p| (t, p)));
    let term = |(t, p): (&gonio::base::quadrature::Node, &gonio::base::quadrature::Node)| {
        let ((st, ct), (sp, cp)) = (at(cell.theta, t.x).sin_cos(), at(cell.phi, p.x).sin_cos());
        t.weight * p.weight * st * f([st * cp, st * sp, ct])
    };
    size * terms.map(term).sum::<f64>()
}

fn close(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * b.abs(), "{a} is not {b}");
}

#[test]
fn a_cell_is_what_its_definition_sums_to() {
    for theta in [[0.0, 0.3], [0.3, 0.4], [1.2, 1.5], [2.0, PI], [0.0, PI]] {
        for phi in [[0.0, 1.0], [-0.3, 0.1], [2.0, 5.0]] {
            let cell = DirectionCell { theta, phi };
            close(cell.solid_angle(), sum(&cell, |_| 1.0), 1e-13);
            let vector: [f64; 3] = std::array::from_fn(|k| sum(&cell, |w| w[k]));
            let length = cell.solid_angle();
            for (got, truth) in cell.vector().into_iter().zip(vector) {
                assert!((got - truth).abs() < 1e-13 * length, "{cell:?}: {got}, {truth}");
            }
            assert_eq!(cell.vector()[2], cell.projected());
        }
    }
}

/// cos θ₀ − cos θ₁ of these is wrong in the first digit; the cell has 15. Near the pole Ω → ½ (θ₁² − θ₀²) Δφ.
#[test]
fn a_tiny_cell_keeps_its_digits() {
    for (a, b) in [(1e-9, 2e-9), (0.0, 1e-7), (1e-3, 1e-3 + 1e-12)] {
        let cell = DirectionCell { theta: [a, b], phi: [0.0, 1e-6] };
        let truth = 0.5 * (b - a) * (b + a) * 1e-6;
        // θ − sin θ is θ³/6; the middle of [a, b] is rounded once.
        close(cell.solid_angle(), truth, 1e-6);
        close(cell.projected(), truth, 2e-6);
        close(cell.vector()[0], (b.powi(3) - a.powi(3)) / 3.0 * 1e-6, if a == 1e-3 { 1e-3 } else { 1e-6 });
    }
}

#[test]
fn cells_tile_the_sphere_and_the_hemisphere() {
    let cells = |rows: usize, most: f64| -> Vec<DirectionCell> {
        let theta = move |k: usize| most * k as f64 / rows as f64;
        let phi = |j: usize| TAU * j as f64 / 7.0;
        (0..rows)
            .flat_map(|k| (0..7).map(move |j| (k, j)))
            .map(|(k, j)| DirectionCell { theta: [theta(k), theta(k + 1)], phi: [phi(j), phi(j + 1)] })
            .collect()
    };
    close(cells(13, PI).iter().map(DirectionCell::solid_angle).sum(), SPHERE, 1e-14);
    close(cells(13, FRAC_PI_2).iter().map(DirectionCell::solid_angle).sum(), HEMISPHERE, 1e-14);
    close(cells(13, FRAC_PI_2).iter().map(DirectionCell::projected).sum(), PI, 1e-14);
}

#[test]
fn a_cone_is_the_limit_of_a_cell_and_of_a_polygon() {
    close(cone(FRAC_PI_2), HEMISPHERE, 1e-15);
    close(cone(PI), SPHERE, 1e-15);
    close(projected_cone(FRAC_PI_2, 0.0), PI, 1e-15);
    close(cone(0.7), DirectionCell { theta: [0.0, 0.7], phi: [0.0, TAU] }.solid_angle(), 1e-15);
    // Sides of a regular polygon of n lie π²/(2 n²) of the radius inside at most.
    let n = 20_000;
    let tilt = 0.6f64;
    let rim: Vec<_> = (0..n)
        .map(|k| {
            // Clockwise as seen along the axis from outside is counter-clockwise from the origin.
            let (sin, cos) = (-TAU * k as f64 / f64::from(n)).sin_cos();
            let [x, y, z] = [0.3f64.sin() * cos, 0.3f64.sin() * sin, 0.3f64.cos()];
            [x * tilt.cos() + z * tilt.sin(), y, z * tilt.cos() - x * tilt.sin()]
        })
        .collect();
    close(polygon(&rim), cone(0.3), 1e-7);
    close(projected_polygon(&rim, [0.0, 0.0, 1.0]), projected_cone(0.3, tilt), 1e-7);
}

/// Girard 1629: the solid angle of a spherical triangle is its excess, the sum of its inner angles less π.
#[test]
fn a_triangle_has_its_excess() {
    let octant = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
    close(triangle(octant), FRAC_PI_2, 1e-15);
    let corners = [[0.9, 0.1, 0.3], [0.2, 0.8, 1.5], [-0.7, -0.4, 0.4]];
    let unit = corners.map(|c: [f64; 3]| {
        let length = c.iter().map(|x| x * x).sum::<f64>().sqrt();
        c.map(|x| x / length)
    });
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let angle = |a, b, c| {
        let (u, v) = (cross(a, b), cross(a, c));
        (dot(u, v) / (dot(u, u) * dot(v, v)).sqrt()).acos()
    };
    let [a, b, c] = unit;
    let excess = angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - PI;
    close(triangle(corners).abs(), excess, 1e-13);
    assert_eq!(triangle(corners), -triangle([corners[0], corners[2], corners[1]]));
}

/// On its axis a rectangle of 2a × 2b at distance d has Ω = 4 asin(ab / √((a² + d²)(b² + d²))) (Mathar 2015, eq. 27).
#[test]
fn a_rectangle_on_its_axis_is_in_closed_form() {
    for [a, b, d] in [[0.5, 0.5, 1.0], [2.0, 0.1, 0.3], [1e-3, 2e-3, 1.0], [10.0, 10.0, 0.1]] {
        let rectangle = Rectangle { centre: [0.0, 0.0, 2.0], half_sides: [[a, 0.0, 0.0], [0.0, b, 0.0]] };
        let from = [0.0, 0.0, 2.0 + d];
        let truth = 4.0 * (a * b / ((a * a + d * d) * (b * b + d * d)).sqrt()).asin();
        close(rectangle.solid_angle(from), truth, 1e-12);
        assert!(rectangle.solid_angle([0.0, 0.0, 2.0 - d]) < 0.0, "it faces the other way");
        close(rectangle.area(), 4.0 * a * b, 1e-15);
    }
}

/// Ω = cos θ_A ΔA / R² errs by s²/(4 R²) for a square of side s seen from above: the series of the closed form.
#[test]
fn apparent_area_errs_with_the_square_of_size_over_distance() {
    let square = Rectangle { centre: [0.0; 3], half_sides: [[0.5, 0.0, 0.0], [0.0, 0.5, 0.0]] };
    for r in [10.0, 30.0, 100.0] {
        let error = square.apparent_error([0.0, 0.0, r]);
        close(error, 0.25 / (r * r), 20.0 / (r * r));
        close(square.apparent([0.0, 0.0, r]), apparent(1.0, 1.0, r), 1e-15);
    }
    // Near by it is no approximation at all.
    assert!(square.apparent_error([0.0, 0.0, 0.25]) > 3.0);
    // From the side it sees the cosine.
    let [sin, cos] = [1.0f64.sin(), 1.0f64.cos()];
    close(square.apparent([50.0 * sin, 0.0, 50.0 * cos]), cos / 2500.0, 1e-14);
    assert!(square.apparent_error([50.0 * sin, 0.0, 50.0 * cos]).abs() < 1e-3);
}

#[test]
fn radiance_becomes_power_energy_and_photons() {
    let beam = Beam { radiance: 100.0, cos_theta: 0.5, area: 2e-4, solid_angle: 1e-3 };
    close(beam.power(), 1e-5, 1e-15);
    close(beam.energy(3.0), 3e-5, 1e-15);
    // 1 J at 555 nm is 2.79e18 photons of 3.58e-19 J.
    close(photons(1.0, 555e-9), 555e-9 / (PLANCK * LIGHT_SPEED), 1e-15);
    close(photons(1.0, 555e-9), 2.794e18, 1e-3);
    close(photons(beam.energy(3.0), 555e-9) * photon_energy(555e-9), 3e-5, 1e-15);
}

/// Radiance is conserved along a ray: the power that leaves a patch towards another is that which arrives there, and
/// the same L accounts for it from either end. In the small, ΔA₁ cos θ₁ Δω₁ = ΔA₂ cos θ₂ Δω₂ at any distance; the
/// error of both apparent areas falls with the square of size over distance.
#[test]
fn radiance_is_conserved_along_a_ray() {
    let patch = |centre, tilt: f64, size: f64| Rectangle {
        centre,
        half_sides: [[size * tilt.cos(), 0.0, -size * tilt.sin()], [0.0, size, 0.0]],
    };
    for distance in [1.0, 10.0, 1000.0] {
        let size = 1e-3;
        let source = patch([0.0; 3], 0.4, size);
        let sink = patch([0.0, 0.0, distance], PI - 0.9, 2.0 * size);
        let beam = |from: &Rectangle, to: &Rectangle, cos_theta: f64| Beam {
            radiance: 7.0,
            cos_theta,
            area: from.area(),
            solid_angle: to.solid_angle(from.centre),
        };
        let leaves = beam(&source, &sink, 0.4f64.cos());
        let arrives = beam(&sink, &source, 0.9f64.cos());
        let budget = 10.0 * (size / distance).powi(2) + 1e-9;
        close(leaves.power(), arrives.power(), budget);
        close(leaves.etendue(), arrives.etendue(), budget);
    }
}

/// Φ = L cos θ ΔA Δω, and L from Φ.
#[test]
fn radiance_and_power_are_each_others() {
    let beam = Beam { radiance: 7.0, cos_theta: 0.3, area: 2e-4, solid_angle: 1e-3 };
    let back = Beam::of_power(beam.power(), 0.3, 2e-4, 1e-3).unwrap();
    close(back.radiance, 7.0, 1e-15);
    for (power, cos_theta) in [(1.0, 0.0), (1.0, -0.5), (-1.0, 0.5), (f64::NAN, 0.5), (1.0, f64::NAN)] {
        assert!(Beam::of_power(power, cos_theta, 1.0, 1.0).is_err());
    }
}
