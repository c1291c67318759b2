#include "engine/app/plan_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <span>

#include <glm/geometric.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/clip_polygon.h"
#include "geometry/perpendicular.h"

namespace heliodon::app {

namespace {

using Corners = std::array<size_t, 3>;
using Key = std::pair<int64_t, int64_t>;

std::vector<Corners> delaunay(const std::vector<Sample>& samples) {
    if (samples.size() < 3) return {};
    glm::dvec2 low(1e300), high(-1e300);
    for (const Sample& s : samples) low = glm::min(low, s.at), high = glm::max(high, s.at);
    // OpenCV works in float pixels.
    const double scale = 8000 / std::max({high.x - low.x, high.y - low.y, 1e-12});
    cv::Subdiv2D division(cv::Rect(-10, -10, 8030, 8030));
    std::map<Key, size_t> at;
    const auto key = [](cv::Point2f p) { return Key{std::llround(p.x * 8), std::llround(p.y * 8)}; };
    for (size_t k = 0; k < samples.size(); ++k) {
        const glm::dvec2 q = scale * (samples[k].at - low);
        // On an eighth of a pixel, so that corners come back as they went in.
        const cv::Point2f p(static_cast<float>(std::round(q.x * 8) / 8),
                            static_cast<float>(std::round(q.y * 8) / 8));
        if (at.try_emplace(key(p), k).second) division.insert(p);
    }
    std::vector<cv::Vec6f> found;
    division.getTriangleList(found);
    std::vector<Corners> triangles;
    for (const cv::Vec6f& t : found) {
        Corners triangle{};
        bool known = true;
        for (int k = 0; k < 3 && known; ++k) {
            const auto corner = at.find(key({t[2 * k], t[2 * k + 1]}));
            known = corner != at.end();
            if (known) triangle[static_cast<size_t>(k)] = corner->second;
        }
        if (known) triangles.push_back(triangle);
    }
    return triangles;
}

// Slopes at the samples that keep every neighbour's place within the range of the neighbours' values.
std::vector<glm::dvec2> slopes(const std::vector<Sample>& samples, const std::vector<Corners>& triangles) {
    std::vector<glm::dvec2> slope(samples.size(), glm::dvec2(0));
    std::vector<double> area(samples.size(), 0), low(samples.size(), 1e300), high(samples.size(), -1e300);
    for (const Corners& t : triangles) {
        const Sample &a = samples[t[0]], &b = samples[t[1]], &c = samples[t[2]];
        const glm::dvec2 ab = b.at - a.at, ac = c.at - a.at;
        const double twice = geometry::cross(ab, ac), sign = twice < 0 ? -1 : 1;
        const glm::dvec2 rise = (b.value - a.value) * ac - (c.value - a.value) * ab; // turned by a quarter
        for (size_t corner : t) {
            slope[corner] += sign * glm::dvec2(rise.y, -rise.x);
            area[corner] += std::abs(twice);
            low[corner] = std::min({low[corner], a.value, b.value, c.value});
            high[corner] = std::max({high[corner], a.value, b.value, c.value});
        }
    }
    std::vector<double> share(samples.size(), 1);
    for (size_t i = 0; i < samples.size(); ++i)
        if (area[i] > 0) slope[i] /= area[i];
    for (const Corners& t : triangles)
        for (size_t i : t)
            for (size_t j : t) {
                const double step = glm::dot(slope[i], samples[j].at - samples[i].at);
                const double room = step > 0 ? high[i] - samples[i].value : samples[i].value - low[i];
                if (std::abs(step) > room) share[i] = std::min(share[i], room / std::abs(step));
            }
    for (size_t i = 0; i < samples.size(); ++i) slope[i] *= share[i];
    return slope;
}

double twiceArea(const std::vector<glm::dvec2>& polygon) {
    double twice = 0;
    for (size_t k = 0; k < polygon.size(); ++k)
        twice += geometry::cross(polygon[k], polygon[(k + 1) % polygon.size()]);
    return twice;
}

double twiceArea(const std::vector<Sample>& polygon) {
    double twice = 0;
    for (size_t k = 2; k < polygon.size(); ++k)
        twice += geometry::cross(polygon[k - 1].at - polygon[0].at, polygon[k].at - polygon[0].at);
    return std::abs(twice);
}

void addFan(std::span<const Sample> polygon, double more, std::vector<SampleTriangle>& triangles) {
    const auto raised = [&](Sample s) { return Sample{s.at, s.value + more, s.height}; };
    for (size_t i = 2; i < polygon.size(); ++i)
        triangles.push_back({raised(polygon[0]), raised(polygon[i - 1]), raised(polygon[i])});
}

// Corners of the convex hull, counterclockwise where y is up.
std::vector<glm::dvec2> convexHull(const std::vector<Sample>& samples) {
    std::vector<cv::Point2f> points;
    for (const Sample& s : samples)
        points.emplace_back(static_cast<float>(s.at.x), static_cast<float>(s.at.y));
    std::vector<int> corners;
    if (!points.empty()) cv::convexHull(points, corners);
    std::vector<glm::dvec2> hull;
    for (const int k : corners) hull.push_back(samples[static_cast<size_t>(k)].at);
    return hull;
}

} // namespace

std::vector<SampleTriangle> smoothTriangles(const std::vector<Sample>& samples, size_t parts) {
    const std::vector<Corners> triangles = delaunay(samples);
    const std::vector<glm::dvec2> slope = slopes(samples, triangles);
    std::vector<SampleTriangle> result;
    for (const Corners& t : triangles) {
        // The point i/parts of the way to the second corner and j/parts to the third.
        const auto at = [&](size_t i, size_t j) {
            const double n = static_cast<double>(parts), u = static_cast<double>(i) / n,
                         v = static_cast<double>(j) / n;
            const double share[]{static_cast<double>(parts - i - j) / n, u, v};
            Sample s{{0, 0}, 0};
            for (size_t k = 0; k < 3; ++k)
                s.at += share[k] * samples[t[k]].at, s.height += share[k] * samples[t[k]].height;
            double weights = 0;
            for (size_t k = 0; k < 3; ++k) {
                const Sample& corner = samples[t[k]];
                const double weight = share[k] * share[k] * (3 - 2 * share[k]);
                s.value += weight * (corner.value + glm::dot(slope[t[k]], s.at - corner.at));
                weights += weight;
            }
            s.value /= weights;
            return s;
        };
        for (size_t i = 0; i < parts; ++i)
            for (size_t j = 0; i + j < parts; ++j) {
                result.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
                if (i + j + 1 < parts) result.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
            }
    }
    return result;
}

double spacingOf(const std::vector<Sample>& samples) {
    if (samples.size() < 2) return 0;
    constexpr size_t kMost = 300;
    const size_t stride = (samples.size() + kMost - 1) / kMost;
    std::vector<double> distances;
    for (size_t i = 0; i < samples.size(); i += stride) {
        double least = 1e300;
        for (size_t j = 0; j < samples.size(); ++j)
            if (j != i) least = std::min(least, glm::distance(samples[i].at, samples[j].at));
        distances.push_back(least);
    }
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
}

std::vector<glm::dvec2> reachOf(const std::vector<Sample>& samples, double reach) {
    const std::vector<glm::dvec2> hull = convexHull(samples);
    std::vector<glm::dvec2> result;
    if (hull.size() < 2) {
        constexpr int kCorners = 32;
        for (int k = 0; k < kCorners && !hull.empty(); ++k) {
            const double turn = 2 * std::numbers::pi * k / kCorners;
            result.push_back(hull[0] + reach * glm::dvec2(std::cos(turn), std::sin(turn)));
        }
        return result;
    }
    const auto outwards = [&](size_t k) { // of the side after corner k
        const glm::dvec2 side = glm::normalize(hull[(k + 1) % hull.size()] - hull[k]);
        return glm::dvec2(side.y, -side.x);
    };
    for (size_t k = 0; k < hull.size(); ++k) {
        const glm::dvec2 before = outwards((k + hull.size() - 1) % hull.size()), after = outwards(k);
        // Where two sides' parallels meet.
        const auto corner = [&](glm::dvec2 n, glm::dvec2 m) {
            result.push_back(hull[k] + reach / (1 + glm::dot(n, m)) * (n + m));
        };
        if (glm::dot(before, after) > -1e-6) {
            corner(before, after);
        } else {
            const glm::dvec2 along(-before.y, before.x), back(after.y, -after.x);
            const glm::dvec2 between = glm::normalize(along + back);
            corner(before, between);
            corner(between, after);
        }
    }
    return result;
}

double areaOf(const std::vector<glm::dvec2>& polygon) {
    return 0.5 * std::abs(twiceArea(polygon));
}

bool isWithin(const std::vector<glm::dvec2>& convex, glm::dvec2 p) {
    for (size_t k = 0; k < convex.size(); ++k)
        if (geometry::cross(convex[(k + 1) % convex.size()] - convex[k], p - convex[k]) < 0) return false;
    return !convex.empty();
}

std::vector<SampleTriangle> within(const std::vector<SampleTriangle>& triangles,
                                   const std::vector<glm::dvec2>& convex) {
    std::vector<SampleTriangle> result;
    for (const SampleTriangle& t : triangles) {
        std::vector<Sample> part(t.begin(), t.end()), next;
        for (size_t k = 0; k < convex.size(); ++k) {
            const glm::dvec2 a = convex[k], side = convex[(k + 1) % convex.size()] - a;
            geometry::clip(
                part, [&](const Sample& p) { return geometry::cross(side, p.at - a); }, next);
            part.swap(next);
        }
        addFan(part, 0, result);
    }
    return result;
}

std::vector<SampleTriangle> raisedWithin(const std::vector<SampleTriangle>& triangles,
                                         std::vector<glm::dvec2> convex, double more) {
    if (twiceArea(convex) < 0) std::reverse(convex.begin(), convex.end());
    glm::dvec2 low(1e300), high(-1e300);
    for (glm::dvec2 p : convex) low = glm::min(low, p), high = glm::max(high, p);
    std::vector<SampleTriangle> result, cut;
    std::vector<Sample> inside, outside, next;
    for (const SampleTriangle& t : triangles) {
        const glm::dvec2 least = glm::min(t[0].at, glm::min(t[1].at, t[2].at)),
                         most = glm::max(t[0].at, glm::max(t[1].at, t[2].at));
        cut.clear();
        inside.assign(t.begin(), t.end());
        const double sliver = 1e-6 * twiceArea(inside);
        if (least.x > high.x || least.y > high.y || most.x < low.x || most.y < low.y) inside.clear();
        for (size_t k = 0; k < convex.size() && !inside.empty(); ++k) {
            const glm::dvec2 a = convex[k], side = convex[(k + 1) % convex.size()] - a;
            const auto left = [&](const Sample& p) { return geometry::cross(side, p.at - a); };
            geometry::clip(
                inside, [&](const Sample& p) { return -left(p); }, outside);
            if (twiceArea(outside) > sliver) addFan(outside, 0, cut);
            geometry::clip(inside, left, next);
            inside.swap(next);
        }
        if (twiceArea(inside) > sliver) {
            addFan(inside, more, result);
            result.insert(result.end(), cut.begin(), cut.end());
        } else {
            result.push_back(t);
        }
    }
    return result;
}

std::vector<std::array<glm::dvec2, 2>> stepsBetween(const std::vector<std::vector<glm::dvec2>>& polygons,
                                                    const std::vector<double>& values, double eps) {
    std::vector<std::vector<glm::dvec2>> turned = polygons;
    for (auto& polygon : turned)
        if (twiceArea(polygon) < 0) std::reverse(polygon.begin(), polygon.end());
    std::vector<std::array<glm::dvec2, 2>> steps;
    for (size_t i = 0; i < turned.size(); ++i)
        for (size_t k = 0; k < turned[i].size(); ++k) {
            const glm::dvec2 a = turned[i][k], b = turned[i][(k + 1) % turned[i].size()];
            const double length = glm::distance(a, b);
            if (length <= eps) continue;
            const glm::dvec2 along = (b - a) / length, outwards(along.y, -along.x);
            std::vector<double> ends{0, length}; // and where others' corners touch the side
            for (const auto& other : turned)
                for (glm::dvec2 p : other)
                    if (const double x = glm::dot(p - a, along);
                        x > eps && x < length - eps && std::abs(glm::dot(p - a, outwards)) < eps)
                        ends.push_back(x);
            std::sort(ends.begin(), ends.end());
            for (size_t e = 1; e < ends.size(); ++e) {
                if (ends[e] - ends[e - 1] <= eps) continue;
                const glm::dvec2 beyond = a + 0.5 * (ends[e - 1] + ends[e]) * along + 2 * eps * outwards;
                bool same = false;
                for (size_t j = 0; j < turned.size() && !same; ++j)
                    same = j != i && isWithin(turned[j], beyond) &&
                           std::abs(values[j] - values[i]) <= 1e-6 * std::abs(values[i]);
                if (!same) steps.push_back({a + ends[e - 1] * along, a + ends[e] * along});
            }
        }
    return steps;
}

std::vector<std::vector<glm::dvec2>> unitedOutlines(std::vector<std::vector<glm::dvec2>> polygons,
                                                    double step) {
    const auto key = [&](glm::dvec2 p) { return Key{std::llround(p.x / step), std::llround(p.y / step)}; };
    std::multiset<std::pair<Key, Key>> sides; // in order of where they start
    for (std::vector<glm::dvec2>& polygon : polygons) {
        if (twiceArea(polygon) < 0) std::reverse(polygon.begin(), polygon.end());
        for (size_t k = 0; k < polygon.size(); ++k) {
            const Key a = key(polygon[k]), b = key(polygon[(k + 1) % polygon.size()]);
            if (a == b) continue;
            const auto other = sides.find({b, a});
            if (other != sides.end())
                sides.erase(other);
            else
                sides.insert({a, b});
        }
    }
    std::vector<std::vector<glm::dvec2>> outlines;
    while (!sides.empty()) { // as many sides lead to a corner as away from it: each way ends where it began
        std::vector<glm::dvec2>& outline = outlines.emplace_back();
        const Key first = sides.begin()->first;
        for (Key at = first;;) {
            outline.push_back(step * glm::dvec2(at.first, at.second));
            const auto side = sides.lower_bound({at, {INT64_MIN, INT64_MIN}});
            at = side->second;
            sides.erase(side);
            if (at == first) break;
        }
    }
    return outlines;
}

std::vector<std::vector<glm::dvec2>> isoLines(const std::vector<SampleTriangle>& triangles, double level) {
    double extent = 1e-12;
    for (const SampleTriangle& t : triangles)
        for (const Sample& s : t) extent = std::max({extent, std::abs(s.at.x), std::abs(s.at.y)});
    const auto key = [&](glm::dvec2 p) {
        return Key{std::llround(p.x / extent * 1e9), std::llround(p.y / extent * 1e9)};
    };
    std::vector<std::array<glm::dvec2, 2>> segments;
    std::multimap<Key, size_t> ends;
    for (const SampleTriangle& t : triangles) {
        std::vector<glm::dvec2> cut;
        for (size_t k = 0; k < 3; ++k) {
            const Sample &a = t[k], &b = t[(k + 1) % 3];
            if ((a.value < level) != (b.value < level))
                cut.push_back(a.at + (level - a.value) / (b.value - a.value) * (b.at - a.at));
        }
        if (cut.size() != 2 || key(cut[0]) == key(cut[1])) continue;
        for (glm::dvec2 p : cut) ends.emplace(key(p), segments.size());
        segments.push_back({cut[0], cut[1]});
    }
    std::vector<bool> used(segments.size());
    std::vector<std::vector<glm::dvec2>> lines;
    for (size_t first = 0; first < segments.size(); ++first) {
        if (used[first]) continue;
        used[first] = true;
        std::vector<glm::dvec2> line(segments[first].begin(), segments[first].end());
        for (int way = 0; way < 2; ++way) { // on from the last point, then from the first
            for (bool more = true; more;) {
                more = false;
                const auto [from, to] = ends.equal_range(key(line.back()));
                for (auto next = from; next != to && !more; ++next) {
                    if (used[next->second]) continue;
                    const auto& s = segments[next->second];
                    used[next->second] = more = true;
                    line.push_back(key(s[0]) == key(line.back()) ? s[1] : s[0]);
                }
            }
            std::reverse(line.begin(), line.end());
        }
        lines.push_back(std::move(line));
    }
    return lines;
}

} // namespace heliodon::app
