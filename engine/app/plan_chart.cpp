#include "engine/app/plan_chart.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "engine/app/plan_field.h"
#include "engine/app/plan_floors.h"
#include "engine/app/plan_frame.h"
#include "engine/passes/false_colour.h"
#include "geometry/bounds.h"
#include "geometry/clip_polygon.h"

namespace heliodon::app {

namespace {

constexpr double kLegend = 90;    // pixels
constexpr double kOutline = 0.01; // pixels to which areas of one colour are joined
constexpr Ink kSunEdge{225, 85, 0};
constexpr size_t kBands = 40; // of colour between the ends of the scale
constexpr size_t kFew = 12;   // sensors whose numbers are written beside them
// Building metres around the sensors that are coloured at least: a grid of sensors leaves out a border of
// half a metre along the walls (EN 12464-1, EN 17037).
constexpr double kBorder = 0.5;

// The part of a convex polygon where the linear field reaches `level` (or stays below it).
std::vector<Sample> clipped(const std::vector<Sample>& polygon, double level, bool above) {
    std::vector<Sample> result;
    geometry::clip(
        polygon, [&](const Sample& s) { return above ? s.value - level : level - s.value; }, result);
    return result;
}

PlanFrame frameOf(const Scene& scene, size_t storey, size_t storeys) {
    const geometry::Bounds bounds = geometry::boundsOf(scene.mesh.vertices);
    return {flat(bounds.low), flat(bounds.high), storey, storeys, kLegend};
}

class PlanDrawing {
public:
    PlanDrawing(const PlanFrame& frame, const ValueScale& scale, double border)
        : frame_(frame), scale_(scale), border_(border) {}

    void draw(Chart& chart, const std::vector<PlanFloor>& floors, bool few) {
        for (const PlanFloor& floor : floors)
            if (!floor.samples.empty()) colours(chart, floor, few);
        walls(chart, floors);
        for (const PlanFloor& floor : floors) sensors(chart, floor.samples, few);
        labels(chart, floors);
    }
    bool hasSunEdges() const { return hasSunEdges_; }
    bool hasDots() const { return hasDots_; }
    static void dot(Chart& chart, glm::dvec2 p) {
        chart.rectangle(p.x - 0.8, p.y - 0.8, 1.6, 1.6, {90, 90, 90});
    }

private:
    // Few sensors that do not cover the floor tell nothing about what they do not surround, and no lines.
    void colours(Chart& chart, const PlanFloor& floor, bool few) {
        std::vector<Sample> samples = floor.sun ? floor.shaded : floor.samples;
        const double spacing = std::max(spacingOf(samples), border_);
        const Points reach = reachOf(samples, spacing * (1 + 1e-6));
        const bool alone =
            few && !std::all_of(floor.outline.begin(), floor.outline.end(),
                                [&](const auto& edge) { return isWithin(reach, flat(edge[0])); });
        if (!alone) extend(floor, samples, spacing);
        std::vector<SampleTriangle> triangles = smoothTriangles(samples, partsFor(spacing));
        // Triangles of samples reach over concave corners: what has its middle outside is left out.
        std::erase_if(triangles, [&](const SampleTriangle& t) {
            return !floor.isOpenAt((t[0].at + t[1].at + t[2].at) / 3.0);
        });
        triangles = within(triangles, reach);
        if (floor.sun) triangles = sunlit(std::move(triangles), *floor.sun);
        fillBands(chart, triangles);
        if (alone) return;
        isoLux(chart, triangles);
        if (floor.sun) sunEdges(chart, floor, reach, triangles);
    }

    void fillBands(Chart& chart, const std::vector<SampleTriangle>& triangles) const {
        std::vector<std::vector<Points>> bands(kBands);
        std::vector<Points> dark;
        for (const SampleTriangle& triangle : triangles) {
            std::vector<Sample> polygon(triangle.begin(), triangle.end());
            if (std::ranges::any_of(polygon, [&](const Sample& s) { return scale_.isBelow(s.value); })) {
                addOutline(clipped(polygon, scale_.low, false), dark);
                polygon = clipped(polygon, scale_.low, true);
                if (polygon.empty()) continue;
            }
            size_t first = kBands, last = 0;
            for (Sample& s : polygon) {
                s.value = scale_.share(s.value);
                const size_t band = std::min(kBands - 1, static_cast<size_t>(s.value * kBands));
                first = std::min(first, band), last = std::max(last, band);
            }
            for (size_t band = first; band <= last; ++band) {
                auto part = band == first ? polygon : clipped(polygon, bandEnd(band), true);
                if (band < last) part = clipped(part, bandEnd(band + 1), false);
                addOutline(part, bands[band]);
            }
        }
        const auto fill = [&](std::vector<Points>& parts, Ink ink) {
            if (auto outlines = unitedOutlines(std::move(parts), kOutline); !outlines.empty())
                chart.fill(std::move(outlines), ink);
        };
        fill(dark, kDark);
        for (size_t band = 0; band < kBands; ++band)
            fill(bands[band], inkAt(0.5 * (bandEnd(band) + bandEnd(band + 1))));
    }

    void addOutline(const std::vector<Sample>& part, std::vector<Points>& outlines) const {
        if (part.empty()) return;
        std::ranges::transform(part, std::back_inserter(outlines.emplace_back()),
                               [&](const Sample& s) { return pixel(s.at); });
    }

    void isoLux(Chart& chart, const std::vector<SampleTriangle>& triangles) {
        for (double level : scale_.ticks) {
            if (level <= scale_.low || level >= scale_.high) continue;
            for (Points& line : isoLines(triangles, level)) {
                for (glm::dvec2& p : line) p = pixel(p);
                chart.line(line, scale_.share(level) > 0.6 ? Ink{40, 40, 40} : Ink{245, 245, 245}, 1.2);
                lines_.push_back({level, std::move(line)});
            }
        }
    }

    // Only over the floor and where there are colours, of the plane that these show: in bits of a few pixels.
    void sunEdges(Chart& chart, const PlanFloor& floor, const Points& reach,
                  const std::vector<SampleTriangle>& triangles) {
        for (size_t plane = 0; plane < floor.sun->heights.size(); ++plane) {
            std::vector<Points> polygons;
            std::vector<double> lux;
            for (const Sunlight::Part& part : floor.sun->parts)
                if (part.plane == plane) polygons.push_back(part.polygon), lux.push_back(part.lux);
            for (const auto& [a, b] :
                 stepsBetween(polygons, lux, 1e-6 * (frame_.size().x + frame_.size().y) / pixelsPerWorld())) {
                const double bits = std::ceil(pixelsPerWorld() * glm::distance(a, b) / 3);
                Points line;
                const auto draw = [&] {
                    if (line.size() > 1) chart.line(std::move(line), kSunEdge, 1.2), hasSunEdges_ = true;
                    line.clear();
                };
                for (double k = 0; k < bits; ++k) {
                    const glm::dvec2 middle = glm::mix(a, b, (k + 0.5) / bits);
                    if (!isWithin(reach, middle) || !floor.isOpenAt(middle) ||
                        planeAt(*floor.sun, triangles, middle) != plane) {
                        draw();
                        continue;
                    }
                    if (line.empty()) line.push_back(pixel(glm::mix(a, b, k / bits)));
                    line.push_back(pixel(glm::mix(a, b, (k + 1) / bits)));
                }
                draw();
            }
        }
    }

    // Dots; of few sensors rounds of their colour with their numbers.
    void sensors(Chart& chart, const std::vector<Sample>& samples, bool few) {
        for (const Sample& s : samples) {
            const glm::dvec2 p = pixel(s.at);
            if (!few) {
                dot(chart, p), hasDots_ = true;
                continue;
            }
            for (const auto& [radius, ink] :
                 {std::pair(8.0, kBlack), std::pair(7.2, kPaper), std::pair(5.8, scale_.ink(s.value))}) {
                Points round;
                for (int k = 0; k < 24; ++k) {
                    const double turn = glm::radians(15.0 * k);
                    round.push_back(p + radius * glm::dvec2(std::cos(turn), std::sin(turn)));
                }
                chart.fill(std::move(round), ink);
            }
            const glm::dvec2 at = p - glm::dvec2(0, 13);
            chart.text(at, passes::legendNumber(s.value), 12, Anchor::middle, kBlack, true);
            numbers_.insert(numbers_.end(), {p, at});
        }
    }

    // A number a line, where it is clear of walls and openings, of other numbers and, best, of other lines. A
    // level without any gets one wherever it fits.
    void labels(Chart& chart, const std::vector<PlanFloor>& floors) const {
        // Pixels: length of the line, distance of the number's middle from walls and from other numbers.
        struct Room {
            double line, wall, label;
        };
        constexpr Room kAmple{50, 17, 42}, kTight{24, 13, 24};
        constexpr double kLine = 24;
        Points obstacles, placed = numbers_;
        const auto along = [&](const std::array<glm::dvec3, 2>& edge) {
            const glm::dvec2 a = pixel(flat(edge[0])), b = pixel(flat(edge[1]));
            const double steps = std::ceil(glm::distance(a, b) / 6 + 1e-9);
            for (double k = 0; k <= steps; ++k) obstacles.push_back(a + k / steps * (b - a));
        };
        for (const PlanFloor& floor : floors)
            for (const auto* edges : {&floor.outline, &floor.openings})
                std::for_each(edges->begin(), edges->end(), along);
        const auto nearest = [](const Points& points, glm::dvec2 p, double least) {
            for (glm::dvec2 q : points) least = std::min(least, glm::distance(p, q));
            return least;
        };
        std::vector<double> labelled; // levels
        const auto label = [&](const IsoLine& line, const Room& room) {
            double length = 0, best = 0;
            for (size_t k = 1; k < line.points.size(); ++k)
                length += glm::distance(line.points[k - 1], line.points[k]);
            if (length < room.line) return;
            const glm::dvec2* place = nullptr;
            for (size_t k = 0; k < line.points.size(); k += 2) {
                const glm::dvec2& p = line.points[k];
                if (nearest(obstacles, p, room.wall) < room.wall) continue;
                const double others = nearest(placed, p, 3 * room.label);
                if (others < room.label) continue;
                double lines = kLine;
                for (const IsoLine& other : lines_)
                    if (&other != &line) lines = nearest(other.points, p, lines);
                const double score = others / (3 * room.label) + 2 * lines / kLine;
                if (score > best) best = score, place = &p;
            }
            if (!place) return;
            placed.push_back(*place);
            labelled.push_back(line.level);
            chart.text(*place + glm::dvec2(0, 4), passes::legendNumber(line.level), 11, Anchor::middle,
                       kBlack, true);
        };
        for (const IsoLine& line : lines_) label(line, kAmple);
        for (const IsoLine& line : lines_)
            if (std::ranges::find(labelled, line.level) == labelled.end()) label(line, kTight);
    }

    void walls(Chart& chart, const std::vector<PlanFloor>& floors) const {
        for (const PlanFloor& floor : floors)
            for (const auto& [a, b] : floor.outline)
                chart.line({pixel(flat(a)), pixel(flat(b))}, kBlack, 1.8);
        for (const PlanFloor& floor : floors)
            for (const auto& [a, b] : floor.openings)
                chart.line({pixel(flat(a)), pixel(flat(b))}, kOpeningInk, 3);
    }

    struct IsoLine {
        double level;
        Points points; // pixels
    };
    static size_t planeOf(const Sunlight& sun, const SampleTriangle& t) {
        const double height = (t[0].height + t[1].height + t[2].height) / 3;
        const auto off = [&](double plane) { return std::abs(plane - height); };
        return static_cast<size_t>(std::ranges::min_element(sun.heights, {}, off) - sun.heights.begin());
    }
    static size_t planeAt(const Sunlight& sun, const std::vector<SampleTriangle>& triangles, glm::dvec2 p) {
        if (sun.heights.size() == 1) return 0;
        const auto at = std::ranges::find_if(triangles, [&](const SampleTriangle& t) {
            return isWithin({t[0].at, t[1].at, t[2].at}, p) || isWithin({t[2].at, t[1].at, t[0].at}, p);
        });
        return at == triangles.end() ? sun.heights.size() : planeOf(sun, *at);
    }
    // The sun's part added to triangles, each on the plane that is nearest to it.
    static std::vector<SampleTriangle> sunlit(std::vector<SampleTriangle> triangles, const Sunlight& sun) {
        std::vector<std::vector<SampleTriangle>> on(sun.heights.size());
        for (const SampleTriangle& t : triangles) on[planeOf(sun, t)].push_back(t);
        for (const Sunlight::Part& part : sun.parts)
            on[part.plane] = raisedWithin(on[part.plane], part.polygon, part.lux);
        triangles.clear();
        for (const auto& some : on) triangles.insert(triangles.end(), some.begin(), some.end());
        return triangles;
    }
    static double bandEnd(size_t band) { return static_cast<double>(band) / kBands; }
    // Parts of about ten pixels for the edges of triangles.
    size_t partsFor(double spacing) const {
        return static_cast<size_t>(std::clamp(std::round(pixelsPerWorld() * spacing / 10), 1.0, 10.0));
    }
    Ink inkAt(double share) const {
        ValueScale unit;
        unit.high = 1;
        return unit.ink(share);
    }
    // Out to the walls: a point of the floor's outline takes the value of the sensors nearest to it, one on
    // either side along the wall and before it, by how far along it they stand.
    void extend(const PlanFloor& floor, std::vector<Sample>& samples, double spacing) const {
        const size_t sensors = samples.size();
        for (const auto& [a, b] : floor.outline) {
            const glm::dvec2 wall = glm::normalize(flat(b) - flat(a));
            // Close enough together that triangles seldom reach over a wall.
            const double steps = std::clamp(
                std::ceil(glm::distance(flat(a), flat(b)) / std::max(0.35 * spacing, 1e-9)), 2.0, 50.0);
            for (double k = 0; k < steps; ++k) {
                const glm::dvec2 p = flat(a + k / steps * (b - a));
                struct {
                    double distance = 1e300, along = 0, value = 0, height = 0;
                } side[2];
                for (size_t s = 0; s < sensors; ++s) {
                    const double along = glm::dot(samples[s].at - p, wall),
                                 distance = glm::distance(samples[s].at, p);
                    // Light behind the wall is not its own; the floor lies to the wall's left.
                    const glm::dvec2 away = samples[s].at - p;
                    if (wall.y * away.x - wall.x * away.y < 0) continue;
                    auto& nearest = side[along > 0];
                    if (distance < nearest.distance)
                        nearest = {distance, std::abs(along), samples[s].value, samples[s].height};
                }
                const auto &near = side[side[1].distance < side[0].distance],
                           &far = side[!(side[1].distance < side[0].distance)];
                if (near.distance > 1e299) continue; // no sensor on this side
                const double span = near.along + far.along;
                const bool both = far.distance < 3 * near.distance && span > 0;
                samples.push_back(
                    {p, both ? (far.along * near.value + near.along * far.value) / span : near.value,
                     near.height});
            }
        }
    }
    glm::dvec2 pixel(glm::dvec2 p) const { return frame_.pixel(p); }
    double pixelsPerWorld() const { return frame_.pixelsPerWorld(); }

    const PlanFrame& frame_;
    const ValueScale& scale_;
    double border_; // world metres
    std::vector<IsoLine> lines_;
    Points numbers_; // pixels, where the sensors' stand
    bool hasSunEdges_ = false, hasDots_ = false;
};

struct Keys {
    bool sunEdges = false, dots = false;
};

void drawKeys(Chart& chart, const PlanFrame& frame, const Keys& has) {
    const glm::dvec2 first(0, has.sunEdges ? -9 : 0);
    frame.key(chart, first, kOpeningInk, 3, "opening");
    if (has.sunEdges) frame.key(chart, first + glm::dvec2(0, 18), kSunEdge, 1.2, "edge of direct sun");
    if (!has.dots) return;
    PlanDrawing::dot(chart, frame.keysAt() + first + glm::dvec2(92, 0));
    chart.text(frame.keysAt() + first + glm::dvec2(99, 4), "sensor", 11);
}

// Of the sensors, and of sun that falls between them as though it had as many.
ValueScale scaleOf(const PlanValues& given, const std::vector<PlanFloor>& floors) {
    std::vector<double> lux(given.values.begin(), given.values.end());
    for (const PlanFloor& floor : floors) {
        if (!floor.sun) continue;
        const double spacing = std::max(spacingOf(floor.samples), 1e-9);
        for (const Sunlight::Part& part : floor.sun->parts) {
            const bool seen = std::ranges::any_of(
                floor.samples, [&](const Sample& s) { return isWithin(part.polygon, s.at); });
            const double share = std::round(areaOf(part.polygon) / (spacing * spacing));
            if (!seen) lux.insert(lux.end(), static_cast<size_t>(std::min(share, 1e3)), part.lux);
        }
    }
    return luxScale(std::move(lux));
}

} // namespace

Plan planChart(const Scene& scene, const PlanValues& given, std::optional<ValueScale> scale,
               const std::string& title, const std::string& subtitle) {
    const std::vector<PlanFloor> floors = planFloors(scene, given);
    size_t shown = 0;
    for (const PlanFloor& floor : floors) shown += floor.samples.size();
    if (!scale) scale = scaleOf(given, floors);
    size_t storeys = 1;
    for (const PlanFloor& floor : floors) storeys = std::max(storeys, floor.storey + 1);
    const PlanFrame first = frameOf(scene, 0, storeys);
    Chart chart = first.chart();
    Keys has;
    for (size_t storey = 0; storey < storeys; ++storey) {
        std::vector<PlanFloor> here;
        std::ranges::copy_if(floors, std::back_inserter(here),
                             [&](const PlanFloor& floor) { return floor.storey == storey; });
        const PlanFrame frame = frameOf(scene, storey, storeys);
        if (storeys > 1) frame.caption(chart, storeyInWords(here, scene.worldPerBuilding));
        PlanDrawing plan(frame, *scale, kBorder * scene.worldPerBuilding);
        plan.draw(chart, here, shown <= kFew);
        has.sunEdges |= plan.hasSunEdges(), has.dots |= plan.hasDots();
    }
    first.title(chart, title, subtitle);
    drawScale(chart, *scale, first.scaleAt(), first.scaleHeight());
    first.foot(chart, scene.worldPerBuilding, scene.northDeg);
    drawKeys(chart, first, has);
    return {std::move(chart), shown};
}

} // namespace heliodon::app
