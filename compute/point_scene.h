// What points of rooms see, through windows too: the patches and the sky of their own room, and those of
// rooms behind panes, each where nothing stands before it.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight/window.h"
#include "compute/outside_cells.h"
#include "compute/patch_slopes.h"
#include "compute/point_view.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

// One small piece of sky or ground behind an opening: times its luminance it gives lux.
struct SkySample {
    glm::vec3 direction; // world, unit; y > 0: sky, else ground
    glm::vec3 weight;    // per channel, glazing included
};

// Whether one sees through an interior window; one that reflects diffusely is taken for frosted.
inline bool isClear(const geometry::Material& pane) {
    return pane.reflectance == glm::vec3(0);
}

// A room that a point sees, through the panes of interior windows if it is not its own.
struct RoomBeyond {
    struct Pane {
        const daylight::Window* window;
        glm::dvec3 normal; // into the room that the window belongs to
        bool entered;      // by who looks on from the point: the room lies beyond
    };
    uint32_t room;
    std::vector<Pane> panes;

    glm::dvec3 transmittance(glm::dvec3 direction) const; // from the point; any length
};

// What a point gets of a patch through tinted panes, in each channel, more than by their photometric
// transmittance; a form factor.
struct TintedShare {
    uint32_t patch;
    glm::vec3 more;
};

// How closely a point looks at light that runs on linearly across patches.
struct SlopeDetail {
    double angle = 0.3;    // radians, of one cell of a patch
    double farSize = 0.05; // size over distance below which a slope averages out
};

class PointScene {
public:
    explicit PointScene(const geometry::PatchMesh& mesh); // must outlive this
    const geometry::PatchMesh& mesh() const { return *mesh_; }
    const Blockers& blockers() const { return blockers_; }
    // Of these, those that can hide the outside from points on a patch.
    Blockers blockersOfSky(uint32_t patch) const;

    // Whether any pane leads from room to room, or any window looks at another one.
    bool hasRoomsBeyond() const { return !panes_.empty() || seesOthers_; }

    // work(view, room) for the point's own room and for each that it sees through panes, four in a row at
    // most: clear interior windows, and windows to the outside that other windows look at; through blinds
    // what passes them straight. The building's own walls hide what lies behind them, inside and out.
    using RoomWork = std::function<void(const PointView&, const RoomBeyond&)>;
    void forRoomsSeen(const PointView& view, uint32_t room, const RoomWork& work) const {
        forRoomsSeen(view, {room, {}}, work);
    }

    // What stands between a point and a piece of the outside: an opening's glass, after that of the panes
    // before it.
    struct GlassBefore {
        const daylight::Window* window;
        glm::dvec3 normal; // into the room
        const RoomBeyond* beyond;
        bool grey; // clear glass in one channel, which is quicker

        glm::dvec3 transmittance(glm::dvec3 direction) const; // unit, from the point
    };
    // work(part, glass) for what a point in the air of `room` sees of sky and ground, in convex parts
    // relative to the point; through panes too. byWall(part, region, glass) for what it sees of regions of
    // outside() that reflect light.
    using OutsideWork = std::function<void(const PointView::Polygon&, const GlassBefore&)>;
    using OutsideWallWork = std::function<void(const PointView::Polygon&, size_t region, const GlassBefore&)>;
    void forOutside(const PointView& view, uint32_t room, const OutsideWork& work,
                    const OutsideWallWork& byWall = {}) const;
    // The same of sky and ground for a point outside, that looks in by openings and out by others; `hiding`:
    // what stands before it. It has no room.
    void forOutsideThrough(const PointView& view, const PointView::Hiding& hiding,
                           const OutsideWork& work) const;
    const OutsideCells& outside() const { return outside_; }
    // False where no opening can show a point the sky between the horizon and `slope`, the tangent of an
    // altitude; a quick look.
    bool mayShowLow(glm::dvec3 position, glm::dvec3 normal, uint32_t room, double slope) const;

    // From a point in the air of `room`, in pieces of at most `angle` radians; through panes too. `walls`:
    // added to by what is seen of outside(), in any order.
    void seeSky(const PointView& view, uint32_t room, double angle, std::vector<SkySample>& samples,
                std::vector<OutsideShare>* walls = nullptr) const;

    // Adds the point's form factors of patches; those seen through panes times their photometric
    // transmittance, with what their tint makes of that in `tinted`.
    void seePatches(const PointView& view, uint32_t room, const PatchSlopes& slopes, float* even,
                    float* smooth, std::vector<TintedShare>& tinted, const SlopeDetail& detail = {}) const;
    // The same of what is seen through panes alone.
    void seePatchesBeyond(const PointView& view, uint32_t room, float* row,
                          std::vector<TintedShare>& tinted) const;

    // work(cell, towards it, form factor) for what the middle of a patch of an opening, before its glass,
    // sees of outside(), in pieces of at most `angle` radians.
    using CellWork = std::function<void(uint32_t cell, glm::dvec3 towards, double factor)>;
    void seeWallsBefore(uint32_t patch, double angle, const CellWork& work) const;

    // The view's form factor of a patch in its own room; 0 where it looks at its back or along it.
    double factor(const PointView& view, uint32_t patch) const;

    struct Patch {
        glm::dvec3 centre, normal;
        double size;   // root of the area
        double radius; // of the ball about the centre that holds it
    };
    std::span<const Patch> patches() const { return patches_; }

private:
    struct Facing { // a window that another looks at, each from outside
        uint32_t to;
        std::vector<PointView::Polygon> hiddenBy; // what stands between them, world
    };
    struct Opening {         // to the outside
        ConvexRegion region; // group: material
        glm::dvec3 normal;
        std::vector<PointView::Polygon> hiddenBy; // what hides the sky, world
        std::vector<Facing> facing;
        struct Wall {
            size_t region; // of outside(), that reflects
            PointView::Polygon part;
        };
        std::vector<Wall> walls; // among what hides the sky
    };
    struct Pane { // clear, of an interior window
        ConvexRegion region;
        const daylight::Window* window;
        glm::dvec3 normal;
        uint32_t roomBeyond;
    };
    const daylight::Window& window(const Opening& opening) const { return windows_[opening.region.group]; }
    void findOpenings(const std::vector<ConvexRegion>& openings, const std::vector<ConvexRegion>& walls);
    void blackenCrowds(const std::vector<ConvexRegion>& openings);
    void forRoomsSeen(const PointView& view, const RoomBeyond& here, const RoomWork& work) const;
    std::vector<PointView> framesOf(const PointView& view, std::span<const PointView::Polygon> parts) const;
    static bool anyShows(std::span<const PointView> frames, std::span<const glm::dvec3> polygon);
    void outsideOf(const PointView& view, const RoomBeyond& beyond, const OutsideWork& work,
                   const OutsideWallWork& byWall) const;
    bool isBefore(glm::dvec3 point, size_t region) const; // of outside()
    void seeWall(const PointView& view, const PointView::Polygon& part, size_t region,
                 const GlassBefore& glass, double angle, std::vector<OutsideShare>& walls) const;

    const geometry::PatchMesh* mesh_;
    Blockers blockers_;
    std::vector<Patch> patches_;
    std::vector<Opening> openings_;
    OutsideCells outside_;
    std::vector<Pane> panes_;
    std::vector<daylight::Window> windows_; // by material
    bool seesOthers_ = false;
};

} // namespace heliodon::compute
