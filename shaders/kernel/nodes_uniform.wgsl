// The nodes of the coarse maps, few: software drivers read uniforms faster than storage.

@group(0) @binding(6) var<uniform> nodes: array<real4, NODES>; // r in [0, 1], weight
