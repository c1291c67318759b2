#include "vision/picture_turn.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "vision/median.h"
#include "vision/table_edge.h"
#include "vision/wall_evidence.h"

namespace heliodon::vision {
namespace {

// The camera of which the turned picture would be the photograph: a reflection where it is mirrored.
geometry::OpticalDevice turnedCamera(const geometry::OpticalDevice& camera, PictureTurn turn) {
    geometry::OpticalDevice out = camera;
    const auto flip = [&](int row) {
        for (int column = 0; column < 3; ++column) out.deviceFromWorld[column][row] *= -1;
        out.translation[row] *= -1;
    };
    if (turn != PictureTurn::upsideDown) {
        flip(0);
        out.lens.cx = camera.width - 1 - camera.lens.cx, out.lens.dist[3] *= -1, out.lens.skew *= -1;
    }
    if (turn != PictureTurn::mirrored) {
        flip(1);
        out.lens.cy = camera.height - 1 - camera.lens.cy, out.lens.dist[2] *= -1, out.lens.skew *= -1;
    }
    return out;
}

// How clearly the walls' faces end where they should; none of fewer than three.
std::optional<float> clearness(const std::vector<geometry::Wall>& walls, const WallEvidence& evidence) {
    constexpr size_t kLeast = 3;
    std::vector<float> feet;
    for (const geometry::Wall& wall : walls)
        if (const auto foot = evidence.reliefOf(wall).foot) feet.push_back(*foot);
    if (feet.size() < kLeast) return std::nullopt;
    return median(std::move(feet));
}

constexpr PictureTurn kTurns[] = {PictureTurn::mirrored, PictureTurn::upsideDown, PictureTurn::turnedByHalf};

// As a calibration has it.
bool fits(const std::optional<glm::dvec2>& edge) {
    constexpr double kOn = 0.06; // inches
    return edge && glm::length(*edge) < kOn;
}

std::optional<PictureTurn> turnByFaces(const std::vector<geometry::Wall>& walls, const ClassImage& image,
                                       const PlanView& view, const DetectOptions& options, double radius) {
    constexpr float kClear = 0.1f, kLeast = 0.08f, kBetter = 1.7f;
    const auto asItIs = clearness(walls, {image, view, options, radius});
    if (!asItIs || *asItIs > kClear) return std::nullopt;
    const bool edgeFits = fits(edgeOffset(view, radius));
    std::optional<PictureTurn> best;
    float most = std::max(kLeast, kBetter * *asItIs);
    for (const PictureTurn turn : kTurns) {
        const geometry::OpticalDevice camera = turnedCamera(view.camera(), turn);
        const PlanView turned(view.photo(), camera, options.gamma);
        if (edgeFits && !fits(edgeOffset(turned, radius))) continue;
        std::vector<geometry::Wall> there = walls;
        for (geometry::Wall& wall : there) {
            const double height = geometry::heightInches(wall.heightClass);
            for (glm::dvec2* end : {&wall.a, &wall.b}) *end = turned.plan(view.pixel(*end, height), height);
        }
        const auto clear = clearness(there, {image, turned, options, radius});
        if (clear && *clear > most) best = turn, most = *clear;
    }
    return best;
}

// Where the faces do not tell, as below a camera over the table's middle: the turn that puts the edge seen on
// the rig's, from which it lies off by more than a calibration errs.
std::optional<PictureTurn> turnByEdge(const PlanView& view, const DetectOptions& options, double radius) {
    constexpr double kOff = 0.2; // inches
    const auto asItIs = edgeOffset(view, radius);
    if (!asItIs || glm::length(*asItIs) < kOff) return std::nullopt;
    for (const PictureTurn turn : kTurns) {
        const geometry::OpticalDevice camera = turnedCamera(view.camera(), turn);
        if (fits(edgeOffset(PlanView(view.photo(), camera, options.gamma), radius))) return turn;
    }
    return std::nullopt;
}

} // namespace

std::optional<PictureTurn> pictureTurn(const std::vector<geometry::Wall>& walls, const ClassImage& image,
                                       const PlanView& view, const DetectOptions& options, double radius) {
    if (const auto turn = turnByFaces(walls, image, view, options, radius)) return turn;
    return turnByEdge(view, options, radius);
}

} // namespace heliodon::vision
