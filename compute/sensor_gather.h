// What points see, as numbers that light is multiplied with: exact form factors of patches (PointView), the
// sky and ground through openings, and sunlit parts of patches. Everything depends on geometry and glass
// alone; light comes in with each moment. Runs on all cores of the host.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight/sky_patches.h"
#include "compute/daylight/window.h"
#include "compute/patch_slopes.h"
#include "compute/point_view.h"
#include "compute/sun_patches.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

struct Sensor {
    glm::dvec3 position{0}, normal{0, 1, 0}; // world metres; unit
};

// One small piece of sky or ground behind an opening: times its luminance it gives lux.
struct SkySample {
    glm::vec3 direction; // world, unit; y > 0: sky, else ground
    glm::vec3 weight;    // per channel, glazing included
};

// What points see of the outside through exterior openings.
struct SkyView {
    std::vector<size_t> first{0}; // of each point's samples
    std::vector<SkySample> samples;

    size_t pointCount() const { return first.size() - 1; }
    std::span<const SkySample> of(size_t point) const {
        return {samples.data() + first[point], first[point + 1] - first[point]};
    }
};

// Coefficients of sky elements per point, 1/pi of the lux per unit of luminance (points x channels x
// elements); each `pointsPerRow` points are averaged.
std::vector<float> skyCoefficients(const SkyView& view, const daylight::SkyPatches& sky, uint32_t channels,
                                   std::span<const uint32_t> pointsOfRow);

// Whether one sees through an interior window; one that reflects diffusely is taken for frosted.
inline bool isClear(const geometry::Material& pane) {
    return pane.reflectance == glm::vec3(0);
}

// A room that a point sees, through the panes of interior windows if it is not its own.
struct RoomBeyond {
    struct Pane {
        const daylight::Window* window;
        glm::dvec3 normal; // towards the point
    };
    uint32_t room;
    std::vector<Pane> panes;

    glm::dvec3 transmittance(glm::dvec3 direction) const; // from the point; any length
};

class PointScene {
public:
    explicit PointScene(const geometry::PatchMesh& mesh); // must outlive this
    const geometry::PatchMesh& mesh() const { return *mesh_; }
    const Blockers& blockers() const { return blockers_; }

    // From a point in the air of `room`, in pieces of at most `angle` radians. Also through clear interior
    // windows, four in a row at most; the building's own walls hide what lies behind them, inside and out.
    void seeSky(const PointView& view, uint32_t room, double angle, std::vector<SkySample>& samples) const;

    // Adds the point's form factors of patches; those of other rooms times the photometric transmittance of
    // the clear glass between (its tint is left out).
    void seePatches(const PointView& view, uint32_t room, const PatchSlopes& slopes, float* even,
                    float* smooth) const;

    struct Patch {
        glm::dvec3 centre, normal;
        double size; // root of the area
    };
    std::span<const Patch> patches() const { return patches_; }

private:
    struct Opening {         // to the outside
        ConvexRegion region; // group: material
        glm::dvec3 normal;
        std::vector<PointView::Polygon> hiddenBy; // walls beyond it, world
    };
    struct Pane { // clear, of an interior window
        ConvexRegion region;
        const daylight::Window* window;
        glm::dvec3 normal;
        uint32_t roomBeyond;
    };
    // work(view, room) for the point's own room and for each that it sees through panes.
    template<class Work>
    void forRoomsSeen(const PointView& view, const RoomBeyond& here, const Work& work) const;
    void skyOf(const PointView& view, const RoomBeyond& beyond, double angle,
               std::vector<SkySample>& samples) const;

    const geometry::PatchMesh* mesh_;
    Blockers blockers_;
    std::vector<Patch> patches_;
    std::vector<Opening> openings_;
    std::vector<Pane> panes_;
    std::vector<daylight::Window> windows_; // by material
};

// Means of the outside's coefficients over patches (patches x channels x elements), from four points on each.
std::vector<float> patchSkyCoefficients(const PointScene& scene, const daylight::SkyPatches& sky,
                                        uint32_t channels);

// Rows of sensors.
struct SensorGather {
    std::vector<Sensor> sensors;
    std::vector<uint32_t> room; // kNoRoom: outside, sees nothing
    std::vector<float> even;    // sensors x patches: form factors
    std::vector<float> smooth;  // the same for light that runs on linearly between patches (PatchSlopes)
    SkyView sky;
    std::vector<float> skyCoefficients; // sensors x channels x elements, for products over many skies
};
SensorGather gatherSensors(const PointScene& scene, const PatchSlopes& slopes, std::vector<Sensor> sensors,
                           const daylight::SkyPatches& sky, uint32_t channels);

// What sunlit parts of patches send to a sensor beyond what their mean light would, lux. `strength`: the
// sun's normal illuminance; `firstBounce`: per patch, reflectance times its mean sunlight.
glm::vec3 sunEdges(const PointScene& scene, const SensorGather& gather, size_t sensor,
                   std::span<const SunlitParts> partly, double strength,
                   std::span<const glm::vec3> firstBounce);

} // namespace heliodon::compute
