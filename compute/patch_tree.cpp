#include "compute/patch_tree.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "compute/convex_regions.h"
#include "geometry/perpendicular.h"

namespace heliodon::compute {

namespace {

using glm::dvec3;

// Second moments about a centre along the plane's two directions.
struct Spread {
    double area = 0, uu = 0, uv = 0, vv = 0;
    dvec3 centre{0};
};

Spread spreadOf(const PatchTree::Leaf& leaf, const dvec3& u, const dvec3& v) {
    Spread s;
    s.area = leaf.area;
    s.centre = (leaf.corner[0] + leaf.corner[1] + leaf.corner[2]) / 3.0;
    for (const dvec3& corner : leaf.corner) {
        const double a = glm::dot(corner - s.centre, u), b = glm::dot(corner - s.centre, v);
        s.uu += leaf.area * a * a / 12, s.uv += leaf.area * a * b / 12, s.vv += leaf.area * b * b / 12;
    }
    return s;
}

class Builder {
public:
    explicit Builder(PatchTree& tree) : tree_(tree) {}

    void addRoot(std::vector<PatchTree::Leaf> leaves, const dvec3& normal, uint32_t room) {
        PatchTree::Node root;
        root.normal = normal;
        root.room = room;
        root.firstLeaf = static_cast<uint32_t>(tree_.leaves.size());
        root.leafCount = static_cast<uint32_t>(leaves.size());
        tree_.leaves.insert(tree_.leaves.end(), leaves.begin(), leaves.end());
        tree_.nodes.push_back(root);
    }

    // Level by level, so that a level's nodes are successive and so are the two children of each.
    void split() {
        tree_.levelFirst = {0, static_cast<uint32_t>(tree_.nodes.size())};
        for (size_t level = 0; tree_.levelFirst[level] < tree_.levelFirst[level + 1]; ++level) {
            for (uint32_t k = tree_.levelFirst[level]; k < tree_.levelFirst[level + 1]; ++k) finish(k);
            tree_.levelFirst.push_back(static_cast<uint32_t>(tree_.nodes.size()));
        }
        tree_.levelFirst.pop_back();
    }

private:
    void finish(uint32_t index) {
        PatchTree::Node node = tree_.nodes[index];
        const dvec3 u = geometry::perpendicular(node.normal), v = glm::cross(node.normal, u);
        const auto begin = tree_.leaves.begin() + node.firstLeaf, end = begin + node.leafCount;
        measure(node, u, v);
        if (node.leafCount > 1) {
            node.child = static_cast<uint32_t>(tree_.nodes.size());
            const auto middle = begin + node.leafCount / 2;
            // Across the longer axis of its spread, half of the triangles each.
            const dvec3 axis = node.axisU;
            std::nth_element(begin, middle, end, [&](const PatchTree::Leaf& a, const PatchTree::Leaf& b) {
                const double x = glm::dot(a.corner[0] + a.corner[1] + a.corner[2], axis),
                             y = glm::dot(b.corner[0] + b.corner[1] + b.corner[2], axis);
                return x < y || (x == y && a.patch < b.patch);
            });
            for (uint32_t half = 0; half < 2; ++half) {
                PatchTree::Node child;
                child.normal = node.normal;
                child.room = node.room;
                child.parent = index;
                child.firstLeaf = node.firstLeaf + half * (node.leafCount / 2);
                child.leafCount = half ? node.leafCount - node.leafCount / 2 : node.leafCount / 2;
                tree_.nodes.push_back(child);
            }
        } else {
            begin->node = index;
        }
        tree_.nodes[index] = node;
    }

    void measure(PatchTree::Node& node, const dvec3& u, const dvec3& v) const {
        std::vector<Spread> parts;
        for (uint32_t k = node.firstLeaf; k < node.firstLeaf + node.leafCount; ++k)
            parts.push_back(spreadOf(tree_.leaves[k], u, v));
        dvec3 sum{0};
        for (const Spread& s : parts) node.area += s.area, sum += s.area * s.centre;
        node.centre = sum / node.area;
        double uu = 0, uv = 0, vv = 0;
        for (const Spread& s : parts) {
            const double a = glm::dot(s.centre - node.centre, u), b = glm::dot(s.centre - node.centre, v);
            uu += s.uu + s.area * a * a, uv += s.uv + s.area * a * b, vv += s.vv + s.area * b * b;
        }
        for (uint32_t k = node.firstLeaf; k < node.firstLeaf + node.leafCount; ++k)
            for (const dvec3& corner : tree_.leaves[k].corner)
                node.radius = std::max(node.radius, glm::length(corner - node.centre));
        // Eigenvectors of the 2 x 2 matrix of second moments.
        const double angle = 0.5 * std::atan2(2 * uv, uu - vv);
        const dvec3 along = std::cos(angle) * u + std::sin(angle) * v,
                    across = glm::cross(node.normal, along);
        const double mean = 0.5 * (uu + vv), half = std::hypot(0.5 * (uu - vv), uv);
        const double least = 1e-12 * node.radius * node.radius;
        node.axisU = along * std::sqrt(std::max((mean + half) / node.area, least));
        node.axisV = across * std::sqrt(std::max((mean - half) / node.area, least));
    }

    PatchTree& tree_;
};

void addLeaves(const geometry::PatchMesh& mesh, size_t patch, std::vector<PatchTree::Leaf>& leaves) {
    const auto c = mesh.patch(patch);
    for (size_t k = 1; k + 1 < c.size(); ++k) {
        PatchTree::Leaf leaf{{mesh.vertices[c[0]], mesh.vertices[c[k]], mesh.vertices[c[k + 1]]},
                             static_cast<uint32_t>(patch),
                             0,
                             0};
        leaf.area =
            0.5 * glm::length(glm::cross(leaf.corner[1] - leaf.corner[0], leaf.corner[2] - leaf.corner[0]));
        if (leaf.area > 0) leaves.push_back(leaf);
    }
}

} // namespace

std::array<double, 2> PatchTree::coordinates(const Node& node, const dvec3& point) {
    const dvec3 d = point - node.centre;
    return {glm::dot(d, node.axisU) / glm::dot(node.axisU, node.axisU),
            glm::dot(d, node.axisV) / glm::dot(node.axisV, node.axisV)};
}

PatchTree buildPatchTree(const geometry::PatchMesh& mesh) {
    PatchTree tree;
    const std::vector<uint32_t> plane = planeNumbers(mesh);
    std::vector<std::vector<size_t>> patches; // of each plane
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (plane[i] >= patches.size()) patches.resize(plane[i] + 1);
        patches[plane[i]].push_back(i);
    }
    Builder builder(tree);
    for (size_t k = 1; k < patches.size(); ++k) { // the first has no area
        dvec3 sum{0};
        std::vector<PatchTree::Leaf> leaves;
        for (size_t i : patches[k]) {
            sum += geometry::patchAreaVector(mesh, i);
            addLeaves(mesh, i, leaves);
        }
        if (!leaves.empty())
            builder.addRoot(std::move(leaves), glm::normalize(sum), mesh.room[patches[k][0]]);
    }
    builder.split();
    return tree;
}

} // namespace heliodon::compute
