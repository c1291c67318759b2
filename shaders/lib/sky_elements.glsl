// Reinhart's division of the sky in world axes (y up, azimuth from -z towards +x); the same numbering as daylight::SkyPatches.
const uint kTregenzaRow[7] = uint[7](30u, 30u, 24u, 24u, 18u, 12u, 6u);
const uint kTregenzaFirst[8] = uint[8](0u, 30u, 60u, 84u, 108u, 126u, 138u, 144u); // patches below each band
const float kPi = 3.14159265358979;

// Element that holds the unit direction; below the horizon the ground, the last one.
uint skyElementOf(vec3 d, uint division) {
    if (d.y <= 0.0) return 144u * division * division + 1u;
    float step = 0.5 * kPi / (7.0 * float(division) + 0.5);
    uint row = uint(asin(min(d.y, 1.0)) / step);
    if (row >= 7u * division) return 144u * division * division;
    uint band = row / division;
    uint count = kTregenzaRow[band] * division;
    float turn = atan(d.x, -d.z) / (2.0 * kPi); // -1/2 .. 1/2
    uint k = uint(floor((turn + 1.0) * float(count) + 0.5)) % count;
    return kTregenzaFirst[band] * division * division + (row - band * division) * count + k;
}
