#include "geometry/plan_snapping.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"

namespace heliodon::geometry {

namespace {

// Ends of segments, those that are one but for rounding once; by x.
class Ends {
public:
    Ends(const std::vector<PlanSegment>& segments, double near) : near_(near) {
        std::vector<glm::dvec2> all;
        for (const PlanSegment& s : segments) all.insert(all.end(), {s.a, s.b});
        std::ranges::sort(all, {}, [](glm::dvec2 p) { return std::pair(p.x, p.y); });
        for (const glm::dvec2 p : all)
            if (place(p) == p) places_.push_back(p);
    }

    // Of the end that is near.
    glm::dvec2 place(glm::dvec2 p) const {
        for (auto at = from(p.x - near_); at != places_.end() && at->x <= p.x + near_; ++at)
            if (glm::length(*at - p) <= near_) return *at;
        return p;
    }

    // From a to b through what is near.
    std::vector<glm::dvec2> chain(glm::dvec2 a, glm::dvec2 b) const {
        std::vector<std::pair<double, glm::dvec2>> between;
        const double length = glm::length(b - a);
        const auto [low, high] = std::minmax(a.y, b.y);
        for (auto at = from(std::min(a.x, b.x) - near_);
             at != places_.end() && at->x <= std::max(a.x, b.x) + near_; ++at) {
            if (at->y < low - near_ || at->y > high + near_ || *at == a || *at == b) continue;
            const double along = glm::dot(*at - a, b - a) / length;
            if (along > 0 && along < length && std::abs(cross(b - a, *at - a)) <= near_ * length)
                between.emplace_back(along, *at);
        }
        std::ranges::sort(between, {}, [](const auto& p) { return p.first; });
        std::vector<glm::dvec2> out{a};
        for (const auto& [along, p] : between) out.push_back(p);
        out.push_back(b);
        return out;
    }

private:
    std::vector<glm::dvec2>::const_iterator from(double x) const {
        return std::ranges::lower_bound(places_, x, {}, &glm::dvec2::x);
    }

    double near_;
    std::vector<glm::dvec2> places_;
};

} // namespace

std::vector<PlanSegment> snapped(const std::vector<PlanSegment>& segments, double near) {
    const Ends ends(segments, near);
    std::vector<PlanSegment> out;
    for (const PlanSegment& s : segments) {
        const glm::dvec2 a = ends.place(s.a), b = ends.place(s.b);
        if (a == b) continue;
        const std::vector<glm::dvec2> chain = ends.chain(a, b);
        for (size_t k = 0; k + 1 < chain.size(); ++k) out.push_back({chain[k], chain[k + 1], s.tag});
    }
    return out;
}

} // namespace heliodon::geometry
