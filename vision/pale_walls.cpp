#include "vision/pale_walls.h"

#include <algorithm>
#include <utility>

#include "vision/pieces.h"
#include "vision/table_marks.h"
#include "vision/wall_evidence.h"

namespace heliodon::vision {
namespace {

constexpr const char* kPaleWall =
    "as pale as glare or wear leaves paint, but with a wall's white ends; it is read as one";

class Search {
public:
    Search(const VividReading& read, const ClassImage& image, const PlanView& view,
           const DetectOptions& options, double radius, Doubts& doubts)
        : read_(read), image_(image), view_(view), options_(options), radius_(radius),
          evidence_(image, view, options, radius), doubts_(doubts) {}

    PaleWalls run() {
        const std::vector<Component> strips = findStrips();
        if (strips.empty() || strips.size() >= kMostRegions) return {{}, {}, read_.markers};
        std::vector<const Component*> pieces;
        for (const Component& strip : strips) pieces.push_back(&strip);
        Chains chains = formChains(pieces, read_.markers, view_, options_);
        out_.otherMarkers = std::move(chains.orphans);
        for (const Chain& chain : chains.chains) readChain(chain);
        return std::move(out_);
    }

private:
    std::vector<Component> findStrips() const {
        std::vector<Component> strips = findComponents(image_, smallestArea(view_));
        std::erase_if(strips, [&](const Component& region) {
            return !isWallPaint(region.group) || !canStandOnTable(region, view_, radius_) || isRead(region) ||
                   !isStripOrArc(region, view_, options_);
        });
        return strips;
    }

    // A token's rim, or a quarter of it beside walls that were read, as far as compressed colour runs.
    bool isRead(const Component& region) const {
        constexpr double kBeside = 0.6; // inches
        size_t beside = 0;
        for (const Run& run : region.runs) {
            const glm::dvec2 pixel(0.5 * (run.x0 + run.x1 - 1), run.y);
            const auto isNear = [&](const auto& shape) {
                for (const double height :
                     {heightOf(region.group), geometry::heightInches(shape.heightClass)})
                    if (evidence_.distance(shape, view_.plan(pixel, height)) < kBeside) return true;
                return false;
            };
            beside += std::any_of(read_.straight.begin(), read_.straight.end(),
                                  [&](const StraightWall& whole) { return isNear(whole.wall); }) ||
                      std::any_of(read_.sketch.arcs.begin(), read_.sketch.arcs.end(), isNear);
        }
        return 4 * beside > region.runs.size() || liesWithin(read_.sketch.tokens, region, view_, options_);
    }

    void readChain(const Chain& chain) {
        if (const auto wall = fitStraight(chain, view_, options_); wall && isPaleWall(wall->wall)) {
            out_.straight.push_back(*wall);
            doubts_.add(centreOf(wall->wall.detection), kPaleWall);
            for (const geometry::WindowMarker& window : wall->windows)
                doubts_.add(centreOf(window.detection),
                            "a window marker on pale paint: colour may be misread");
            return;
        }
        out_.otherMarkers.insert(out_.otherMarkers.end(), chain.markers.begin(), chain.markers.end());
        if (!chain.markers.empty()) return;
        if (const auto arc = fitArc(chain, view_, options_); arc && isPaleWall(*arc)) {
            out_.arcs.push_back(*arc);
            doubts_.add(centreOf(arc->detection), kPaleWall);
        }
    }

    template<class Shape> bool isPaleWall(const Shape& shape) const {
        constexpr float kEnd = 0.15f, kFoot = 0.08f;
        if (!evidence_.isWall(shape) || !evidence_.standsOnTable(shape)) return false;
        const Relief relief = evidence_.reliefOf(shape);
        return std::min(relief.ends[0], relief.ends[1]) > kEnd && relief.foot.value_or(1) > kFoot;
    }

    const VividReading& read_;
    const ClassImage& image_;
    const PlanView& view_;
    const DetectOptions& options_;
    double radius_;
    WallEvidence evidence_;
    Doubts& doubts_;
    PaleWalls out_;
};

} // namespace

PaleWalls readPaleWalls(const VividReading& read, const ClassImage& image, const PlanView& view,
                        const DetectOptions& options, double radius, Doubts& doubts) {
    return Search(read, image, view, options, radius, doubts).run();
}

} // namespace heliodon::vision
