#include "compute/sun_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"

namespace heliodon::compute {

namespace {

using Polygon = std::vector<glm::dvec2>;

double area(const Polygon& p) {
    double twice = 0;
    for (size_t k = 1; k + 1 < p.size(); ++k) twice += geometry::cross(p[k] - p[0], p[k + 1] - p[0]);
    return 0.5 * twice;
}

// The part of `p` left of the line a -> b (`side` 1) or right of it (-1).
Polygon beside(const Polygon& p, glm::dvec2 a, glm::dvec2 b, double side) {
    Polygon result;
    geometry::clip<glm::dvec2>(
        p, [&](glm::dvec2 q) { return side * geometry::cross(b - a, q - a); }, result);
    return result;
}

Polygon intersection(Polygon p, const Polygon& convex) {
    for (size_t k = 0; k < convex.size() && !p.empty(); ++k) {
        const glm::dvec2 a = convex[k], b = convex[(k + 1) % convex.size()];
        if (std::ranges::any_of(p, [&](glm::dvec2 q) { return geometry::cross(b - a, q - a) < 0; }))
            p = beside(p, a, b, 1);
    }
    return p;
}

// Appends `p` minus `convex` as convex pieces of more than `least` area.
void subtract(Polygon p, const Polygon& convex, double least, std::vector<Polygon>& pieces) {
    for (size_t k = 0; k < convex.size() && !p.empty(); ++k) {
        const glm::dvec2 a = convex[k], b = convex[(k + 1) % convex.size()];
        Polygon inside = beside(p, a, b, 1), outside = beside(p, a, b, -1);
        if (!outside.empty() && area(outside) > least) pieces.push_back(std::move(outside));
        p = std::move(inside);
    }
}

struct Box {
    glm::dvec2 low{1e300}, high{-1e300};
    explicit Box(const Polygon& p) {
        for (const glm::dvec2& q : p) low = glm::min(low, q), high = glm::max(high, q);
    }
};

bool apart(glm::dvec2 low0, glm::dvec2 high0, glm::dvec2 low1, glm::dvec2 high1) {
    return low0.x >= high1.x || low1.x >= high0.x || low0.y >= high1.y || low1.y >= high0.y;
}

bool inside(const Polygon& p, glm::dvec2 q) {
    for (size_t k = 0; k < p.size(); ++k)
        if (geometry::cross(p[(k + 1) % p.size()] - p[k], q - p[k]) < 0) return false;
    return true;
}

constexpr double kDiscTangent = 0.004651; // of half the sun's disc, 0.533 degrees wide on average
constexpr size_t kPlaces = 256;           // on the disc
constexpr double kMissed = 0.02;          // of a beam: what so many places give wrong of half-planes, at most

// Cautious: also of some points beyond corners. `reachOf(k)`: how near is near to the side from corner k on.
template<class ReachOf> bool isNearOutline(const Polygon& p, glm::dvec2 q, const ReachOf& reachOf) {
    bool near = false;
    for (size_t k = 0; k < p.size(); ++k) {
        const glm::dvec2 side = p[(k + 1) % p.size()] - p[k];
        // Without roots: of the distance inwards from the side.
        const double times = geometry::cross(side, q - p[k]), reach = reachOf(k),
                     most = reach * reach * glm::dot(side, side);
        const bool isFar = times * times >= most;
        if (times < 0 && isFar) return false;
        near |= !isFar;
    }
    return near;
}

} // namespace

SunScene::SunScene(const geometry::PatchMesh& mesh, bool disc) : mesh_(&mesh), disc_(disc) {
    constexpr uint32_t kMostCorners = 16;
    std::vector<uint32_t> pane(mesh.patchCount(), kNoGroup), wall(mesh.patchCount(), kNoGroup);
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        normals_.push_back(geometry::patchNormal(mesh, i));
        if (mesh.materials[mesh.material[i]].isOpening())
            pane[i] = 2 * mesh.material[i] + (mesh.twin[i] != geometry::kNoTwin ? 1 : 0);
        else
            wall[i] = 0;
    }
    for (const geometry::Material& material : mesh.materials) windows_.emplace_back(material);
    panes_ = mergedRegions(mesh, pane, kMostCorners);
    walls_ = mergedRegions(mesh, wall, kMostCorners);
    std::ranges::move(outsideRegions(mesh, kMostCorners), std::back_inserter(walls_));
    scale_ = geometry::boundsOf(mesh.vertices).diagonal();
}

// A flat polygon that faces the sun.
struct SunPatches::Receiver {
    std::vector<glm::dvec3> corners; // convex
    glm::dvec3 normal;
    Polygon outline; // as the sun sees it
};

// Whether the patch lies in the face's plane: its own wall, or the other side of that, which rounding may
// have put a little before it.
bool SunPatches::isPartOf(const Face& face, const Receiver& receiver) const {
    const double facing = glm::dot(face.normal, receiver.normal), share = facing > 0 ? kSamePlane : kOnePlane;
    if (std::abs(facing) < 0.999) return false;
    const glm::dvec3 origin = face.region->corners[0];
    return std::ranges::all_of(receiver.corners, [&](const glm::dvec3& corner) {
        return std::abs(glm::dot(corner - origin, face.normal)) <= share * scale_;
    });
}

SunPatches::SunPatches(const SunScene& scene, glm::dvec3 towardsSun, bool clipAnyway)
    : mesh_(scene.mesh_), sun_(glm::normalize(towardsSun)) {
    project(scene, clipAnyway);
}

SunPatches::SunPatches(const geometry::PatchMesh& mesh, glm::dvec3 towardsSun)
    : mesh_(&mesh), sun_(glm::normalize(towardsSun)), own_(std::make_unique<SunScene>(mesh)) {
    project(*own_, false);
}

SunPatches::Face SunPatches::faceOf(const ConvexRegion& region) const {
    Face face;
    face.region = &region;
    for (const glm::dvec3& corner : region.corners) {
        face.outline.push_back(project(corner));
        face.depth.push_back(glm::dot(corner, sun_));
    }
    face.normal = normalOf(region);
    if (glm::dot(face.normal, sun_) < 0) {
        std::ranges::reverse(face.outline);
        std::ranges::reverse(face.depth);
    }
    const Box box(face.outline);
    face.low = box.low, face.high = box.high;
    face.farthest = std::ranges::max(face.depth);
    return face;
}

void SunPatches::project(const SunScene& scene, bool clipAnyway) {
    constexpr double kEdgeOn = 1e-9; // neither lit nor in the way
    across_ = geometry::perpendicular(sun_);
    up_ = glm::cross(sun_, across_);
    scale_ = scene.scale_;
    disc_ = scene.disc_;
    normals_ = scene.normals_;
    for (const ConvexRegion& region : scene.panes_) {
        Face face = faceOf(region);
        const double facing = glm::dot(face.normal, sun_);
        if (std::abs(facing) <= kEdgeOn) continue;
        const bool outside = region.group % 2 == 0;
        const daylight::Window& window = scene.windows_[region.group / 2];
        face.transmittance = window.straight(facing < 0 ? sun_ : -sun_, face.normal);
        canEnter_ |= outside && facing < 0;
        if (facing < 0)
            panes_.push_back(std::move(face));
        else if (outside)
            entered_.push_back(std::move(face));
    }
    if (!canEnter_ && !clipAnyway) panes_.clear(); // interior glass alone lets no sun in
    if (panes_.empty() && !clipAnyway) return;
    for (const ConvexRegion& region : scene.walls_) {
        Face face = faceOf(region);
        if (std::abs(glm::dot(face.normal, sun_)) > kEdgeOn) walls_.push_back(std::move(face));
    }
}

Polygon SunPatches::inFrontOf(const Face& face, const Receiver& receiver) const {
    const auto height = [&](const glm::dvec3& p) {
        return glm::dot(p - receiver.corners[0], receiver.normal);
    };
    std::vector<glm::dvec3> above;
    geometry::clip<glm::dvec3>(face.region->corners, height, above);
    if (std::ranges::none_of(above, [&](const glm::dvec3& p) { return height(p) > 1e-9 * scale_; }))
        return {};
    Polygon result;
    for (const glm::dvec3& p : above) result.push_back(project(p));
    if (area(result) < 0) std::reverse(result.begin(), result.end());
    return result;
}

// What the walls in front of the receiver leave of each piece.
void SunPatches::keepVisible(const Receiver& receiver, std::vector<Piece>& pieces) const {
    if (pieces.empty()) return;
    Box box(pieces[0].outline);
    double whole = 0;
    for (const Piece& piece : pieces) {
        const Box one(piece.outline);
        box.low = glm::min(box.low, one.low), box.high = glm::max(box.high, one.high);
        whole += area(piece.outline);
    }
    std::vector<Piece> next;
    std::vector<Polygon> rest;
    for (const Face& wall : walls_) {
        if (apart(box.low, box.high, wall.low, wall.high) || isPartOf(wall, receiver)) continue;
        const Polygon front = inFrontOf(wall, receiver);
        if (front.empty()) continue;
        next.clear();
        for (Piece& piece : pieces) {
            // Most walls near by only touch: leave those pieces whole.
            const Polygon common = intersection(piece.outline, front);
            if (common.empty() || area(common) <= 1e-9 * whole) {
                next.push_back(std::move(piece));
                continue;
            }
            rest.clear();
            subtract(std::move(piece.outline), front, 1e-9 * whole, rest);
            for (Polygon& part : rest) next.push_back({std::move(part), piece.transmittance});
        }
        pieces.swap(next);
        if (pieces.empty()) return;
    }
}

// Moves pieces on to `dimmed`, cut along the outline of a pane that part of them is behind.
void SunPatches::dim(std::vector<Piece>& pieces, const Polygon& pane, glm::dvec3 transmittance, double least,
                     std::vector<Piece>& dimmed) {
    std::vector<Polygon> others;
    for (Piece& piece : pieces) {
        Polygon common = intersection(piece.outline, pane);
        if (common.empty() || area(common) <= least) {
            dimmed.push_back(std::move(piece));
            continue;
        }
        others.clear();
        subtract(std::move(piece.outline), pane, least, others);
        for (Polygon& other : others) dimmed.push_back({std::move(other), piece.transmittance});
        dimmed.push_back({std::move(common), piece.transmittance * transmittance});
    }
}

// Pieces of the receiver that leave by at least one pane, disjoint: pane by pane, what is new of it is added,
// and what was there already is dimmed.
std::vector<SunPatches::Piece> SunPatches::throughPanes(const Receiver& receiver) const {
    const double least = 1e-9 * area(receiver.outline);
    const Box box(receiver.outline);
    std::vector<Piece> pieces, next;
    std::vector<Polygon> uncovered{receiver.outline}, rest;
    for (const Face& pane : panes_) {
        if (apart(box.low, box.high, pane.low, pane.high)) continue;
        const Polygon front = inFrontOf(pane, receiver);
        if (front.empty()) continue;
        next.clear();
        dim(pieces, front, pane.transmittance, least, next);
        rest.clear();
        for (Polygon& open : uncovered) {
            Polygon common = intersection(open, front);
            if (common.empty() || area(common) <= least) {
                rest.push_back(std::move(open));
                continue;
            }
            subtract(std::move(open), front, least, rest);
            next.push_back({std::move(common), pane.transmittance});
        }
        pieces.swap(next);
        uncovered.swap(rest);
    }
    dimByPanes(receiver, entered_, pieces);
    return pieces;
}

// Pieces behind panes that they need not pass.
void SunPatches::dimByPanes(const Receiver& receiver, const std::vector<Face>& panes,
                            std::vector<Piece>& pieces) const {
    const double least = 1e-9 * area(receiver.outline);
    const Box box(receiver.outline);
    std::vector<Piece> next;
    for (const Face& pane : panes) {
        if (pieces.empty() || apart(box.low, box.high, pane.low, pane.high) || isPartOf(pane, receiver))
            continue;
        const Polygon front = inFrontOf(pane, receiver);
        if (front.empty()) continue;
        next.clear();
        dim(pieces, front, pane.transmittance, least, next);
        pieces.swap(next);
    }
}

// All but the normal, which those who are out of the way need not know.
void SunPatches::see(size_t patch, Receiver& receiver) const {
    receiver.corners.clear(), receiver.outline.clear();
    for (uint32_t corner : mesh_->patch(patch)) {
        receiver.corners.push_back(mesh_->vertices[corner]);
        receiver.outline.push_back(project(mesh_->vertices[corner]));
    }
}

std::vector<SunPatches::Piece> SunPatches::litPieces(const Receiver& receiver) const {
    std::vector<Piece> pieces = throughPanes(receiver);
    std::erase_if(pieces, [](const Piece& piece) { return piece.transmittance == glm::dvec3(0); });
    keepVisible(receiver, pieces);
    return pieces;
}

// Back along the sun on to the receiver's plane.
std::vector<SunlitParts::Part> SunPatches::partsOf(const std::vector<Piece>& pieces,
                                                   const Receiver& receiver) const {
    const double facing = glm::dot(receiver.normal, sun_);
    std::vector<SunlitParts::Part> parts;
    for (const Piece& piece : pieces) {
        SunlitParts::Part part{{}, glm::vec3(piece.transmittance * facing)};
        for (const glm::dvec2& q : piece.outline) {
            const glm::dvec3 flat = q.x * across_ + q.y * up_;
            part.polygon.push_back(flat +
                                   sun_ * (glm::dot(receiver.corners[0] - flat, receiver.normal) / facing));
        }
        parts.push_back(std::move(part));
    }
    return parts;
}

glm::vec3 SunPatches::onPatch(const Receiver& receiver, SunlitParts* partly) const {
    const double whole = area(receiver.outline);
    if (!(whole > 0)) return glm::vec3(0);
    const std::vector<Piece> pieces = litPieces(receiver);
    if (pieces.empty()) return glm::vec3(0);
    glm::dvec3 lit(0);
    double covered = 0;
    bool even = true;
    for (const Piece& piece : pieces) {
        const double share = area(piece.outline) / whole;
        covered += share;
        lit += share * piece.transmittance;
        even &= piece.transmittance == pieces[0].transmittance;
    }
    if (partly && !(even && covered > 1 - 1e-6)) partly->parts = partsOf(pieces, receiver);
    return glm::vec3(lit * glm::dot(receiver.normal, sun_));
}

std::vector<glm::vec3> SunPatches::onPatches(std::vector<SunlitParts>* partly) const {
    std::vector<glm::vec3> result(mesh_->patchCount(), glm::vec3(0));
    if (partly) partly->clear();
    if (panes_.empty()) return result;
    glm::dvec2 low(1e300), high(-1e300);
    for (const Face& pane : panes_) low = glm::min(low, pane.low), high = glm::max(high, pane.high);
    Receiver receiver;
    for (size_t i = 0; i < mesh_->patchCount(); ++i) {
        receiver.normal = normals_[i];
        if (!(glm::dot(receiver.normal, sun_) > 1e-9)) continue;
        see(i, receiver);
        const Box box(receiver.outline);
        if (apart(box.low, box.high, low, high)) continue;
        SunlitParts parts{static_cast<uint32_t>(i), {}};
        result[i] = onPatch(receiver, partly ? &parts : nullptr);
        if (!parts.parts.empty()) partly->push_back(std::move(parts));
    }
    return result;
}

std::vector<SunlitParts::Part> SunPatches::onPolygon(std::span<const glm::dvec3> corners) const {
    Receiver receiver{{corners.begin(), corners.end()}, glm::normalize(geometry::areaVector(corners)), {}};
    for (const glm::dvec3& corner : corners) receiver.outline.push_back(project(corner));
    if (panes_.empty() || !(glm::dot(receiver.normal, sun_) > 1e-9)) return {};
    return partsOf(litPieces(receiver), receiver);
}

glm::dvec3 SunPatches::onOutside(size_t patch) const {
    Receiver receiver;
    receiver.normal = -geometry::patchNormal(*mesh_, patch);
    const double facing = glm::dot(receiver.normal, sun_);
    if (!(facing > 1e-9)) return glm::dvec3(0);
    see(patch, receiver);
    std::reverse(receiver.outline.begin(), receiver.outline.end()); // seen from outside
    return outdoors(receiver);
}

glm::dvec3 SunPatches::onStanding(std::span<const glm::dvec3> corners) const {
    Receiver receiver{{corners.begin(), corners.end()}, glm::normalize(geometry::areaVector(corners)), {}};
    for (const glm::dvec3& corner : corners) receiver.outline.push_back(project(corner));
    return glm::dot(receiver.normal, sun_) > 1e-9 ? outdoors(receiver) : glm::dvec3(0);
}

// Of a receiver that faces the sun: lit share times cosine, what walls and glass of the building leave.
glm::dvec3 SunPatches::outdoors(const Receiver& receiver) const {
    const double whole = area(receiver.outline);
    if (!(whole > 0)) return glm::dvec3(0);
    std::vector<Piece> pieces{{receiver.outline, glm::dvec3(1)}};
    for (const std::vector<Face>* panes : {&panes_, &entered_}) dimByPanes(receiver, *panes, pieces);
    keepVisible(receiver, pieces);
    glm::dvec3 lit(0);
    for (const Piece& piece : pieces) lit += area(piece.outline) * piece.transmittance;
    return glm::dot(receiver.normal, sun_) * glm::min(glm::dvec3(1), lit / whole);
}

SunPatches::Ahead SunPatches::ahead(glm::dvec3 position, double least) const {
    const glm::dvec2 q = project(position);
    const double depth = glm::dot(position, sun_);
    const auto pick = [&](const std::vector<Face>& faces, std::vector<const Face*>& picked) {
        for (const Face& face : faces) {
            const double r = std::max(least, disc_ ? kDiscTangent * (face.farthest - depth) : 0.0);
            if (!apart(q - r, q + r, face.low, face.high)) picked.push_back(&face);
        }
    };
    Ahead all;
    pick(panes_, all.panes);
    if (all.panes.empty()) return all;
    pick(entered_, all.entered);
    pick(walls_, all.walls);
    return all;
}

glm::dvec3 SunPatches::towards(glm::dvec3 direction, const Ahead& ahead, glm::dvec3 position,
                               glm::dvec3 normal, glm::dvec2 off) const {
    // Moved by less than any tolerance, off the common edges of polygons, which would count twice.
    off += 1e-9 * scale_ * glm::dvec2(0.6180339887, 0.4142135623);
    const auto meets = [&](const Face* face) {
        const double height = glm::dot(face->region->corners[0] - position, face->normal),
                     facing = glm::dot(direction, face->normal);
        // The wall that the point lies on, were it a hair behind it.
        if (std::abs(height) <= kSamePlane * scale_ && std::abs(glm::dot(face->normal, normal)) > 0.999)
            return false;
        const double far = height / facing;
        if (!(far > 1e-9 * scale_) || facing * glm::dot(sun_, face->normal) <= 0) return false;
        return inside(face->outline, project(position + far * direction) + off);
    };
    glm::dvec3 through(1);
    bool leaves = false;
    for (const Face* pane : ahead.panes)
        if (meets(pane)) through *= pane->transmittance, leaves = true;
    for (const Face* pane : ahead.entered)
        if (leaves && meets(pane)) through *= pane->transmittance;
    return leaves && std::ranges::none_of(ahead.walls, meets) ? through : glm::dvec3(0);
}

glm::dvec3 SunPatches::towardsDisc(const Ahead& ahead, glm::dvec3 position, glm::dvec3 normal,
                                   glm::dvec2 off) const {
    static const std::array<glm::dvec2, kPlaces> places = [] { // as a sunflower's seeds lie
        constexpr double kGoldenAngle = 2.399963229728653;
        std::array<glm::dvec2, kPlaces> out;
        for (size_t k = 0; k < kPlaces; ++k) {
            const double turn = kGoldenAngle * static_cast<double>(k);
            out[k] = std::sqrt((static_cast<double>(k) + 0.5) / kPlaces) *
                     glm::dvec2(std::cos(turn), std::sin(turn));
        }
        return out;
    }();
    glm::dvec3 sum(0);
    for (const glm::dvec2 place : places) {
        const glm::dvec3 there = sun_ + kDiscTangent * (place.x * across_ + place.y * up_);
        sum += towards(glm::normalize(there), ahead, position, normal, off);
    }
    return sum / double{kPlaces};
}

SunPatches::Beam SunPatches::beamAtPoint(glm::dvec3 position, glm::dvec3 normal) const {
    const double cosine = glm::dot(normal, sun_);
    if (cosine <= 0 || panes_.empty()) return {};
    const double hair = glm::radians(1e-3) * scale_, depth = glm::dot(position, sun_);
    const glm::dvec2 q = project(position);
    const Ahead near = ahead(position, hair);
    const auto hasEdge = [&](double tangent) {
        const auto hasIt = [&](const Face* face) {
            return isNearOutline(face->outline, q, [&](size_t k) {
                const double farther = std::max(face->depth[k], face->depth[(k + 1) % face->depth.size()]);
                return std::max(hair, tangent * (farther - depth));
            });
        };
        return std::ranges::any_of(near.panes, hasIt) || std::ranges::any_of(near.walls, hasIt);
    };
    const bool inPenumbra = disc_ && hasEdge(kDiscTangent);
    const auto lit = [&](glm::dvec2 off) {
        return inPenumbra ? towardsDisc(near, position, normal, off)
                          : towards(sun_, near, position, normal, off);
    };
    const glm::dvec3 here = lit(glm::dvec2(0));
    glm::dvec3 unsure(0);
    if (inPenumbra)
        for (const Face* pane : near.panes) unsure = glm::max(unsure, kMissed * pane->transmittance);
    if (hasEdge(0))
        for (const glm::dvec2 step : {glm::dvec2(hair, 0), {-hair, 0}, {0, hair}, {0, -hair}})
            unsure = glm::max(unsure, glm::abs(lit(step) - here));
    return {glm::vec3(cosine * here), glm::vec3(cosine * unsure)};
}

} // namespace heliodon::compute
