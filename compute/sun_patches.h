// Direct sun on patches and at points: everything is projected along the sun, then polygons are clipped
// exactly in double precision. The sun is a point, at single points a disc if wanted; glass counts with its
// transmittance at the sun's angle. A ray towards the sun passes each pane that it leaves by (front to back),
// and each to the outside that it enters another room by; that an interior window has two faces therefore
// does not count twice. Opaque patches of every room block, from both sides.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "compute/convex_regions.h"
#include "compute/daylight/window.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

// What does not change with the sun: panes and walls merged into few convex polygons.
class SunScene {
public:
    // `mesh` must outlive this, unchanged. `disc`: the sun is one, evenly bright, for beamAtPoint.
    explicit SunScene(const geometry::PatchMesh& mesh, bool disc = false);

private:
    friend class SunPatches;
    const geometry::PatchMesh* mesh_;
    std::vector<ConvexRegion> panes_, walls_; // groups of panes: 2 material + (interior ? 1 : 0)
    std::vector<daylight::Window> windows_;   // by material
    std::vector<glm::dvec3> normals_;         // of patches
    double scale_ = 1;                        // extent of the mesh
    bool disc_;
};

// A patch that the sun lights in part, or through several panes.
struct SunlitParts {
    struct Part {
        std::vector<glm::dvec3> polygon; // convex, world
        glm::vec3 light{0};              // as SunPatches::onPatches gives it, where this part is lit
    };
    uint32_t patch = 0;
    std::vector<Part> parts; // disjoint
};

class SunPatches {
public:
    // `towardsSun` unit, world. O(n); the mesh must outlive this.
    SunPatches(const geometry::PatchMesh& mesh, glm::dvec3 towardsSun);
    // `clipAnyway`: also where the sun cannot enter, to check that rule.
    SunPatches(const SunScene& scene, glm::dvec3 towardsSun, bool clipAnyway = false);

    // False when no opening faces the sun from outside: every result is zero then.
    bool canEnter() const { return canEnter_; }

    // Per patch and channel: illuminance over the sun's normal illuminance, averaged over the patch: lit
    // fraction times cosine times transmittance. About 2 ms for 2000 patches. `partly`, when given, receives
    // the lit parts of patches that are not lit evenly.
    std::vector<glm::vec3> onPatches(std::vector<SunlitParts>* partly = nullptr) const;

    // The same on the outside of an opening, before its glass: lit fraction times cosine. Walls of the
    // building shade it, its other windows dim what comes through them.
    glm::dvec3 onOutside(size_t patch) const;

    // The same on a flat convex polygon that stands outside, counter-clockwise seen from the side that it
    // faces. Needs `clipAnyway`.
    glm::dvec3 onStanding(std::span<const glm::dvec3> corners) const;

    // The lit parts, disjoint, of any flat convex polygon in the air, counter-clockwise seen from the side
    // that it faces: all of it takes part, whichever rooms it reaches through.
    std::vector<SunlitParts::Part> onPolygon(std::span<const glm::dvec3> corners) const;

    struct Beam {
        glm::vec3 share{0}, unsure{0}; // per channel
    };
    // onPatches' value at a point of the air of a room with unit normal, of the scene's sun, point or disc
    // (the lit share of 256 places on it, with the cosine and the glass of its middle). `unsure`: by how much
    // that changes at most when the sun moves by a thousandth of a degree, or the point as far as this moves
    // a shadow across the building, and what so many places may miss: not zero at the edges of beams alone. A
    // point in a disc's penumbra takes about 20 us.
    Beam beamAtPoint(glm::dvec3 position, glm::dvec3 normal) const;

private:
    struct Face { // seen from the sun
        const ConvexRegion* region = nullptr;
        glm::dvec3 normal{0};
        std::vector<glm::dvec2> outline; // counter-clockwise
        std::vector<double> depth;       // of its corners, towards the sun
        glm::dvec2 low{0}, high{0};
        double farthest = 0;         // of them
        glm::dvec3 transmittance{0}; // at the sun's angle; panes only
    };
    // What a ray from a point towards the sun may meet.
    struct Ahead {
        std::vector<const Face*> panes, entered, walls;
    };
    struct Piece {
        std::vector<glm::dvec2> outline;
        glm::dvec3 transmittance;
    };
    struct Receiver;

    void project(const SunScene& scene, bool clipAnyway);
    Face faceOf(const ConvexRegion& region) const;
    glm::dvec2 project(glm::dvec3 p) const { return {dot(p, across_), dot(p, up_)}; }
    static double dot(glm::dvec3 a, glm::dvec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    // The part of a face in front of the receiver's plane, as the sun sees it; empty when there is none.
    std::vector<glm::dvec2> inFrontOf(const Face& face, const Receiver& receiver) const;
    bool isPartOf(const Face& face, const Receiver& receiver) const;
    std::vector<Piece> throughPanes(const Receiver& receiver) const;
    static void dim(std::vector<Piece>& pieces, const std::vector<glm::dvec2>& pane, glm::dvec3 transmittance,
                    double least, std::vector<Piece>& dimmed);
    void dimByPanes(const Receiver& receiver, const std::vector<Face>& panes,
                    std::vector<Piece>& pieces) const;
    void keepVisible(const Receiver& receiver, std::vector<Piece>& pieces) const;
    void see(size_t patch, Receiver& receiver) const;
    glm::dvec3 outdoors(const Receiver& receiver) const;
    std::vector<Piece> litPieces(const Receiver& receiver) const;
    std::vector<SunlitParts::Part> partsOf(const std::vector<Piece>& pieces, const Receiver& receiver) const;
    glm::vec3 onPatch(const Receiver& receiver, SunlitParts* partly) const;
    // What rays from there towards the disc, or as far beside them as `least`, may meet.
    Ahead ahead(glm::dvec3 position, double least) const;
    // Transmittance towards there, which is near the sun, as the sun sees it from `off` beside the point;
    // zero behind walls.
    glm::dvec3 towards(glm::dvec3 direction, const Ahead& ahead, glm::dvec3 position, glm::dvec3 normal,
                       glm::dvec2 off) const;
    glm::dvec3 towardsDisc(const Ahead& ahead, glm::dvec3 position, glm::dvec3 normal, glm::dvec2 off) const;

    const geometry::PatchMesh* mesh_;
    std::span<const glm::dvec3> normals_; // the scene's
    glm::dvec3 sun_, across_{0}, up_{0};
    double scale_ = 1;
    bool canEnter_ = false, disc_ = false;
    std::vector<Face> panes_;   // glazing that a ray towards the sun leaves by
    std::vector<Face> entered_; // and enters a room by, from outside
    std::vector<Face> walls_;
    std::unique_ptr<SunScene> own_; // where no scene was given
};

} // namespace heliodon::compute
