// What a lighting loop calls: f cos θi of a Lambertian surface, from a struct of parameters, beside the
// program's own bindings and entry point.
struct Surface { albedo: f32 }
@group(0) @binding(0) var<uniform> surface: Surface;

fn shade(wi: vec3<f32>, wo: vec3<f32>, albedo: f32) -> vec3<f32> {
    return vec3<f32>(albedo / 3.14159265) * wi.z;
}

fn shade_bound(wi: vec3<f32>, wo: vec3<f32>) -> vec3<f32> {
    return shade(wi, wo, surface.albedo);
}

fn tint(wi: vec3<f32>, color: vec3<f32>) -> i32 {
    return 1;
}

@fragment
fn fragment() -> @location(0) vec4<f32> {
    return vec4<f32>(shade_bound(vec3<f32>(0.0, 0.0, 1.0), vec3<f32>(0.0, 0.0, 1.0)), 1.0);
}
