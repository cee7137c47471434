// Hemispherical integrals in slopes of ωm: one invocation a (roughness, direction), Gauss–Legendre
// in r and in azimuth. The host tabulates the azimuths of every direction in f64.

@group(0) @binding(1) var<storage, read> alphas: array<real>;
@group(0) @binding(2) var<storage, read> mus: array<real>;
@group(0) @binding(3) var<storage, read> azimuths: array<SlopeAzimuth>; // job.azimuths for each column
@group(0) @binding(4) var<storage, read> nodes: array<real2>;           // (r in [0, 1], weight)
@group(0) @binding(5) var<storage, read_write> raw: array<real2>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let invocation = job.first + id.x;
    if invocation >= job.end {
        return;
    }
    let column = invocation % job.columns;
    let alpha = alphas[invocation / job.columns];
    let mu = mus[column];
    if alpha == 0.0 {
        raw[invocation - job.base] = mirror_limit(mu);
        return;
    }
    var sum = real2();
    for (var k = 0u; k < job.azimuths; k++) {
        let azimuth = azimuths[column * job.azimuths + k];
        let end = ndf_map_end(azimuth.y, alpha);
        var inner = real2();
        for (var j = 0u; j < job.nodes; j++) {
            inner += nodes[j].y * slope_integrand(end * nodes[j].x, azimuth, mu, alpha);
        }
        sum += (azimuth.w * end) * inner;
    }
    raw[invocation - job.base] = sum;
}
