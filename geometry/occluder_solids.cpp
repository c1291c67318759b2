#include "geometry/occluder_solids.h"

namespace heliodon::geometry {

namespace {

class SolidBuilder {
public:
    explicit SolidBuilder(double chordError) : chordError_(chordError) {}

    // The footprint is a strip: corner k of one long side faces corner size - 1 - k of the other.
    void add(const WallPiece& piece) {
        const std::vector<glm::dvec2> outline = footprint(piece, chordError_).outline;
        const auto n = static_cast<uint32_t>(outline.size());
        const auto first = static_cast<uint32_t>(out_.vertices.size());
        for (const double height : {0.0, piece.height})
            for (const glm::dvec2 p : outline)
                out_.vertices.push_back(kMetresPerInch * glm::dvec3(p.x, height, -p.y));
        for (uint32_t k = 0; k < n; ++k) {
            const uint32_t next = (k + 1) % n;
            quad(first + k, first + next, first + n + next, first + n + k);
        }
        for (uint32_t k = 0; k + 1 < n / 2; ++k) {
            const uint32_t a = k, b = k + 1, c = n - 2 - k, d = n - 1 - k;
            quad(first + n + a, first + n + b, first + n + c, first + n + d);
            quad(first + a, first + d, first + c, first + b);
        }
    }

    Occluders take() { return std::move(out_); }

private:
    void quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
        for (const uint32_t v : {a, b, c, a, c, d}) out_.triangles.push_back(v);
    }

    Occluders out_;
    double chordError_;
};

} // namespace

Occluders occluderSolids(const PlanWalls& plan, double chordError) {
    SolidBuilder builder(chordError);
    for (const WallPiece& piece : plan.pieces) builder.add(piece);
    for (const WallPiece& piece : plan.partitions) builder.add(piece);
    return builder.take();
}

} // namespace heliodon::geometry
