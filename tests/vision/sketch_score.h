// How well a detected sketch agrees with a stated one: primitives matched by their place in plan, errors in
// inches and degrees.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/sketch.h"

namespace heliodon::vision {

struct KindScore {
    int stated = 0, found = 0, extra = 0;
    double placeWorst = 0, placeSquares = 0; // inches
    double angleWorst = 0, angleSquares = 0; // degrees
    double colorWorst = 0;                   // sRGB steps

    void add(const KindScore& o) {
        stated += o.stated, found += o.found, extra += o.extra;
        placeWorst = std::max(placeWorst, o.placeWorst), placeSquares += o.placeSquares;
        angleWorst = std::max(angleWorst, o.angleWorst), angleSquares += o.angleSquares;
        colorWorst = std::max(colorWorst, o.colorWorst);
    }
    void match(double place, double angle, double color = 0) {
        ++found;
        placeWorst = std::max(placeWorst, place), placeSquares += place * place;
        angleWorst = std::max(angleWorst, angle), angleSquares += angle * angle;
        colorWorst = std::max(colorWorst, color);
    }
};

using Score = std::map<std::string, KindScore>;

namespace score {

struct Mark {                       // what of any primitive can be compared
    std::vector<glm::dvec2> points; // ends or corners, in any order
    std::string label;              // must agree
    double angle = 0, period = 360; // degrees
    std::array<double, 3> rgb{};
};

inline double angleBetween(const Mark& a, const Mark& b) {
    const double d = std::abs(std::remainder(a.angle - b.angle, a.period));
    return d;
}

// Largest distance from a stated point to the nearest detected one.
inline double placeError(const Mark& a, const Mark& b) {
    double worst = 0;
    for (const auto& p : a.points) {
        double best = 1e9;
        for (const auto& q : b.points) best = std::min(best, glm::distance(p, q));
        worst = std::max(worst, best);
    }
    return worst;
}

inline double degrees(glm::dvec2 v) {
    return std::atan2(v.y, v.x) * 180 / std::numbers::pi;
}
inline glm::dvec2 direction(double deg) {
    return {std::cos(deg * std::numbers::pi / 180), std::sin(deg * std::numbers::pi / 180)};
}

inline std::vector<Mark> wallMarks(const geometry::Sketch& s) {
    std::vector<Mark> out;
    for (const auto& w : s.walls)
        out.push_back(
            {{w.a, w.b}, std::to_string(static_cast<int>(w.heightClass)), degrees(w.b - w.a), 180, {}});
    return out;
}

inline std::vector<Mark> arcMarks(const geometry::Sketch& s) {
    std::vector<Mark> out;
    for (const auto& a : s.arcs)
        out.push_back({{a.center + a.radius * direction(a.a0Deg), a.center + a.radius * direction(a.a1Deg),
                        a.center + a.radius * direction(0.5 * (a.a0Deg + a.a1Deg))},
                       std::to_string(static_cast<int>(a.heightClass)),
                       0,
                       360,
                       {}});
    return out;
}

// Markers of one kind that overlap or meet on one line are one window.
inline std::vector<Mark> windowMarks(const geometry::Sketch& s) {
    std::vector<Mark> out;
    for (const auto& w : s.windows)
        for (const auto& wall : s.walls) {
            if (wall.id != w.wall) continue;
            const glm::dvec2 along = glm::normalize(wall.b - wall.a);
            out.push_back(
                {{wall.a + (w.pos - 0.5 * w.width) * along, wall.a + (w.pos + 0.5 * w.width) * along},
                 std::to_string(static_cast<int>(w.kind)),
                 degrees(along),
                 180,
                 {}});
        }
    for (bool merged = true; merged;) {
        merged = false;
        for (size_t i = 0; i < out.size() && !merged; ++i)
            for (size_t k = 0; k < out.size() && !merged; ++k) {
                if (i == k || out[i].label != out[k].label) continue;
                const glm::dvec2 a = out[i].points[0], along = glm::normalize(out[i].points[1] - a);
                const double length = glm::distance(out[i].points[0], out[i].points[1]);
                double s0 = glm::dot(out[k].points[0] - a, along), s1 = glm::dot(out[k].points[1] - a, along);
                const glm::dvec2 mid = 0.5 * (out[k].points[0] + out[k].points[1]) - a;
                if (s0 > s1) std::swap(s0, s1);
                if (std::abs(along.x * mid.y - along.y * mid.x) > 0.3 || s0 > length + 0.1 || s1 < -0.1)
                    continue;
                out[i].points = {a + std::min(0.0, s0) * along, a + std::max(length, s1) * along};
                out.erase(out.begin() + static_cast<std::ptrdiff_t>(k));
                merged = true;
            }
    }
    return out;
}

inline std::vector<Mark> skylightMarks(const geometry::Sketch& s) {
    std::vector<Mark> out;
    for (const auto& k : s.skylights) {
        Mark mark{{}, "", k.angleDeg, 90, {}};
        const glm::dvec2 x = direction(k.angleDeg), y(-x.y, x.x);
        for (const double sx : {-0.5, 0.5})
            for (const double sy : {-0.5, 0.5})
                mark.points.push_back(k.center + sx * k.size.x * x + sy * k.size.y * y);
        out.push_back(mark);
    }
    return out;
}

inline std::vector<Mark> tokenMarks(const geometry::Sketch& s) {
    std::vector<Mark> out;
    for (const auto& t : s.tokens)
        out.push_back({{t.pos}, std::to_string(static_cast<int>(t.kind)), 0, 360, t.rgb});
    return out;
}

inline std::vector<Mark> arrowMarks(const geometry::Sketch& s) {
    std::vector<Mark> out;
    if (s.north) out.push_back({{s.north->pos}, "", s.north->dirDeg, 360, {}});
    return out;
}

// Greedy, nearest pairs first. A place further off than `limit` is no match.
inline KindScore compare(const std::vector<Mark>& stated, const std::vector<Mark>& detected, double limit) {
    KindScore out;
    out.stated = static_cast<int>(stated.size());
    struct Pair {
        double place;
        size_t i, k;
    };
    std::vector<Pair> pairs;
    for (size_t i = 0; i < stated.size(); ++i)
        for (size_t k = 0; k < detected.size(); ++k)
            if (stated[i].label == detected[k].label)
                if (const double place =
                        std::max(placeError(stated[i], detected[k]), placeError(detected[k], stated[i]));
                    place < limit)
                    pairs.push_back({place, i, k});
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.place < b.place; });
    std::vector<bool> hit(stated.size()), taken(detected.size());
    for (const auto& p : pairs) {
        if (hit[p.i] || taken[p.k]) continue;
        hit[p.i] = taken[p.k] = true;
        double color = 0;
        for (size_t c = 0; c < 3; ++c)
            color = std::max(color, std::abs(stated[p.i].rgb[c] - detected[p.k].rgb[c]));
        out.match(p.place, angleBetween(stated[p.i], detected[p.k]), color);
    }
    out.extra = static_cast<int>(std::count(taken.begin(), taken.end(), false));
    return out;
}

} // namespace score

inline Score scoreSketch(const geometry::Sketch& stated, const geometry::Sketch& detected) {
    using namespace score;
    const double limit = 0.5; // inches
    return {{"wall", compare(wallMarks(stated), wallMarks(detected), limit)},
            {"arc", compare(arcMarks(stated), arcMarks(detected), limit)},
            {"window", compare(windowMarks(stated), windowMarks(detected), limit)},
            {"skylight", compare(skylightMarks(stated), skylightMarks(detected), limit)},
            {"token", compare(tokenMarks(stated), tokenMarks(detected), limit)},
            {"arrow", compare(arrowMarks(stated), arrowMarks(detected), limit)}};
}

inline void addTo(Score& sum, const Score& score) {
    for (const auto& [kind, value] : score) sum[kind].add(value);
}

inline std::string table(const Score& score) {
    std::string out = fmt::format("{:9} {:>7} {:>6} {:>6}  {:>15}  {:>17}  {:>5}\n", "kind", "stated",
                                  "found", "extra", "place in: rms max", "angle deg: rms max", "rgb");
    for (const auto& [kind, k] : score) {
        const double n = std::max(1, k.found);
        out += fmt::format("{:9} {:7} {:6} {:6}  {:8.3f} {:8.3f}  {:9.3f} {:8.3f}  {:5.1f}\n", kind, k.stated,
                           k.found, k.extra, std::sqrt(k.placeSquares / n), k.placeWorst,
                           std::sqrt(k.angleSquares / n), k.angleWorst, k.colorWorst);
    }
    return out;
}

} // namespace heliodon::vision
