#include "compute/sun_patches.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <glm/geometric.hpp>

#include "compute/convex_regions.h"
#include "compute/daylight/glazing.h"
#include "geometry/perpendicular.h"

namespace heliodon::compute {

namespace {

using Polygon = std::vector<glm::dvec2>;

constexpr double kEdgeOn = 1e-9; // cosine below which a face is neither lit nor in the way

double cross2(glm::dvec2 a, glm::dvec2 b) {
    return a.x * b.y - a.y * b.x;
}

double area(const Polygon& p) {
    double twice = 0;
    for (size_t k = 1; k + 1 < p.size(); ++k) twice += cross2(p[k] - p[0], p[k + 1] - p[0]);
    return 0.5 * twice;
}

// The parts of `p` left (inside) and right (outside) of the line a -> b; either may come out empty.
void split(const Polygon& p, glm::dvec2 a, glm::dvec2 b, Polygon* left, Polygon* right) {
    const glm::dvec2 along = b - a;
    for (size_t k = 0; k < p.size(); ++k) {
        const glm::dvec2 q = p[k], r = p[(k + 1) % p.size()];
        const double dq = cross2(along, q - a), dr = cross2(along, r - a);
        if (left && dq >= 0) left->push_back(q);
        if (right && dq <= 0) right->push_back(q);
        if ((dq > 0 && dr < 0) || (dq < 0 && dr > 0)) {
            const glm::dvec2 on = q + (r - q) * (dq / (dq - dr));
            if (left) left->push_back(on);
            if (right) right->push_back(on);
        }
    }
    if (left && left->size() < 3) left->clear();
    if (right && right->size() < 3) right->clear();
}

Polygon intersection(Polygon p, const Polygon& convex) {
    for (size_t k = 0; k < convex.size() && !p.empty(); ++k) {
        Polygon inside;
        split(p, convex[k], convex[(k + 1) % convex.size()], &inside, nullptr);
        p = std::move(inside);
    }
    return p;
}

// Appends `p` minus `convex` as convex pieces of more than `least` area.
void subtract(Polygon p, const Polygon& convex, double least, std::vector<Polygon>& pieces) {
    for (size_t k = 0; k < convex.size() && !p.empty(); ++k) {
        Polygon inside, outside;
        split(p, convex[k], convex[(k + 1) % convex.size()], &inside, &outside);
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
        if (cross2(p[(k + 1) % p.size()] - p[k], q - p[k]) < 0) return false;
    return true;
}

} // namespace

SunScene::SunScene(const geometry::PatchMesh& mesh) : mesh_(&mesh) {
    std::vector<uint32_t> opaque;
    std::map<std::pair<uint32_t, bool>, std::vector<uint32_t>> panes; // by material; inside or outside
    glm::dvec3 low(1e300), high(-1e300);
    for (const glm::dvec3& v : mesh.vertices) low = glm::min(low, v), high = glm::max(high, v);
    scale_ = mesh.vertices.empty() ? 1 : glm::length(high - low);
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        normals_.push_back(geometry::patchNormal(mesh, i));
        const auto patch = static_cast<uint32_t>(i);
        if (mesh.materials[mesh.material[i]].isOpening())
            panes[{mesh.material[i], mesh.twin[i] != geometry::kNoTwin}].push_back(patch);
        else
            opaque.push_back(patch);
    }
    add(opaque, 0, false, opaque_);
    for (const auto& [kind, patches] : panes) add(patches, kind.first, kind.second, panes_);
}

void SunScene::add(const std::vector<uint32_t>& patches, uint32_t material, bool interior,
                   std::vector<Region>& regions) const {
    constexpr uint32_t kAnyCorners = 1u << 20;
    for (ConvexRegion& region : flatRegions(*mesh_, patches, kAnyCorners)) {
        glm::dvec3 twice(0);
        const std::vector<glm::dvec3>& c = region.corners;
        for (size_t k = 1; k + 1 < c.size(); ++k) twice += glm::cross(c[k] - c[0], c[k + 1] - c[0]);
        regions.push_back({std::move(region.corners), glm::normalize(twice), material, interior});
    }
}

SunPatches::SunPatches(const geometry::PatchMesh& mesh, glm::dvec3 towardsSun)
    : SunPatches(std::make_shared<const SunScene>(mesh), towardsSun) {}

SunPatches::SunPatches(std::shared_ptr<const SunScene> own, glm::dvec3 towardsSun)
    : SunPatches(*own, towardsSun) {
    own_ = std::move(own);
}

SunPatches::SunPatches(const SunScene& scene, glm::dvec3 towardsSun)
    : scene_(&scene), mesh_(scene.mesh_), sun_(glm::normalize(towardsSun)) {
    across_ = geometry::perpendicular(sun_);
    up_ = glm::cross(sun_, across_);
    bool outside = false;
    for (const SunScene::Region& pane : scene.panes_) {
        const double facing = glm::dot(pane.normal, sun_);
        if (facing > -kEdgeOn) continue;
        openings_.push_back(face(pane, facing));
        openings_.back().transmittance =
            daylight::glazingOf(mesh_->materials[pane.material]).transmittance(-facing);
        outside |= !pane.interior;
    }
    if (!outside) openings_.clear(); // interior glass alone lets no sun in
    for (const SunScene::Region& matter : scene.opaque_) {
        const double facing = glm::dot(matter.normal, sun_);
        if (!openings_.empty() && std::abs(facing) >= kEdgeOn) opaque_.push_back(face(matter, facing));
    }
}

SunPatches::Face SunPatches::face(const SunScene::Region& region, double facing) const {
    Face face;
    face.region = &region;
    for (const glm::dvec3& corner : region.corners) face.outline.push_back(project(corner));
    if (facing < 0) std::reverse(face.outline.begin(), face.outline.end());
    const Box box(face.outline);
    face.low = box.low, face.high = box.high;
    return face;
}

std::vector<glm::dvec2> SunPatches::inFrontOf(const Face& face, glm::dvec3 point, glm::dvec3 normal) const {
    const std::vector<glm::dvec3>& corners = face.region->corners;
    const double least = 1e-9 * scene_->scale_;
    bool any = false, all = true;
    for (const glm::dvec3& corner : corners) {
        const double height = glm::dot(corner - point, normal);
        any |= height > least;
        all &= height >= 0;
    }
    if (!any) return {};
    if (all) return face.outline;
    Polygon result;
    for (size_t k = 0; k < corners.size(); ++k) {
        const glm::dvec3 a = corners[k], b = corners[(k + 1) % corners.size()];
        const double ha = glm::dot(a - point, normal), hb = glm::dot(b - point, normal);
        if (ha >= 0) result.push_back(project(a));
        if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0))
            result.push_back(project(a + (b - a) * (ha / (ha - hb))));
    }
    if (result.size() < 3) return {};
    if (area(result) < 0) std::reverse(result.begin(), result.end());
    return result;
}

// What the opaque patches in front of the receiver leave of a convex outline.
double SunPatches::visibleArea(const Polygon& outline, uint32_t receiver) const {
    const glm::dvec3 normal = scene_->normals_[receiver];
    const glm::dvec3 point = mesh_->vertices[mesh_->patch(receiver)[0]];
    const Box box(outline);
    const double least = 1e-9 * area(outline);
    std::vector<Polygon> pieces{outline}, next;
    for (const Face& blocker : opaque_) {
        if (apart(box.low, box.high, blocker.low, blocker.high)) continue;
        const Polygon front = inFrontOf(blocker, point, normal);
        if (front.empty()) continue;
        next.clear();
        for (Polygon& piece : pieces) {
            // Most blockers near by only touch: leave those pieces whole.
            const Polygon common = intersection(piece, front);
            if (common.empty() || area(common) <= least)
                next.push_back(std::move(piece));
            else
                subtract(std::move(piece), front, least, next);
        }
        pieces.swap(next);
        if (pieces.empty()) return 0;
    }
    double sum = 0;
    for (const Polygon& piece : pieces) sum += area(piece);
    return sum;
}

glm::dvec3 SunPatches::onPatch(const Receiver& receiver) const {
    const uint32_t patch = receiver.patch;
    const glm::dvec3 normal = scene_->normals_[patch];
    const glm::dvec3 point = mesh_->vertices[mesh_->patch(patch)[0]];
    const double whole = receiver.area, least = 1e-9 * whole;
    // Pieces that leave by at least one pane, disjoint: pane by pane, what is new of it is added, and what
    // was there already is dimmed.
    std::vector<Piece> pieces, next;
    std::vector<Polygon> uncovered{receiver.outline}, rest;
    for (const Face& pane : openings_) {
        if (apart(receiver.low, receiver.high, pane.low, pane.high)) continue;
        const Polygon front = inFrontOf(pane, point, normal);
        if (front.empty()) continue;
        next.clear();
        for (Piece& piece : pieces) {
            Polygon common = intersection(piece.outline, front);
            if (common.empty() || area(common) <= least) {
                next.push_back(std::move(piece));
                continue;
            }
            std::vector<Polygon> others;
            subtract(std::move(piece.outline), front, least, others);
            for (Polygon& other : others) next.push_back({std::move(other), piece.transmittance});
            next.push_back({std::move(common), piece.transmittance * pane.transmittance});
        }
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
    glm::dvec3 lit(0);
    for (const Piece& piece : pieces) lit += visibleArea(piece.outline, patch) / whole * piece.transmittance;
    return lit * glm::dot(normal, sun_);
}

std::vector<glm::vec3> SunPatches::onPatches() const {
    std::vector<glm::vec3> result(mesh_->patchCount(), glm::vec3(0));
    if (!canEnter()) return result;
    Receiver receiver;
    for (size_t i = 0; i < mesh_->patchCount(); ++i) {
        if (glm::dot(scene_->normals_[i], sun_) < kEdgeOn) continue;
        receiver.patch = static_cast<uint32_t>(i);
        receiver.outline.clear();
        for (uint32_t corner : mesh_->patch(i)) receiver.outline.push_back(project(mesh_->vertices[corner]));
        const Box box(receiver.outline);
        receiver.low = box.low, receiver.high = box.high;
        if (std::all_of(openings_.begin(), openings_.end(),
                        [&](const Face& pane) { return apart(box.low, box.high, pane.low, pane.high); }))
            continue;
        receiver.area = area(receiver.outline);
        if (receiver.area > 0) result[i] = glm::vec3(onPatch(receiver));
    }
    return result;
}

glm::vec3 SunPatches::atPoint(glm::dvec3 position, glm::dvec3 normal) const {
    const double cosine = glm::dot(normal, sun_);
    if (cosine <= 0 || !canEnter()) return glm::vec3(0);
    // Moved by less than any tolerance, off the common edges of faces, which would count twice.
    const glm::dvec2 q = project(position) + 1e-9 * scene_->scale_ * glm::dvec2(0.6180339887, 0.4142135623);
    // Whether the ray towards the sun meets the face; its plane must lie ahead.
    const auto meets = [&](const Face& face) {
        if (q.x < face.low.x || q.x > face.high.x || q.y < face.low.y || q.y > face.high.y) return false;
        if (!inside(face.outline, q)) return false;
        const glm::dvec3 normalOf = face.region->normal;
        return glm::dot(face.region->corners[0] - position, normalOf) / glm::dot(sun_, normalOf) >
               1e-9 * scene_->scale_;
    };
    glm::dvec3 through(1);
    bool leaves = false;
    for (const Face& pane : openings_)
        if (meets(pane)) through *= pane.transmittance, leaves = true;
    if (!leaves || std::any_of(opaque_.begin(), opaque_.end(), meets)) return glm::vec3(0);
    return glm::vec3(through * cosine);
}

} // namespace heliodon::compute
