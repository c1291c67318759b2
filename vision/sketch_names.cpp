#include "vision/sketch_names.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "vision/doubts.h"

namespace heliodon::vision {

void nameInOrder(geometry::Sketch& sketch) {
    auto place = [](const geometry::Detection& d) {
        const glm::dvec2 mean = centreOf(d);
        return std::pair(std::lround(mean.y), std::lround(mean.x));
    };
    auto byPlace = [&](const auto& a, const auto& b) { return place(a.detection) < place(b.detection); };
    std::vector<size_t> order(sketch.walls.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return byPlace(sketch.walls[a], sketch.walls[b]); });
    std::vector<geometry::Wall> walls;
    std::vector<std::string> idOfOld(order.size());
    for (const size_t old : order) {
        walls.push_back(sketch.walls[old]);
        walls.back().id = idOfOld[old] = fmt::format("w{}", walls.size());
    }
    sketch.walls.swap(walls);
    for (auto& window : sketch.windows) window.wall = idOfOld[std::stoul(window.wall)];
    auto name = [&](auto& list, const char* prefix) {
        std::stable_sort(list.begin(), list.end(), byPlace);
        for (size_t i = 0; i < list.size(); ++i) list[i].id = fmt::format("{}{}", prefix, i + 1);
    };
    name(sketch.arcs, "a");
    name(sketch.windows, "win");
    name(sketch.skylights, "sky");
    name(sketch.tokens, "token");
}

} // namespace heliodon::vision
