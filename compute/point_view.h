// What a point of a room sees, exactly: convex polygons are cut at the point's horizon and by the shadow
// cones of what stands before them, in double precision, and Lambert's formula gives what arrives from the
// rest. Nothing is sampled, so nothing is noisy. Cost: about 0.05 us for an unhindered polygon, plus 10 ns a
// blocker in the room.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/convex_regions.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

// The room that a point with this normal is in: that of the patch met first by some ray in front of it, if
// met from its front. geometry::kNoRoom outside of all rooms.
uint32_t roomOfPoint(const geometry::PatchMesh& mesh, glm::dvec3 position, glm::dvec3 normal);

// What can stand between two points of a room.
class Blockers {
public:
    explicit Blockers(const geometry::PatchMesh& mesh);

    // Those that can stand between two of the points, or of points between these.
    Blockers between(std::span<const glm::dvec3> points) const;

    double tolerance() const { return tolerance_; } // a length that does not matter in this mesh
    std::span<const ConvexRegion> regions() const { return regions_; }

    struct Ball {
        glm::dvec3 centre;
        double radius;
    };
    std::span<const Ball> balls() const { return balls_; } // each holds the region of its number

private:
    Blockers() = default;
    void add(ConvexRegion region);
    std::vector<ConvexRegion> regions_;
    std::vector<Ball> balls_;
    double tolerance_ = 0;
};

class PointView {
public:
    using Polygon = std::vector<glm::dvec3>; // convex; relative to the point

    // `normal` unit. `blockers` must outlive this.
    PointView(const Blockers& blockers, glm::dvec3 position, glm::dvec3 normal, uint32_t room);
    // As if nothing stood in the way.
    PointView(const Blockers& blockers, glm::dvec3 position, glm::dvec3 normal)
        : position_(position), normal_(normal), least_(blockers.tolerance()) {}

    // What the point sees of a room through a pane, beyond its plane: `frame` is a visible part of the pane.
    PointView through(const Blockers& blockers, const Polygon& frame, uint32_t room) const;

    // False where a convex polygon (world) lies outside of what the panes leave open; a quick look.
    bool mayShow(std::span<const glm::dvec3> polygon) const;
    bool mayShow(glm::dvec3 centre, double radius) const; // the same of a ball (world)

    // True where something may stand before a convex polygon (world); a quick look.
    bool isHindered(std::span<const glm::dvec3> polygon) const;

    // The form factor from the point to a convex polygon (world), whichever way the polygon faces.
    double factor(std::span<const glm::dvec3> polygon) const;

    // The same with the polygon's visible parts, relative to the point; `parts` is overwritten.
    double factor(std::span<const glm::dvec3> polygon, std::vector<Polygon>& parts) const;

    // Of a polygon relative to the point and above its horizon, regardless of blockers.
    double unhinderedFactor(std::span<const glm::dvec3> polygon) const;

    // Of the part of a convex polygon (world) above the horizon, regardless of blockers; `above` is
    // overwritten.
    double openFactor(std::span<const glm::dvec3> polygon, Polygon& above) const;

    // Takes from parts what polygons (world) hide that stand beyond all of them, as outside of a window.
    void hideBeyond(std::span<const Polygon* const> polygons, std::vector<Polygon>& parts) const;
    // The same of parts of what stands among the polygons: each hides what lies behind it. Those as this
    // point sees them are made once for all parts.
    class Hiding;
    Hiding hidingBehind(std::span<const Polygon* const> polygons) const;
    void hideBehind(const Hiding& hiding, std::vector<Polygon>& parts) const;

    glm::dvec3 position() const { return position_; }
    glm::dvec3 normal() const { return normal_; }

private:
    struct Cone {
        std::vector<glm::dvec3> sides; // inward normals of the planes through the point and the edges
        glm::dvec3 normal;             // of the blocker's plane, towards what it may hide
        double distance;               // of that plane from the point
        double beyond;                 // the distance from which on it hides: a front nothing of its own wall
        bool isFront;                  // of a body, as seen from the point
    };
    // `frame`: what bounds all that is seen; empty without.
    void addCones(const Blockers& blockers, uint32_t room, std::span<const glm::dvec3> frame);
    // A quick look at a polygon, which becomes relative to the point where it has few corners.
    using Local = std::array<glm::dvec3, 16>;
    enum class Glance { nothing, all, unclear };
    Glance glance(std::span<const glm::dvec3> polygon, Local& local) const;
    std::optional<Cone> coneOf(std::span<const glm::dvec3> corners) const; // relative; none if seen edge-on
    std::vector<Cone> conesOf(std::span<const Polygon* const> polygons) const; // world
    void keepLit(std::span<const Cone> cones, std::vector<Polygon>& parts) const;
    bool mayHide(const Cone& cone, std::span<const glm::dvec3> polygon) const;
    enum class Reach { nothing, some, all };
    Reach reachOf(const Cone& cone, std::span<const glm::dvec3> part) const;
    // Adds to `lit` what none of before[from, end) hides of a convex part, cut along their planes: each piece
    // by those alone that reach into it, and not at all behind one that hides it wholly. `before` grows
    // meanwhile.
    void keepLit(Polygon&& part, std::vector<const Cone*>& before, size_t from,
                 std::vector<Polygon>& lit) const;

    glm::dvec3 position_, normal_;
    double least_; // length
    struct Side {
        glm::dvec3 normal; // inward
        double offset;     // from the point
        double inWorld;    // the same from the world's origin
    };
    std::vector<Side> frame_; // planes that bound what is seen; none: everything
    std::vector<Cone> cones_;
};

class PointView::Hiding {
    friend class PointView;
    std::vector<Cone> cones_;
};

} // namespace heliodon::compute
