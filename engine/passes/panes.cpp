#include "engine/passes/panes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <tuple>

#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"
#include "shaders/io/scene.io.h"

namespace heliodon::passes {

namespace {

using geometry::PatchMesh;

bool everyRoomIsClosed(const PatchMesh& mesh) {
    // Positions, not indices: rooms may be drawn from meshes whose patches do not share vertices.
    std::map<std::tuple<double, double, double>, uint32_t> ids;
    std::vector<uint32_t> id(mesh.vertices.size());
    for (size_t i = 0; i < id.size(); ++i) {
        const glm::dvec3& v = mesh.vertices[i];
        id[i] = ids.try_emplace({v.x, v.y, v.z}, static_cast<uint32_t>(ids.size())).first->second;
    }
    std::map<std::tuple<uint32_t, uint32_t, uint32_t>, int> balance;
    for (size_t p = 0; p < mesh.patchCount(); ++p) {
        const auto corner = mesh.patch(p);
        for (size_t k = 0; k < corner.size(); ++k) {
            const uint32_t a = id[corner[k]], b = id[corner[(k + 1) % corner.size()]];
            if (a != b) balance[{mesh.room[p], std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
        }
    }
    return std::all_of(balance.begin(), balance.end(), [](const auto& e) { return e.second == 0; });
}

// Edges with one patch of the group on one side only, straight runs joined.
std::vector<glm::dvec3> outline(const PatchMesh& mesh, const std::vector<uint32_t>& patches) {
    std::set<std::pair<uint32_t, uint32_t>> directed;
    for (uint32_t p : patches) {
        const auto corner = mesh.patch(p);
        for (size_t k = 0; k < corner.size(); ++k) {
            const uint32_t a = corner[k], b = corner[(k + 1) % corner.size()];
            if (directed.erase({b, a}) == 0) directed.insert({a, b});
        }
    }
    std::map<uint32_t, uint32_t> next;
    bool simple = true;
    for (const auto& [a, b] : directed) simple &= next.emplace(a, b).second;
    if (simple) {
        std::map<uint32_t, uint32_t> previous;
        for (const auto& [a, b] : next) previous[b] = a;
        const std::vector<std::pair<uint32_t, uint32_t>> all(next.begin(), next.end());
        for (const auto& [v, unused] : all) {
            if (!next.contains(v) || !previous.contains(v)) continue;
            const uint32_t a = previous[v], b = next[v];
            if (a == b || next.size() <= 3) continue;
            const glm::dvec3 in = mesh.vertices[v] - mesh.vertices[a],
                             out = mesh.vertices[b] - mesh.vertices[v];
            const bool straight = glm::dot(in, out) > 0 && glm::length(glm::cross(in, out)) <
                                                               1e-9 * glm::length(in) * glm::length(out);
            if (!straight) continue;
            next[a] = b;
            previous[b] = a;
            next.erase(v);
            previous.erase(v);
        }
        directed = {next.begin(), next.end()};
    }
    std::vector<glm::dvec3> edges;
    for (const auto& [a, b] : directed) edges.insert(edges.end(), {mesh.vertices[a], mesh.vertices[b]});
    return edges;
}

} // namespace

Panes::Panes(const PatchMesh& mesh) : closed_(everyRoomIsClosed(mesh)) {
    for (const geometry::Material& material : mesh.materials) windows_.emplace_back(material);
    // Patches of one glass lie in one plane; a bent one is taken apart.
    std::map<std::tuple<uint32_t, uint32_t, uint32_t, bool>, std::vector<uint32_t>> groups;
    for (uint32_t p = 0; p < mesh.patchCount(); ++p)
        if (mesh.materials[mesh.material[p]].isOpening())
            groups[{mesh.surface[p], mesh.room[p], mesh.material[p], mesh.twin[p] != geometry::kNoTwin}]
                .push_back(p);
    for (const auto& [key, patches] : groups) {
        const glm::dvec3 normal = geometry::patchNormal(mesh, patches.front());
        const glm::dvec3 point = mesh.vertices[mesh.patch(patches.front())[0]];
        const bool flat = std::all_of(patches.begin(), patches.end(), [&](uint32_t p) {
            if (glm::dot(geometry::patchNormal(mesh, p), normal) < 1 - 1e-9) return false;
            const auto corner = mesh.patch(p);
            return std::all_of(corner.begin(), corner.end(), [&](uint32_t v) {
                const glm::dvec3 offset = mesh.vertices[v] - point;
                return std::abs(glm::dot(offset, normal)) <= 1e-6 * (1e-3 + glm::length(offset));
            });
        });
        if (flat)
            addPane(mesh, patches);
        else
            for (uint32_t p : patches) addPane(mesh, {p});
    }
}

void Panes::addPane(const PatchMesh& mesh, const std::vector<uint32_t>& patches) {
    Pane pane;
    glm::dvec3 normal{0};
    for (uint32_t p : patches) normal += geometry::patchAreaVector(mesh, p);
    if (!(glm::length(normal) > 0)) return;
    pane.normal = glm::normalize(normal);
    pane.point = mesh.vertices[mesh.patch(patches.front())[0]];
    pane.material = mesh.material[patches.front()];
    pane.hasTwin = mesh.twin[patches.front()] != geometry::kNoTwin;
    pane.edges = outline(mesh, patches);
    panes_.push_back(std::move(pane));
}

SunPaneData Panes::seenFromSun(glm::dvec3 towardsSun) const {
    const glm::dvec3 u = geometry::perpendicular(towardsSun), v = glm::cross(towardsSun, u);
    SunPaneData data;
    std::vector<io::SunPane> list;
    for (const Pane& pane : panes_) {
        const double cosine = glm::dot(pane.normal, towardsSun);
        if (std::abs(cosine) < 1e-9 || (pane.hasTwin && cosine > 0)) continue;
        io::SunPane out{};
        out.normal = pane.normal / cosine;
        out.offset = static_cast<float>(glm::dot(pane.normal, pane.point) / cosine);
        out.transmittance =
            windows_[pane.material].straight(towardsSun, cosine < 0 ? pane.normal : -pane.normal);
        out.firstEdge = static_cast<uint32_t>(data.edges.size());
        out.edgeCount = static_cast<uint32_t>(pane.edges.size() / 2);
        out.leaves = cosine < 0;
        for (size_t k = 0; k < pane.edges.size(); k += 2) {
            const glm::dvec3 &a = pane.edges[k], &b = pane.edges[k + 1];
            data.edges.emplace_back(glm::dot(a, u), glm::dot(a, v), glm::dot(b, u), glm::dot(b, v));
        }
        list.push_back(out);
    }
    if (data.edges.empty()) data.edges.emplace_back(0.0f);
    const io::SunPaneHeader header{glm::vec3(u), glm::vec3(v), static_cast<uint32_t>(list.size()),
                                   closed_ ? 1u : 0u};
    data.panes.resize(sizeof header + list.size() * sizeof(io::SunPane));
    std::memcpy(data.panes.data(), &header, sizeof header);
    if (!list.empty())
        std::memcpy(data.panes.data() + sizeof header, list.data(), list.size() * sizeof(io::SunPane));
    return data;
}

} // namespace heliodon::passes
