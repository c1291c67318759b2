#include "compute/patch_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "compute/narrow_gaps.h"
#include "geometry/bounds.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"

namespace heliodon::compute {

namespace {

using glm::dvec3;

// Where a blocker stands on or passes through a plane.
struct Foot {
    dvec3 from, to;
};

constexpr double kWorthCutting = 0.3; // see cutWorth
constexpr double kSliver = 1e-7;      // of what was cut: rounding

std::vector<Foot> feetOn(const dvec3& point, const dvec3& normal, uint32_t room,
                         std::span<const ConvexRegion> blockers, double flat) {
    std::vector<Foot> feet;
    for (const ConvexRegion& blocker : blockers) {
        if (blocker.room != room) continue;
        std::vector<dvec3> on;
        const auto& c = blocker.corners;
        for (size_t k = 0; k < c.size(); ++k) {
            const dvec3 &a = c[k], &b = c[(k + 1) % c.size()];
            const double h = glm::dot(normal, a - point), g = glm::dot(normal, b - point);
            if (std::abs(h) <= flat) on.push_back(a);
            if ((h > flat && g < -flat) || (h < -flat && g > flat)) on.push_back(a + h / (h - g) * (b - a));
        }
        // One point is a corner that touches; more than two are a blocker that lies in the plane.
        if (on.size() == 2 && glm::length(on[1] - on[0]) > flat) feet.push_back({on[0], on[1]});
    }
    return feet;
}

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

    void addRoot(std::vector<PatchTree::Leaf> leaves, const dvec3& normal, uint32_t room,
                 std::vector<Foot> feet) {
        PatchTree::Node root;
        root.normal = normal;
        root.room = room;
        root.covered = leaves[0].across != PatchTree::kNone;
        root.firstLeaf = static_cast<uint32_t>(tree_.leaves.size());
        root.leafCount = static_cast<uint32_t>(leaves.size());
        tree_.leaves.insert(tree_.leaves.end(), leaves.begin(), leaves.end());
        tree_.nodes.push_back(root);
        feet_.push_back(std::move(feet));
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
        const auto begin = tree_.leaves.begin() + node.firstLeaf;
        measure(node, u, v);
        if (node.leafCount > 1) {
            node.child = static_cast<uint32_t>(tree_.nodes.size());
            std::vector<Foot> feet = std::move(feet_[index]);
            std::erase_if(feet, [&](const Foot& foot) { return cutWorth(node, foot) == 0; });
            const uint32_t low = divide(node, feet);
            for (uint32_t half = 0; half < 2; ++half) {
                PatchTree::Node child;
                child.normal = node.normal;
                child.room = node.room;
                child.covered = node.covered;
                child.parent = index;
                child.firstLeaf = node.firstLeaf + half * low;
                child.leafCount = half ? node.leafCount - low : low;
                tree_.nodes.push_back(child);
                feet_.push_back(feet);
            }
        } else {
            begin->node = index;
            feet_[index] = std::vector<Foot>();
        }
        tree_.nodes[index] = node;
    }

    auto below(const PatchTree::Node& node, const Foot& foot) const {
        const dvec3 across = glm::cross(node.normal, foot.to - foot.from);
        return [across, at = 3 * glm::dot(across, foot.from)](const PatchTree::Leaf& leaf) {
            return glm::dot(across, leaf.corner[0] + leaf.corner[1] + leaf.corner[2]) < at;
        };
    }

    // The more, the more of the cluster's width a foot takes and the more evenly it divides the triangles.
    double cutWorth(const PatchTree::Node& node, const Foot& foot) const {
        const dvec3 along = glm::normalize(foot.to - foot.from), d = node.centre - foot.from;
        const double middle = glm::dot(d, along), off = glm::length(d - middle * along);
        if (off >= node.radius) return 0;
        const double half = std::sqrt(node.radius * node.radius - off * off);
        const double inside =
            std::min(middle + half, glm::length(foot.to - foot.from)) - std::max(middle - half, 0.0);
        if (inside <= 0) return 0;
        const auto begin = tree_.leaves.begin() + node.firstLeaf;
        const auto low = static_cast<double>(std::count_if(begin, begin + node.leafCount, below(node, foot)));
        return inside / node.radius * std::sqrt(std::min(low, node.leafCount - low) / node.leafCount);
    }

    // Orders the triangles so that the first ones, as many as it returns, become one child.
    uint32_t divide(const PatchTree::Node& node, const std::vector<Foot>& feet) {
        const auto begin = tree_.leaves.begin() + node.firstLeaf, end = begin + node.leafCount;
        const Foot* best = nullptr;
        double worth = kWorthCutting;
        for (const Foot& foot : feet)
            if (const double w = cutWorth(node, foot); w > worth) worth = w, best = &foot;
        if (best) return static_cast<uint32_t>(std::stable_partition(begin, end, below(node, *best)) - begin);
        // Across the longer axis of its spread, half of the triangles each.
        const dvec3 axis = node.axisU;
        const auto middle = begin + node.leafCount / 2;
        std::nth_element(begin, middle, end, [&](const PatchTree::Leaf& a, const PatchTree::Leaf& b) {
            const double x = glm::dot(a.corner[0] + a.corner[1] + a.corner[2], axis),
                         y = glm::dot(b.corner[0] + b.corner[1] + b.corner[2], axis);
            return x < y || (x == y && a.patch < b.patch);
        });
        return node.leafCount / 2;
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
        for (uint32_t k = node.firstLeaf; k < node.firstLeaf + node.leafCount; ++k) {
            const auto& c = tree_.leaves[k].corner;
            const auto at = PatchTree::coordinates(node, (c[0] + c[1] + c[2]) / 3.0);
            node.reachU = std::max(node.reachU, std::abs(at[0]));
            node.reachV = std::max(node.reachV, std::abs(at[1]));
        }
    }

    PatchTree& tree_;
    std::vector<std::vector<Foot>> feet_; // per node, of what its parent holds; none once it was divided
};

// A fan of triangles; those that cuts left without area, and less than `least`, are left out.
void addLeaves(std::span<const dvec3> outline, uint32_t patch, double least,
               std::vector<PatchTree::Leaf>& leaves) {
    for (size_t k = 1; k + 1 < outline.size(); ++k) {
        PatchTree::Leaf leaf{.corner = {outline[0], outline[k], outline[k + 1]}, .patch = patch};
        leaf.area =
            0.5 * glm::length(glm::cross(leaf.corner[1] - leaf.corner[0], leaf.corner[2] - leaf.corner[0]));
        if (leaf.area > least) leaves.push_back(leaf);
    }
}

// Triangles of all overlaps, by the plane of their patch; `across` numbers them until the tree is done.
std::vector<std::vector<PatchTree::Leaf>> coveredLeaves(const geometry::PatchMesh& mesh,
                                                        const NarrowGaps& gaps,
                                                        std::span<const uint32_t> plane, size_t planes) {
    std::vector<std::vector<PatchTree::Leaf>> result(planes);
    uint32_t count = 0;
    for (const NarrowGaps::Overlap& overlap : gaps.overlaps) {
        std::vector<PatchTree::Leaf> own;
        const double size = overlap.area(), patch = std::min(geometry::patchArea(mesh, overlap.first),
                                                             geometry::patchArea(mesh, overlap.second));
        addLeaves(overlap.outline, overlap.first, kSliver * size, own);
        for (PatchTree::Leaf& leaf : own) {
            const double border = geometry::perimeter(leaf.corner);
            leaf.misses =
                std::min(0.5 * overlap.gap * border / leaf.area, 1.0) * std::sqrt(leaf.area / patch);
            leaf.across = count + 1;
            PatchTree::Leaf other = leaf;
            other.patch = overlap.second;
            other.across = count;
            const dvec3 up =
                glm::normalize(glm::cross(leaf.corner[1] - leaf.corner[0], leaf.corner[2] - leaf.corner[0]));
            for (size_t k = 0; k < 3; ++k) other.corner[k] = leaf.corner[2 - k] + overlap.gap * up;
            result[plane[overlap.first]].push_back(leaf);
            result[plane[overlap.second]].push_back(other);
            count += 2;
        }
    }
    return result;
}

// Numbers of covered leaves become their places in the tree; the two of a pair differ in the last bit.
void joinAcross(PatchTree& tree) {
    std::vector<uint32_t> place(tree.leaves.size());
    for (uint32_t k = 0; k < tree.leaves.size(); ++k)
        if (const uint32_t across = tree.leaves[k].across; across != PatchTree::kNone) place[across ^ 1u] = k;
    for (PatchTree::Leaf& leaf : tree.leaves)
        if (leaf.across != PatchTree::kNone) leaf.across = place[leaf.across];
}

} // namespace

std::array<double, 2> PatchTree::coordinates(const Node& node, const dvec3& point) {
    const dvec3 d = point - node.centre;
    return {glm::dot(d, node.axisU) / glm::dot(node.axisU, node.axisU),
            glm::dot(d, node.axisV) / glm::dot(node.axisV, node.axisV)};
}

PatchTree buildPatchTree(const geometry::PatchMesh& mesh, std::span<const ConvexRegion> blockers) {
    PatchTree tree;
    const double flat = mesh.vertices.empty() ? 0 : kSamePlane * geometry::boundsOf(mesh.vertices).diagonal();
    const std::vector<uint32_t> plane = planeNumbers(mesh);
    std::vector<std::vector<size_t>> patches; // of each plane
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (plane[i] >= patches.size()) patches.resize(plane[i] + 1);
        patches[plane[i]].push_back(i);
    }
    const NarrowGaps gaps = narrowGaps(mesh, plane);
    std::vector<std::vector<PatchTree::Leaf>> covered = coveredLeaves(mesh, gaps, plane, patches.size());
    Builder builder(tree);
    for (size_t k = 1; k < patches.size(); ++k) { // the first has no area
        dvec3 sum{0};
        std::vector<PatchTree::Leaf> leaves;
        for (size_t i : patches[k]) {
            sum += geometry::patchAreaVector(mesh, i);
            const auto patch = static_cast<uint32_t>(i);
            if (const auto found = gaps.open.find(patch); found == gaps.open.end())
                addLeaves(geometry::patchCorners(mesh, i), patch, 0, leaves);
            else
                for (const std::vector<dvec3>& part : found->second)
                    addLeaves(part, patch, kSliver * geometry::patchArea(mesh, i), leaves);
        }
        const dvec3 normal = glm::normalize(sum);
        const uint32_t room = mesh.room[patches[k][0]];
        if (!covered[k].empty()) builder.addRoot(std::move(covered[k]), normal, room, {});
        if (leaves.empty()) continue;
        std::vector<Foot> feet = feetOn(leaves[0].corner[0], normal, room, blockers, flat);
        builder.addRoot(std::move(leaves), normal, room, std::move(feet));
    }
    builder.split();
    joinAcross(tree);
    return tree;
}

} // namespace heliodon::compute
