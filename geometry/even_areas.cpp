#include "geometry/even_areas.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace heliodon::geometry {

namespace {

constexpr int kPasses = 5;
constexpr double kUneven = 0.1;       // of the mean area: what areas round a point differ by at least
constexpr double kWorthMoving = 1e-3; // of the sum of squares
const double kLeastCosine = std::cos(37 * std::numbers::pi / 180); // one degree to spare

class AreaEvener {
public:
    explicit AreaEvener(PlanarNet& net) : net_(net), stars_(net) {
        double twice = 0;
        for (uint32_t t = 0; t < net.corner.size(); ++t) twice += net.twiceArea(t);
        uneven_ = kUneven * twice / static_cast<double>(net.corner.size());
    }

    void even(bool onFoldsOnly) {
        stirred_.assign(net_.points.size(), true);
        for (int pass = 0; pass < kPasses; ++pass) {
            bool moved = false;
            for (uint32_t v = net_.boundaryCount; v < net_.points.size(); ++v)
                if (stirred_[v] && (net_.slides[v] || !onFoldsOnly)) moved |= move(v);
            if (!moved) return;
        }
    }

private:
    struct Side { // of a triangle round the point, opposite to it
        glm::dvec2 from, to;
        double most; // that the cosine of its smallest angle may be
    };

    bool move(uint32_t v) {
        stirred_[v] = false;
        const glm::dvec2 start = net_.points[v], way = wayToEven(v);
        if (way == glm::dvec2(0)) return false;
        for (Side& side : round_)
            side.most = std::max(kLeastCosine, PlanarNet::worstCosine(start, side.from, side.to));
        for (const double part : {1.0, 0.5, 0.25}) {
            const glm::dvec2 p = start + part * way;
            if (std::ranges::any_of(round_, [&](const Side& side) {
                    return PlanarNet::worstCosine(p, side.from, side.to) > side.most;
                }))
                continue;
            net_.points[v] = p;
            for (uint32_t i = stars_.first[v]; i < stars_.first[v + 1]; ++i)
                for (const uint32_t w : net_.corner[stars_.triangles[i]]) stirred_[w] = true;
            return true;
        }
        return false;
    }

    // Areas are linear in the place of v, so that the sum of their squares has its minimum where a system of
    // two equations says. None where that is not worth while.
    glm::dvec2 wayToEven(uint32_t v) {
        round_.clear();
        const glm::dvec2 start = net_.points[v];
        double xx = 0, xy = 0, yy = 0, squares = 0, least = 1e300, most = 0;
        glm::dvec2 pull(0);
        for (uint32_t i = stars_.first[v]; i < stars_.first[v + 1]; ++i) {
            const auto& c = net_.corner[stars_.triangles[i]];
            const size_t k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
            const glm::dvec2 a = net_.points[c[(k + 1) % 3]], b = net_.points[c[(k + 2) % 3]];
            const glm::dvec2 growth(a.y - b.y, b.x - a.x);
            const double area = cross(b - a, start - a);
            xx += growth.x * growth.x;
            xy += growth.x * growth.y;
            yy += growth.y * growth.y;
            pull -= area * growth;
            squares += area * area;
            least = std::min(least, area);
            most = std::max(most, area);
            round_.push_back({a, b, 0});
        }
        if (most - least < uneven_) return glm::dvec2(0);
        const double determinant = xx * yy - xy * xy;
        const glm::dvec2 way =
            net_.slides[v] ? glm::dvec2(0, pull.y / yy)
                           : glm::dvec2(yy * pull.x - xy * pull.y, xx * pull.y - xy * pull.x) / determinant;
        return glm::dot(pull, way) > kWorthMoving * squares ? way : glm::dvec2(0);
    }

    PlanarNet& net_;
    Stars stars_;
    double uneven_; // twice an area
    std::vector<bool> stirred_;
    std::vector<Side> round_;
};

} // namespace

void evenAreas(PlanarNet& net, bool onFoldsOnly) {
    if (net.points.size() > net.boundaryCount) AreaEvener(net).even(onFoldsOnly);
}

} // namespace heliodon::geometry
