#include "geometry/size_field.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace heliodon::geometry {

SizeField::SizeField(std::vector<SizeSource> sources, double edge, double growth)
    : edge_(edge), growth_(growth) {
    std::erase_if(sources, [&](const SizeSource& s) { return s.size >= edge; });
    if (sources.empty()) return;
    glm::dvec2 high = low_ = sources[0].at;
    for (const SizeSource& s : sources) {
        low_ = glm::min(low_, s.at);
        high = glm::max(high, s.at);
    }
    constexpr double kMostAcross = 256;
    const glm::dvec2 extent = high - low_;
    width_ = std::max(edge / growth, std::max(extent.x, extent.y) / kMostAcross);
    columns_ = static_cast<int>(extent.x / width_) + 1;
    rows_ = static_cast<int>(extent.y / width_) + 1;
    const auto cellOf = [&](glm::dvec2 p) {
        return cell(std::min(static_cast<int>((p.x - low_.x) / width_), columns_ - 1),
                    std::min(static_cast<int>((p.y - low_.y) / width_), rows_ - 1));
    };
    first_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_) + 1, 0);
    for (const SizeSource& s : sources) ++first_[cellOf(s.at) + 1];
    for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    std::vector<uint32_t> place(first_.begin(), first_.end() - 1);
    sources_.resize(sources.size());
    for (const SizeSource& s : sources) sources_[place[cellOf(s.at)]++] = s;
    leastSize_ = std::ranges::min_element(sources_, {}, &SizeSource::size)->size;
}

template<class Visit> bool SizeField::anyNear(glm::dvec2 p, Visit visit) const {
    if (sources_.empty()) return false;
    const glm::dvec2 in = glm::floor((p - low_) / width_);
    if (!(in.x >= -1 && in.y >= -1 && in.x <= columns_ && in.y <= rows_)) return false;
    const int column = static_cast<int>(in.x), row = static_cast<int>(in.y);
    const int left = std::max(0, column - 1), right = std::min(columns_ - 1, column + 1);
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r)
        // Cells of a row follow one another.
        for (uint32_t i = first_[cell(left, r)]; i < first_[cell(right, r) + 1]; ++i)
            if (visit(sources_[i])) return true;
    return false;
}

double SizeField::at(glm::dvec2 p) const {
    double size = edge_;
    anyNear(p, [&](const SizeSource& source) {
        const glm::dvec2 d = p - source.at;
        const double rise = size - source.size, square = glm::dot(d, d);
        if (rise > 0 && growth_ * growth_ * square < rise * rise)
            size = source.size + growth_ * std::sqrt(square);
        return false;
    });
    return size;
}

bool SizeField::atMost(glm::dvec2 p, double limit) const {
    if (limit >= edge_) return true;
    if (limit < leastSize_) return false;
    return anyNear(p, [&](const SizeSource& source) {
        const glm::dvec2 d = p - source.at;
        const double rise = limit - source.size;
        return rise >= 0 && growth_ * growth_ * glm::dot(d, d) <= rise * rise;
    });
}

} // namespace heliodon::geometry
