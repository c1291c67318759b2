#include "compute/sun_patches.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "compute/daylight/glazing.h"
#include "geometry/perpendicular.h"

namespace heliodon::compute {

namespace {

using Polygon = std::vector<glm::dvec2>;

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

SunPatches::SunPatches(const geometry::PatchMesh& mesh, glm::dvec3 towardsSun)
    : mesh_(&mesh), sun_(glm::normalize(towardsSun)) {
    across_ = geometry::perpendicular(sun_);
    up_ = glm::cross(sun_, across_);
    glm::dvec3 low(1e300), high(-1e300);
    for (const glm::dvec3& v : mesh.vertices) low = glm::min(low, v), high = glm::max(high, v);
    scale_ = mesh.vertices.empty() ? 1 : glm::length(high - low);
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const double facing = glm::dot(geometry::patchNormal(mesh, i), sun_);
        if (std::abs(facing) < 1e-9) continue; // edge-on: neither lit nor in the way
        Face face;
        face.patch = static_cast<uint32_t>(i);
        for (uint32_t corner : mesh.patch(i)) face.outline.push_back(project(mesh.vertices[corner]));
        if (facing < 0) std::reverse(face.outline.begin(), face.outline.end());
        const Box box(face.outline);
        face.low = box.low, face.high = box.high;
        const geometry::Material& material = mesh.materials[mesh.material[i]];
        if (facing > 0) receivers_.push_back(face);
        if (!material.isOpening()) {
            opaque_.push_back(std::move(face));
        } else if (facing < 0) {
            face.transmittance = daylight::glazingOf(material).transmittance(-facing);
            openings_.push_back(std::move(face));
        }
    }
    if (std::all_of(openings_.begin(), openings_.end(),
                    [&](const Face& f) { return mesh.twin[f.patch] != geometry::kNoTwin; }))
        openings_.clear(); // interior glass alone lets no sun in
}

std::vector<glm::dvec2> SunPatches::inFrontOf(uint32_t patch, glm::dvec3 point, glm::dvec3 normal) const {
    const auto corners = mesh_->patch(patch);
    const double least = 1e-9 * scale_;
    Polygon result;
    bool any = false;
    for (size_t k = 0; k < corners.size(); ++k) {
        const glm::dvec3 a = mesh_->vertices[corners[k]],
                         b = mesh_->vertices[corners[(k + 1) % corners.size()]];
        const double ha = glm::dot(a - point, normal), hb = glm::dot(b - point, normal);
        any |= ha > least;
        if (ha >= 0) result.push_back(project(a));
        if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0))
            result.push_back(project(a + (b - a) * (ha / (ha - hb))));
    }
    if (!any || result.size() < 3) return {};
    if (area(result) < 0) std::reverse(result.begin(), result.end());
    return result;
}

// What the opaque patches in front of the receiver leave of a convex outline.
double SunPatches::visibleArea(const Polygon& outline, uint32_t receiver) const {
    const glm::dvec3 normal = geometry::patchNormal(*mesh_, receiver);
    const glm::dvec3 point = mesh_->vertices[mesh_->patch(receiver)[0]];
    const Box box(outline);
    const double least = 1e-9 * area(outline);
    std::vector<Polygon> pieces{outline}, next;
    for (const Face& blocker : opaque_) {
        if (apart(box.low, box.high, blocker.low, blocker.high) || blocker.patch == receiver) continue;
        const Polygon front = inFrontOf(blocker.patch, point, normal);
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

glm::dvec3 SunPatches::onPatch(const Face& receiver) const {
    const uint32_t patch = receiver.patch;
    const glm::dvec3 normal = geometry::patchNormal(*mesh_, patch);
    const glm::dvec3 point = mesh_->vertices[mesh_->patch(patch)[0]];
    const double whole = area(receiver.outline), least = 1e-9 * whole;
    if (whole <= 0) return glm::dvec3(0);
    // Pieces that leave by at least one pane, disjoint: pane by pane, what is new of it is added, and what
    // was there already is dimmed.
    std::vector<Piece> pieces, next;
    std::vector<Polygon> uncovered{receiver.outline}, rest;
    for (const Face& pane : openings_) {
        if (apart(receiver.low, receiver.high, pane.low, pane.high) || pane.patch == patch) continue;
        const Polygon front = inFrontOf(pane.patch, point, normal);
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
    glm::dvec2 low(1e300), high(-1e300);
    for (const Face& pane : openings_) low = glm::min(low, pane.low), high = glm::max(high, pane.high);
    for (const Face& receiver : receivers_)
        if (!apart(receiver.low, receiver.high, low, high))
            result[receiver.patch] = glm::vec3(onPatch(receiver));
    return result;
}

glm::vec3 SunPatches::atPoint(glm::dvec3 position, glm::dvec3 normal) const {
    const double cosine = glm::dot(normal, sun_);
    if (cosine <= 0 || !canEnter()) return glm::vec3(0);
    // Moved by less than any tolerance, off the common edges of triangles, which would count twice.
    const glm::dvec2 q = project(position) + 1e-9 * scale_ * glm::dvec2(0.6180339887, 0.4142135623);
    // Whether the ray towards the sun meets the face; its plane must lie ahead.
    const auto meets = [&](const Face& face) {
        if (q.x < face.low.x || q.x > face.high.x || q.y < face.low.y || q.y > face.high.y) return false;
        if (!inside(face.outline, q)) return false;
        const glm::dvec3 faceNormal = geometry::patchNormal(*mesh_, face.patch);
        const glm::dvec3 corner = mesh_->vertices[mesh_->patch(face.patch)[0]];
        return glm::dot(corner - position, faceNormal) / glm::dot(sun_, faceNormal) > 1e-9 * scale_;
    };
    glm::dvec3 through(1);
    bool leaves = false;
    for (const Face& pane : openings_)
        if (meets(pane)) through *= pane.transmittance, leaves = true;
    if (!leaves || std::any_of(opaque_.begin(), opaque_.end(), meets)) return glm::vec3(0);
    return glm::vec3(through * cosine);
}

} // namespace heliodon::compute
