#include "compute/daylight/sky_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace heliodon::daylight {

namespace {

constexpr double kStep = 1.5 * std::numbers::pi / 180;
// Rows whose distance grows evenly from nothing at the horizon, where gradations are steep, to kStep.
constexpr double kLowRows = 8;
constexpr double kLowest = 1e-6; // radians; at 0 ground begins
constexpr uint32_t kFewest = 8;  // nodes of a row
constexpr double kRough = 1e-3;  // of a sky's brightest

// Lagrange's, of three places.
std::array<double, 3> quadratic(std::array<double, 3> at, double x) {
    const auto weight = [&](size_t i, size_t j, size_t k) {
        return (x - at[j]) * (x - at[k]) / ((at[i] - at[j]) * (at[i] - at[k]));
    };
    return {weight(0, 1, 2), weight(1, 0, 2), weight(2, 0, 1)};
}

} // namespace

SkyGrid::SkyGrid() {
    constexpr double kZenith = std::numbers::pi / 2;
    for (double k = 0;; ++k) {
        const double wanted = k < kLowRows ? k * k / (2 * kLowRows) : k - kLowRows / 2;
        // The row before the last is not much nearer to the zenith than others to one another.
        const bool last = wanted * kStep > kZenith - 0.5 * kStep;
        const double elevation = last ? kZenith : std::max(kLowest, wanted * kStep);
        const auto around = static_cast<uint32_t>(2 * std::numbers::pi * std::cos(elevation) / kStep);
        const uint32_t count = last ? 1 : std::max(kFewest, around);
        rows_.push_back({elevation, static_cast<uint32_t>(nodes_.size()), count});
        for (uint32_t n = 0; n < count; ++n) {
            const double azimuth = 2 * std::numbers::pi * n / count;
            const double level = last ? 0 : std::cos(elevation);
            nodes_.emplace_back(level * std::cos(azimuth), std::sin(elevation), level * std::sin(azimuth));
        }
        if (last) return;
    }
}

SkyGrid::Rows SkyGrid::rowsAbout(double elevation) const {
    const auto above = std::ranges::lower_bound(rows_, elevation, {}, &Row::elevation) - rows_.begin();
    auto middle = std::clamp<std::ptrdiff_t>(above, 1, std::ssize(rows_) - 2);
    if (middle > 1 && elevation - rows_[static_cast<size_t>(middle - 1)].elevation <
                          rows_[static_cast<size_t>(middle)].elevation - elevation)
        --middle;
    const Row* const three = &rows_[static_cast<size_t>(middle - 1)];
    return {static_cast<size_t>(middle - 1),
            quadratic({three[0].elevation, three[1].elevation, three[2].elevation}, elevation)};
}

SkyGrid::Shares SkyGrid::sharesOf(glm::dvec3 direction) const {
    const double elevation = std::asin(std::clamp(direction.y, 0.0, 1.0)),
                 turn = std::atan2(direction.z, direction.x) / (2 * std::numbers::pi);
    const auto& [firstRow, upward] = rowsAbout(elevation);
    Shares shares;
    for (size_t r = 0; r < 3; ++r) {
        const Row& row = rows_[firstRow + r];
        const double place = (turn < 0 ? turn + 1 : turn) * row.count, nearest = std::round(place);
        const std::array<double, 3> along = quadratic({-1, 0, 1}, place - nearest);
        for (size_t c = 0; c < 3; ++c) {
            const auto column = (static_cast<uint32_t>(nearest) + row.count - 1 + static_cast<uint32_t>(c));
            shares[3 * r + c] = {row.first + column % row.count, upward[r] * along[c]};
        }
    }
    return shares;
}

bool SkyGrid::isSmoothWithHeight(const Sky& sky) const {
    const SkyFormula& f = sky.formula;
    if (f.intermediate || f.scale <= 0) return true;
    const auto gradationAt = [&](double elevation) {
        return std::max(0.0, gradation(f, std::sin(elevation)));
    };
    const double sun = std::asin(std::clamp(sky.shapeDirection.y, -1.0, 1.0));
    const auto roundSun = [&](double elevation) {
        return std::max(0.0, indicatrix(f, std::cos(elevation - sun)));
    };
    std::vector<double> ofRows;
    double brightest = 0;
    for (const Row& row : rows_) {
        ofRows.push_back(gradationAt(row.elevation));
        brightest = std::max(brightest, ofRows.back() * roundSun(row.elevation));
    }
    for (size_t r = 0; r + 1 < rows_.size(); ++r)
        for (const double part : {0.25, 0.5, 0.75}) {
            const double elevation = std::lerp(rows_[r].elevation, rows_[r + 1].elevation, part);
            const auto& [first, weight] = rowsAbout(elevation);
            double off = -gradationAt(elevation);
            for (size_t k = 0; k < weight.size(); ++k) off += weight[k] * ofRows[first + k];
            if (std::abs(off) * roundSun(elevation) > kRough * brightest) return false;
        }
    return true;
}

} // namespace heliodon::daylight
