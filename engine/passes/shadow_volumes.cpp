#include "engine/passes/shadow_volumes.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <span>

#include <glm/geometric.hpp>

namespace heliodon::passes {

ShadowCasters::ShadowCasters(const geometry::PatchMesh& mesh)
    : vertices_(mesh.vertices.begin(), mesh.vertices.end()) {
    std::map<std::pair<uint32_t, uint32_t>, std::vector<Use>> byEdge;
    const auto add = [&](std::span<const uint32_t> corner, const glm::dvec3& normal) {
        const uint32_t caster = static_cast<uint32_t>(normals_.size());
        normals_.push_back(normal);
        corners_.insert(corners_.end(), corner.begin(), corner.end());
        firstCorner_.push_back(static_cast<uint32_t>(corners_.size()));
        for (size_t k = 0; k < corner.size(); ++k) {
            const uint32_t a = corner[k], b = corner[(k + 1) % corner.size()];
            byEdge[{std::min(a, b), std::max(a, b)}].push_back({caster, a < b});
        }
    };
    for (size_t p = 0; p < mesh.patchCount(); ++p)
        if (!mesh.materials[mesh.material[p]].isOpening())
            add(mesh.patch(p), geometry::patchAreaVector(mesh, p));
    const std::vector<glm::dvec3>& points = mesh.outside.vertices;
    const std::vector<uint32_t>& triangles = mesh.outside.triangles;
    const auto first = static_cast<uint32_t>(vertices_.size());
    vertices_.insert(vertices_.end(), points.begin(), points.end());
    for (size_t t = 0; t < triangles.size(); t += 3) {
        const glm::dvec3 a = points[triangles[t]], b = points[triangles[t + 1]], c = points[triangles[t + 2]];
        add(std::array{first + triangles[t], first + triangles[t + 1], first + triangles[t + 2]},
            glm::cross(b - a, c - a));
    }
    for (const auto& [ends, uses] : byEdge) {
        edges_.push_back({ends.first, ends.second, static_cast<uint32_t>(uses_.size()),
                          static_cast<uint32_t>(uses.size())});
        uses_.insert(uses_.end(), uses.begin(), uses.end());
    }
}

ShadowCasters::Volumes ShadowCasters::volumes(glm::dvec3 towardsSun, const SunPlane& wanted) const {
    Volumes out;
    std::vector<glm::vec4>& points = out.corners;
    const auto point = [&](uint32_t v) { return glm::vec4(vertices_[v], 1); };
    // Which side an edge-on patch is given to does not matter: its volume has no inside. It must only be the
    // same for its cap and for its edges.
    std::vector<bool> facesSun(normals_.size()), casts(normals_.size());
    std::vector<glm::vec3> outline;
    for (size_t i = 0; i < normals_.size(); ++i) {
        facesSun[i] = glm::dot(normals_[i], towardsSun) >= 0;
        const uint32_t first = firstCorner_[i];
        outline.clear();
        for (uint32_t c = first; c < firstCorner_[i + 1]; ++c) outline.push_back(vertices_[corners_[c]]);
        casts[i] = wanted.touches(outline);
        if (!casts[i]) continue;
        for (uint32_t c = first + 1; c + 1 < firstCorner_[i + 1]; ++c) {
            const uint32_t second = facesSun[i] ? corners_[c] : corners_[c + 1];
            const uint32_t third = facesSun[i] ? corners_[c + 1] : corners_[c];
            points.insert(points.end(), {point(corners_[first]), point(second), point(third)});
        }
    }
    out.capCorners = static_cast<uint32_t>(points.size());
    const glm::vec4 infinity(glm::vec3(-towardsSun), 0);
    for (const Edge& edge : edges_) {
        int count = 0; // casters, seen from the sun, that go from -> to, less those that go back
        for (uint32_t u = edge.firstUse; u < edge.firstUse + edge.useCount; ++u)
            if (casts[uses_[u].caster]) count += uses_[u].forward == facesSun[uses_[u].caster] ? 1 : -1;
        const uint32_t a = count > 0 ? edge.from : edge.to, b = count > 0 ? edge.to : edge.from;
        for (int k = 0; k < std::abs(count); ++k) points.insert(points.end(), {point(b), point(a), infinity});
    }
    return out;
}

} // namespace heliodon::passes
