// How long the edges of triangles should be, place by place.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

namespace heliodon::geometry {

// A point near which triangles are smaller than elsewhere.
struct SizeSource {
    glm::dvec2 at{};
    double size = 0;
    bool operator==(const SizeSource&) const = default;
};

// At p: min(edge, min over the sources of size + growth |p - at|).
class SizeField {
public:
    SizeField() = default;
    SizeField(std::vector<SizeSource> sources, double edge, double growth);
    bool operator==(const SizeField&) const = default;

    double edge() const { return edge_; }
    bool uniform() const { return sources_.empty(); }
    double at(glm::dvec2 p) const; // asks only the sources that are near
    // Whether at(p) <= limit, in less time.
    bool atMost(glm::dvec2 p, double limit) const;

private:
    // Calls visit(source) for those in the cells round p until it returns true; whether it did.
    template<class Visit> bool anyNear(glm::dvec2 p, Visit visit) const;

    size_t cell(int column, int row) const {
        return static_cast<size_t>(row) * static_cast<size_t>(columns_) + static_cast<size_t>(column);
    }

    std::vector<SizeSource> sources_; // by cells of a grid, each as wide as a source reaches
    std::vector<uint32_t> first_;     // of cell c: sources_[first_[c] .. first_[c + 1])
    double edge_ = 0, growth_ = 0, width_ = 1, leastSize_ = 0;
    glm::dvec2 low_{};
    int columns_ = 0, rows_ = 0;
};

} // namespace heliodon::geometry
