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
}

double SizeField::at(glm::dvec2 p) const {
    double size = edge_;
    if (sources_.empty()) return size;
    const glm::dvec2 in = glm::floor((p - low_) / width_);
    if (!(in.x >= -1 && in.y >= -1 && in.x <= columns_ && in.y <= rows_)) return size;
    const int column = static_cast<int>(in.x), row = static_cast<int>(in.y);
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r)
        for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c)
            for (uint32_t i = first_[cell(c, r)]; i < first_[cell(c, r) + 1]; ++i) {
                const glm::dvec2 d = p - sources_[i].at;
                const double reach = (size - sources_[i].size) / growth_, square = glm::dot(d, d);
                if (reach > 0 && square < reach * reach)
                    size = sources_[i].size + growth_ * std::sqrt(square);
            }
    return size;
}

} // namespace heliodon::geometry
