// How fast the device writes: four vectors an invocation, strided, so that neighbours write neighbours.

@group(0) @binding(0) var<storage, read_write> values: array<vec4f>;

@compute @workgroup_size(256)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let stride = groups.x * 256u;
    for (var k = 0u; k < 4u; k++) {
        values[id.x + k * stride] = vec4f(f32(k));
    }
}
