#include "vision/saddle.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/glm.hpp>

namespace heliodon::vision {
namespace {

constexpr size_t kTerms = 6; // x2, xy, y2, x, y, 1
using Row = std::array<double, kTerms>;
struct NormalEquations {
    std::array<Row, kTerms> matrix{};
    Row right{};

    void add(const Row& row, double value, double weight) {
        for (size_t i = 0; i < kTerms; ++i) {
            for (size_t j = 0; j <= i; ++j) matrix[i][j] += weight * row[i] * row[j];
            right[i] += weight * row[i] * value;
        }
    }

    // Cholesky; none when the pixels do not span a quadratic.
    std::optional<Row> solve() {
        for (size_t i = 0; i < kTerms; ++i)
            for (size_t j = 0; j <= i; ++j) {
                double sum = matrix[i][j];
                for (size_t k = 0; k < j; ++k) sum -= matrix[i][k] * matrix[j][k];
                if (i == j && sum < 1e-9 * (1 + matrix[i][i])) return std::nullopt;
                matrix[i][j] = i == j ? std::sqrt(sum) : sum / matrix[j][j];
            }
        Row x = right;
        for (size_t i = 0; i < kTerms; ++i) {
            for (size_t k = 0; k < i; ++k) x[i] -= matrix[i][k] * x[k];
            x[i] /= matrix[i][i];
        }
        for (size_t i = kTerms; i-- > 0;) {
            for (size_t k = i + 1; k < kTerms; ++k) x[i] -= matrix[k][i] * x[k];
            x[i] /= matrix[i][i];
        }
        return x;
    }
};

// The window's axes in pixels; a circle of two pixels where it would be narrower than that.
glm::dmat2 windowAxes(const glm::dmat2& pixelFromCell, double radius) {
    constexpr double kLeast = 2;
    glm::dmat2 axes = radius * pixelFromCell;
    const double area = std::abs(glm::determinant(axes));
    const double squares = glm::dot(axes[0], axes[0]) + glm::dot(axes[1], axes[1]);
    const double largest =
        std::sqrt((squares + std::sqrt(std::max(squares * squares - 4 * area * area, 0.0))) / 2);
    const double smallest = largest > 0 ? area / largest : 0;
    return smallest < kLeast ? glm::dmat2(kLeast) : axes;
}

} // namespace

std::optional<Saddle> refineSaddle(const GreyPicture& picture, glm::dvec2 start,
                                   const glm::dmat2& pixelFromCell, double radius) {
    const glm::dmat2 axes = windowAxes(pixelFromCell, radius);
    const glm::dmat2 windowFromPixel = glm::inverse(axes);
    const glm::dvec2 reach(std::hypot(axes[0].x, axes[1].x), std::hypot(axes[0].y, axes[1].y));
    Saddle out{start, 0};
    for (int round = 0; round < 12; ++round) {
        if (!picture.holds(out.pixel, 1 + std::max(reach.x, reach.y))) return std::nullopt;
        NormalEquations equations;
        for (int y = static_cast<int>(std::ceil(out.pixel.y - reach.y)); y <= out.pixel.y + reach.y; ++y)
            for (int x = static_cast<int>(std::ceil(out.pixel.x - reach.x)); x <= out.pixel.x + reach.x;
                 ++x) {
                const glm::dvec2 w = windowFromPixel * (glm::dvec2(x, y) - out.pixel);
                const double room = 1 - glm::dot(w, w);
                if (room > 0)
                    equations.add({w.x * w.x, w.x * w.y, w.y * w.y, w.x, w.y, 1},
                                  static_cast<double>(picture(x, y)), room * room);
            }
        const auto q = equations.solve();
        if (!q) return std::nullopt;
        const auto [xx, xy, yy, x, y, one] = *q;
        const double curvature = 4 * xx * yy - xy * xy; // of the Hessian: negative at a saddle
        if (!(curvature < 0)) return std::nullopt;
        glm::dvec2 step((xy * y - 2 * yy * x) / curvature, (xy * x - 2 * xx * y) / curvature);
        out.strength = std::sqrt(-curvature);
        const double length = glm::length(step);
        if (!(length < 4)) return std::nullopt;
        if (length > 0.5) step *= 0.5 / length;
        out.pixel += axes * step;
        if (glm::length(windowFromPixel * (out.pixel - start)) > 1.5) return std::nullopt;
        if (length < 1e-4) return out;
    }
    return out;
}

double saddleBlur(double cellPixels) {
    return std::clamp(0.05 * cellPixels, 0.4, 2.0);
}

} // namespace heliodon::vision
