// Azimuths and nodes of a table with many directions, or of the finest tolerances.

@group(0) @binding(5) var<storage, read> azimuths: array<SlopeAzimuth>;
@group(0) @binding(6) var<storage, read> nodes: array<real4>; // r in [0, 1], weight
