#include "vision/doubts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>

#include "geometry/counted.h"
#include "geometry/segment_distance.h"
#include "vision/edges.h"
#include "vision/median.h"

namespace heliodon::vision {

void Doubts::add(glm::dvec2 pixel, std::string_view what) {
    const auto same = std::find_if(matters_.begin(), matters_.end(),
                                   [&](const Matter& matter) { return matter.what == what; });
    if (same == matters_.end())
        matters_.push_back({std::string(what), {pixel}});
    else
        same->at.push_back(pixel);
}

std::vector<std::string> Doubts::lines() const {
    constexpr size_t kNamed = 4;
    std::vector<std::string> out;
    for (const Matter& matter : matters_) {
        const size_t count = matter.at.size(), named = std::min(count, kNamed);
        std::string places;
        for (size_t i = 0; i < named; ++i)
            places +=
                fmt::format("{}{:.0f}, {:.0f}", i == 0 ? "pixel " : "; ", matter.at[i].x, matter.at[i].y);
        if (named < count) places += " and " + geometry::counted(count - named, "more place");
        out.push_back(fmt::format("{}: {}", places, matter.what));
    }
    return out;
}

glm::dvec2 centreOf(const geometry::Detection& detection) {
    glm::dvec2 mean{};
    for (const auto& p : detection.outlinePx) mean += p / static_cast<double>(detection.outlinePx.size());
    return mean;
}

namespace {

class Examination {
public:
    Examination(const geometry::Sketch& sketch, const WallEvidence& evidence, const PlanView& view,
                const DetectOptions& options, Doubts& doubts)
        : sketch_(sketch), evidence_(evidence), view_(view), options_(options), doubts_(doubts) {}

    void run() {
        for (const auto& skylight : sketch_.skylights) lookAt(skylight);
        for (const auto& token : sketch_.tokens) lookAt(token);
        if (sketch_.north) lookAt(*sketch_.north);
        for (const auto& wall : sketch_.walls) lookForPaleMarkers(wall);
        for (const auto& window : sketch_.windows) lookAt(window);
        lookAtEnds();
        lookAtPicturesEdge();
        for (const auto& wall : sketch_.walls) lookBeyond(wall);
        for (const auto& arc : sketch_.arcs) lookBeyond(arc);
    }

private:
    void lookAt(const geometry::Skylight& skylight) {
        constexpr double kAllEdges = 0.98, kAsChip = 0.12; // inches
        constexpr double kNarrow = 1, kLong = 3;           // inches; times as long as wide
        const double chip = options_.tokenSide - 4 * options_.tokenBand;
        const glm::dvec2 off = glm::abs(skylight.size - chip);
        if (skylight.detection.confidence < kAllEdges)
            doubts_.add(centreOf(skylight.detection),
                        "read as a skylight, but its edges are not straight all round");
        else if (const auto [least, most] = std::minmax({skylight.size.x, skylight.size.y});
                 least < kNarrow && most > kLong * least)
            doubts_.add(centreOf(skylight.detection),
                        "read as a skylight, but as narrow as a wall or a face of one: is it one?");
        else if (std::max(off.x, off.y) < kAsChip)
            doubts_.add(centreOf(skylight.detection),
                        "read as a skylight, but as large as the chip of a token: is it one?");
        else if (!isLightBlue(skylight))
            doubts_.add(centreOf(skylight.detection), "read as a skylight, but deeper or darker than "
                                                      "light-blue card: is it a mat, a note or a pot?");
    }

    // The chip's colour is told by the white round it: cut off, that makes it lighter, by more in one channel
    // than in another.
    void lookAt(const geometry::Token& token) {
        constexpr uint8_t kClipped = 254;
        constexpr int kAlong = 10, kMost = 8 * kAlong / 4; // samples along half a side; a quarter of all
        const Photograph& photo = view_.photo();
        const double angle = glm::radians(token.angleDeg),
                     ring = 0.5 * options_.tokenSide - 1.5 * options_.tokenBand;
        const glm::dvec2 axis(std::cos(angle), std::sin(angle));
        int clipped = 0;
        for (const glm::dvec2 out : {axis, -axis, turnedLeft(axis), -turnedLeft(axis)})
            for (int i = -kAlong; i < kAlong; ++i) {
                const glm::dvec2 at = token.pos + ring * (out + (i + 0.5) / kAlong * turnedLeft(out));
                const glm::dvec2 p = view_.pixel(at, options_.tokenThickness);
                const auto x = std::lround(p.x), y = std::lround(p.y);
                if (x < 0 || y < 0 || x >= photo.width || y >= photo.height) continue;
                const uint8_t* rgb = &photo.rgb[3 * static_cast<size_t>(y * photo.width + x)];
                clipped += std::max({rgb[0], rgb[1], rgb[2]}) >= kClipped;
            }
        if (clipped > kMost)
            doubts_.add(centreOf(token.detection),
                        "the white round a token's chip is overexposed: the chip is read too light");
    }

    // Its confidence is the share of its length along which both sides are seen as edges that lie alike.
    void lookAt(const geometry::NorthArrow& north) {
        constexpr double kMost = 0.5;
        if (north.detection.confidence < kMost)
            doubts_.add(centreOf(north.detection),
                        "read as the north arrow, but its two sides are not seen all along: is it one?");
    }

    // Coloured fringes along a wall's sides, where the lens or the mosaic parts the channels, can be as long
    // as a marker. Those of the paper are on walls of full height.
    void lookAt(const geometry::WindowMarker& window) {
        constexpr double kNarrow = 0.8; // inches
        const geometry::Wall& wall = sketch_.walls[std::stoul(window.wall)];
        if (wall.heightClass == geometry::HeightClass::green)
            doubts_.add(centreOf(window.detection),
                        "read as a window marker, but on a low wall, which has no windows: is it one?");
        else if (window.width < kNarrow)
            doubts_.add(centreOf(window.detection), "read as a window marker, but very narrow: is it one?");
    }

    // Light blue is one group with blue, so that a cyan marker read as light blue goes with the wall's paint;
    // so is orange with red.
    void lookForPaleMarkers(const geometry::Wall& wall) {
        const double height = geometry::heightInches(wall.heightClass);
        for (const auto& [shade, name] : {std::pair{Paint::sky, "light blue"}, {Paint::orange, "orange"}})
            for (const glm::dvec2 middle : evidence_.otherShadeOn(wall, shade))
                if (!isUnderMarker(middle))
                    doubts_.add(
                        view_.pixel(middle, height),
                        fmt::format("{} on a wall's top: a marker of a window? It is left out", name));
    }

    // The card returns most of the light and takes half of the red: its chroma holds in shadow, its
    // brightness within what the light found there is good for.
    bool isLightBlue(const geometry::Skylight& skylight) const {
        constexpr float kDeepest = 0.65f, kDarkest = 0.35f; // saturation; of white
        constexpr int kPlaces = 4;                          // to either side of the middle
        std::array<std::vector<float>, 3> seen;
        const double angle = glm::radians(skylight.angleDeg);
        const glm::dvec2 axis(std::cos(angle), std::sin(angle));
        for (int i = -kPlaces; i <= kPlaces; ++i)
            for (int j = -kPlaces; j <= kPlaces; ++j) {
                const glm::dvec2 off = 0.1 * skylight.size * glm::dvec2(i, j);
                const auto light = evidence_.overWhite(
                    skylight.center + off.x * axis + off.y * turnedLeft(axis), options_.markerThickness);
                for (int channel = 0; light && channel < 3; ++channel)
                    seen[static_cast<size_t>(channel)].push_back((*light)[channel]);
            }
        if (seen[0].empty()) return true;
        std::array<float, 3> typical{};
        for (size_t channel = 0; channel < 3; ++channel) typical[channel] = median(std::move(seen[channel]));
        const auto [low, high] = std::minmax_element(typical.begin(), typical.end());
        return *high > kDarkest && *high - *low < kDeepest * *high;
    }

    struct End {
        glm::dvec2 plan{};
        double height = 0;
        glm::vec3 seen{};
        std::optional<float> step; // over what is beside it, where that is no other wall
    };
    // Those in the picture that no marker covers: beneath one, the marker tells where the end is.
    std::vector<End> seenEnds() const {
        std::vector<End> ends;
        const auto look = [&](const auto& shape) {
            constexpr double kAlone = 0.9; // inches
            const double height = geometry::heightInches(shape.heightClass);
            const auto middles = evidence_.endsOf(shape);
            const auto steps = evidence_.endSteps(shape);
            for (size_t k = 0; k < middles.size(); ++k) {
                const auto seen = evidence_.overWhite(middles[k], height);
                if (!seen || isUnderMarker(middles[k])) continue;
                ends.push_back({middles[k], height, *seen, std::nullopt});
                if (!anotherStandsAt(view_.pixel(middles[k], height), shape, kAlone))
                    ends.back().step = steps[k];
            }
        };
        for (const auto& wall : sketch_.walls) look(wall);
        for (const auto& arc : sketch_.arcs) look(arc);
        return ends;
    }
    bool isUnderMarker(glm::dvec2 plan) const {
        return std::any_of(sketch_.windows.begin(), sketch_.windows.end(), [&](const auto& window) {
            const geometry::Wall& wall = sketch_.walls[std::stoul(window.wall)];
            const glm::dvec2 along = glm::normalize(wall.b - wall.a), half = 0.5 * window.width * along;
            const glm::dvec2 middle = wall.a + window.pos * along;
            return geometry::distanceToSegment(plan, middle - half, middle + half) <
                   0.5 * options_.wallThickness;
        });
    }

    // Card has one colour all over the table and is brighter than what is beside it. An end that shows
    // another, or is much darker, or no brighter where others are, is not the wall's but where something
    // hides it or where its paint is interrupted.
    void lookAtEnds() {
        constexpr float kMostColour = 0.18f, kDarkest = 0.4f; // of the typical end
        constexpr float kTypicalStep = 0.1f, kNoStep = 0;
        const std::vector<End> ends = seenEnds();
        std::vector<float> steps;
        for (const End& end : ends)
            if (end.step) steps.push_back(*end.step);
        const float typicalStep = steps.empty() ? 0 : median(std::move(steps));
        glm::vec3 typical(1);
        for (int channel = 0; channel < 3; ++channel) {
            std::vector<float> values;
            for (const End& end : ends) values.push_back(end.seen[channel]);
            if (!values.empty()) typical[channel] = median(std::move(values));
        }
        for (const End& end : ends) {
            const glm::vec3 seen = end.seen / typical;
            const auto [low, high] = std::minmax({seen.r, seen.g, seen.b});
            const bool standsOut = typicalStep < kTypicalStep || !end.step || *end.step > kNoStep;
            if (high - low < kMostColour * high && high > kDarkest && standsOut) continue;
            doubts_.add(view_.pixel(end.plan, end.height),
                        "a wall's white end is not seen here; it is read as far as its paint is");
        }
    }

    void lookAtPicturesEdge() {
        const auto look = [&](const auto& list) {
            for (const auto& shape : list) lookAtPicturesEdge(shape.detection);
        };
        look(sketch_.walls), look(sketch_.arcs), look(sketch_.windows);
        look(sketch_.skylights), look(sketch_.tokens);
        if (sketch_.north) lookAtPicturesEdge(sketch_.north->detection);
    }
    void lookAtPicturesEdge(const geometry::Detection& detection) {
        constexpr double kEdge = 3; // pixels
        const glm::dvec2 last(view_.photo().width - 1, view_.photo().height - 1);
        for (const glm::dvec2& p : detection.outlinePx) {
            if (std::min({p.x, p.y, last.x - p.x, last.y - p.y}) >= kEdge) continue;
            doubts_.add(glm::clamp(p, glm::dvec2(0), last),
                        "reaches the picture's edge; it is read as far as it is seen");
            return;
        }
    }

    // A wall's top goes on beyond its white end where glare or wear hides the paint.
    template<class Shape> void lookBeyond(const Shape& shape) {
        constexpr double kNear = 0.6; // inches
        const double height = geometry::heightInches(shape.heightClass);
        for (const glm::dvec2 beyond : evidence_.goesOnTo(shape)) {
            const glm::dvec2 p = view_.pixel(beyond, height);
            if (!anotherStandsAt(p, shape, kNear))
                doubts_.add(p, "a wall seems to go on without paint; it is read as far as its paint");
        }
    }
    // Within `inches` of its middle line, at its height.
    template<class Shape> bool anotherStandsAt(glm::dvec2 pixel, const Shape& shape, double inches) const {
        const auto stands = [&](const auto& other) {
            if (static_cast<const void*>(&other) == static_cast<const void*>(&shape)) return false;
            const double height = geometry::heightInches(other.heightClass);
            return evidence_.distance(other, view_.plan(pixel, height)) < inches;
        };
        return std::any_of(sketch_.walls.begin(), sketch_.walls.end(), stands) ||
               std::any_of(sketch_.arcs.begin(), sketch_.arcs.end(), stands);
    }

    const geometry::Sketch& sketch_;
    const WallEvidence& evidence_;
    const PlanView& view_;
    const DetectOptions& options_;
    Doubts& doubts_;
};

} // namespace

void addDoubts(const geometry::Sketch& sketch, const WallEvidence& evidence, const PlanView& view,
               const DetectOptions& options, Doubts& doubts) {
    Examination(sketch, evidence, view, options, doubts).run();
}

} // namespace heliodon::vision
