#include "geometry/occluder_solids.h"

#include <array>

namespace heliodon::geometry {

namespace {

class SolidBuilder {
public:
    // The footprint is a strip: corner k of one long side faces corner size - 1 - k of the other. Each of its
    // cells becomes a convex solid of its own.
    void add(const WallPiece& piece) {
        const std::vector<glm::dvec2> outline = footprint(piece).outline;
        const size_t n = outline.size();
        for (size_t k = 0; k + 1 < n / 2; ++k)
            addPrism({outline[k], outline[k + 1], outline[n - 2 - k], outline[n - 1 - k]}, piece.height);
    }

    Occluders take() { return std::move(out_); }

private:
    void addPrism(const std::array<glm::dvec2, 4>& base, double height) {
        const auto first = static_cast<uint32_t>(out_.vertices.size());
        for (const double y : {0.0, height})
            for (const glm::dvec2 p : base)
                out_.vertices.push_back(kMetresPerInch * glm::dvec3(p.x, y, -p.y));
        for (uint32_t k = 0; k < 4; ++k) {
            const uint32_t next = (k + 1) % 4;
            quad(first + k, first + next, first + 4 + next, first + 4 + k);
        }
        quad(first + 4, first + 5, first + 6, first + 7);
        quad(first, first + 3, first + 2, first + 1);
    }

    void quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
        for (const uint32_t v : {a, b, c, a, c, d}) out_.triangles.push_back(v);
    }

    Occluders out_;
};

} // namespace

Occluders occluderSolids(const PlanWalls& plan) {
    SolidBuilder builder;
    for (const WallPiece& piece : plan.pieces) builder.add(piece);
    for (const WallPiece& piece : plan.partitions) builder.add(piece);
    return builder.take();
}

} // namespace heliodon::geometry
