#include "geometry/necks.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

using Loop = std::vector<glm::dvec2>;

constexpr double kFacing = -0.7; // cosine between edges that run opposite ways
constexpr double kBeyond = 3;    // times the area of the neck, to both sides

class NeckFinder {
public:
    explicit NeckFinder(const MeshDomain& domain) : loops_(domain.planar) {}

    std::vector<Neck> find(double widest) const {
        std::vector<Neck> necks;
        for (size_t l = 0; l < loops_.size(); ++l)
            for (size_t i = 0; i < loops_[l].size(); ++i)
                for (size_t j = i + 2; j < loops_[l].size(); ++j)
                    if (const auto neck = between(l, i, j, widest)) necks.push_back(*neck);
        return necks;
    }

private:
    static glm::dvec2 at(const Loop& loop, size_t k) { return loop[k % loop.size()]; }

    std::optional<Neck> between(size_t l, size_t i, size_t j, double widest) const {
        const Loop& loop = loops_[l];
        const glm::dvec2 a = loop[i], along = glm::normalize(at(loop, i + 1) - a), c = loop[j],
                         opposite = at(loop, j + 1) - c;
        if (glm::dot(along, opposite) > kFacing * glm::length(opposite)) return std::nullopt;
        const double from = glm::dot(c - a, along), to = from + glm::dot(opposite, along);
        const double low = std::max(0.0, to), high = std::min(glm::dot(at(loop, i + 1) - a, along), from);
        if (!(high > low)) return std::nullopt;
        const double middle = 0.5 * (low + high);
        const glm::dvec2 p = a + middle * along, q = c + (middle - from) / (to - from) * opposite;
        const double width = cross(along, q - p); // the domain is on the left
        if (!(width > 0 && width <= widest)) return std::nullopt;
        const Neck neck{l, i, j, width, high - low};
        if (!reachesOn(neck, p, q) || isCrossed(neck, p, q)) return std::nullopt;
        return neck;
    }

    // Whether the line from p to q parts the domain in two of some size.
    bool reachesOn(const Neck& neck, glm::dvec2 p, glm::dvec2 q) const {
        const Loop& loop = loops_[neck.loop];
        double whole = 0, part = cross(loop[neck.second] - p, q - p);
        for (size_t k = 0; k < loop.size(); ++k) whole += cross(loop[k] - p, at(loop, k + 1) - p);
        for (size_t k = neck.first + 1; k < neck.second; ++k) part += cross(loop[k] - p, at(loop, k + 1) - p);
        const double least = 2 * kBeyond * neck.width * neck.length, rest = whole - part;
        // Of what runs round a hole one part is the air that the line shuts in.
        return neck.loop == 0 ? std::min(part, rest) >= least : std::max(part, rest) >= least;
    }

    bool isCrossed(const Neck& neck, glm::dvec2 p, glm::dvec2 q) const {
        const auto side = [](glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) { return cross(b - a, c - a) > 0; };
        for (size_t l = 0; l < loops_.size(); ++l)
            for (size_t k = 0; k < loops_[l].size(); ++k) {
                if (l == neck.loop && (k == neck.first || k == neck.second)) continue;
                const glm::dvec2 a = loops_[l][k], b = at(loops_[l], k + 1);
                if (side(p, q, a) != side(p, q, b) && side(a, b, p) != side(a, b, q)) return true;
            }
        return false;
    }

    const std::vector<Loop>& loops_;
};

} // namespace

std::vector<Neck> necksOf(const MeshDomain& domain, double widest) {
    if (domain.frames.size() > 1) return {};
    return NeckFinder(domain).find(widest);
}

} // namespace heliodon::geometry
