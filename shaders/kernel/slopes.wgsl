// Hemispherical integrals in slopes of ωm, Gauss–Legendre in r and in azimuth: one invocation takes
// one direction and four α. The host tabulates azimuths and nodes in f64, and how many of them each tile
// of texels takes.

@group(0) @binding(2) var<storage, read> alphas: array<real4>; // padded to whole fours
@group(0) @binding(3) var<storage, read> mus: array<real>;
@group(0) @binding(4) var<storage, read> tiles: array<Tile>;
@group(0) @binding(5) var<storage, read> azimuths: array<SlopeAzimuth>;
@group(0) @binding(7) var<storage, read> order: array<u32>;    // of the rows of fours, dear and cheap mixed

/// The two halves of the azimuths, which differ in how many nodes they take.
struct Tile {
    sides: array<Side, 2>,
}

struct Side {
    first_azimuth: u32, // of the tile's first column
    azimuths: u32,      // of a column
    first_node: u32,
    nodes: u32,
}

const TILE_COLUMNS = 8u;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    // What is beyond the end does the last one's work again: an early return would make software
    // drivers mask every instruction.
    let invocation = min(job.first + id.x, job.end - 1u);
    let k = invocation / job.columns;
    let column = invocation - k * job.columns;
    let row = order[k];
    let alpha = alphas[row];
    let mu = mus[column];
    let e = masked(mu, alpha);
    let tile = row * job.tiles + column / TILE_COLUMNS;
    // Both sides by one loop and all stores by another: software drivers compile them once each.
    var sum = Slope();
    for (var k = 0u; k < 2u; k++) {
        let part = integral(tiles[tile].sides[k], column % TILE_COLUMNS, e, alpha);
        sum.all += part.all;
        sum.grazing += part.grazing;
    }
    let rest = sum.all - sum.grazing;
    let mirror = mirror_limit(mu);
    // The last four may be fewer.
    let end = min(4u * row + 4u, job.nodes);
    for (var r = 4u * row; r < end; r++) {
        let k = r - 4u * row;
        let result = select(real2(rest[k], sum.grazing[k]), mirror, alpha[k] == 0.0);
        write(r * job.columns + column - job.base, result);
    }
}

fn integral(side: Side, column: u32, e: Masked, alpha: real4) -> Slope {
    var sum = Slope();
    let tan_scale = NDF_MAP_TAN * alpha;
    let first = side.first_azimuth + column * side.azimuths;
    for (var k = first; k < first + side.azimuths; k++) {
        let azimuth = azimuths[k];
        let end = ndf_map_end(azimuth.y, alpha);
        var inner = Slope();
        for (var j = side.first_node; j < side.first_node + side.nodes; j++) {
            let node = nodes[j];
            let value = slope_term(end * node.x, node.y, azimuth, e, tan_scale);
            inner.all += value.all;
            inner.grazing += value.grazing;
        }
        sum.all += azimuth.w * end * inner.all;
        sum.grazing += azimuth.w * end * inner.grazing;
    }
    let scale = 2.0 * NDF_MAP_WEIGHT;
    return Slope(scale * sum.all, scale * sum.grazing);
}
