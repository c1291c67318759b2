#include "vision/camera_calibration.h"
#include "vision/median.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <glm/glm.hpp>

namespace heliodon::vision {
namespace {

constexpr double kLeastTurn = 5; // degrees

// The views still used; `index` says which of those given each is.
struct Working {
    std::vector<Correspondences> views;
    std::vector<size_t> index;
};

void leaveOut(size_t view, Working& work, std::vector<CalibratedView>& report) {
    report[work.index[view]].used = false;
    work.views.erase(work.views.begin() + static_cast<std::ptrdiff_t>(view));
    work.index.erase(work.index.begin() + static_cast<std::ptrdiff_t>(view));
}

// Leaves out marks beyond 4.5 deviations (the median of a 2-D residual is 1.18 of them) and views that lie
// far off as a whole: a board that moved or bent, or marks taken for others. True when something went.
bool reject(Working& work, const LensSolution& solution, std::vector<CalibratedView>& report) {
    std::vector<double> all, ofViews;
    std::vector<std::vector<double>> off;
    for (size_t v = 0; v < work.views.size(); ++v) {
        off.push_back(residuals(work.views[v], solution.fit.lens, solution.poses[v]));
        all.insert(all.end(), off[v].begin(), off[v].end());
        ofViews.push_back(median(off[v]));
    }
    const double limit = std::max(0.15, 4.5 * median(all) / 1.18);
    const double viewLimit = std::max(0.1, 4 * median(ofViews));
    // One at a time: a bad view bends the lens, so that others look bad as well.
    const size_t worst =
        static_cast<size_t>(std::max_element(ofViews.begin(), ofViews.end()) - ofViews.begin());
    if (ofViews[worst] > viewLimit && work.views.size() > kLeastViews) {
        leaveOut(worst, work, report);
        return true;
    }
    bool changed = false;
    for (size_t v = 0; v < work.views.size(); ++v) {
        Correspondences kept;
        for (size_t i = 0; i < off[v].size(); ++i)
            if (off[v][i] <= limit) kept.push_back(work.views[v][i]);
        if (kept.size() == off[v].size() || 2 * kept.size() < off[v].size()) continue;
        work.views[v] = std::move(kept);
        changed = true;
    }
    return changed;
}

// World x = board x, world z = board y, world y = up from `thickness` below the printed side.
geometry::OpticalDevice overTable(const geometry::Lens& lens, int width, int height, const Pose& boardPose,
                                  double thickness) {
    static const glm::dmat3 boardFromWorld(glm::dvec3(1, 0, 0), glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0));
    return {"camera",
            width,
            height,
            lens,
            boardPose.rotation * boardFromWorld,
            boardPose.translation + boardPose.rotation * glm::dvec3(0, 0, thickness)};
}

// The largest angle between the boards of two views, degrees: parallel boards say nothing that one does not.
double turnBetween(const std::vector<Pose>& poses) {
    double least = 1;
    for (const Pose& a : poses)
        for (const Pose& b : poses) least = std::min(least, glm::dot(a.rotation[2], b.rotation[2]));
    return glm::degrees(std::acos(std::clamp(least, -1.0, 1.0)));
}

void warnOf(CameraCalibration& result, size_t used, int width, int height) {
    const auto warn = [&](const auto& text) { result.warnings.emplace_back(text); };
    if (used < 8) warn(fmt::format("only {} views; 15 to 30 make the lens sure", used));
    double most = 0;
    for (const auto& view : result.views)
        if (view.used) most = std::max(most, view.tiltDegrees);
    if (most < 20)
        warn(fmt::format("no view is tilted by more than {:.0f} degrees; tilt the board by 20 to 45", most));
    if (result.coverage < 0.6)
        warn(fmt::format(
            "the marks cover {:.0f} % of the picture; bring the board to its edges and corners too",
            100 * result.coverage));
    const geometry::Lens &lens = result.fit.lens, &sigma = result.fit.sigma;
    if (sigma.fx > 0.005 * lens.fx || sigma.fy > 0.005 * lens.fy)
        warn(fmt::format("the focal length is uncertain: {:.1f} +- {:.1f} px", lens.fx, sigma.fx));
    if (result.rms > 0.5)
        warn(fmt::format("marks lie {:.2f} px off; is the board flat, sharp and not moving?", result.rms));
    if (foldsInPicture(lens, width, height))
        warn("the lens model bends back inside the picture: its edges are not to be trusted; show marks "
             "there");
}

// What a lens found without a view makes of it.
struct HeldOut {
    geometry::Lens lens;
    double rms = 0, turnedRms = 0; // px; turned: with the picture turned by half
};

HeldOut judge(const geometry::Lens& lens, const Correspondences& view, const Pose& pose, int width,
              int height) {
    const auto rmsWith = [&](const Correspondences& points, const Pose& start) {
        return rmsOf(residuals(points, lens, solvePose(points, lens, start)));
    };
    Correspondences turned = view;
    for (Correspondence& point : turned) point.pixel = glm::dvec2(width - 1, height - 1) - point.pixel;
    const glm::dmat3 half(glm::dvec3(-1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1));
    return {lens, rmsWith(view, pose), rmsWith(turned, {half * pose.rotation, half * pose.translation})};
}

HeldOut holdOut(size_t left, const Working& work, int width, int height, LensTerms terms,
                const LensSolution& all) {
    std::vector<Correspondences> others = work.views;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(left));
    return judge(solveLens(others, width, height, terms, &all).fit.lens, work.views[left], all.poses[left],
                 width, height);
}

// Empty of so few views that none can be held out.
std::vector<HeldOut> holdOutEach(const Working& work, int width, int height, LensTerms terms,
                                 const LensSolution& all) {
    std::vector<HeldOut> out;
    if (work.views.size() <= kLeastViews) return out;
    for (size_t v = 0; v < work.views.size(); ++v) out.push_back(holdOut(v, work, width, height, terms, all));
    return out;
}

constexpr double kClearlyBetter = 0.5; // residuals once turned, as a share

// Turned by half, a board looks as one in another pose, but through a lens whose middle and distortion lie on
// the other side. Of four views the lens of the other three is not sure enough to tell.
std::optional<size_t> mostTurned(const std::vector<HeldOut>& heldOut) {
    if (heldOut.size() <= kLeastViews + 1) return std::nullopt;
    const auto gain = [](const HeldOut& view) { return view.turnedRms / view.rms; };
    const auto worst = std::min_element(heldOut.begin(), heldOut.end(),
                                        [&](const auto& a, const auto& b) { return gain(a) < gain(b); });
    if (gain(*worst) > kClearlyBetter) return std::nullopt;
    return static_cast<size_t>(worst - heldOut.begin());
}

std::vector<size_t> missingFrom(const Correspondences& used, const TargetView& given) {
    std::vector<size_t> out;
    size_t next = 0; // both are in the same order
    for (const FoundMark& mark : given.marks)
        if (next < used.size() && used[next].pixel == mark.pixel)
            ++next;
        else
            out.push_back(mark.id);
    return out;
}

// With k3 if that foretells more than it blurs: H. Akaike's criterion (1974), by which a term has to lower
// the sum of squares by two variances of a coordinate.
LensSolution withThirdRadialIfBetter(LensSolution solution, const Working& work, int width, int height,
                                     LensTerms& terms) {
    LensTerms more = terms;
    more.radial3 = true;
    LensSolution longer = solveLens(work.views, width, height, more, &solution);
    const double variance = longer.squares / (2.0 * static_cast<double>(longer.points));
    if (solution.squares - longer.squares <= 2 * variance) return solution;
    terms = more;
    return longer;
}

} // namespace

CameraCalibration calibrateCamera(const CalibrationTarget& target, int width, int height,
                                  const std::vector<TargetView>& given, double thickness) {
    assert(given.size() >= kLeastViews);
    CameraCalibration result;
    Working work;
    for (const TargetView& view : given) {
        Correspondences points;
        for (const FoundMark& mark : view.marks) points.push_back({{target.marks[mark.id], 0}, mark.pixel});
        work.index.push_back(work.views.size());
        work.views.push_back(std::move(points));
        result.views.emplace_back().name = view.name;
    }

    LensTerms terms;
    LensSolution solution = solveLens(work.views, width, height, terms, nullptr);
    const std::vector<Correspondences> all = work.views;
    const std::vector<Pose> poses = solution.poses;
    for (size_t round = 0; round < 4 + given.size() && reject(work, solution, result.views); ++round)
        solution = solveLens(work.views, width, height, terms, &solution);
    solution = withThirdRadialIfBetter(std::move(solution), work, width, height, terms);
    std::vector<HeldOut> heldOut = holdOutEach(work, width, height, terms, solution);
    while (const auto turned = mostTurned(heldOut)) {
        result.views[work.index[*turned]].turned = true;
        leaveOut(*turned, work, result.views);
        solution = solveLens(work.views, width, height, terms, nullptr);
        heldOut = holdOutEach(work, width, height, terms, solution);
    }

    for (size_t v = 0; v < all.size(); ++v)
        if (CalibratedView& view = result.views[v]; !view.used && work.views.size() > kLeastViews) {
            const HeldOut out = judge(solution.fit.lens, all[v], poses[v], width, height);
            view.turned = view.turned || out.turnedRms < kClearlyBetter * out.rms;
        }

    result.fit = solution.fit;
    if (const double turn = turnBetween(solution.poses); turn < kLeastTurn)
        throw CalibrationError(fmt::format(
            "the boards of all pictures are parallel within {:.1f} degrees, which does not determine the "
            "lens: tilt them in different directions",
            turn));
    result.rms = solution.rms();
    result.coverage = coverageOf(work.views, width, height);
    double heldOutSquares = 0;
    std::vector<geometry::Lens> others;
    for (size_t v = 0; v < work.views.size(); ++v) {
        CalibratedView& view = result.views[work.index[v]];
        view.camera = overTable(result.fit.lens, width, height, solution.poses[v], thickness);
        view.marks = work.views[v].size();
        view.rejected = missingFrom(work.views[v], given[work.index[v]]);
        view.rms = rmsOf(residuals(work.views[v], result.fit.lens, solution.poses[v]));
        view.tiltDegrees = glm::degrees(std::acos(std::clamp(solution.poses[v].rotation[2].z, -1.0, 1.0)));
        if (heldOut.empty()) continue;
        view.heldOutRms = heldOut[v].rms;
        heldOutSquares += heldOut[v].rms * heldOut[v].rms * static_cast<double>(view.marks);
        others.push_back(heldOut[v].lens);
    }
    if (!others.empty()) {
        widenByJackknife(result.fit.sigma, others);
        result.heldOutRms = std::sqrt(heldOutSquares / static_cast<double>(solution.points));
    }
    warnOf(result, work.views.size(), width, height);
    return result;
}

} // namespace heliodon::vision
