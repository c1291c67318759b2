#include "vision/lens_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/glm.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

namespace heliodon::vision {
namespace {

const char* const kUndetermined = "the pictures do not determine the lens: it needs points at different "
                                  "distances and in different directions";

struct Points {
    std::vector<cv::Point3f> at;
    std::vector<cv::Point2f> pixel;
};

Points pointsOf(const Correspondences& view) {
    Points out;
    for (const Correspondence& c : view) {
        const glm::vec3 at(c.at);
        const glm::vec2 pixel(c.pixel);
        out.at.emplace_back(at.x, at.y, at.z);
        out.pixel.emplace_back(pixel.x, pixel.y);
    }
    return out;
}

cv::Mat matrixOf(const geometry::Lens& lens) {
    return (cv::Mat_<double>(3, 3) << lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1);
}

cv::Mat distortionOf(const geometry::Lens& lens, LensTerms terms) {
    const auto [k1, k2, p1, p2, k3] = lens.dist;
    const double tangential = terms.tangential ? 1 : 0;
    return (cv::Mat_<double>(1, 5) << (terms.radial1 ? k1 : 0), (terms.radial2 ? k2 : 0), tangential * p1,
            tangential * p2, (terms.radial3 ? k3 : 0));
}

// Of OpenCV's order of parameters: fx fy cx cy k1 k2 p1 p2 k3.
geometry::Lens lensOf(const std::array<double, 9>& p) {
    geometry::Lens lens;
    lens.fx = p[0], lens.fy = p[1], lens.cx = p[2], lens.cy = p[3];
    std::copy(p.begin() + 4, p.end(), lens.dist.begin());
    return lens;
}

Pose poseOf(const cv::Mat& rotation, const cv::Mat& translation) {
    cv::Matx33d r;
    cv::Rodrigues(rotation, r);
    Pose pose;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) pose.rotation[column][row] = r(row, column);
        pose.translation[row] = translation.at<double>(row);
    }
    return pose;
}

} // namespace

double LensSolution::rms() const {
    return std::sqrt(squares / static_cast<double>(std::max<size_t>(points, 1)));
}

LensSolution solveLens(const std::vector<Correspondences>& views, int width, int height, LensTerms terms,
                       const LensSolution* start) {
    std::vector<std::vector<cv::Point3f>> at;
    std::vector<std::vector<cv::Point2f>> pixel;
    LensSolution out;
    for (const Correspondences& view : views) {
        Points points = pointsOf(view);
        at.push_back(std::move(points.at));
        pixel.push_back(std::move(points.pixel));
        out.points += view.size();
    }
    int flags = (terms.radial1 ? 0 : cv::CALIB_FIX_K1) | (terms.radial2 ? 0 : cv::CALIB_FIX_K2) |
                (terms.radial3 ? 0 : cv::CALIB_FIX_K3) | (terms.tangential ? 0 : cv::CALIB_ZERO_TANGENT_DIST);
    cv::Mat k, dist, sigma;
    if (start) {
        k = matrixOf(start->fit.lens);
        dist = distortionOf(start->fit.lens, terms);
        flags |= cv::CALIB_USE_INTRINSIC_GUESS;
    }
    std::vector<cv::Mat> rotations, translations;
    try {
        const double rms = cv::calibrateCamera(
            at, pixel, cv::Size(width, height), k, dist, rotations, translations, sigma, cv::noArray(),
            cv::noArray(), flags,
            cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-10));
        out.squares = rms * rms * static_cast<double>(out.points);
    } catch (const cv::Exception&) {
        throw CalibrationError(kUndetermined);
    }
    std::array<double, 9> values{k.at<double>(0, 0), k.at<double>(1, 1), k.at<double>(0, 2),
                                 k.at<double>(1, 2)},
        deviations{};
    for (int i = 0; i < 5; ++i) values[static_cast<size_t>(i) + 4] = dist.at<double>(i);
    for (int i = 0; i < 9; ++i) deviations[static_cast<size_t>(i)] = sigma.at<double>(i);
    out.fit = {lensOf(values), lensOf(deviations)};
    for (size_t v = 0; v < views.size(); ++v) out.poses.push_back(poseOf(rotations[v], translations[v]));
    for (const double x : values)
        if (!std::isfinite(x)) throw CalibrationError(kUndetermined);
    if (!std::isfinite(out.squares) || !(values[0] > 0 && values[1] > 0))
        throw CalibrationError(kUndetermined);
    return out;
}

Pose solvePose(const Correspondences& view, const geometry::Lens& lens, const Pose& start) {
    const Points points = pointsOf(view);
    cv::Matx33d r;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) r(row, column) = start.rotation[column][row];
    cv::Mat rotation, translation = (cv::Mat_<double>(3, 1) << start.translation.x, start.translation.y,
                                     start.translation.z);
    cv::Rodrigues(r, rotation);
    cv::solvePnP(points.at, points.pixel, matrixOf(lens), distortionOf(lens, {true, true, true, true}),
                 rotation, translation, true);
    return poseOf(rotation, translation);
}

std::vector<double> residuals(const Correspondences& view, const geometry::Lens& lens, const Pose& pose) {
    std::vector<double> out;
    for (const Correspondence& c : view) {
        const glm::dvec3 p = pose.rotation * c.at + pose.translation;
        out.push_back(p.z > 0 ? glm::distance(lens.pixelFromPlane({p.x / p.z, p.y / p.z}), c.pixel)
                              : std::numeric_limits<double>::infinity());
    }
    return out;
}

double rmsOf(const std::vector<double>& residuals) {
    double squares = 0;
    for (const double r : residuals) squares += r * r;
    return std::sqrt(squares / static_cast<double>(std::max<size_t>(residuals.size(), 1)));
}

double medianOf(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

bool foldsInPicture(const geometry::Lens& lens, int width, int height) {
    double largest = 0;
    for (const double x : {-0.5, width - 0.5})
        for (const double y : {-0.5, height - 0.5})
            largest = std::max(largest, std::hypot((x - lens.cx) / lens.fx, (y - lens.cy) / lens.fy));
    const auto [k1, k2, p1, p2, k3] = lens.dist;
    double reached = 0;
    for (double r = 0; r < 4 && reached < largest; r += 0.002) {
        const double r2 = r * r;
        if (1 + r2 * (3 * k1 + r2 * (5 * k2 + r2 * 7 * k3)) <= 0) return true;
        reached = r * (1 + r2 * (k1 + r2 * (k2 + r2 * k3)));
    }
    return false;
}

} // namespace heliodon::vision
