// How fast the device multiplies and adds: eight chains of four that do not wait for each other.

@group(0) @binding(0) var<storage, read_write> values: array<vec4f>;

const TURNS = 256u;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let x = values[id.x];
    var a = x;
    var b = x + 1.0;
    var c = x + 2.0;
    var d = x + 3.0;
    var e = x + 4.0;
    var f = x + 5.0;
    var g = x + 6.0;
    var h = x + 7.0;
    for (var k = 0u; k < TURNS; k++) {
        a = a * x + x;
        b = b * x + x;
        c = c * x + x;
        d = d * x + x;
        e = e * x + x;
        f = f * x + x;
        g = g * x + x;
        h = h * x + x;
    }
    values[id.x] = a + b + c + d + e + f + g + h;
}
