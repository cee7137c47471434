// The nodes of the fine maps, as many as it takes.

@group(0) @binding(6) var<storage, read> nodes: array<real4>; // r in [0, 1], weight
