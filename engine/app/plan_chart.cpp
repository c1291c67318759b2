#include "engine/app/plan_chart.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <opencv2/imgproc.hpp>

namespace heliodon::app {

namespace {

using Points = std::vector<glm::dvec2>;

constexpr double kPlan = 720, kNarrowest = 420, kMargin = 40, kLegend = 90, kHead = 62, kFoot = 40; // pixels
constexpr size_t kBands = 40; // of colour between the ends of the scale

struct Sample {
    glm::dvec2 at; // plan: world x, z
    double value;
};

glm::dvec2 flat(glm::dvec3 p) {
    return {p.x, p.z};
}

// Edges of some patches that only one of them has, by place so that welding does not matter.
std::vector<std::array<glm::dvec3, 2>> borders(const geometry::PatchMesh& mesh,
                                               const std::vector<size_t>& patches) {
    using Key = std::array<int64_t, 3>;
    const auto key = [](glm::dvec3 p) {
        return Key{std::llround(p.x * 1e6), std::llround(p.y * 1e6), std::llround(p.z * 1e6)};
    };
    std::map<std::pair<Key, Key>, std::array<glm::dvec3, 2>> edges;
    for (size_t i : patches) {
        const auto corners = mesh.patch(i);
        for (size_t k = 0; k < corners.size(); ++k) {
            const glm::dvec3 a = mesh.vertices[corners[k]],
                             b = mesh.vertices[corners[(k + 1) % corners.size()]];
            if (!edges.erase({key(b), key(a)})) edges.insert({{key(a), key(b)}, {a, b}});
        }
    }
    std::vector<std::array<glm::dvec3, 2>> result;
    for (const auto& [keys, edge] : edges) result.push_back(edge);
    return result;
}

struct Floor {
    std::vector<size_t> patches;
    std::vector<std::array<glm::dvec3, 2>> outline;
};

std::vector<Floor> floorsOf(const geometry::PatchMesh& mesh) {
    std::map<uint32_t, Floor> floors;
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (geometry::patchNormal(mesh, i).y > 0.5) floors[mesh.room[i]].patches.push_back(i);
    std::vector<Floor> result;
    for (auto& [room, floor] : floors) {
        floor.outline = borders(mesh, floor.patches);
        result.push_back(std::move(floor));
    }
    return result;
}

bool covers(const geometry::PatchMesh& mesh, size_t patch, glm::dvec2 p) {
    const auto corners = mesh.patch(patch);
    for (size_t k = 0; k < corners.size(); ++k) {
        const glm::dvec2 a = flat(mesh.vertices[corners[k]]),
                         b = flat(mesh.vertices[corners[(k + 1) % corners.size()]]);
        if ((b.y - a.y) * (p.x - a.x) - (b.x - a.x) * (p.y - a.y) < -1e-9) return false;
    }
    return true;
}

// The part of a convex polygon where the linear field reaches `level` (or stays below it).
std::vector<Sample> clipped(const std::vector<Sample>& polygon, double level, bool above) {
    std::vector<Sample> result;
    for (size_t k = 0; k < polygon.size(); ++k) {
        const Sample &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
        const double da = above ? a.value - level : level - a.value,
                     db = above ? b.value - level : level - b.value;
        if (da >= 0) result.push_back(a);
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
            const double t = da / (da - db);
            result.push_back({a.at + t * (b.at - a.at), level});
        }
    }
    return result;
}

std::vector<std::array<Sample, 3>> triangulated(const std::vector<Sample>& samples) {
    if (samples.size() < 3) return {};
    glm::dvec2 low(1e300), high(-1e300);
    for (const Sample& s : samples) low = glm::min(low, s.at), high = glm::max(high, s.at);
    // OpenCV works in float pixels.
    const double scale = 8000 / std::max({high.x - low.x, high.y - low.y, 1e-12});
    cv::Subdiv2D division(cv::Rect(-10, -10, 8030, 8030));
    std::map<std::pair<int64_t, int64_t>, size_t> at;
    const auto key = [](cv::Point2f p) {
        return std::pair<int64_t, int64_t>{std::llround(p.x * 8), std::llround(p.y * 8)};
    };
    for (size_t k = 0; k < samples.size(); ++k) {
        const glm::dvec2 q = scale * (samples[k].at - low);
        // On an eighth of a pixel, so that corners come back as they went in.
        const cv::Point2f p(static_cast<float>(std::round(q.x * 8) / 8),
                            static_cast<float>(std::round(q.y * 8) / 8));
        if (at.try_emplace(key(p), k).second) division.insert(p);
    }
    std::vector<cv::Vec6f> found;
    division.getTriangleList(found);
    std::vector<std::array<Sample, 3>> triangles;
    for (const cv::Vec6f& t : found) {
        std::array<Sample, 3> triangle;
        bool known = true;
        for (int k = 0; k < 3 && known; ++k) {
            const auto corner = at.find(key({t[2 * k], t[2 * k + 1]}));
            known = corner != at.end();
            if (known) triangle[static_cast<size_t>(k)] = samples[corner->second];
        }
        if (known) triangles.push_back(triangle);
    }
    return triangles;
}

class PlanDrawing {
public:
    PlanDrawing(const Scene& scene, const ValueScale& scale) : mesh_(scene.mesh), scale_(scale) {
        for (const glm::dvec3& v : mesh_.vertices)
            low_ = glm::min(low_, flat(v)), high_ = glm::max(high_, flat(v));
        const glm::dvec2 extent = glm::max(high_ - low_, glm::dvec2(1e-9));
        pixels_ = kPlan / std::max(extent.x, extent.y);
        size_ = pixels_ * extent;
    }
    Chart chart() const {
        return {std::max(size_.x, kNarrowest) + 2 * kMargin + kLegend,
                std::max(size_.y, 260.0) + kHead + kFoot + kMargin};
    }
    glm::dvec2 pixel(glm::dvec2 p) const { return glm::dvec2(kMargin, kHead) + pixels_ * (p - low_); }
    double pixelsPerWorld() const { return pixels_; }
    glm::dvec2 size() const { return size_; }

    void colours(Chart& chart, const Floor& floor, std::vector<Sample> samples) const {
        extend(floor, samples);
        const auto triangles = triangulated(samples);
        std::vector<glm::dvec2> middle;
        for (const auto& triangle : triangles) {
            std::vector<Sample> polygon(triangle.begin(), triangle.end());
            for (Sample& s : polygon) s.value = scale_.share(s.value);
            for (size_t band = 0; band < kBands; ++band) {
                const double from = static_cast<double>(band) / kBands,
                             to = static_cast<double>(band + 1) / kBands;
                auto part = band == 0 ? polygon : clipped(polygon, from, true);
                if (band + 1 < kBands) part = clipped(part, to, false);
                if (part.size() >= 3) overFloor(chart, floor, part, inkAt(0.5 * (from + to)));
            }
        }
        std::vector<glm::dvec2> labels;
        for (double level : scale_.ticks)
            if (level > scale_.low && level < scale_.high) isoLine(chart, floor, triangles, level, labels);
    }

    void walls(Chart& chart, const std::vector<Floor>& floors) const {
        for (const Floor& floor : floors)
            for (const auto& [a, b] : floor.outline)
                chart.line({pixel(flat(a)), pixel(flat(b))}, kBlack, 1.8);
        std::vector<size_t> glass;
        for (size_t i = 0; i < mesh_.patchCount(); ++i)
            if (mesh_.materials[mesh_.material[i]].isOpening()) glass.push_back(i);
        for (const auto& [a, b] : borders(mesh_, glass))
            chart.line({pixel(flat(a)), pixel(flat(b))}, {60, 150, 255}, 3);
    }

private:
    Ink inkAt(double share) const {
        ValueScale unit;
        unit.high = 1;
        return unit.ink(share);
    }
    // Out to the walls: points of the floor's outline take the mean of the sensors nearest to them.
    void extend(const Floor& floor, std::vector<Sample>& samples) const {
        const size_t sensors = samples.size(), near = std::min<size_t>(3, sensors);
        std::vector<std::pair<double, double>> nearest(near); // distance, value
        for (const auto& [a, b] : floor.outline)
            for (double t : {0.0, 0.5}) {
                const glm::dvec2 p = flat(a + t * (b - a));
                nearest.assign(near, {1e300, 0.0});
                for (size_t s = 0; s < sensors; ++s) {
                    std::pair<double, double> next{glm::distance(samples[s].at, p), samples[s].value};
                    for (auto& place : nearest)
                        if (next.first < place.first) std::swap(next, place);
                }
                double sum = 0, weights = 0;
                for (const auto& [distance, value] : nearest) {
                    const double weight = std::pow(distance + 1e-9, -3.0);
                    sum += weight * value, weights += weight;
                }
                samples.push_back({p, sum / weights});
            }
    }
    bool isOverFloor(const Floor& floor, glm::dvec2 p) const {
        return std::any_of(floor.patches.begin(), floor.patches.end(),
                           [&](size_t i) { return covers(mesh_, i, p); });
    }
    // Triangles of samples reach over concave corners: what has its middle outside is left out.
    void overFloor(Chart& chart, const Floor& floor, const std::vector<Sample>& part, Ink ink) const {
        glm::dvec2 middle(0);
        Points outline;
        for (const Sample& s : part)
            middle += s.at / static_cast<double>(part.size()), outline.push_back(pixel(s.at));
        if (isOverFloor(floor, middle)) chart.fill(std::move(outline), ink);
    }
    void isoLine(Chart& chart, const Floor& floor, const std::vector<std::array<Sample, 3>>& triangles,
                 double level, std::vector<glm::dvec2>& labels) const {
        const Ink ink = scale_.share(level) > 0.6 ? Ink{40, 40, 40} : Ink{245, 245, 245};
        std::vector<std::array<glm::dvec2, 2>> segments;
        for (const auto& t : triangles) {
            Points cut;
            for (size_t k = 0; k < 3; ++k) {
                const Sample &a = t[k], &b = t[(k + 1) % 3];
                if ((a.value < level) != (b.value < level))
                    cut.push_back(a.at + (level - a.value) / (b.value - a.value) * (b.at - a.at));
            }
            if (cut.size() != 2 || !isOverFloor(floor, 0.5 * (cut[0] + cut[1]))) continue;
            chart.line({pixel(cut[0]), pixel(cut[1])}, ink, 1.2);
            segments.push_back({cut[0], cut[1]});
        }
        // One number a line, away from the others.
        double best = 45;
        const glm::dvec2* place = nullptr;
        for (const auto& s : segments) {
            const glm::dvec2 here = pixel(s[0]) - glm::dvec2(kMargin, kHead);
            if (std::min({here.x, here.y, size_.x - here.x, size_.y - here.y}) < 16) continue;
            double nearest = 400;
            for (glm::dvec2 other : labels) nearest = std::min(nearest, glm::distance(pixel(s[0]), other));
            if (nearest > best) best = nearest, place = &s[0];
        }
        if (!place) return;
        labels.push_back(pixel(*place));
        chart.text(pixel(*place) + glm::dvec2(0, 4), fmt::format("{:g}", level), 11, Anchor::middle, kBlack,
                   true);
    }

    const geometry::PatchMesh& mesh_;
    const ValueScale& scale_;
    glm::dvec2 low_{1e300}, high_{-1e300}, size_{0};
    double pixels_ = 1;
};

void drawNorthAndScale(Chart& chart, const Scene& scene, const PlanDrawing& plan) {
    const double metre = plan.pixelsPerWorld() * scene.worldPerBuilding;
    double length = 1; // building metres, about a fifth of the plan
    while (length * metre > 220) length /= 2;
    while (length * metre < 70) length *= 2;
    const glm::dvec2 at(kMargin, chart.height() - kFoot + 8);
    chart.line({at, at + glm::dvec2(length * metre, 0)}, kBlack, 2);
    for (double end : {0.0, length * metre})
        chart.line({at + glm::dvec2(end, -4), at + glm::dvec2(end, 4)}, kBlack, 1.2);
    chart.text(at + glm::dvec2(length * metre + 8, 4), fmt::format("{:g} m", length), 11);
    const double angle = scene.northDeg * 3.14159265358979 / 180;
    const glm::dvec2 north(std::cos(angle), -std::sin(angle)), side(-north.y, north.x);
    const glm::dvec2 foot = glm::dvec2(chart.width() - kLegend - kMargin - 20, at.y) - 12.0 * north;
    chart.line({foot, foot + 24.0 * north}, kBlack, 1.5);
    chart.fill({foot + 28.0 * north, foot + 16.0 * north + 5.0 * side, foot + 16.0 * north - 5.0 * side},
               kBlack);
    chart.text(foot + 24.0 * north + 14.0 * side + glm::dvec2(0, 4), "N", 12, Anchor::middle);
}

} // namespace

Chart planChart(const Scene& scene, std::span<const glm::dvec3> points, std::span<const glm::dvec3> normals,
                std::span<const double> values, const ValueScale& scale, const std::string& title,
                const std::string& subtitle) {
    const std::vector<Floor> floors = floorsOf(scene.mesh);
    std::vector<std::vector<Sample>> samples(floors.size());
    std::set<std::pair<int64_t, int64_t>> taken;
    for (size_t s = 0; s < points.size(); ++s) {
        const glm::dvec2 p = flat(points[s]);
        if (normals[s].y < 0.5 || !taken.insert({std::llround(p.x * 1e5), std::llround(p.y * 1e5)}).second)
            continue;
        for (size_t f = 0; f < floors.size(); ++f)
            if (std::any_of(floors[f].patches.begin(), floors[f].patches.end(),
                            [&](size_t i) { return covers(scene.mesh, i, p); })) {
                samples[f].push_back({p, values[s]});
                break;
            }
    }
    const PlanDrawing plan(scene, scale);
    Chart chart = plan.chart();
    for (size_t f = 0; f < floors.size(); ++f)
        if (!samples[f].empty()) plan.colours(chart, floors[f], samples[f]);
    plan.walls(chart, floors);
    for (const auto& room : samples)
        for (const Sample& s : room) {
            const glm::dvec2 p = plan.pixel(s.at);
            chart.rectangle(p.x - 0.8, p.y - 0.8, 1.6, 1.6, {90, 90, 90});
        }
    chart.text({kMargin, 22}, title, 15);
    chart.text({kMargin, 40}, subtitle, 11);
    drawScale(chart, scale, {chart.width() - kLegend, kHead + 10}, std::max(plan.size().y, 260.0) - 20);
    drawNorthAndScale(chart, scene, plan);
    return chart;
}

} // namespace heliodon::app
