#include "vision/wall_evidence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "geometry/segment_distance.h"
#include "vision/chroma.h"
#include "vision/edges.h"
#include "vision/median.h"
#include "vision/pieces.h"

namespace heliodon::vision {
namespace {

Paint paintOf(geometry::HeightClass height) {
    return height == geometry::HeightClass::red    ? Paint::red
           : height == geometry::HeightClass::blue ? Paint::blue
                                                   : Paint::green;
}

// `from`, `to`: shares of the length.
std::vector<glm::dvec2> along(const geometry::Wall& wall, double from, double to, int steps) {
    std::vector<glm::dvec2> out;
    for (int i = 0; i <= steps; ++i) out.push_back(glm::mix(wall.a, wall.b, from + (to - from) * i / steps));
    return out;
}
std::vector<glm::dvec2> along(const geometry::Arc& arc, double from, double to, int steps) {
    std::vector<glm::dvec2> out;
    for (int i = 0; i <= steps; ++i) {
        const double share = from + (to - from) * i / steps;
        const double a = glm::radians(arc.a0Deg + share * (arc.a1Deg - arc.a0Deg));
        out.push_back(arc.center + arc.radius * glm::dvec2(std::cos(a), std::sin(a)));
    }
    return out;
}

double lengthOf(const geometry::Wall& wall) {
    return glm::distance(wall.a, wall.b);
}
double lengthOf(const geometry::Arc& arc) {
    return arc.radius * glm::radians(arc.a1Deg - arc.a0Deg);
}

// Of all but the ends, every quarter of an inch.
template<class Shape> std::vector<glm::dvec2> paintedLine(const Shape& shape, double unpainted) {
    const double length = lengthOf(shape), end = unpainted / length;
    return along(shape, end, 1 - end, static_cast<int>(4 * length) + 2);
}

template<class Shape> std::vector<glm::dvec2> middlesOfEnds(const Shape& shape, double unpainted) {
    const double in = 0.5 * unpainted / lengthOf(shape);
    return along(shape, in, 1 - in, 1);
}

} // namespace

WallEvidence::Line WallEvidence::endsOf(const geometry::Wall& wall) const {
    return middlesOfEnds(wall, options_.unpaintedEnd);
}
WallEvidence::Line WallEvidence::endsOf(const geometry::Arc& arc) const {
    return middlesOfEnds(arc, options_.unpaintedEnd);
}

bool WallEvidence::isWall(const geometry::Wall& wall) const {
    return isWallWithEnds(wall);
}
bool WallEvidence::isWall(const geometry::Arc& arc) const {
    return isWallWithEnds(arc);
}
template<class Shape> bool WallEvidence::isWallWithEnds(const Shape& shape) const {
    if (lengthOf(shape) <= 2 * options_.unpaintedEnd) return false; // nothing between its ends
    const Line ends = endsOf(shape);
    return isWall(paintedLine(shape, options_.unpaintedEnd), paintOf(shape.heightClass), ends[0], ends[1]);
}
bool WallEvidence::isWall(const Line& painted, Paint paint, glm::dvec2 end, glm::dvec2 otherEnd) const {
    return isStripOfPaint(painted, paint) && !isRim(painted, heightOf(paint)) &&
           !(isBare(end, heightOf(paint)) && isBare(otherEnd, heightOf(paint)));
}

bool WallEvidence::isRim(const Line& painted, double height) const {
    constexpr float kSameHue = 15, kLeast = 0.2f; // degrees; P' of a floor with a hue
    // Byte. Half a byte more in one channel and less in another makes that P' of it: gamma / kDarkest.
    constexpr size_t kDarkest = 11;
    const double reach = view_.photo().chromaStep > 0 ? 16 : 3; // pixels
    const double band = options_.wallThickness + reach / view_.pixelsPerInch({0, 0}, 0);
    size_t rim = 0;
    for (const glm::dvec2 plan : painted) {
        const glm::dvec2 onTable = view_.plan(view_.pixel(plan, height), 0);
        const double from = glm::length(onTable);
        if (std::abs(from - radius_) > band) continue;
        const glm::dvec2 beyond = onTable * ((radius_ + band + options_.wallThickness) / from);
        const glm::vec3 light = view_.light(view_.pixel(beyond, 0));
        if (std::max({light.r, light.g, light.b}) < view_.linearFromByte()[kDarkest]) continue;
        const auto floor = overWhite(beyond, 0), seen = overWhite(plan, height);
        if (!floor || !seen || vision::saturationOf(*floor) < kLeast) continue;
        const float apart = std::abs(hueOf(*floor) - hueOf(*seen));
        rim += std::min(apart, 360 - apart) < kSameHue;
    }
    return 2 * rim > painted.size();
}

bool WallEvidence::isStripOfPaint(const Line& painted, Paint paint) const {
    constexpr double kCovered = 0.5, kBeside = 0.2; // share of places
    const double height = heightOf(paint), half = 0.5 * options_.wallThickness;
    // Beyond what blur reaches.
    const double out = half + std::max(0.8 * half, 2.2 / view_.pixelsPerInch(painted.front(), height));
    int covered = 0, on = 0, same = 0, beside = 0;
    for (size_t i = 1; i + 1 < painted.size(); ++i) {
        const glm::dvec2 across = turnedLeft(glm::normalize(painted[i + 1] - painted[i - 1]));
        for (const double off : {-out, out})
            same += paintSeen(painted[i] + off * across, height) == paint, ++beside;
        for (const double off : {-0.5 * half, 0.0, 0.5 * half}) {
            const Paint there = paintSeen(painted[i] + off * across, height);
            covered += there == paint || isMarker(there), ++on;
        }
    }
    return same < kBeside * beside && covered >= kCovered * on;
}

std::optional<glm::vec3> WallEvidence::overWhite(glm::dvec2 plan, double height) const {
    constexpr double kReach = 0.1; // inches
    const glm::dvec2 middle = view_.pixel(plan, height);
    const Photograph& photo = view_.photo();
    if (!(middle.x >= 0 && middle.y >= 0 && middle.x <= photo.width - 1 && middle.y <= photo.height - 1))
        return std::nullopt;
    glm::vec3 sum(0);
    for (const double x : {-kReach, 0.0, kReach})
        for (const double y : {-kReach, 0.0, kReach}) {
            const glm::dvec2 p = view_.pixel(plan + glm::dvec2(x, y), height);
            sum += view_.light(p) / view_.white(p) / 9.0f;
        }
    return sum;
}

bool WallEvidence::isBare(glm::dvec2 end, double height) const {
    constexpr float kFloor = 0.35f; // of white
    const glm::vec3 light = overWhite(end, height).value_or(glm::vec3(1));
    const float seen = std::max({light.r, light.g, light.b}), table = 1 / image_.whiteOverTable.g;
    const bool overTable = glm::length(view_.plan(view_.pixel(end, height), 0)) < radius_;
    if (!overTable) return seen < kFloor;
    return table < 1 && seen < 0.8f * std::sqrt(table); // nearer to the table than to card
}

Paint WallEvidence::paintSeen(glm::dvec2 plan, double height) const {
    return image_.groupAt(view_.pixel(plan, height));
}

// Both sides in stretches of an inch, and both ends.
template<class Shape> std::vector<WallEvidence::Stretch> WallEvidence::stretchesOf(const Shape& shape) const {
    constexpr double kStep = 0.2, kEnd = 0.3; // inches
    constexpr size_t kPoints = 6;             // of a stretch
    const double length = lengthOf(shape), half = 0.5 * options_.wallThickness, end = kEnd / length;
    const Line line = along(shape, end, 1 - end, std::max(4, static_cast<int>((length - 2 * kEnd) / kStep)));
    std::vector<Stretch> out;
    for (size_t begin = 0; begin + 2 < line.size(); begin += kPoints) {
        const size_t last = std::min(begin + kPoints, line.size()) - 1;
        const glm::dvec2 left = turnedLeft(glm::normalize(line[last] - line[begin]));
        for (const double side : {-1.0, 1.0}) {
            out.push_back({{}, side * left});
            for (size_t i = begin; i <= last; ++i) out.back().foot.push_back(line[i] + side * half * left);
        }
    }
    const Line tips = along(shape, 0, 1, 1);
    for (const auto& [tip, inner] : {std::pair{tips[0], line.front()}, {tips[1], line.back()}}) {
        out.push_back({{}, glm::normalize(tip - inner)});
        for (const double off : {-0.6, -0.3, 0.0, 0.3, 0.6})
            out.back().foot.push_back(tip + off * half * turnedLeft(out.back().outward));
    }
    return out;
}

float WallEvidence::levelAt(glm::dvec2 plan, double height) const {
    const glm::vec3 light = view_.light(view_.pixel(plan, height));
    return (light.r + light.g + light.b) / 3;
}

// Relative to the level. None where the face looks away from the camera or is too narrow in the picture.
std::optional<float> WallEvidence::footStep(const Stretch& stretch, double height) const {
    constexpr double kSpacing = 0.25, kLeastPx = 2.6; // from sample to sample: inches, pixels
    constexpr float kDarkest = 1e-4f, kOverexposed = 0.97f;
    const glm::dvec3 eye = view_.camera().centre() / geometry::kMetresPerInch;
    const glm::dvec2 middle = stretch.foot[stretch.foot.size() / 2];
    const double away = glm::dot(glm::dvec2(eye.x, -eye.z) - middle, stretch.outward);
    const double hidden = away * height / (eye.y - height); // of the table behind the foot
    const double spacing = std::min(kSpacing, hidden / 2.5);
    if (spacing * view_.pixelsPerInch(middle, 0) < kLeastPx) return std::nullopt;
    std::array<glm::vec3, 4> light{}; // two on the face, two on the table
    for (size_t k = 0; k < light.size(); ++k)
        for (const glm::dvec2& p : stretch.foot)
            light[k] +=
                view_.light(view_.pixel(p + (static_cast<double>(k) - 1.5) * spacing * stretch.outward, 0)) /
                static_cast<float>(stretch.foot.size());
    const auto step = [&](const auto& levelOf) -> std::optional<float> {
        std::array<float, 4> level{};
        for (size_t k = 0; k < level.size(); ++k) level[k] = levelOf(light[k]);
        const float mean = 0.25f * (level[0] + level[1] + level[2] + level[3]);
        if (mean < kDarkest || mean > kOverexposed) return std::nullopt;
        // Less what an even gradient of light has there.
        return std::abs(level[1] - level[2] - 0.5f * (level[0] - level[1] + level[2] - level[3])) / mean;
    };
    std::optional<float> most = step([](glm::vec3 l) { return (l.r + l.g + l.b) / 3; });
    // A face and the table at its foot in two lights may be as bright as one another, but not of one colour.
    for (int c = 0; c < 3 && most && image_.twoLights; ++c)
        most = std::max(*most, step([c](glm::vec3 l) { return l[c]; }).value_or(0));
    return most;
}

float WallEvidence::endStep(glm::dvec2 end, glm::dvec2 outward, double height) const {
    constexpr double kStep = 0.05, kBeside = 0.22; // inches
    const double aside = 0.5 * options_.wallThickness + kBeside;
    std::array<float, 3> level{}; // beside, on it, beside
    for (int i = -2; i <= 2; ++i)
        for (int j = -1; j <= 1; ++j)
            for (size_t k = 0; k < level.size(); ++k) {
                const double off = (static_cast<double>(k) - 1) * aside + kStep * j;
                level[k] += levelAt(end + kStep * i * outward + off * turnedLeft(outward), height);
            }
    const float beside = 0.5f * (level[0] + level[2]);
    return (level[1] - beside) / std::max(0.5f * (level[1] + beside), 1e-4f);
}

template<class Shape> std::array<float, 2> WallEvidence::stepsOfEnds(const Shape& shape) const {
    const double height = geometry::heightInches(shape.heightClass);
    const Line ends = endsOf(shape), tips = along(shape, 0, 1, 1);
    std::array<float, 2> out{};
    for (size_t k = 0; k < 2; ++k) out[k] = endStep(ends[k], glm::normalize(tips[k] - ends[k]), height);
    return out;
}
std::array<float, 2> WallEvidence::endSteps(const geometry::Wall& wall) const {
    return stepsOfEnds(wall);
}
std::array<float, 2> WallEvidence::endSteps(const geometry::Arc& arc) const {
    return stepsOfEnds(arc);
}

EndLook WallEvidence::lookOf(glm::dvec2 end, double height) const {
    constexpr float kColour = 0.15f, kBare = 1.04f, kCard = 1.1f; // saturation; of white
    const auto seen = overWhite(end, height);
    if (!seen || vision::saturationOf(*seen) > kColour) return EndLook::other;
    const float level = (seen->r + seen->g + seen->b) / 3;
    return level < kBare ? EndLook::bare : level > kCard ? EndLook::card : EndLook::other;
}

double WallEvidence::paintedShareOf(const geometry::Wall& wall) const {
    constexpr double kBlur = 0.1, kStep = 0.1; // inches
    const double height = geometry::heightInches(wall.heightClass), off = 0.25 * options_.wallThickness;
    const double length = lengthOf(wall), end = (options_.unpaintedEnd + kBlur) / length;
    if (end >= 0.5) return 1;
    const glm::dvec2 across = turnedLeft(glm::normalize(wall.b - wall.a));
    size_t painted = 0, all = 0;
    for (const glm::dvec2 middle :
         along(wall, end, 1 - end, 1 + static_cast<int>((1 - 2 * end) * length / kStep)))
        for (const double side : {-off, 0.0, off}) {
            painted += paintSeen(middle + side * across, height) != Paint::none;
            ++all;
        }
    return static_cast<double>(painted) / static_cast<double>(all);
}

WallEvidence::Line WallEvidence::otherShadeOn(const geometry::Wall& wall, Paint shade) const {
    constexpr double kStep = 0.1, kLeast = 0.5; // inches
    const double height = geometry::heightInches(wall.heightClass), length = lengthOf(wall);
    const double end = options_.unpaintedEnd / length, side = 0.25 * options_.wallThickness;
    if (end >= 0.5) return {};
    const glm::dvec2 across = side * turnedLeft(glm::normalize(wall.b - wall.a));
    const auto isOther = [&](glm::dvec2 middle) {
        int seen = 0;
        for (const glm::dvec2 plan : {middle - across, middle, middle + across}) {
            const glm::dvec2 p = view_.pixel(plan, height);
            seen +=
                image_.at(static_cast<int>(std::lround(p.x)), static_cast<int>(std::lround(p.y))) == shade;
        }
        return seen >= 2;
    };
    Line out, stretch;
    size_t all = 0, other = 0;
    const auto close = [&] {
        if (kStep * static_cast<double>(stretch.size()) >= kLeast)
            out.push_back(0.5 * (stretch.front() + stretch.back()));
        stretch.clear();
    };
    for (const glm::dvec2 middle :
         along(wall, end, 1 - end, 1 + static_cast<int>((1 - 2 * end) * length / kStep))) {
        ++all;
        if (isOther(middle))
            stretch.push_back(middle), ++other;
        else
            close();
    }
    close();
    return 2 * other > all ? Line{} : out;
}

template<class Shape> float WallEvidence::medianSaturation(const Shape& shape) const {
    std::vector<float> seen;
    for (const glm::dvec2 at : paintedLine(shape, options_.unpaintedEnd))
        if (const auto light = overWhite(at, geometry::heightInches(shape.heightClass)))
            seen.push_back(vision::saturationOf(*light));
    return seen.empty() ? 0 : median(std::move(seen));
}
float WallEvidence::saturationOf(const geometry::Wall& wall) const {
    return medianSaturation(wall);
}
float WallEvidence::saturationOf(const geometry::Arc& arc) const {
    return medianSaturation(arc);
}

template<class Shape> Relief WallEvidence::reliefOfShape(const Shape& shape) const {
    const double height = geometry::heightInches(shape.heightClass);
    Relief out;
    out.ends = stepsOfEnds(shape);
    const Line ends = endsOf(shape);
    for (size_t k = 0; k < 2; ++k) out.looks[k] = lookOf(ends[k], height);
    std::vector<float> steps;
    for (const Stretch& stretch : stretchesOf(shape))
        if (const auto step = footStep(stretch, height)) steps.push_back(*step);
    if (!steps.empty()) out.foot = median(std::move(steps));
    out.saturation = saturationOf(shape);
    return out;
}
Relief WallEvidence::reliefOf(const geometry::Wall& wall) const {
    Relief out = reliefOfShape(wall);
    if (isStripOfPaint(paintedLine(wall, options_.unpaintedEnd), paintOf(wall.heightClass)))
        out.painted = paintedShareOf(wall); // else it was read by paler paint
    return out;
}
Relief WallEvidence::reliefOf(const geometry::Arc& arc) const {
    return reliefOfShape(arc);
}

template<class Shape> WallEvidence::Line WallEvidence::goesOnBeyond(const Shape& shape) const {
    constexpr float kBright = 0.12f, kAsEnd = 0.5f; // of the level beside; of the end's step
    constexpr double kFirst = 0.3, kLast = 1;       // inches past the end
    const double height = geometry::heightInches(shape.heightClass), length = lengthOf(shape);
    const Line ends = endsOf(shape), tips = along(shape, 0, 1, 1);
    Line out;
    for (size_t k = 0; k < 2; ++k) {
        const float least =
            std::max(kBright, kAsEnd * endStep(ends[k], glm::normalize(tips[k] - ends[k]), height));
        bool goesOn = true;
        glm::dvec2 last = tips[k];
        for (double past = kFirst; past <= kLast && goesOn; past += 0.2) {
            const double share = k == 0 ? -past / length : 1 + past / length;
            const glm::dvec2 next = along(shape, share, share, 1)[0];
            goesOn = endStep(next, glm::normalize(next - last), height) > least;
            last = next;
        }
        if (goesOn) out.push_back(last);
    }
    return out;
}
WallEvidence::Line WallEvidence::goesOnTo(const geometry::Wall& wall) const {
    return goesOnBeyond(wall);
}
WallEvidence::Line WallEvidence::goesOnTo(const geometry::Arc& arc) const {
    return goesOnBeyond(arc);
}

double WallEvidence::distance(const geometry::Wall& wall, glm::dvec2 plan) const {
    return geometry::distanceToSegment(plan, wall.a, wall.b);
}
double WallEvidence::distance(const geometry::Arc& arc, glm::dvec2 plan) const {
    double nearest = 1e9;
    for (const glm::dvec2& p : along(arc, 0, 1, static_cast<int>(4 * lengthOf(arc)) + 1))
        nearest = std::min(nearest, glm::distance(p, plan));
    return nearest;
}

namespace {

constexpr float kBrightEnd = 0.12f;

// What a quarter exceeds: many pens do not make a few walls unlikely.
float upperQuartile(std::vector<float> values) {
    if (values.empty()) return 0;
    return ranked(values, 3 * values.size() / 4);
}

// A pen's cap can be as bright as a wall's end.
std::vector<float> fainterEnds(const std::vector<Relief>& reliefs) {
    std::vector<float> ends;
    for (const Relief& r : reliefs) ends.push_back(std::min(r.ends[0], r.ends[1]));
    return ends;
}
float typicalEnd(const std::vector<Relief>& reliefs) {
    return upperQuartile(fainterEnds(reliefs));
}

} // namespace

bool showRelief(const std::vector<Relief>& reliefs) {
    constexpr float kFoot = 0.08f;
    std::vector<float> feet;
    for (const Relief& r : reliefs)
        if (r.foot) feet.push_back(*r.foot);
    return typicalEnd(reliefs) >= kBrightEnd || upperQuartile(std::move(feet)) >= kFoot;
}

std::vector<Lies> lieFlat(const std::vector<Relief>& reliefs) {
    constexpr float kNoEnd = 0.03f, kShare = 0.3f;      // nothing; of what the ends of the others are
    constexpr float kSureEnd = 0.2f;                    // whatever the others are
    constexpr float kVividEnd = 0.2f;                   // of the others, where ends alone tell
    constexpr float kNoFoot = 0.04f, kFaintFoot = 0.1f; // with one bright end, with none
    constexpr float kPaler = 0.75f;                     // of the saturation of the others
    constexpr double kPainted = 0.85;                   // of its top
    std::vector<Lies> out(reliefs.size(), Lies::no);
    if (!showRelief(reliefs)) return out;
    const float typical = typicalEnd(reliefs), noEnd = std::clamp(kShare * typical, kNoEnd, kSureEnd);
    // Where nearly all have bright ends, light and table are such that none lacks them but where it is
    // hidden.
    std::vector<float> ends = fainterEnds(reliefs);
    const bool mostHaveEnds = ranked(ends, ends.size() / 3) >= noEnd;
    std::vector<float> saturation;
    for (const Relief& r : reliefs) saturation.push_back(r.saturation);
    const float pale = kPaler * upperQuartile(std::move(saturation));
    for (size_t i = 0; i < reliefs.size(); ++i) {
        const Relief& r = reliefs[i];
        // White card beside a table that is as bright stands out by nothing, and is brighter than white.
        const auto isBright = [&](size_t k) { return r.ends[k] >= noEnd || r.looks[k] == EndLook::card; };
        if (isBright(0) && isBright(1)) continue;
        const bool noEnds = !isBright(0) && !isBright(1), isPale = r.saturation < pale,
                   isBare = r.painted < kPainted;
        const bool isHidden = !noEnds && r.looks[isBright(0) ? 1 : 0] != EndLook::bare;
        if (r.foot && *r.foot < (noEnds ? kFaintFoot : kNoFoot))
            out[i] = isHidden && !isPale && !isBare ? Lies::unsure : Lies::flat;
        if (out[i] != Lies::no || typical < kVividEnd) continue;
        const bool nothingHides =
            std::all_of(r.looks.begin(), r.looks.end(), [](EndLook look) { return look == EndLook::bare; });
        if (noEnds) out[i] = isPale || isBare || (mostHaveEnds && nothingHides) ? Lies::flat : Lies::unsure;
        if (isPale && isBare) out[i] = Lies::flat;
    }
    return out;
}

bool WallEvidence::standsOnTable(const geometry::Wall& wall) const {
    return standsOnTable(along(wall, 0, 1, 10));
}
bool WallEvidence::standsOnTable(const geometry::Arc& arc) const {
    return standsOnTable(along(arc, 0, 1, 10));
}
bool WallEvidence::standsOnTable(const Line& centre) const {
    size_t on = 0;
    for (const glm::dvec2& p : centre) {
        if (glm::length(p) > radius_ + kOverEdge) return false;
        on += glm::length(p) < radius_;
    }
    return 2 * on > centre.size();
}

} // namespace heliodon::vision
