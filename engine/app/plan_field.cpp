#include "engine/app/plan_field.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include <glm/geometric.hpp>
#include <opencv2/imgproc.hpp>

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
            for (size_t k = 0; k < 3; ++k) s.at += share[k] * samples[t[k]].at;
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
