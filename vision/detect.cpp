#include "vision/detect.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "geometry/input_error.h"
#include "vision/bright_ends.h"
#include "vision/color_classes.h"
#include "vision/components.h"
#include "vision/doubts.h"
#include "vision/edges.h"
#include "vision/median.h"
#include "vision/overexposed_cards.h"
#include "vision/pale_walls.h"
#include "vision/picture_faults.h"
#include "vision/picture_turn.h"
#include "vision/pieces.h"
#include "vision/plan_view.h"
#include "vision/region_pieces.h"
#include "vision/sketch_names.h"
#include "vision/table_edge.h"
#include "vision/table_marks.h"
#include "vision/vivid_part.h"
#include "vision/wall_evidence.h"
#include "vision/wall_fit.h"

namespace heliodon::vision {
namespace {

using geometry::Sketch;

size_t wallsIn(const DetectionResult& result) {
    return result.sketch.walls.size() + result.sketch.arcs.size();
}

// One pass over the picture, and what it shows of how the next should go.
struct Reading {
    DetectionResult result;
    std::optional<CardWhite> card;
    std::optional<BrightEnds> ends;
    std::optional<double> otherThickness;
    bool endsHaveTablesColour = false, seesRelief = false;
};

class Detector {
public:
    Detector(const Photograph& photo, const geometry::Rig& rig, const DetectOptions& options,
             const std::optional<CardWhite>& card = std::nullopt)
        : rig_(rig), options_(options), view_(photo, rig.camera, options.gamma), card_(card) {}

    Reading read() {
        run();
        return {out_,
                card_,
                brightEnds(out_.sketch, evidence(), image_, view_, radius()),
                otherThickness(),
                endsHaveTablesColour(out_.sketch, evidence(), image_, view_),
                showRelief(reliefs())};
    }

private:
    void run() {
        image_ = classifyPixels(view_, rig_, options_, card_);
        if (!image_.hasTable) {
            out_.warnings.emplace_back("no lit white table is seen where the rig says that it is");
            return;
        }
        view_.setWhite(image_.white);
        regions_ = findComponents(image_, smallestArea(view_));
        std::erase_if(regions_,
                      [&](const Component& region) { return !canStandOnTable(region, view_, radius()); });
        if (regions_.size() > kMostRegions) {
            out_.warnings.push_back(fmt::format(
                "{} coloured regions: the picture is noise, nothing is read from it", regions_.size()));
            return;
        }
        used_.assign(regions_.size(), false);
        findTokens();
        partArrowsFromWalls();
        findArrow();
        findSkylights();
        findWalls();
        warnOfTurn(); // where walls are read at wrong places, theirs are no faces, and they seem to lie flat
        leaveOutWhatLiesFlat();
        readOverexposedCards(out_.sketch, image_, evidence(), view_, options_, radius(), doubts_);
        addDoubts(out_.sketch, evidence(), view_, options_, doubts_);
        for (std::string& line : doubts_.lines()) out_.warnings.push_back(std::move(line));
        if (out_.sketch.walls.empty() && out_.sketch.arcs.empty())
            out_.warnings.emplace_back("no wall is seen on the table");
        for (std::string& line : pictureFaults(out_.sketch, image_, evidence(), view_, options_, radius()))
            out_.warnings.push_back(std::move(line));
        out_.sketch.tableDiameter = 2 * radius();
        nameInOrder(out_.sketch);
    }

    // Walls cut from another sheet: the width that most strips have which are no walls of the options'
    // thickness, where they are more than the walls.
    std::optional<double> otherThickness() const {
        constexpr size_t kLeast = 3;
        constexpr double kAlike = 0.1, kMost = 2.0 / 3; // of the width; of the strips
        if (otherWidths_.size() < std::max(kLeast, wallsIn(out_))) return std::nullopt;
        const double width = median(otherWidths_);
        const auto alike = std::count_if(otherWidths_.begin(), otherWidths_.end(), [&](double other) {
            return std::abs(other - width) < kAlike * width;
        });
        if (static_cast<double>(alike) < kMost * static_cast<double>(otherWidths_.size()))
            return std::nullopt;
        return width;
    }

    void warnOfTurn() {
        const auto turn = pictureTurn(out_.sketch.walls, image_, view_, options_, radius());
        if (!turn) return;
        out_.warnings.push_back(
            fmt::format("the picture fits the rig's camera better if it is {}: was it changed after it was "
                        "taken? The sketch would be, too",
                        *turn == PictureTurn::mirrored     ? "mirrored left to right"
                        : *turn == PictureTurn::upsideDown ? "mirrored top to bottom"
                                                           : "turned by half"));
    }

    double radius() const { return rig_.tableRadius / geometry::kMetresPerInch; }

    bool liesOnTable(glm::dvec2 plan, double halfWidth) const {
        return glm::length(plan) + halfWidth < radius() + 0.3;
    }

    bool liesOnTable(const geometry::NorthArrow& arrow) const {
        const double a = glm::radians(arrow.dirDeg);
        const glm::dvec2 half = 0.5 * options_.arrowLength * glm::dvec2(std::cos(a), std::sin(a));
        constexpr double kBroad = 0.6; // inches; slivers of a coloured floor lie along the edge
        return liesOnTable(arrow.pos - half, kBroad) && liesOnTable(arrow.pos + half, kBroad);
    }

    // With all its corners: a sleeve or a sheet reaches past the edge.
    bool liesOnTable(const geometry::Skylight& skylight) const {
        const double a = glm::radians(skylight.angleDeg);
        const glm::dvec2 x = 0.5 * skylight.size.x * glm::dvec2(std::cos(a), std::sin(a)),
                         y = 0.5 * skylight.size.y * glm::dvec2(-std::sin(a), std::cos(a));
        return liesOnTable(skylight.center + x + y, 0) && liesOnTable(skylight.center + x - y, 0) &&
               liesOnTable(skylight.center - x + y, 0) && liesOnTable(skylight.center - x - y, 0);
    }

    WallEvidence evidence() const { return {image_, view_, options_, radius()}; }

    void findTokens() {
        for (size_t i = 0; i < regions_.size(); ++i) {
            if (!isWallPaint(regions_[i].group) ||
                liesWithin(out_.sketch.tokens, regions_[i], view_, options_))
                continue;
            auto token = fitToken(regions_[i], image_, view_, options_);
            if (!token) token = fitToken(withNeighbours(i), image_, view_, options_);
            if (token && liesOnTable(token->pos, 0.5 * options_.tokenSide)) addToken(*token);
        }
        findFaintTokens();
        // What lies within a token is its chip, whatever its colour.
        for (size_t i = 0; i < regions_.size(); ++i)
            used_[i] = liesWithin(out_.sketch.tokens, regions_[i], view_, options_);
    }

    // A speck near a rim makes with it the token that the rim is: the better one counts.
    void addToken(const geometry::Token& token) {
        for (geometry::Token& other : out_.sketch.tokens) {
            if (glm::distance(other.pos, token.pos) > 0.6 * options_.tokenSide) continue;
            if (token.detection.confidence > other.detection.confidence) other = token;
            return;
        }
        out_.sketch.tokens.push_back(token);
    }

    // A rim of two pixels, or a blurred one, is paler than paint.
    void findFaintTokens() {
        if (image_.withFaint.empty()) return;
        std::swap(image_.paint, image_.withFaint);
        const double perInch = view_.pixelsPerInch(glm::dvec2(0), 0);
        const double least = 0.3 * options_.tokenSide * options_.tokenBand * perInch * perInch; // half a side
        for (const Component& region : findComponents(image_, std::max(4, static_cast<int>(least)))) {
            if (!isWallPaint(region.group) || liesWithin(out_.sketch.tokens, region, view_, options_))
                continue;
            const auto token = fitToken(region, image_, view_, options_, TokenLook::faint);
            if (token && liesOnTable(token->pos, 0.5 * options_.tokenSide)) addToken(*token);
        }
        std::swap(image_.paint, image_.withFaint);
    }

    // Noise or a shadow may cut a token's rim: the region with those of its paint that lie as near as a rim's
    // parts do.
    Component withNeighbours(size_t index) const {
        Component joined = regions_[index];
        const double reach = options_.tokenSide * view_.pixelsPerInch(view_.plan(joined.centre, 0), 0);
        for (size_t k = 0; k < regions_.size(); ++k) {
            const Component& other = regions_[k];
            if (k == index || other.group != joined.group || other.area > reach * reach) continue;
            if (glm::distance(other.centre, regions_[index].centre) > reach) continue;
            joined.runs.insert(joined.runs.end(), other.runs.begin(), other.runs.end());
            joined.area += other.area;
        }
        std::sort(joined.runs.begin(), joined.runs.end(),
                  [](const Run& a, const Run& b) { return std::pair(a.y, a.x0) < std::pair(b.y, b.x0); });
        return joined;
    }

    // A red wall's top that touches the arrow in the picture, or hides a part, makes one region with it.
    void partArrowsFromWalls() {
        const int least = smallestArea(view_);
        for (size_t i = 0; i < used_.size(); ++i) {
            const Component whole = regions_[i];
            if (used_[i] || whole.group != Paint::red || whole.minorityArea < least) continue;
            std::vector<Component> red = findComponents(partOf(whole, image_, Paint::red), least),
                                   orange = findComponents(partOf(whole, image_, Paint::orange), least);
            std::erase_if(red, [&](const Component& part) { return isSliver(part); });
            const auto isArrow = [&](const Component& part) {
                return fitArrow(part, view_, options_).has_value();
            };
            const auto straight = [&](const Component& part) {
                return fitStraight({Paint::red, {&part}, {}}, view_, options_);
            };
            const bool hasArrow = std::any_of(orange.begin(), orange.end(), isArrow),
                       hasWall = std::any_of(red.begin(), red.end(), straight);
            const auto all = straight(whole); // a face in the shade beside the top is orange, too
            if (red.empty() || !(hasArrow || (hasWall && !(all && evidence().isWall(all->wall))))) continue;
            for (const Component& part : orange)
                for (const Run& run : part.runs)
                    for (int x = run.x0; x < run.x1; ++x) image_.set(x, run.y, Paint::none);
            regions_[i] = std::move(red.back());
            red.pop_back();
            regions_.insert(regions_.end(), red.begin(), red.end());
            regions_.insert(regions_.end(), orange.begin(), orange.end());
        }
        used_.resize(regions_.size(), false);
    }

    // Of the regions with an arrow's shape the one that is most orange and whose sides are seen best.
    void findArrow() {
        double best = -1;
        size_t bestRegion = 0;
        for (size_t i = 0; i < regions_.size(); ++i) {
            const Component& region = regions_[i];
            if (used_[i] || (region.group != Paint::red && region.group != Paint::yellow)) continue;
            const double orange = static_cast<double>(region.minorityArea) / region.area;
            const auto arrow = fitArrow(region, view_, options_);
            if (!arrow || !liesOnTable(*arrow) || continuesAWall(region)) continue;
            const double likely = orange * arrow->detection.confidence;
            if (likely <= best) continue;
            if (out_.sketch.north && best > 0.5)
                out_.warnings.emplace_back("more than one north arrow: the most orange one counts");
            best = likely, bestRegion = i;
            out_.sketch.north = arrow;
        }
        if (out_.sketch.north) used_[bestRegion] = true;
    }

    // A marker has its wall's paint past both of its ends, a wall's red a marker past one of them; an orange
    // arrow may point at a marker.
    bool continuesAWall(const Component& region) const {
        constexpr double kGap = 0.25; // inches: past blur
        const Pca pca = principalAxes(planPoints(region, view_, 0));
        const auto paintAt = [&](double along) {
            const Paint paint = image_.groupAt(view_.pixel(pca.mean + along * pca.axis, 0));
            return paint != region.group ? paint : Paint::none;
        };
        const Paint before = paintAt(pca.low - kGap), after = paintAt(pca.high + kGap);
        const bool isRed = region.group == Paint::red && 2 * region.minorityArea < region.area;
        return (isWallPaint(before) && isWallPaint(after)) ||
               (isRed && (isMarker(before) || isMarker(after)));
    }

    void findSkylights() {
        for (size_t i = 0; i < regions_.size(); ++i) {
            const Component& region = regions_[i];
            if (used_[i] || region.group != Paint::blue) continue;
            // By its colour, or by being wider than any strip of wall, which noise in the colour leaves
            // alone.
            if (!isLightBlue(region) && !isWide(region)) continue;
            // A wall with the shade or a skylight beside it is as wide, but only in part as vivid or blue.
            if (cutter_.hasVividPieces(region)) continue;
            // As narrow as a wall: pale cyan on one, rather.
            if (!isWide(region) && relativeWidth(region, 8) < 1.6) {
                paleStrips_.push_back(region);
                paleStrips_.back().group = Paint::cyan;
                for (const Run& run : region.runs)
                    for (int x = run.x0; x < run.x1; ++x) image_.set(x, run.y, Paint::cyan);
                used_[i] = true;
                continue;
            }
            if (auto skylight = fitSkylight(region, view_, options_); skylight && liesOnTable(*skylight)) {
                used_[i] = true;
                if (isPatchOfLight(*skylight)) {
                    unread(region, "a patch of bluish light; it is left out");
                    continue;
                }
                out_.sketch.skylights.push_back(*skylight);
            }
        }
    }

    // Light adds to what the white table returns in every channel; light-blue card takes from its red.
    bool isPatchOfLight(const geometry::Skylight& skylight) const {
        if (image_.whiteOverTable != glm::vec3(1)) return false;
        const glm::dvec2 p = view_.pixel(skylight.center, 0);
        glm::vec3 sum(0);
        for (int i = -2; i <= 2; ++i)
            for (int j = -2; j <= 2; ++j) sum += view_.light(p + glm::dvec2(i, j)) / view_.white(p) / 25.0f;
        return std::min({sum.r, sum.g, sum.b}) > 1;
    }

    // Standard deviation across a region's long axis over that of a wall's top, in plan at the height of its
    // colour.
    double relativeWidth(const Component& region, double height) const {
        return principalAxes(planPoints(region, view_, height)).minor * std::sqrt(12.0) /
               options_.wallThickness;
    }
    // The blurred rim of a marker can have another marker's or a wall's hue: much thinner than they.
    bool isSliver(const Component& region) const {
        return relativeWidth(region, isWallPaint(region.group) ? heightOf(region.group) : 8) < 0.5;
    }
    bool isWide(const Component& region) const { return relativeWidth(region, 0) > 2; }

    void findWalls() {
        std::vector<const Component*> pieces, markers;
        for (size_t i = 0; i < regions_.size(); ++i) {
            if (used_[i]) continue;
            if (isSliver(regions_[i])) continue;
            if (isWallPaint(regions_[i].group)) {
                const RegionCutter::Pieces cut = cutter_.piecesOf(regions_[i]);
                pieces.insert(pieces.end(), cut.pieces.begin(), cut.pieces.end());
                if (cut.pieces.empty() && !isLightBlue(regions_[i]))
                    noteWidth({regions_[i].group, {&regions_[i]}, {}});
                if (cut.unread) unread(regions_[i], cut.unread);
            }
            if (isMarker(regions_[i].group)) markers.push_back(&regions_[i]);
        }
        for (const Component& strip : paleStrips_) markers.push_back(&strip);
        Chains chains = formChains(pieces, markers, view_, options_);
        for (const Chain& chain : chains.chains) readChain(chain);
        readPale(chains.orphans);
        for (const StraightWall& whole : wholeWalls_) splitWall(whole);
    }

    // `markers` that no vivid wall has, with what is faint.
    void readPale(const std::vector<const Component*>& markers) {
        PaleWalls pale{{}, {}, markers};
        if (!image_.withFaint.empty()) {
            std::swap(image_.paint, image_.withFaint);
            pale = readPaleWalls({wholeWalls_, out_.sketch, markers}, image_, view_, options_, radius(),
                                 doubts_);
            std::swap(image_.paint, image_.withFaint);
        }
        wholeWalls_.insert(wholeWalls_.end(), pale.straight.begin(), pale.straight.end());
        out_.sketch.arcs.insert(out_.sketch.arcs.end(), pale.arcs.begin(), pale.arcs.end());
        for (const Component* marker : pale.otherMarkers) readOrphan(*marker);
    }

    void splitWall(const StraightWall& whole) {
        std::vector<geometry::Wall> others;
        for (const StraightWall& other : wholeWalls_)
            if (&other != &whole) others.push_back(other.wall);
        for (const StraightWall& part : splitAtJoints(whole, others, view_, options_)) {
            for (auto window : part.windows) {
                window.wall = std::to_string(out_.sketch.walls.size());
                out_.sketch.windows.push_back(window);
            }
            out_.sketch.walls.push_back(part.wall);
        }
    }

    // Cyan and light blue differ by little: a marker on no wall may be a skylight, if it is wide enough.
    void readOrphan(const Component& marker) {
        if (marker.group == Paint::cyan && relativeWidth(marker, 0) > 1.5)
            if (auto skylight = fitSkylight(marker, view_, options_); skylight && liesOnTable(*skylight)) {
                out_.sketch.skylights.push_back(*skylight);
                return;
            }
        unread(marker, "a window marker on no wall; it is left out");
    }

    // Of a strip that is no wall of the options' thickness.
    void noteWidth(const Chain& chain) {
        auto width = straightWidth(chain, view_, options_);
        if (!width && chain.markers.empty()) width = arcWidth(chain, view_, options_);
        if (width) otherWidths_.push_back(*width);
    }

    void readChain(const Chain& chain) {
        if (const auto wall = fitStraight(chain, view_, options_);
            wall && evidence().isWall(wall->wall) && evidence().standsOnTable(wall->wall)) {
            wholeWalls_.push_back(*wall);
            return;
        }
        if (chain.markers.empty())
            if (const auto arc = fitArc(chain, view_, options_);
                arc && evidence().isWall(*arc) && evidence().standsOnTable(*arc)) {
                out_.sketch.arcs.push_back(*arc);
                return;
            }
        noteWidth(chain);
        for (const Component* piece : chain.pieces) unread(*piece, whyNoWall(*piece));
        for (const Component* marker : chain.markers)
            unread(*marker, "a window marker on no wall; it is left out");
    }

    std::vector<Relief> reliefs() const {
        std::vector<Relief> out;
        for (const auto& wall : out_.sketch.walls) out.push_back(evidence().reliefOf(wall));
        for (const auto& arc : out_.sketch.arcs) out.push_back(evidence().reliefOf(arc));
        return out;
    }

    // Pens, tape and cables have a wall's colour and width, but none of its height.
    void leaveOutWhatLiesFlat() {
        Sketch& sketch = out_.sketch;
        const std::vector<Lies> lies = lieFlat(reliefs());
        const auto isFlat = [&](size_t i, const geometry::Detection& detection) {
            if (lies[i] == Lies::no) return false;
            const glm::dvec2 p = centreOf(detection);
            const bool flat = lies[i] == Lies::flat;
            out_.wallsLeftOut += flat;
            doubts_.add(
                p, flat ? "coloured and wide like a wall, but without its white ends and its faces; it is "
                          "left out"
                        : "coloured and wide like a wall, but its ends are not seen to be white: is it one?");
            return flat;
        };
        std::vector<geometry::Wall> walls;
        std::vector<std::string> placeOf(sketch.walls.size()); // empty: left out
        for (size_t i = 0; i < placeOf.size(); ++i) {
            if (isFlat(i, sketch.walls[i].detection)) continue;
            placeOf[i] = std::to_string(walls.size());
            walls.push_back(std::move(sketch.walls[i]));
        }
        std::vector<geometry::Arc> arcs;
        for (size_t i = 0; i < sketch.arcs.size(); ++i)
            if (!isFlat(placeOf.size() + i, sketch.arcs[i].detection))
                arcs.push_back(std::move(sketch.arcs[i]));
        for (auto& window : sketch.windows) window.wall = placeOf[std::stoul(window.wall)];
        std::erase_if(sketch.windows, [](const auto& window) { return window.wall.empty(); });
        sketch.walls = std::move(walls), sketch.arcs = std::move(arcs);
    }

    void unread(const Component& region, const char* what) {
        const double perInch = view_.pixelsPerInch(view_.plan(region.centre, 0), 0);
        if (region.area < 3 * kSmallestRegion * perInch * perInch) return; // specks are not worth a line
        out_.wallsLeftOut += isWallPaint(region.group) && 2 * region.minorityArea <= region.area;
        doubts_.add(region.centre, what);
    }

    const geometry::Rig& rig_;
    const DetectOptions& options_;
    PlanView view_;
    std::optional<CardWhite> card_;
    ClassImage image_;
    RegionCutter cutter_{image_, view_, options_, radius()};
    std::vector<Component> regions_;
    std::deque<Component> paleStrips_;
    std::vector<StraightWall> wholeWalls_; // before joints under markers are looked for
    std::vector<bool> used_;
    std::vector<double> otherWidths_; // inches
    Doubts doubts_;
    DetectionResult out_;
};

} // namespace

DetectionResult detectSketch(const Photograph& photo, const geometry::Rig& rig,
                             const DetectOptions& options) {
    if (photo.width != rig.camera.width || photo.height != rig.camera.height) {
        const bool turned = photo.width == rig.camera.height && photo.height == rig.camera.width;
        throw geometry::InputError(
            photo.name, "",
            fmt::format("{} x {} pixels, but the rig's camera has {} x {}{}", photo.width, photo.height,
                        rig.camera.width, rig.camera.height,
                        turned ? ": it was turned, expected it as the camera gave it" : ""));
    }
    Reading best = Detector(photo, rig, options).read();
    // What was taken for card on a coloured table is none: the table is white.
    if (best.endsHaveTablesColour) {
        Reading again = Detector(photo, rig, options, kWhiteTable).read();
        if (wallsIn(again.result) >= wallsIn(best.result)) best = std::move(again);
    }
    // Walls that were found although the table is not white show what card returns: all is held against that.
    // It loses no walls, or those left agree with it: what was read before may have been paper.
    if (best.ends && best.ends->count >= kEnoughEnds) {
        Reading again = Detector(photo, rig, options, best.ends->card).read();
        const size_t left = wallsIn(again.result);
        if (left >= wallsIn(best.result) || (!again.ends && 2 * left >= kEnoughEnds)) best = std::move(again);
    }
    // Strips that are no walls of the thickness expected, but all alike and as high as their colours state.
    if (best.otherThickness) {
        DetectOptions others = options;
        others.wallThickness = *best.otherThickness;
        Reading again = Detector(photo, rig, others, best.card).read();
        if (wallsIn(again.result) > wallsIn(best.result) && again.seesRelief) {
            best = std::move(again);
            best.result.warnings.push_back(
                fmt::format("the walls are {:.2f} in thick, not {:.3g} in: they are read so",
                            others.wallThickness, options.wallThickness));
        }
    }
    DetectionResult& result = best.result;
    if (best.ends)
        result.warnings.push_back(fmt::format("the walls' white ends are {:.1f} times as bright as what was "
                                              "taken for white: colours may be misread",
                                              best.ends->overWhite));
    // Before all other warnings: it may explain them.
    const PlanView view(photo, rig.camera, options.gamma);
    if (auto line = tableElsewhere(view, rig.tableRadius / geometry::kMetresPerInch))
        result.warnings.insert(result.warnings.begin(), std::move(*line));
    return std::move(result);
}

} // namespace heliodon::vision
