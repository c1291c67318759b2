#include "geometry/glass_mark.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "geometry/bounds.h"

namespace heliodon::geometry {

namespace {

// Six decimals of coordinates of a room of 0.2 m, as on the table, leave 5e-6.
constexpr double kRounding = 2e-5;
// In sums of n panes what rounding leaves adds up as a random walk does: that much for one is six times its
// standard deviation.
constexpr double kSumRounding = 1e-5;

bool near(glm::dvec3 a, glm::dvec3 b, double most) {
    return glm::all(glm::lessThanEqual(glm::abs(a - b), glm::dvec3(most)));
}

// G. Steele, D. Lea and C. Flood, "Fast splittable pseudorandom number generators" (2014).
double weightOf(uint64_t pane) {
    uint64_t z = (pane + 1) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    const double size = 0.5 + static_cast<double>(z >> 11) * 0x1p-53;
    return (z & 1u) != 0 ? size : -size;
}

glm::dvec3 sortedSizes(glm::dvec3 v) {
    std::array<double, 3> sizes{std::abs(v.x), std::abs(v.y), std::abs(v.z)};
    std::ranges::sort(sizes);
    return {sizes[0], sizes[1], sizes[2]};
}

} // namespace

bool GlassMark::agrees(const GlassMark& other) const {
    if (panes != other.panes) return false;
    const bool inPlace = near(place, other.place, kRounding);
    if (!checksum || !other.checksum) return inPlace;
    const double most = kSumRounding * std::sqrt(static_cast<double>(panes));
    if (near(*checksum, *other.checksum, most)) return inPlace;
    return near(sortedSizes(*checksum), sortedSizes(*other.checksum), most);
}

GlassMark glassMark(std::span<const glm::dvec3> vertices, std::span<const uint32_t> corners,
                    std::span<const uint32_t> firstCorner, std::span<const size_t> glass) {
    if (glass.empty()) return {};
    std::vector<glm::dvec3> drawn;
    for (const uint32_t v : corners) drawn.push_back(vertices[v]);
    const Bounds box = boundsOf(drawn);
    const glm::dvec3 centre = 0.5 * (box.low + box.high);
    glm::dvec3 squares{0}, sum{0};
    for (size_t k = 0; k < glass.size(); ++k) {
        const uint32_t first = firstCorner[glass[k]], end = firstCorner[glass[k] + 1];
        glm::dvec3 middle{0};
        for (uint32_t c = first; c < end; ++c) middle += drawn[c];
        middle /= static_cast<double>(end - first);
        squares += (middle - box.low) * (middle - box.low);
        sum += weightOf(k) * (middle - centre);
    }
    return {static_cast<uint32_t>(glass.size()),
            glm::sqrt(squares / static_cast<double>(glass.size())) / box.diagonal(), sum / box.diagonal()};
}

std::vector<double> numbersOf(const GlassMark& mark) {
    std::vector<double> numbers{static_cast<double>(mark.panes)};
    const auto add = [&](glm::dvec3 v) {
        for (int c = 0; c < 3; ++c) numbers.push_back(std::round(v[c] * 1e7) / 1e7);
    };
    add(mark.place);
    if (mark.checksum) add(*mark.checksum);
    return numbers;
}

std::optional<GlassMark> glassMark(std::span<const double> numbers) {
    constexpr double kMost = std::numeric_limits<uint32_t>::max();
    if ((numbers.size() != 4 && numbers.size() != 7) ||
        !std::ranges::all_of(numbers, [](double n) { return std::isfinite(n); }) || numbers[0] < 0 ||
        numbers[0] > kMost || numbers[0] != std::floor(numbers[0]))
        return std::nullopt;
    GlassMark mark{static_cast<uint32_t>(numbers[0]), {numbers[1], numbers[2], numbers[3]}, {}};
    if (numbers.size() == 7) mark.checksum = {numbers[4], numbers[5], numbers[6]};
    return mark;
}

} // namespace heliodon::geometry
