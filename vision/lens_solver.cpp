#include "vision/lens_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

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

// The numbers of a lens that are fitted, in that order.
std::array<double, 9> numbersOf(const geometry::Lens& lens) {
    const auto& d = lens.dist;
    return {lens.fx, lens.fy, lens.cx, lens.cy, d[0], d[1], d[2], d[3], d[4]};
}

geometry::Lens withTerms(geometry::Lens lens, LensTerms terms) {
    auto& d = lens.dist;
    const std::array<bool, 5> kept{terms.radial1, terms.radial2, terms.tangential, terms.tangential,
                                   terms.radial3};
    for (size_t i = 0; i < 5; ++i) d[i] = kept[i] ? d[i] : 0;
    return lens;
}

// Parameters of one view by number: 0 to 8 the lens as in numbersOf, 9 to 11 turns about the device's axes,
// 12 to 14 its shift.
struct ViewParameters {
    geometry::Lens lens;
    Pose pose;

    void move(size_t parameter, double by) {
        if (parameter < 9) {
            std::array<double, 9> numbers = numbersOf(lens);
            numbers[parameter] += by;
            lens = lensOf(numbers);
        } else if (parameter < 12) {
            const size_t axis = parameter - 9, u = (axis + 1) % 3, v = (axis + 2) % 3;
            for (int column = 0; column < 3; ++column) {
                glm::dvec3& c = pose.rotation[column];
                const int iu = static_cast<int>(u), iv = static_cast<int>(v);
                const double a = c[iu], b = c[iv];
                c[iu] = std::cos(by) * a - std::sin(by) * b;
                c[iv] = std::sin(by) * a + std::cos(by) * b;
            }
        } else
            pose.translation[static_cast<int>(parameter) - 12] += by;
    }
};

std::vector<size_t> freeParameters(LensTerms terms) {
    std::vector<size_t> out{0, 1, 2, 3};
    if (terms.radial1) out.push_back(4);
    if (terms.radial2) out.push_back(5);
    if (terms.tangential) out.insert(out.end(), {6, 7});
    if (terms.radial3) out.push_back(8);
    for (size_t i = 9; i < 15; ++i) out.push_back(i);
    return out;
}

std::vector<glm::dvec2> offsets(const Correspondences& view, const ViewParameters& parameters) {
    std::vector<glm::dvec2> out;
    out.reserve(view.size());
    for (const Correspondence& c : view) {
        const glm::dvec3 p = parameters.pose.rotation * c.at + parameters.pose.translation;
        out.push_back(parameters.lens.pixelFromPlane({p.x / p.z, p.y / p.z}) - c.pixel);
    }
    return out;
}

double sumOfSquares(const std::vector<glm::dvec2>& offsets) {
    double sum = 0;
    for (const glm::dvec2& o : offsets) sum += glm::dot(o, o);
    return sum;
}

// By central differences: the lens is smooth, and pixels are known to 1e-2 while these are good to 1e-6.
std::vector<std::vector<glm::dvec2>> slopesOf(const Correspondences& view, const ViewParameters& at,
                                              const std::vector<size_t>& free) {
    std::vector<std::vector<glm::dvec2>> out;
    for (const size_t parameter : free) {
        const double step = parameter < 4 ? 1e-2 : 1e-6;
        ViewParameters less = at, more = at;
        less.move(parameter, -step);
        more.move(parameter, step);
        std::vector<glm::dvec2> slope = offsets(view, more);
        const std::vector<glm::dvec2> low = offsets(view, less);
        for (size_t i = 0; i < slope.size(); ++i) slope[i] = (slope[i] - low[i]) / (2 * step);
        out.push_back(std::move(slope));
    }
    return out;
}

// Takes the middle of the points to the origin and their mean distance to about 1.
glm::dmat4 normalization(const std::vector<glm::dvec3>& points) {
    glm::dvec3 mean{};
    for (const glm::dvec3& p : points) mean += p / static_cast<double>(points.size());
    double distance = 0;
    for (const glm::dvec3& p : points)
        distance += glm::distance(p, mean) / static_cast<double>(points.size());
    const double scale = distance > 0 ? 1 / distance : 1;
    glm::dmat4 out(scale);
    out[3] = glm::dvec4(-scale * mean, 1);
    return out;
}

// Sums of the products of slopes with one another, and of slopes with what is still off.
struct NormalEquations {
    cv::Mat matrix, right;
};

NormalEquations normalEquations(const std::vector<std::vector<glm::dvec2>>& slopes,
                                const std::vector<glm::dvec2>& off) {
    const int count = static_cast<int>(slopes.size());
    NormalEquations out{cv::Mat::zeros(count, count, CV_64F), cv::Mat::zeros(count, 1, CV_64F)};
    for (int a = 0; a < count; ++a) {
        const auto& slope = slopes[static_cast<size_t>(a)];
        for (size_t i = 0; i < off.size(); ++i) out.right.at<double>(a) -= glm::dot(slope[i], off[i]);
        for (int b = 0; b <= a; ++b) {
            double sum = 0;
            for (size_t i = 0; i < off.size(); ++i)
                sum += glm::dot(slope[i], slopes[static_cast<size_t>(b)][i]);
            out.matrix.at<double>(a, b) = out.matrix.at<double>(b, a) = sum;
        }
    }
    return out;
}

// Moves `now` to the least sum of squares, in px^2, by K. Levenberg's and D. Marquardt's damped steps (1944,
// 1963). Returns the normal equations' matrix of the last step.
cv::Mat descend(const Correspondences& view, const std::vector<size_t>& free, ViewParameters& now,
                double& squares) {
    constexpr int kMostRounds = 200;
    constexpr double kLeastGain = 1e-12, kMostDamping = 1e12, kLeastDamping = 1e-9;
    std::vector<glm::dvec2> off = offsets(view, now);
    squares = sumOfSquares(off);
    double damping = 1e-3;
    NormalEquations equations;
    for (int round = 0; round < kMostRounds && damping < kMostDamping; ++round) {
        equations = normalEquations(slopesOf(view, now, free), off);
        const double before = squares;
        while (damping < kMostDamping) { // until a step goes down
            cv::Mat damped = equations.matrix.clone(), step;
            for (int a = 0; a < damped.rows; ++a) damped.at<double>(a, a) *= 1 + damping;
            if (cv::solve(damped, equations.right, step, cv::DECOMP_SVD)) {
                ViewParameters next = now;
                for (int a = 0; a < damped.rows; ++a)
                    next.move(free[static_cast<size_t>(a)], step.at<double>(a));
                std::vector<glm::dvec2> there = offsets(view, next);
                if (const double fewer = sumOfSquares(there); fewer <= squares) {
                    now = next, off = std::move(there), squares = fewer;
                    damping = std::max(damping / 10, kLeastDamping);
                    break;
                }
            }
            damping *= 10;
        }
        if (before - squares <= kLeastGain * before) break;
    }
    return equations.matrix;
}

// The projection that takes points to pixels, from the least eigenvector of their homogeneous equations, each
// in coordinates of its own mean and spread (R. Hartley, "In Defense of the Eight-Point Algorithm", 1997);
// points lie before the device.
cv::Matx34d projectionOf(const Correspondences& view) {
    std::vector<glm::dvec3> at, pixel;
    for (const Correspondence& c : view) at.push_back(c.at), pixel.emplace_back(c.pixel, 0);
    const glm::dmat4 fromAt = normalization(at), fromPixel = normalization(pixel);
    cv::Mat normal = cv::Mat::zeros(12, 12, CV_64F);
    for (const Correspondence& c : view) {
        const glm::dvec4 x = fromAt * glm::dvec4(c.at, 1), u = fromPixel * glm::dvec4(c.pixel, 0, 1);
        cv::Mat rows = cv::Mat::zeros(2, 12, CV_64F);
        for (int i = 0; i < 4; ++i) {
            rows.at<double>(0, i) = rows.at<double>(1, 4 + i) = x[i];
            rows.at<double>(0, 8 + i) = -u.x * x[i];
            rows.at<double>(1, 8 + i) = -u.y * x[i];
        }
        normal += rows.t() * rows;
    }
    cv::Mat values, vectors; // largest first
    cv::eigen(normal, values, vectors);
    // Points in a plane leave more than one solution.
    if (view.size() < 6 || !(values.at<double>(10) > 1e-12 * values.at<double>(0)))
        throw CalibrationError(kUndetermined);
    glm::dmat4 p(0); // rows 0, 1 and 3; row 2 as an identity, so that the product below is whole
    for (int i = 0; i < 4; ++i) {
        p[i][0] = vectors.at<double>(11, i);
        p[i][1] = vectors.at<double>(11, 4 + i);
        p[i][3] = vectors.at<double>(11, 8 + i);
    }
    p = glm::inverse(fromPixel) * p * fromAt;
    cv::Matx34d projection;
    for (int column = 0; column < 4; ++column) {
        projection(0, column) = p[column][0];
        projection(1, column) = p[column][1];
        projection(2, column) = p[column][3];
    }
    double depth = 0;
    for (const Correspondence& c : view)
        depth += projection(2, 0) * c.at.x + projection(2, 1) * c.at.y + projection(2, 2) * c.at.z +
                 projection(2, 3);
    return depth < 0 ? -projection : projection;
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

LensSolution solveView(const Correspondences& view, LensTerms terms, const LensSolution& start) {
    const std::vector<size_t> free = freeParameters(terms);
    ViewParameters now{withTerms(start.fit.lens, terms), start.poses.at(0)};
    double squares = 0;
    const cv::Mat normal = descend(view, free, now, squares);
    LensSolution out;
    out.fit.lens = now.lens;
    out.poses = {now.pose};
    out.squares = squares;
    out.points = view.size();
    cv::Mat covariance;
    const double freedom = 2.0 * static_cast<double>(view.size()) - normal.rows;
    if (!(now.lens.fx > 0 && now.lens.fy > 0) || !std::isfinite(squares) || freedom < 1 ||
        cv::invert(normal, covariance, cv::DECOMP_SVD) <= 0)
        throw CalibrationError(kUndetermined);
    std::array<double, 9> sigma{};
    for (int a = 0; a < normal.rows; ++a)
        if (free[static_cast<size_t>(a)] < sigma.size())
            sigma[free[static_cast<size_t>(a)]] =
                std::sqrt(std::max(covariance.at<double>(a, a), 0.0) * squares / freedom);
    out.fit.sigma = lensOf(sigma);
    return out;
}

LensSolution solvePinhole(const Correspondences& view) {
    cv::Matx33d k, r;
    cv::Vec4d centre;
    cv::decomposeProjectionMatrix(projectionOf(view), k, r, centre);
    const double scale = k(2, 2);
    LensSolution out;
    out.fit.lens.fx = k(0, 0) / scale, out.fit.lens.fy = k(1, 1) / scale;
    out.fit.lens.cx = k(0, 2) / scale, out.fit.lens.cy = k(1, 2) / scale;
    Pose pose;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) pose.rotation[column][row] = r(row, column);
    pose.translation = -(pose.rotation * (glm::dvec3(centre[0], centre[1], centre[2]) / centre[3]));
    out.poses = {pose};
    out.points = view.size();
    if (!(out.fit.lens.fx > 0 && out.fit.lens.fy > 0) || !std::isfinite(out.fit.lens.cx + out.fit.lens.cy))
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

void widenByJackknife(geometry::Lens& sigma, const std::vector<geometry::Lens>& without) {
    std::array<double, 9> widest = numbersOf(sigma), mean{}, squares{};
    const double n = static_cast<double>(without.size());
    for (const geometry::Lens& lens : without)
        for (size_t i = 0; i < 9; ++i) mean[i] += numbersOf(lens)[i] / n;
    for (const geometry::Lens& lens : without)
        for (size_t i = 0; i < 9; ++i) {
            const double off = numbersOf(lens)[i] - mean[i];
            squares[i] += off * off;
        }
    for (size_t i = 0; i < 9; ++i) widest[i] = std::max(widest[i], std::sqrt(squares[i] * (n - 1) / n));
    sigma = lensOf(widest);
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

double coverageOf(std::span<const Correspondences> views, int width, int height) {
    constexpr int kColumns = 8, kRows = 6;
    std::set<std::pair<int, int>> fields;
    for (const Correspondences& view : views)
        for (const Correspondence& c : view)
            fields.emplace(static_cast<int>((c.pixel.x + 0.5) * kColumns / width),
                           static_cast<int>((c.pixel.y + 0.5) * kRows / height));
    return static_cast<double>(fields.size()) / (kColumns * kRows);
}

} // namespace heliodon::vision
