// Integrals that are known in closed form.

@group(0) @binding(2) var<storage, read> alphas: array<real>;
@group(0) @binding(3) var<storage, read> mus: array<real>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let invocation = job.first + id.x;
    if invocation >= job.end {
        return;
    }
    write(invocation - job.base, directional(mus[invocation % job.columns], alphas[invocation / job.columns]));
}
