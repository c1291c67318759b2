// What a ribbon of light at the horizon (daylight/horizon_ribbon.h) gives through openings. It may be lower
// than a degree, and cells of sky that are small enough for it would be many: here a piece of sky is summed
// up azimuth by azimuth. Along each, a convex polygon shows the heights from one to another, over which the
// ribbon's integral is known; between azimuths a Gauss rule is refined until it changes no more.
#pragma once

#include <array>
#include <span>

#include <glm/vec3.hpp>

#include "compute/daylight/horizon_ribbon.h"
#include "compute/near_light.h"
#include "compute/point_scene.h"

namespace heliodon::compute {

class RibbonLight {
public:
    // Of a sky that daylight::hasHorizonRibbon. `scene` and `sky` must outlive this.
    RibbonLight(const PointScene& scene, const daylight::Sky& sky);

    // At a point in the air of `room`, `normal` unit: lux, to about 1e-3 of it. 20 us beside a window, half a
    // microsecond where no window shows the ribbon.
    glm::dvec3 at(glm::dvec3 position, glm::dvec3 normal, uint32_t room) const;

    // By way of walls that are taken apart beside a sensor.
    glm::dvec3 byWalls(const NearLight& near, uint32_t room) const;

    struct Mean {
        glm::dvec3 lux{0};
        double error = 0; // estimate, photometric lux
    };
    // Over a patch, from 4 points, or where those and its corners see different amounts, as patches that the
    // height of a sill runs through do, from 16, 64 or 256. `usual`: lux against which errors are small. 0.1
    // to 0.2 ms in the mean over a room of 2000 patches.
    Mean onPatch(uint32_t patch, double usual) const;

private:
    struct Fan;
    glm::dvec3 ofPart(const PointView::Polygon& part, glm::dvec3 normal,
                      const PointScene::GlassBefore& glass) const;

    const PointScene* scene_;
    const daylight::Sky* sky_;
    daylight::HorizonRibbon ribbon_;
    std::array<daylight::HorizonRibbon::Integral, 3> rows_; // that its heights are summed in, each whole
};

} // namespace heliodon::compute
