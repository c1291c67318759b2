// Where sunlight ends within patches, over many hours: what a sensor gets beyond what the patches' mean
// exitance would send it. Exactly for patches that loom large at the sensor; for others by how much nearer
// and squarer the middle of the light stands than that of the patch.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/point_view.h"
#include "compute/sun_patches.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

class SunEdges {
public:
    struct Edge {
        uint32_t patch;
        float exitance;   // photometric mean over the patch
        glm::vec3 middle; // of the light
        struct Part {
            std::vector<glm::dvec3> polygon;
            float exitance; // photometric
        };
        std::vector<Part> parts;
    };
    // Of one hour. `strength`: the sun's normal illuminance.
    static std::vector<Edge> edgesOf(const geometry::PatchMesh& mesh, const std::vector<SunlitParts>& partly,
                                     double strength);

    SunEdges() = default;
    SunEdges(const geometry::PatchMesh& mesh,
             std::vector<std::vector<Edge>> ofHours); // mesh must outlive this

    // Adds to `lux`, one entry an hour. `even`: the sensor's form factors of patches. About 3 ns for each
    // edge of patches that count; same bits on any number of threads.
    void addTo(std::span<float> lux, const PointView& view, uint32_t room, const float* even) const;

    size_t bytes() const;

private:
    struct Patch {
        uint32_t patch;
        size_t first; // of its edges; they end where the next one's begin
        glm::vec3 middle, normal;
    };
    const geometry::PatchMesh* mesh_ = nullptr;
    std::vector<Patch> patches_;
    // Edges, patch by patch.
    std::vector<uint32_t> hour_;
    std::vector<float> exitance_, x_, y_, z_; // and middles
    std::vector<std::vector<Edge::Part>> parts_;
};

} // namespace heliodon::compute
