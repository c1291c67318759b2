#include "engine/app/refused_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/app/plan_frame.h"
#include "geometry/bounds.h"

namespace heliodon::app {

namespace {

constexpr Ink kDrawn{170, 170, 170}, kOpen{240, 130, 0}, kFault{214, 30, 30};
constexpr double kLeastCircle = 14, kMostCircle = 90, kRoundCircle = 8; // pixels

class RefusedPlan {
public:
    RefusedPlan(const PlanFrame& frame, Chart& chart) : frame_(frame), chart_(chart) {}

    void outlines(const geometry::RefusedModel::Outlines& all, Ink ink, double thickness) {
        for (const auto& outline : all)
            for (size_t k = 0; k < outline.size(); ++k)
                edge(outline[k], outline[(k + 1) % outline.size()], ink, thickness);
        drawn_.clear();
    }

    void edges(std::span<const glm::dvec3> ends, Ink ink, double thickness) {
        for (size_t k = 0; k + 1 < ends.size(); k += 2) edge(ends[k], ends[k + 1], ink, thickness);
        drawn_.clear();
    }

    void circleRound(std::span<const glm::dvec3> points) {
        const geometry::Bounds box = geometry::boundsOf(points);
        const glm::dvec2 low = frame_.pixel(flat(box.low)), high = frame_.pixel(flat(box.high));
        const double radius = std::max(kLeastCircle, 0.5 * glm::distance(low, high) + kRoundCircle);
        if (radius > kMostCircle) return; // seen without
        constexpr int kSides = 48;
        std::vector<glm::dvec2> circle;
        for (int k = 0; k <= kSides; ++k) {
            const double turn = 2 * std::numbers::pi * k / kSides;
            circle.push_back(0.5 * (low + high) + radius * glm::dvec2(std::cos(turn), std::sin(turn)));
        }
        chart_.line(std::move(circle), kFault, 2);
    }

private:
    // What is upright is a line, and neighbours share edges: each is drawn once.
    void edge(glm::dvec3 a, glm::dvec3 b, Ink ink, double thickness) {
        const glm::dvec2 p = frame_.pixel(flat(a)), q = frame_.pixel(flat(b));
        const auto place = [](glm::dvec2 pixel) {
            constexpr double kPerPixel = 4;
            return std::pair(std::lround(kPerPixel * pixel.x), std::lround(kPerPixel * pixel.y));
        };
        const Pixel from = place(p), to = place(q);
        if (from != to && drawn_.insert(std::minmax(from, to)).second) chart_.line({p, q}, ink, thickness);
    }

    const PlanFrame& frame_;
    Chart& chart_;
    using Pixel = std::pair<long, long>;
    std::set<std::pair<Pixel, Pixel>> drawn_;
};

} // namespace

Chart refusedPlan(const geometry::RefusedModel& model, double northDeg, const std::string& title,
                  const std::string& why) {
    std::vector<glm::dvec3> corners;
    for (const auto* outlines : {&model.walls, &model.glass})
        for (const auto& outline : *outlines) corners.insert(corners.end(), outline.begin(), outline.end());
    const geometry::Bounds box = geometry::boundsOf(corners);
    const PlanFrame frame(flat(box.low), flat(box.high), 0, 1, 0);
    Chart chart = frame.chart();
    RefusedPlan plan(frame, chart);
    plan.outlines(model.walls, kDrawn, 0.5);
    plan.outlines(model.glass, kOpeningInk, 1.5);
    plan.edges(model.open, kOpen, 1.5);
    for (const auto& face : model.named) plan.outlines(face, kFault, 1.5);
    plan.edges(model.border, kFault, 3);
    if (!model.border.empty())
        plan.circleRound(model.border);
    else if (!model.named.empty())
        plan.circleRound(model.named[0][0]);
    frame.title(chart, title, why.substr(why.starts_with(' ') ? 1 : 0));
    frame.foot(chart, model.worldPerBuilding, northDeg);
    std::vector<PlanFrame::Key> keys;
    if (!model.glass.empty()) keys.push_back({kOpeningInk, 3, "opening"});
    if (!model.open.empty()) keys.push_back({kOpen, 3, "open edge"});
    if (!model.named.empty() || !model.border.empty()) keys.push_back({kFault, 3, "refused"});
    frame.keys(chart, keys);
    return chart;
}

} // namespace heliodon::app
