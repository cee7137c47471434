// Azimuths and nodes of a table of usual size and tolerance: software drivers read uniforms twice as
// fast as storage.

@group(0) @binding(5) var<uniform> azimuths: array<SlopeAzimuth, VECTORS>;
@group(0) @binding(6) var<uniform> nodes: array<real4, VECTORS>; // r in [0, 1], weight
