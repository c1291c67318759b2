// P. Hanrahan, D. Salzman, L. Aupperle, "A Rapid Hierarchical Radiosity Algorithm", 1991, with links that
// vary linearly over both ends.
#include "compute/reference/hierarchical.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include <glm/geometric.hpp>

#include "compute/reference/exact_form_factors.h"

namespace heliodon::compute::reference {

namespace {

using Node = PatchTree::Node;

double kernelBetween(const glm::dvec3& x, const glm::dvec3& nx, const glm::dvec3& y, const glm::dvec3& ny) {
    const glm::dvec3 d = y - x;
    const double r2 = glm::dot(d, d);
    return std::max(0.0, glm::dot(nx, d)) * std::max(0.0, -glm::dot(ny, d)) / (std::numbers::pi * r2 * r2);
}

class OpenLinks {
public:
    OpenLinks(const PatchTree& tree, double tolerance) : tree_(tree), tolerance_(tolerance) {}

    void pair(uint32_t i, uint32_t j) {
        const Node &p = tree_.nodes[i], &q = tree_.nodes[j];
        if (p.room != q.room) return;
        if (p.child == 0 && q.child == 0)
            triangles(i, j);
        else
            clusters(i, j);
    }

    std::vector<Link> links;

private:
    void triangles(uint32_t i, uint32_t j) {
        const auto polygon = [&](uint32_t node) {
            const auto& corner = tree_.leaves[tree_.nodes[node].firstLeaf].corner;
            return Polygon(corner.begin(), corner.end());
        };
        const double exchange = exchangeUnoccluded(polygon(i), polygon(j));
        if (exchange > 0)
            links.push_back({i, j, exchange / (tree_.nodes[i].area * tree_.nodes[j].area), {}, 0});
    }

    void clusters(uint32_t i, uint32_t j) {
        const Node &p = tree_.nodes[i], &q = tree_.nodes[j];
        const glm::dvec3 d = q.centre - p.centre;
        const double distance = glm::length(d), tilt = glm::length(glm::cross(p.normal, q.normal)),
                     heightQ = glm::dot(p.normal, d), heightP = -glm::dot(q.normal, d),
                     flat = 1e-6 * (distance + p.radius + q.radius);
        if (heightQ + q.radius * tilt <= flat || heightP + p.radius * tilt <= flat) return;

        Link link{i, j, kernelBetween(p.centre, p.normal, q.centre, q.normal), {}, 0};
        const double middle = link.density;
        const std::array<glm::dvec3, 4> axes{p.axisU, p.axisV, q.axisU, q.axisV};
        double bends = 0, squares = 0, steepness = 0;
        for (size_t k = 0; k < 4; ++k) {
            const auto off = [&](double sign) {
                const glm::dvec3 step = sign * axes[k], none(0);
                return kernelBetween(p.centre + (k < 2 ? step : none), p.normal,
                                     q.centre + (k < 2 ? none : step), q.normal);
            };
            const double up = off(1), down = off(-1), bend = up + down - 2 * middle;
            link.density += 0.5 * bend;
            link.slopes[k] = 0.5 * (up - down);
            bends += std::abs(bend);
            squares += bend * bend;
            steepness += std::abs(link.slopes[k]);
        }
        const bool wholly = heightQ > q.radius * tilt && heightP > p.radius * tilt;
        if (!wholly || p.radius + q.radius >= 0.8 * distance ||
            std::max(p.area, q.area) * bends > tolerance_ || link.density <= 2 * steepness)
            return split(i, j);
        for (double& slope : link.slopes) slope /= link.density;
        link.error = 0.8 * std::sqrt(squares);
        links.push_back(link);
    }

    // The larger into its children, or both where they are alike.
    void split(uint32_t i, uint32_t j) {
        const Node &p = tree_.nodes[i], &q = tree_.nodes[j];
        const bool alike = std::max(p.radius, q.radius) < 1.5 * std::min(p.radius, q.radius);
        const bool both = p.child && q.child && alike,
                   splitP = both || (p.child && (q.child == 0 || p.radius >= q.radius)),
                   splitQ = both || !splitP;
        for (uint32_t k = 0; k < (splitP ? 2u : 1u); ++k)
            for (uint32_t l = 0; l < (splitQ ? 2u : 1u); ++l)
                pair(splitP ? p.child + k : i, splitQ ? q.child + l : j);
    }

    const PatchTree& tree_;
    double tolerance_;
};

} // namespace

std::vector<Link> openLinks(const PatchTree& tree, double tolerance) {
    OpenLinks made(tree, tolerance);
    const uint32_t roots = tree.nodes.empty() ? 0 : tree.levelFirst[1];
    for (uint32_t a = 0; a < roots; ++a)
        for (uint32_t b = a + 1; b < roots; ++b) made.pair(a, b);
    std::sort(made.links.begin(), made.links.end(), [](const Link& a, const Link& b) {
        return std::tie(a.first, a.second) < std::tie(b.first, b.second);
    });
    return made.links;
}

} // namespace heliodon::compute::reference
