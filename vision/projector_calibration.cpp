#include "vision/projector_calibration.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <glm/glm.hpp>

#include "vision/homography.h"
#include "vision/median.h"

namespace heliodon::vision {
namespace {

// A picture of 4 : 3 stretched to 16 : 9 has pixels of 0.75 : 1.
constexpr double kMostAspect = 1.6, kSquareWithin = 0.03;
// Of what corners lie off where all planes are held out, to where they take part.
constexpr double kMostHeldOut = 1.2;
constexpr double kMostOff = 0.01; // of the picture's width, rms: beyond, the corners are no projector's
constexpr double kApart = 0.02;   // metres, least from camera to projector

// One correspondence, with where it comes from.
struct Origin {
    size_t plane, corner;
};
struct Working {
    Correspondences points;
    std::vector<Origin> origins;
};

// The plane's corners whose map from projector to plane is one homography, within a hundredth of the
// projector's width, which leaves room for its lens: RANSAC (M. A. Fischler and R. C. Bolles, 1981).
std::vector<bool> onOnePlane(const Correspondences& points, double width) {
    std::mt19937 random(7);
    const auto any = [&] { return random() % points.size(); };
    const auto ground = [&](size_t i) { return glm::dvec2(points[i].at.x, points[i].at.z); };
    std::vector<bool> best(points.size(), false);
    size_t bestCount = 0;
    for (int round = 0; round < 400; ++round) {
        const std::array<size_t, 4> pick{any(), any(), any(), any()};
        const auto pixelFromGround = homographyThrough(
            {ground(pick[0]), ground(pick[1]), ground(pick[2]), ground(pick[3])},
            {points[pick[0]].pixel, points[pick[1]].pixel, points[pick[2]].pixel, points[pick[3]].pixel});
        if (!pixelFromGround) continue;
        std::vector<bool> fits;
        for (size_t i = 0; i < points.size(); ++i)
            fits.push_back(glm::distance((*pixelFromGround)(ground(i)), points[i].pixel) < 0.01 * width);
        const size_t count = static_cast<size_t>(std::count(fits.begin(), fits.end(), true));
        if (count > bestCount) bestCount = count, best = std::move(fits);
    }
    return best;
}

Working gather(const geometry::OpticalDevice& camera, int width, const std::vector<ProjectorPlane>& planes,
               std::vector<CalibratedPlane>& report) {
    Working work;
    for (size_t p = 0; p < planes.size(); ++p) {
        CalibratedPlane& plane = report.emplace_back();
        plane.height = planes[p].height;
        if (planes[p].corners.size() < kLeastCorners) continue;
        Correspondences points;
        std::vector<size_t> index;
        for (size_t i = 0; i < planes[p].corners.size(); ++i)
            if (const auto at = camera.worldOnPlane(planes[p].corners[i].camera, planes[p].height)) {
                points.push_back({*at, planes[p].corners[i].projector});
                index.push_back(i);
            }
        if (points.size() < kLeastCorners) continue;
        const std::vector<bool> kept = onOnePlane(points, width);
        if (static_cast<size_t>(std::count(kept.begin(), kept.end(), true)) < kLeastCorners) continue;
        for (size_t i = 0; i < points.size(); ++i)
            if (kept[i]) {
                work.points.push_back(points[i]);
                work.origins.push_back({p, index[i]});
            }
    }
    return work;
}

// Leaves out corners beyond 4.5 robust deviations; true when there were some.
bool reject(Working& work, const LensSolution& solution) {
    const std::vector<double> off = residuals(work.points, solution.fit.lens, solution.poses[0]);
    const double limit = std::max(0.15, 4.5 * median(off) / 1.18);
    Working kept;
    for (size_t i = 0; i < off.size(); ++i)
        if (off[i] <= limit) {
            kept.points.push_back(work.points[i]);
            kept.origins.push_back(work.origins[i]);
        }
    const bool changed = kept.points.size() < work.points.size();
    if (2 * kept.points.size() > work.points.size()) work = std::move(kept);
    return changed;
}

// A term costs ln(n) variances of a coordinate (G. Schwarz, "Estimating the dimension of a model", 1978):
// more than its noise, because the corners of the projector's picture often lie beyond what the planes catch.
bool isWorth(const LensSolution& longer, const LensSolution& shorter, int terms) {
    const double n = 2.0 * static_cast<double>(longer.points);
    return shorter.squares - longer.squares > terms * std::log(n) * longer.squares / n;
}

// A mirror, or the projector's setting for screens lit from behind, turns the picture round: no lens does.
LensSolution pinholeOf(const Correspondences& points, int width) {
    try {
        return solvePinhole(points);
    } catch (const CalibrationError&) {
        Correspondences mirrored = points;
        for (Correspondence& c : mirrored) c.pixel.x = width - 1 - c.pixel.x;
        try {
            solvePinhole(mirrored);
        } catch (const CalibrationError&) {
            mirrored.clear();
        }
        if (mirrored.empty()) throw;
        throw CalibrationError(
            "the projector shows its picture mirrored (by a mirror, or its setting for rear "
            "projection?): turn that off in the projector's menu");
    }
}

LensSolution fitTerms(const Working& work, int width, int height, const LensSolution& start,
                      LensTerms& terms) {
    LensSolution best = solveView(work.points, terms = {false, false, false, false}, start);
    int added = 0; // since the best one: a term may only help together with the next
    for (const LensTerms next : {LensTerms{true, false, false, false}, LensTerms{true, true, false, false},
                                 LensTerms{true, true, false, true}, LensTerms{true, true, true, true}}) {
        added += next.tangential && !next.radial3 ? 2 : 1;
        LensSolution longer;
        try {
            longer = solveView(work.points, next, best);
        } catch (const CalibrationError&) {
            continue; // more terms than the points bear
        }
        if (foldsInPicture(longer.fit.lens, width, height) || !isWorth(longer, best, added)) continue;
        best = std::move(longer);
        terms = next;
        added = 0;
    }
    return best;
}

Correspondences ofPlane(const Working& work, size_t plane, bool others) {
    Correspondences out;
    for (size_t i = 0; i < work.points.size(); ++i)
        if ((work.origins[i].plane == plane) != others) out.push_back(work.points[i]);
    return out;
}

geometry::OpticalDevice deviceOf(const LensSolution& solution, int width, int height) {
    return {"", width, height, solution.fit.lens, solution.poses[0].rotation, solution.poses[0].translation};
}

// Distances on the planes: what the paper states.
void measureOnPlanes(const Correspondences& points, ProjectorCalibration& result) {
    double sum = 0, squares = 0, n = 0;
    for (const Correspondence& c : points)
        if (const auto shown = result.projector.worldOnPlane(c.pixel, c.at.y)) {
            const double mm = 1000 * glm::distance(*shown, c.at);
            sum += mm, squares += mm * mm, n += 1;
        }
    result.meanMm = sum / std::max(n, 1.0);
    result.deviationMm = std::sqrt(std::max(squares / std::max(n, 1.0) - result.meanMm * result.meanMm, 0.0));
}

// What each plane says of itself, and how the lens changes without it.
void examinePlanes(const Working& work, const LensSolution& solution,
                   const std::vector<ProjectorPlane>& given, int width, int height,
                   ProjectorCalibration& result) {
    std::vector<LensSolution> others;
    double squares = 0, n = 0;
    const auto heightsWithout = [&](size_t plane) {
        std::set<double> heights;
        for (const Origin& origin : work.origins)
            if (origin.plane != plane) heights.insert(given[origin.plane].height);
        return heights.size();
    };
    for (size_t p = 0; p < given.size(); ++p) {
        CalibratedPlane& plane = result.planes[p];
        std::set<size_t> kept;
        for (const Origin& origin : work.origins)
            if (origin.plane == p) kept.insert(origin.corner);
        plane.corners = kept.size();
        for (size_t i = 0; i < given[p].corners.size(); ++i)
            if (!kept.contains(i)) plane.rejected.push_back(i);
        const Correspondences own = ofPlane(work, p, false);
        if (own.empty()) continue;
        plane.rms = rmsOf(residuals(own, solution.fit.lens, solution.poses[0]));
        glm::dvec2 mean{};
        for (const Correspondence& c : own)
            if (const auto pixel = result.projector.pixelFromWorld(c.at))
                mean += (*pixel - c.pixel) / static_cast<double>(own.size());
        plane.meanOff = glm::length(mean);
        if (heightsWithout(p) < kLeastPlanes) continue;
        others.push_back(solveView(ofPlane(work, p, true), result.terms, solution));
        const double rms = rmsOf(residuals(own, others.back().fit.lens, others.back().poses[0]));
        plane.heldOutRms = rms;
        squares += rms * rms * static_cast<double>(own.size());
        n += static_cast<double>(own.size());
    }
    if (others.empty()) return;
    result.heldOutRms = std::sqrt(squares / n);
    std::vector<geometry::Lens> lenses;
    glm::dvec3 mean{}, spread{};
    const double count = static_cast<double>(others.size());
    for (const LensSolution& other : others) {
        lenses.push_back(other.fit.lens);
        mean += deviceOf(other, width, height).centre() / count;
    }
    for (const LensSolution& other : others) {
        const glm::dvec3 off = deviceOf(other, width, height).centre() - mean;
        spread += off * off;
    }
    widenByJackknife(result.sigma, lenses);
    result.centreSigma = glm::sqrt(spread * (count - 1) / count);
}

void warnOf(ProjectorCalibration& result) {
    const auto warn = [&](const auto& text) { result.warnings.emplace_back(text); };
    size_t used = 0;
    for (const CalibratedPlane& plane : result.planes) {
        used += plane.corners > 0;
        if (plane.corners > 0 && plane.rejected.size() > plane.corners)
            warn(fmt::format("plane at {:.4f} m: {} corners lie on it, {} do not", plane.height,
                             plane.corners, plane.rejected.size()));
        if (plane.meanOff > std::max(0.5, 2 * result.rms))
            warn(fmt::format(
                "plane at {:.4f} m: its corners lie {:.1f} px off as a whole; is that its height?",
                plane.height, plane.meanOff));
    }
    if (used < 4) warn(fmt::format("only {} planes; nine make the lens sure", used));
    if (result.coverage < 0.5)
        warn(
            fmt::format("the planes catch {:.0f} % of the projector's picture; its lens is guessed elsewhere",
                        100 * result.coverage));
    // Noise is the same in planes that are held out.
    const bool strained = result.heldOutRms.value_or(0) > std::max(0.1, kMostHeldOut * result.rms);
    if (result.rms > 0.5 || strained)
        warn(fmt::format("corners lie {:.2f} px off{}; are the planes' heights right, and did neither camera "
                         "nor projector move?",
                         result.rms,
                         strained ? fmt::format(", {:.2f} on planes held out", *result.heldOutRms) : ""));
    const geometry::Lens &lens = result.projector.lens, &sigma = result.sigma;
    const double aspect = lens.fx / lens.fy, off = std::max(aspect, 1 / aspect) - 1;
    if (off > std::max(kSquareWithin, 3 * std::hypot(sigma.fx / lens.fx, sigma.fy / lens.fy)))
        warn(fmt::format(
            "its pixels come out as {:.2f} : 1, not square: are the planes' heights right (or is its "
            "picture stretched)?",
            aspect));
    if (sigma.fx > 0.005 * lens.fx || sigma.fy > 0.005 * lens.fy)
        warn(fmt::format("the focal length is uncertain: {:.1f} +- {:.1f} px", lens.fx,
                         std::max(sigma.fx, sigma.fy)));
    if (result.projector.centre().y <= 0)
        warn("the projector comes out below the table; are the heights right?");
}

ProjectorCalibration calibrateAsTaken(const geometry::OpticalDevice& camera, int width, int height,
                                      const std::vector<ProjectorPlane>& planes) {
    ProjectorCalibration result;
    Working work = gather(camera, width, planes, result.planes);
    std::set<double> heights;
    for (const Origin& origin : work.origins) heights.insert(planes[origin.plane].height);
    if (heights.size() < kLeastPlanes)
        throw CalibrationError(
            fmt::format("corners were found on {} planes of different height, at least {} are needed",
                        heights.size(), kLeastPlanes));
    LensSolution solution = pinholeOf(work.points, width);
    solution = fitTerms(work, width, height, solution, result.terms);
    for (int round = 0; round < 6 && reject(work, solution); ++round)
        solution = fitTerms(work, width, height, solution, result.terms);
    result.projector = deviceOf(solution, width, height);
    result.sigma = solution.fit.sigma;
    result.rms = solution.rms();
    if (result.rms > kMostOff * width)
        throw CalibrationError(fmt::format(
            "the corners lie {:.0f} projector pixels off those of any lens: are the planes in order, their "
            "heights right, and all pictures of one projector?",
            result.rms));
    // Corners that stay where they are in the camera's picture fit a projector in its place, and exactly so.
    if (glm::distance(result.projector.centre(), camera.centre()) < kApart)
        throw CalibrationError(
            "the camera sees the corners in the same place whatever the plane's height: do most "
            "fall beside the board that is raised, or are all pictures of one plane?");
    result.coverage = coverageOf({&work.points, 1}, width, height);
    measureOnPlanes(work.points, result);
    examinePlanes(work, solution, planes, width, height, result);
    const double aspect = result.projector.lens.fx / result.projector.lens.fy;
    if (std::max(aspect, 1 / aspect) > kMostAspect)
        throw CalibrationError(fmt::format("only a lens with pixels of {:.2f} : 1 puts the corners on the "
                                           "planes: are the planes in order, and their heights right?",
                                           aspect));
    return result;
}

void turnByHalf(ProjectorPlane& plane, const geometry::OpticalDevice& camera) {
    for (PatternCorner& corner : plane.corners)
        corner.camera = glm::dvec2(camera.width - 1, camera.height - 1) - corner.camera;
}

// Throws where corners that lie `rms` off come to lie where they should once all pictures, or those of one
// plane, are turned by half, or the heights are put in reverse.
void refuseMixedUp(const geometry::OpticalDevice& camera, int width, int height,
                   const std::vector<ProjectorPlane>& planes, double rms) {
    constexpr double kFits = 0.2, kUsed = 0.5; // of what they are off as they are; of the corners
    if (planes.empty()) return;
    const size_t count = planes.size();
    std::vector<ProjectorPlane> tried = planes;
    // How far corners then lie off; none where that is no better, or those of these planes are left out.
    const auto fit = [&](size_t first, size_t end) -> std::optional<double> {
        try {
            const ProjectorCalibration result = calibrateAsTaken(camera, width, height, tried);
            size_t used = 0, all = 0;
            for (size_t i = first; i < end; ++i)
                used += result.planes[i].corners, all += tried[i].corners.size();
            const bool uses = static_cast<double>(used) > kUsed * static_cast<double>(all);
            if (uses && result.rms < kFits * rms) return result.rms;
        } catch (const CalibrationError&) { // so that is not it
        }
        return std::nullopt;
    };
    for (ProjectorPlane& plane : tried) turnByHalf(plane, camera);
    if (fit(0, count))
        throw CalibrationError(
            "the camera's pictures are turned by half against the rig's camera: take them as "
            "it gave those that it was calibrated with");
    tried = planes;
    for (size_t i = 0; i < count; ++i) tried[i].height = planes[count - 1 - i].height;
    if (fit(0, count))
        throw CalibrationError(
            "the corners fit the planes' heights in reverse: is the first plane the lowest?");
    std::optional<std::pair<double, size_t>> best;
    for (size_t i = 0; i < count; ++i) {
        tried = planes;
        turnByHalf(tried[i], camera);
        if (const auto off = fit(i, i + 1); off && (!best || *off < best->first)) best = {*off, i};
    }
    if (best)
        throw CalibrationError(fmt::format("the pictures of the plane at {:.4f} m are turned by half against "
                                           "those of the others",
                                           planes[best->second].height));
}

} // namespace

ProjectorCalibration calibrateProjector(const geometry::OpticalDevice& camera, int width, int height,
                                        const std::vector<ProjectorPlane>& planes) {
    constexpr double kFar = 1; // px: more is no noise
    ProjectorCalibration result;
    try {
        result = calibrateAsTaken(camera, width, height, planes);
    } catch (const CalibrationError&) {
        refuseMixedUp(camera, width, height, planes, kMostOff * width);
        throw;
    }
    if (result.rms > kFar) refuseMixedUp(camera, width, height, planes, result.rms);
    warnOf(result);
    return result;
}

} // namespace heliodon::vision
