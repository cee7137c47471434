// Hemispherical integrals in slopes of ωm, Gauss–Legendre in r and in azimuth: one invocation takes
// one direction and four α. The host tabulates the azimuths of every direction in f64, and how many
// nodes each tile of texels takes.

@group(0) @binding(1) var<storage, read> alphas: array<real4>;          // padded to whole fours
@group(0) @binding(2) var<storage, read> mus: array<real>;
@group(0) @binding(3) var<storage, read> columns: array<vec4u>;         // first azimuth and count, for each side
@group(0) @binding(4) var<storage, read> tiles: array<vec4u>;           // first node and count, for each side
@group(0) @binding(7) var<storage, read_write> raw: array<real2>;

const TILE_COLUMNS = 8u;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    // What is beyond the end does the last one's work again: an early return would make software
    // drivers mask every instruction.
    let invocation = min(job.first + id.x, job.end - 1u);
    let column = invocation % job.columns;
    let row = invocation / job.columns;
    let alpha = alphas[row];
    let mu = mus[column];
    let e = masked(mu, alpha);
    let azimuth = columns[column];
    let tile = tiles[row * ((job.columns + TILE_COLUMNS - 1u) / TILE_COLUMNS) + column / TILE_COLUMNS];
    let near = side(azimuth.x, azimuth.y, tile.x, tile.y, e, alpha);
    let far = side(azimuth.z, azimuth.w, tile.z, tile.w, e, alpha);
    let grazing = near.grazing + far.grazing;
    let rest = near.all + far.all - grazing;
    let mirror = mirror_limit(mu);
    put(4u * row, column, select(real2(rest.x, grazing.x), mirror, alpha.x == 0.0));
    put(4u * row + 1u, column, select(real2(rest.y, grazing.y), mirror, alpha.y == 0.0));
    put(4u * row + 2u, column, select(real2(rest.z, grazing.z), mirror, alpha.z == 0.0));
    put(4u * row + 3u, column, select(real2(rest.w, grazing.w), mirror, alpha.w == 0.0));
}

/// One result; the last four may be fewer.
fn put(row: u32, column: u32, result: real2) {
    if row < job.nodes {
        raw[row * job.columns + column - job.base] = result;
    }
}

/// One half of the azimuths: they differ in how many nodes they take.
fn side(first: u32, count: u32, first_node: u32, node_count: u32, e: Masked, alpha: real4) -> Slope {
    var sum = Slope();
    for (var k = first; k < first + count; k++) {
        let azimuth = azimuths[k];
        let end = ndf_map_end(azimuth.y, alpha);
        var inner = Slope();
        for (var j = first_node; j < first_node + node_count; j++) {
            let node = nodes[j];
            let value = slope_integrand(end * node.x, azimuth, e, alpha);
            inner.all += node.y * value.all;
            inner.grazing += node.y * value.grazing;
        }
        sum.all += azimuth.w * end * inner.all;
        sum.grazing += azimuth.w * end * inner.grazing;
    }
    return sum;
}
