// P. R. Tregenza: Subdivision of the sky hemisphere for luminance measurements. Lighting Research &
// Technology 19, 1987. C. F. Reinhart: Daylight availability and manual lighting control in office buildings,
// 2001 (subdivision).
#include "compute/daylight/sky_patches.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "compute/daylight/frame.h"
#include "compute/daylight/horizon_ribbon.h"
#include "compute/daylight/quadrature.h"

namespace heliodon::daylight {

namespace {

constexpr std::array<uint32_t, 7> kTregenzaRow{30, 30, 24, 24, 18, 12, 6};
constexpr auto kCoarse = gaussLegendre<2>();
constexpr auto kFine = gaussLegendre<3>();
constexpr size_t kNodes = 13;     // 2 x 2 + 3 x 3
constexpr size_t kCapSectors = 4; // so that no cell spans more than a quarter of the compass
constexpr double kRefineAbove = 3e-4;
constexpr int kDeepest = 5;

// A part of the sky bounded by two altitudes and two azimuths; uniform in solid angle over (sine, azimuth).
struct Cell {
    double lowSine, highSine, lowAzimuth, highAzimuth;

    glm::dvec3 at(double s, double t) const {
        const double y = lowSine + s * (highSine - lowSine);
        const double azimuth = lowAzimuth + t * (highAzimuth - lowAzimuth);
        const double level = std::sqrt(std::max(0.0, 1.0 - y * y));
        return {level * std::sin(azimuth), y, -level * std::cos(azimuth)};
    }
    std::array<Cell, 4> quarters() const {
        const double s = 0.5 * (lowSine + highSine), a = 0.5 * (lowAzimuth + highAzimuth);
        return {{{lowSine, s, lowAzimuth, a},
                 {lowSine, s, a, highAzimuth},
                 {s, highSine, lowAzimuth, a},
                 {s, highSine, a, highAzimuth}}};
    }
};

template<typename Visit> void visitNodes(const Cell& cell, Visit visit) {
    for (const auto& u : kCoarse)
        for (const auto& v : kCoarse) visit(cell.at(u.x, v.x));
    for (const auto& u : kFine)
        for (const auto& v : kFine) visit(cell.at(u.x, v.x));
}

// Means by the two rules from the luminances at the nodes of visitNodes.
struct Estimate {
    double coarse = 0, fine = 0;

    explicit Estimate(const std::array<double, kNodes>& values) {
        for (size_t i = 0; i < 4; ++i) coarse += 0.25 * values[i];
        for (size_t i = 0; i < 9; ++i) fine += kFine[i / 3].weight * kFine[i % 3].weight * values[4 + i];
    }
    bool agrees() const { return std::abs(fine - coarse) <= kRefineAbove * std::abs(fine); }
};

// A sky's luminance where it is asked for thousands of times: its indicatrix is told by cubic pieces of value
// and slope, within 1e-5 of itself, in two fifths of the time.
class LuminanceOf {
public:
    explicit LuminanceOf(const Sky& sky) : sky_(sky) {
        const SkyFormula& f = sky.formula;
        // Of even skies there is nothing to tell, others are too steep.
        if (f.intermediate || (f.c == 0 && f.e == 0) || std::abs(f.d) * kStep > 0.25) return;
        inPieces_ = true;
        for (size_t side = 0; side < 2; ++side) {
            // By the chord to the sun and to what lies opposite: there is no tip in these.
            const double sign = side == 0 ? 1 : -1;
            double before = 0, slopeBefore = 0;
            for (size_t k = 0; k <= kPieces; ++k) {
                const double chord = static_cast<double>(k) * kStep, cosine = 1 - 0.5 * chord * chord;
                const double value = indicatrix(f, sign * cosine),
                             round = value - f.i0 - f.e * cosine * cosine;
                const double slope = kStep * (sign * f.d * round / std::sqrt(1 - 0.25 * chord * chord) -
                                              2 * f.e * cosine * chord);
                if (k > 0) {
                    const double rise = value - before;
                    pieces_[side][k - 1] = {before, slopeBefore, 3 * rise - 2 * slopeBefore - slope,
                                            slope + slopeBefore - 2 * rise};
                }
                before = value, slopeBefore = slope;
            }
        }
    }

    double indicatrixAt(double cosine) const {
        if (!inPieces_) return indicatrix(sky_.formula, cosine);
        const double chord = std::sqrt(std::max(0.0, 2 - 2 * std::abs(cosine))), place = chord / kStep;
        const size_t piece = std::min(static_cast<size_t>(place), kPieces - 1);
        const double x = place - static_cast<double>(piece);
        const std::array<double, 4>& p = pieces_[cosine < 0 ? 1 : 0][piece];
        return ((p[3] * x + p[2]) * x + p[1]) * x + p[0];
    }
    // The gradation known; not of intermediate skies.
    double at(double gradation, glm::dvec3 direction) const {
        const double round = indicatrixAt(glm::dot(direction, sky_.shapeDirection));
        return sky_.formula.scale * std::max(0.0, gradation * round);
    }
    double at(glm::dvec3 direction) const { // above the horizon
        if (!inPieces_) return sky_.luminance(direction);
        return at(gradation(sky_.formula, direction.y), direction);
    }

private:
    static constexpr size_t kPieces = 128;
    static constexpr double kStep = std::numbers::sqrt2 / kPieces;
    const Sky& sky_;
    bool inPieces_ = false;
    std::array<std::array<std::array<double, 4>, kPieces>, 2> pieces_;
};

double refinedMean(const LuminanceOf& sky, const Cell& cell, int depth) {
    double sum = 0;
    for (const Cell& quarter : cell.quarters()) {
        std::array<double, kNodes> values{};
        size_t i = 0;
        visitNodes(quarter, [&](glm::dvec3 d) { values[i++] = sky.at(d); });
        const Estimate estimate(values);
        sum += estimate.agrees() || depth == kDeepest ? estimate.fine : refinedMean(sky, quarter, depth + 1);
    }
    return 0.25 * sum;
}

// Of a sky with a ribbon at the horizon, which halving a cell would find too late.
double meanWithRibbon(const SkyFormula& formula, const LuminanceOf& sky, const Cell& cell) {
    double sum = 0;
    Cell part = cell;
    const auto add = [&](double highSine) {
        part.highSine = std::clamp(highSine, part.lowSine, cell.highSine);
        if (part.highSine > part.lowSine) sum += (part.highSine - part.lowSine) * refinedMean(sky, part, 1);
        part.lowSine = part.highSine;
    };
    for (const double z : horizonRibbonCuts(formula)) add(z);
    add(cell.highSine);
    return sum / (cell.highSine - cell.lowSine);
}

// The cells that a patch is made of: itself, or the sectors of the cap.
template<typename Visit> void visitCells(const SkyRow& row, uint32_t column, Visit visit) {
    const bool cap = row.patchCount == 1;
    const uint32_t sectors = cap ? kCapSectors : 1;
    const double step = 2.0 * kPi / (row.patchCount * sectors);
    for (uint32_t s = 0; s < sectors; ++s) {
        const double middle = (column + s) * step;
        visit(Cell{row.lowSine, row.highSine, middle - 0.5 * step, middle + 0.5 * step});
    }
}

} // namespace

SkyPatches::SkyPatches(int subdivision) : subdivision_(subdivision) {
    assert(subdivision >= 1 && subdivision <= 64);
    const uint32_t mf = static_cast<uint32_t>(subdivision), rowCount = 7 * mf;
    alpha_ = 0.5 * kPi / (rowCount + 0.5);
    for (uint32_t r = 0; r <= rowCount; ++r) {
        const bool cap = r == rowCount;
        const uint32_t count = cap ? 1 : kTregenzaRow[r / mf] * mf;
        rows_.push_back({static_cast<uint32_t>(patchCount_), count, std::sin(r * alpha_),
                         cap ? 1.0 : std::sin((r + 1) * alpha_)});
        patchCount_ += count;
        rowOfPatch_.insert(rowOfPatch_.end(), count, r);
    }
    samples_.reserve((patchCount_ + kCapSectors) * kNodes);
    for (const SkyRow& row : rows_)
        for (uint32_t c = 0; c < row.patchCount; ++c)
            visitCells(row, c, [&](const Cell& cell) {
                visitNodes(cell, [&](glm::dvec3 d) { samples_.push_back(d); });
            });
}

const SkyRow& SkyPatches::rowOf(size_t patch) const {
    return rows_[rowOfPatch_.at(patch)];
}

size_t SkyPatches::elementOf(glm::dvec3 d) const {
    if (d.y <= 0) return groundElement();
    const auto r = std::min(static_cast<size_t>(std::asin(std::min(d.y, 1.0)) / alpha_), rows_.size() - 1);
    const SkyRow& row = rows_[r];
    const double turns = std::atan2(d.x, -d.z) / (2.0 * kPi);
    const auto column = static_cast<uint32_t>((turns + 1.0) * row.patchCount + 0.5) % row.patchCount;
    return row.firstPatch + column;
}

glm::dvec3 SkyPatches::centre(size_t patch) const {
    const SkyRow& row = rowOf(patch);
    if (row.patchCount == 1) return {0, 1, 0};
    const double altitude = (rowOfPatch_[patch] + 0.5) * alpha_;
    const double azimuth = 2.0 * kPi * static_cast<double>(patch - row.firstPatch) / row.patchCount;
    return {std::cos(altitude) * std::sin(azimuth), std::sin(altitude),
            -std::cos(altitude) * std::cos(azimuth)};
}

double SkyPatches::solidAngle(size_t patch) const {
    const SkyRow& row = rowOf(patch);
    return 2.0 * kPi / row.patchCount * (row.highSine - row.lowSine);
}

double SkyPatches::projectedSolidAngle(size_t patch) const {
    const SkyRow& row = rowOf(patch);
    return kPi / row.patchCount * (row.highSine * row.highSine - row.lowSine * row.lowSine);
}

std::vector<double> SkyPatches::luminances(const Sky& sky) const {
    std::vector<double> result(elementCount(), 0.0);
    result.back() = sky.ground.luminance;
    if (sky.formula.scale <= 0) return result;
    const double ribbonEnd = hasHorizonRibbon(sky.formula) ? horizonRibbonCuts(sky.formula).back() : 0.0;
    const SkyFormula& f = sky.formula;
    const LuminanceOf luminance(sky);
    size_t sample = 0;
    std::array<double, kNodes> gradations{}; // at the nodes of a cell, the same all along a row
    for (size_t patch = 0; patch < patchCount_; ++patch) {
        const SkyRow& row = rowOf(patch);
        if (patch == row.firstPatch && !f.intermediate)
            for (size_t i = 0; i < kNodes; ++i) gradations[i] = gradation(f, samples_[sample + i].y);
        const double share = row.patchCount == 1 ? 1.0 / kCapSectors : 1.0;
        visitCells(row, static_cast<uint32_t>(patch - row.firstPatch), [&](const Cell& cell) {
            std::array<double, kNodes> values{};
            for (size_t i = 0; i < kNodes; ++i, ++sample) {
                const glm::dvec3 d = samples_[sample];
                values[i] = f.intermediate ? sky.luminance(d) : luminance.at(gradations[i], d);
            }
            const Estimate estimate(values);
            result[patch] += share * (cell.lowSine < ribbonEnd ? meanWithRibbon(f, luminance, cell)
                                      : estimate.agrees()      ? estimate.fine
                                                               : refinedMean(luminance, cell, 1));
        });
    }
    return result;
}

} // namespace heliodon::daylight
