// Where sunlight ends within patches, over many hours: what a sensor gets beyond what the patches' mean
// exitance would send it. Exactly, where it makes a difference, for patches that loom large at the sensor or
// are hidden in part, and for light much nearer than its patch's middle; where its horizon cuts a patch, by
// what of the light is above; for the rest by how much nearer and squarer the middle of the light stands than
// that of the patch.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/near_light.h"
#include "compute/point_view.h"
#include "compute/sun_patches.h"
#include "compute/vector_width.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

// Form factor of a patch at a sensor below which edges of sunlight on it average out: small, as small patches
// may be all that lights a dark room (those of a slot). In light by way of a near wall's cells, which are
// many: of what reaches the sensor by the cell.
constexpr float kEdgeShare = 1e-6F;
constexpr double kEdgeOnCells = 2e-4;

class SunEdges {
public:
    struct Edge {
        uint32_t patch;
        glm::vec3 exitance;  // mean over the patch
        glm::vec3 beyond{0}; // that it is taken to send besides, SunBounce's `sent`
        glm::vec3 middle{0}; // of the light
        struct Part {
            std::vector<glm::dvec3> polygon;
            glm::vec3 exitance;
        };
        std::vector<Part> parts;
    };
    // Of one hour. `strength`: the sun's normal illuminance.
    static std::vector<Edge> edgesOf(const geometry::PatchMesh& mesh, const std::vector<SunlitParts>& partly,
                                     double strength);

    SunEdges() = default;
    SunEdges(const geometry::PatchMesh& mesh,
             std::vector<std::vector<Edge>> ofHours); // mesh must outlive this

    // A sensor with its form factors of patches.
    struct Place {
        PointView view;
        uint32_t room;
        const float* even;
    };
    static constexpr size_t kTogether = 16;
    // Adds to `lux`, rows of `stride` for hours, what at most kTogether sensors get. `lux` holds what the
    // hour's sun gives them by way of patches taken for even: an edge that cannot change this by more than
    // 1e-3, each for itself, is told by its middle, so that what an hour gets does not depend on which others
    // are here. About 1 ns for each edge and sensor, 0.15 us for those that middles do not tell; same bits on
    // any number of threads.
    void addTo(float* lux, size_t stride, const PointScene& scene, std::span<const Place> places,
               VectorWidth width = widestVectors()) const;

    // The same by way of the cells of a sensor's near walls: from 2e-4 of what reaches the sensor by a cell.
    void addTo(std::span<float> lux, const PointScene& scene, const NearLight& near, uint32_t room,
               VectorWidth width = widestVectors()) const;

    // What edges of one hour take, here and before they are put in order.
    static size_t bytesOf(std::span<const Edge> edges);

private:
    struct Part {
        size_t firstCorner; // its corners end where the next one's begin
        glm::vec3 exitance;
    };
    struct Patch {
        uint32_t patch;
        size_t first; // of its edges; they end where the next one's begin
        glm::vec3 middle, normal;
        float area, reach; // from the middle to the farthest corner
    };
    static Patch patchOf(const geometry::PatchMesh& mesh, uint32_t patch, size_t first);
    // At least its form factor from the view's point.
    static double mostOf(const Patch& patch, const PointView& view);
    size_t edgesEnd(size_t patch) const {
        return patch + 1 < patches_.size() ? patches_[patch + 1].first : hour_.size();
    }
    struct Lanes;
    // How a sensor sees one of patches_; false where its edges do not count.
    bool look(const PointScene& scene, const Place& from, size_t patch, Lanes& lanes, size_t lane) const;
    // Per edge of one of patches_, how many times nearer and squarer its light stands to the view's point
    // than the patch's middle, less one; false where the middle lies below either's horizon.
    bool findNearer(const PointView& view, size_t patch, VectorWidth width, std::vector<float>& nearer) const;
    // Whether the view's horizon runs through it, leaving more than a sliver below.
    static bool isCut(const geometry::PatchMesh& mesh, uint32_t patch, const PointView& view);
    // Whether something stands before more than a sliver of what is above the horizon; `straight`: form
    // factor of what is seen.
    static bool isPartlyHidden(const geometry::PatchMesh& mesh, const PointView& view, uint32_t patch,
                               double straight);
    // What a sensor gets by an edge, not told by its middle, beyond what it is taken to send evenly.
    float exactly(const PointView& view, size_t edge, const Lanes& lanes, size_t lane) const;
    glm::dvec3 exactly(const PointView& view, size_t edge, double straight) const;
    std::span<const Part> partsOf(size_t edge) const {
        return {&parts_[firstPart_[edge]], firstPart_[edge + 1] - firstPart_[edge]};
    }
    std::span<const glm::dvec3> cornersOf(const Part& part) const {
        return {&corners_[part.firstCorner], (&part + 1)->firstCorner - part.firstCorner};
    }
    size_t hours_ = 0;
    std::vector<Patch> patches_;
    // Edges, patch by patch.
    std::vector<uint32_t> hour_;
    std::vector<float> exitance_, beyond_, x_, y_, z_; // photometric, and middles
    std::vector<glm::vec3> colour_, colourBeyond_;
    // Parts of edges and their corners, as they are walked through.
    std::vector<size_t> firstPart_; // and one that ends all
    std::vector<Part> parts_;
    std::vector<glm::dvec3> corners_;
};

} // namespace heliodon::compute
