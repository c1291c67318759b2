// The sky's direct light within patches, where a value per patch tells too little: on a floor below a window
// it climbs from nothing at the wall's foot and falls off again within one triangle. Here it is at corners of
// patches, and over a grid on those triangles where linear between their corners will not do.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight/sky.h"
#include "compute/lighting.h"
#include "compute/point_scene.h"

namespace heliodon::compute {

class SkyDetail {
public:
    // `scene` and its mesh outlive this. Cost: that of patchSkyCoefficients, or less.
    explicit SkyDetail(const PointScene& scene);

    // Of a sky without a ribbon at its horizon. Luminance is taken for linear between directions 15 degrees
    // apart, which changes how light spreads within patches, not how much they have. Cost: 0.5 ms of one
    // core at 4000 triangles.
    LightDetail of(const daylight::Sky& sky) const;

private:
    // What a point gets of the outside, by luminance in some directions.
    struct Share {
        uint32_t node;
        glm::vec3 weight;
    };
    using Row = std::vector<Share>;
    static double underEvenSky(const Row& row);
    // Points on one patch; `blockers` as PointScene::blockersOfSky.
    std::vector<Row> seenFrom(uint32_t patch, const Blockers& blockers,
                              std::span<const glm::dvec3> points) const;
    std::vector<Row> seenFromCorners(); // one a pair
    // Per patch; none where values of pairs will do.
    std::vector<std::vector<Row>> seenFromGrids(std::span<const Row> pairs) const;
    double meanOf(std::span<const double> atPairs) const; // by area
    bool bends(uint32_t triangle, const Blockers& blockers, std::span<const double> atPairs,
               double usual) const;

    const PointScene* scene_;
    std::vector<uint32_t> pairOf_; // per corner of the mesh: number of its vertex and surface
    std::vector<uint32_t> bent_;   // patches with a grid
    std::vector<size_t> first_{0}; // of each point's shares: one point a pair, then the places of grids
    std::vector<Share> shares_;
};

} // namespace heliodon::compute
