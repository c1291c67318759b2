#include "compute/bvh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "compute/texel.h"
#include "shaders/io/bvh.io.h"

namespace heliodon::compute {

namespace {

using glm::dvec3;

constexpr uint32_t kLeafMost = 4;     // triangles; under io::kBvhLeafMost
constexpr double kTriangleCost = 1.3; // over that of a box
constexpr int kBins = 16;

struct Box {
    dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

    void grow(const dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
    void grow(const Box& b) { low = glm::min(low, b.low), high = glm::max(high, b.high); }
    double halfArea() const {
        const dvec3 d = high - low;
        return d.x < 0 ? 0 : d.x * d.y + d.y * d.z + d.z * d.x;
    }
};

struct Node {
    Box box;
    uint32_t left = 0, right = 0; // children; 0: a leaf
    uint32_t first = 0, count = 0;
    int axis = 0;
};

class Builder {
public:
    explicit Builder(const std::vector<BvhTriangle>& triangles) {
        for (const BvhTriangle& t : triangles) {
            Box box;
            for (const dvec3& p : t.corner) box.grow(p);
            boxes_.push_back(box);
            middles_.push_back(0.5 * (box.low + box.high));
            order.push_back(static_cast<uint32_t>(order.size()));
        }
        if (!order.empty()) build(0, static_cast<uint32_t>(order.size()), 0);
    }

    std::vector<Node> nodes;
    std::vector<uint32_t> order;

private:
    struct Split {
        double cost = std::numeric_limits<double>::infinity();
        int axis = 0, bin = 0;
    };

    static int binOf(double x, double low, double scale) {
        return std::clamp(static_cast<int>((x - low) * scale), 0, kBins - 1);
    }

    Split bestSplit(uint32_t first, uint32_t count, const Box& middles) const {
        Split best;
        for (int axis = 0; axis < 3; ++axis) {
            const double extent = middles.high[axis] - middles.low[axis];
            if (!(extent > 0)) continue;
            std::array<Box, kBins> box;
            std::array<uint32_t, kBins> in{};
            const double scale = kBins / extent;
            for (uint32_t k = first; k < first + count; ++k) {
                const auto bin =
                    static_cast<size_t>(binOf(middles_[order[k]][axis], middles.low[axis], scale));
                box[bin].grow(boxes_[order[k]]);
                ++in[bin];
            }
            std::array<double, kBins> right{};
            Box sum;
            uint32_t n = 0;
            for (size_t b = kBins - 1; b > 0; --b) {
                sum.grow(box[b]), n += in[b];
                right[b] = sum.halfArea() * n;
            }
            sum = {}, n = 0;
            for (size_t b = 0; b + 1 < kBins; ++b) {
                sum.grow(box[b]), n += in[b];
                const double cost = sum.halfArea() * n + right[b + 1];
                if (n > 0 && n < count && cost < best.cost) best = {cost, axis, static_cast<int>(b)};
            }
        }
        return best;
    }

    uint32_t build(uint32_t first, uint32_t count, int depth) {
        const auto index = static_cast<uint32_t>(nodes.size());
        Node node;
        Box middles;
        for (uint32_t k = first; k < first + count; ++k) {
            node.box.grow(boxes_[order[k]]);
            middles.grow(middles_[order[k]]);
        }
        node.first = first, node.count = count;
        nodes.push_back(node);
        if (count <= 1) return index;
        const Split split = bestSplit(first, count, middles);
        const double area = std::max(node.box.halfArea(), 1e-300);
        if (count <= kLeafMost && !(split.cost * kTriangleCost + 2 * area < kTriangleCost * count * area))
            return index;
        const auto begin = order.begin() + first, end = begin + count;
        auto middle = begin + count / 2;
        // Beyond a sane depth, or with all middles in one place, halves by number keep the depth bounded.
        if (std::isfinite(split.cost) && depth < 64) {
            const double low = middles.low[split.axis],
                         scale = kBins / (middles.high[split.axis] - middles.low[split.axis]);
            middle = std::stable_partition(begin, end, [&](uint32_t t) {
                return binOf(middles_[t][split.axis], low, scale) <= split.bin;
            });
        }
        const auto left = static_cast<uint32_t>(middle - begin);
        nodes[index].axis = split.axis;
        const uint32_t l = build(first, left, depth + 1);
        nodes[index].left = l;
        const uint32_t r = build(first + left, count - left, depth + 1);
        nodes[index].right = r;
        return index;
    }

    std::vector<Box> boxes_;
    std::vector<dvec3> middles_;
};

// Depth first with the near child first for directions of one octant (bit a set: negative along axis a).
class Flattener {
public:
    Flattener(const std::vector<Node>& nodes, const Bvh& bvh, uint32_t octant, std::vector<glm::uvec4>& out)
        : nodes_(nodes), bvh_(bvh), octant_(octant), out_(out), base_(out.size() / 2) {
        if (!nodes.empty()) add(0);
    }

private:
    void add(uint32_t index) {
        const Node& node = nodes_[index];
        const size_t at = out_.size();
        const dvec3 pad(2e-7 * bvh_.diagonal); // rounding of float32 positions and of the slab test
        const uint32_t leaf = node.right == 0 ? node.first * 2 * io::kBvhLeafMost + node.count : 0;
        out_.push_back(texelOf(node.box.low - bvh_.centre - pad, 0));
        out_.push_back(texelOf(node.box.high - bvh_.centre + pad, leaf));
        if (node.right != 0) {
            const bool swap = (octant_ >> node.axis) & 1u;
            add(swap ? node.right : node.left);
            add(swap ? node.left : node.right);
        }
        out_[at].w = static_cast<uint32_t>(out_.size() / 2 - base_);
    }

    const std::vector<Node>& nodes_;
    const Bvh& bvh_;
    uint32_t octant_;
    std::vector<glm::uvec4>& out_;
    size_t base_;
};

} // namespace

std::vector<BvhTriangle> bvhTriangles(const geometry::PatchMesh& mesh) {
    std::vector<BvhTriangle> result;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const auto c = mesh.patch(i);
        for (size_t k = 1; k + 1 < c.size(); ++k)
            result.push_back({{mesh.vertices[c[0]], mesh.vertices[c[k]], mesh.vertices[c[k + 1]]},
                              static_cast<uint32_t>(i),
                              mesh.room[i]});
    }
    return result;
}

Bvh buildBvh(gpu::Device& device, std::vector<BvhTriangle> triangles) {
    Bvh result;
    Box all;
    for (const BvhTriangle& t : triangles)
        for (const dvec3& p : t.corner) all.grow(p);
    if (!triangles.empty()) {
        result.centre = 0.5 * (all.low + all.high);
        result.diagonal = std::max(glm::length(all.high - all.low), 1e-30);
    }
    const Builder builder(triangles);
    std::vector<glm::uvec4> nodes, corners;
    for (uint32_t octant = 0; octant < 8; ++octant) Flattener(builder.nodes, result, octant, nodes);
    for (uint32_t t : builder.order) {
        const BvhTriangle& triangle = triangles[t];
        const auto& c = triangle.corner;
        const dvec3 e = c[1] - c[0], f = c[2] - c[0], area = glm::cross(e, f); // twice the area
        const double inverse = 1 / std::max(glm::length(area), 1e-30);
        const dvec3 normal = area * inverse;
        corners.push_back(texelOf(c[0] - result.centre, triangle.patch));
        corners.push_back(texelOf(normal, triangle.room));
        corners.push_back(texelOf(glm::cross(f, normal) * inverse, 0));
        corners.push_back(texelOf(glm::cross(normal, e) * inverse, 0));
    }
    result.nodeCount = static_cast<uint32_t>(builder.nodes.size());
    result.nodes = gpu::Buffer::from(device, nodes, "bvh nodes");
    result.triangles = gpu::Buffer::from(device, corners, "bvh triangles");
    return result;
}

} // namespace heliodon::compute
