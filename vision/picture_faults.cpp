#include "vision/picture_faults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "vision/doubts.h"
#include "vision/edges.h"
#include "vision/median.h"

namespace heliodon::vision {
namespace {

std::optional<std::string> overexposed(const PlanView& view, double radius) {
    constexpr double kMost = 0.005, kMostOfOne = 0.1, kStep = 0.25; // of the table; inches
    constexpr uint8_t kClipped = 254;
    const Photograph& photo = view.photo();
    glm::dvec2 where{};
    double clipped = 0, table = 0;
    std::array<double, 3> clippedIn{}; // a channel
    for (double x = -radius; x <= radius; x += kStep)
        for (double y = -radius; y <= radius; y += kStep) {
            if (glm::length(glm::dvec2(x, y)) > radius - kStep) continue;
            const glm::dvec2 p = view.pixel({x, y}, 0);
            const auto i = std::lround(p.x), j = std::lround(p.y);
            if (i < 0 || j < 0 || i >= photo.width || j >= photo.height) continue;
            const uint8_t* rgb = &photo.rgb[3 * (static_cast<size_t>(j) * static_cast<size_t>(photo.width) +
                                                 static_cast<size_t>(i))];
            table += 1;
            if (std::min({rgb[0], rgb[1], rgb[2]}) >= kClipped) clipped += 1, where += p;
            for (size_t c = 0; c < 3; ++c) clippedIn[c] += rgb[c] >= kClipped;
        }
    const double worst = *std::max_element(clippedIn.begin(), clippedIn.end());
    if (clipped <= kMost * table && worst > kMostOfOne * table) {
        std::string channels;
        for (size_t c = 0; c < 3; ++c)
            if (clippedIn[c] > kMostOfOne * table)
                channels +=
                    (channels.empty() ? "" : " and ") + std::array<std::string, 3>{"red", "green", "blue"}[c];
        return fmt::format(
            "{:.0f} % of the table are overexposed in {} alone: its white has another colour there "
            "than in shadows; paint may be misread",
            100 * worst / table, channels);
    }
    if (clipped <= kMost * table) return std::nullopt;
    where /= clipped;
    return fmt::format("about pixel {:.0f}, {:.0f}: {:.0f} % of the table are overexposed; what lies there "
                       "cannot be seen",
                       where.x, where.y, std::max(1.0, 100 * clipped / table));
}

constexpr float kPale = 0.45f; // saturation

// By what is too pale to be paint by itself.
template<class Shape> bool isReadAsPale(const Shape& shape, const WallEvidence& evidence) {
    return evidence.saturationOf(shape) < kPale && !evidence.isWall(shape);
}

// Glare, wear and a camera's settings make paint pale; that of the walls found is as the rest, of which some
// may be paler than what counts as paint.
std::optional<std::string> pale(const geometry::Sketch& sketch, const WallEvidence& evidence) {
    std::vector<float> saturation;
    std::optional<float> palest; // of the walls read as pale
    const auto look = [&](const auto& shape) {
        saturation.push_back(evidence.saturationOf(shape));
        if (isReadAsPale(shape, evidence)) palest = std::min(palest.value_or(1), saturation.back());
    };
    for (const auto& wall : sketch.walls) look(wall);
    for (const auto& arc : sketch.arcs) look(arc);
    if (saturation.empty()) return std::nullopt;
    const float typical = median(std::move(saturation));
    if (typical < kPale)
        return fmt::format(
            "the walls' paint is pale (saturation {:.2f}, expected 0.6 to 0.9): was the picture's "
            "colour turned down, or is there glare? Walls, markers and tokens may be missed",
            typical);
    if (!palest) return std::nullopt;
    return fmt::format(
        "paint of a wall is pale (saturation {:.2f}, expected 0.6 to 0.9): is there glare, or is it "
        "worn? Other walls, markers and tokens may be missed",
        *palest);
}

// Pixels across the sharpest part of a side, as long as its whole step would take at that slope.
std::optional<double> edgeWidth(const PlanView& view, glm::dvec2 plan, glm::dvec2 outward, glm::dvec2 along,
                                double thickness, double height) {
    constexpr double kStep = 0.5, kReach = 0.15; // pixels; inches, to average along the side
    constexpr float kLeast = 0.2f;               // of the brighter side
    const double perInch = view.pixelsPerInch(plan, height);
    const int steps = static_cast<int>(thickness * perInch / kStep);
    std::vector<float> profile;
    for (int i = -steps; i <= steps; ++i) {
        float sum = 0;
        for (const double side : {-kReach, -0.5 * kReach, 0.0, 0.5 * kReach, kReach}) {
            const glm::vec3 light =
                view.light(view.pixel(plan + i * kStep / perInch * outward + side * along, height));
            sum += light.r + light.g + light.b;
        }
        profile.push_back(sum);
    }
    if (profile.size() < 3) return std::nullopt;
    const size_t middle = profile.size() / 2;
    float slope = 0;
    for (size_t i = 1; i < profile.size(); ++i)
        slope = std::max(slope, std::abs(profile[i] - profile[i - 1]));
    // The paint's own level is that of the wall's middle, half a thickness within.
    const float inside = profile[middle / 2], outside = profile[middle + middle / 2],
                step = std::abs(inside - outside);
    if (step < kLeast * std::max(inside, outside) || slope <= 0) return std::nullopt;
    return static_cast<double>(step / slope) * kStep;
}

// Against the width of the walls' own tops: what is thinner than that, as a token's rim, runs together.
std::optional<std::string> smeared(const geometry::Sketch& sketch, const PlanView& view,
                                   const DetectOptions& options) {
    constexpr double kMost = 0.5, kLeastPixels = 4.5; // of the top's width; of the top on the table
    const double top = options.wallThickness * view.pixelsPerInch({0, 0}, 0);
    if (top < kLeastPixels)
        return fmt::format("a wall's top is {:.2f} pixels wide, expected {:.2f} or more: walls and markers "
                           "may be misread, tokens missed; more pixels or a nearer camera help",
                           top, kLeastPixels);
    std::vector<double> widths;
    for (const auto& wall : sketch.walls) {
        const double height = geometry::heightInches(wall.heightClass);
        const glm::dvec2 along = glm::normalize(wall.b - wall.a), across = turnedLeft(along);
        for (const double at : {0.2, 0.35, 0.5, 0.65, 0.8})
            for (const double side : {-0.5, 0.5}) {
                const glm::dvec2 plan = wall.a + at * (wall.b - wall.a) + side * wall.thickness * across;
                if (const auto width =
                        edgeWidth(view, plan, 2 * side * across, along, wall.thickness, height))
                    widths.push_back(*width / (wall.thickness * view.pixelsPerInch(plan, height)));
            }
    }
    if (widths.empty()) return std::nullopt;
    const double typical = median(std::move(widths));
    if (typical < kMost) return std::nullopt;
    return fmt::format("the picture is out of focus: edges are {:.0f} % as wide as a wall's top; walls and "
                       "markers may be misread, tokens missed",
                       100 * typical);
}

// Streaks and wear: the worst of the walls that were read by their paint tells of those that were not.
std::optional<std::string> interrupted(const geometry::Sketch& sketch, const WallEvidence& evidence) {
    constexpr double kWhole = 0.88;
    double least = 1;
    glm::dvec2 where{};
    for (const auto& wall : sketch.walls) {
        if (isReadAsPale(wall, evidence)) continue;
        if (const double share = evidence.paintedShareOf(wall); share < least)
            least = share, where = centreOf(wall.detection);
    }
    if (least > kWhole) return std::nullopt;
    return fmt::format(
        "about pixel {:.0f}, {:.0f}: {:.0f} % of a wall's top are bare between its ends: is the paint "
        "streaked, worn or in glare? Walls may be misread or missed",
        where.x, where.y, 100 * (1 - least));
}

} // namespace

std::vector<std::string> pictureFaults(const geometry::Sketch& sketch, const ClassImage& image,
                                       const WallEvidence& evidence, const PlanView& view,
                                       const DetectOptions& options, double radius) {
    std::vector<std::string> out;
    if (auto line = overexposed(view, radius)) out.push_back(std::move(*line));
    constexpr int kCoarse = 35;
    if (view.photo().jpegQuality < kCoarse)
        out.push_back(
            fmt::format("the file is strongly compressed (JPEG quality {}): colours run together over "
                        "16 pixels, markers and tokens may be misread",
                        view.photo().jpegQuality));
    if (image.hidesSky)
        out.emplace_back(
            "the table has the colour of light-blue card: skylights on it are not seen, and blue "
            "paint may be missed");
    if (image.shadeHidesSky)
        out.emplace_back(
            "the light in shadows has another colour than elsewhere, by which light-blue card looks "
            "white there: skylights in shadows may be missed");
    constexpr double kNoisy = 0.1, kMottled = 0.05;
    if (image.noise > kNoisy)
        out.push_back(
            fmt::format("the picture is so dark that noise is {:.0f} % of what white returns: walls may "
                        "be missed and colours misread; more light or a longer exposure helps",
                        100 * image.noise));
    if (image.faintShare > kMottled)
        out.push_back(
            fmt::format("{:.0f} % of the table look faintly coloured: noise of the camera, or coloured "
                        "light? Walls and markers may be misread",
                        100 * image.faintShare));
    if (auto line = smeared(sketch, view, options)) out.push_back(std::move(*line));
    if (auto line = pale(sketch, evidence)) out.push_back(std::move(*line));
    if (auto line = interrupted(sketch, evidence)) out.push_back(std::move(*line));
    return out;
}

} // namespace heliodon::vision
