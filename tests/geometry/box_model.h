#pragma once

#include <fstream>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <gtest/gtest.h>

#include "geometry/building.h"
#include "geometry/model_file.h"

namespace heliodon::test {

// A model in a file of boxes: a room of 6 m x 5 m seen from inside, what stands in it from outside.
class BoxModel {
public:
    explicit BoxModel(double height = 3) { add({0, 0, 0}, {6, height, 5}, true); }

    // A pit in the floor, whose bottom this is.
    BoxModel(double height, glm::dvec3 low, glm::dvec3 high) {
        add({0, 0, 0}, {6, height, 5}, true, kBottom);
        for (const auto& [a, b] : {std::pair(glm::dvec2(0, 0), glm::dvec2(6, low.z)),
                                   std::pair(glm::dvec2(0, high.z), glm::dvec2(6, 5)),
                                   std::pair(glm::dvec2(0, low.z), glm::dvec2(low.x, high.z)),
                                   std::pair(glm::dvec2(high.x, low.z), glm::dvec2(6, high.z))}) {
            text_ += fmt::format("v {} 0 {}\nv {} 0 {}\nv {} 0 {}\nv {} 0 {}\n", a.x, a.y, a.x, b.y, b.x, b.y,
                                 b.x, a.y);
            text_ += fmt::format("f {} {} {} {}\n", first_, first_ + 1, first_ + 2, first_ + 3);
            first_ += 4;
        }
        add(low, {high.x, 0, high.z}, true, kTop);
    }

    void add(glm::dvec3 low, glm::dvec3 high, bool inside = false, std::string_view without = "") {
        for (int k = 0; k < 8; ++k)
            text_ += fmt::format("v {} {} {}\n", k & 1 ? high.x : low.x, k & 2 ? high.y : low.y,
                                 k & 4 ? high.z : low.z);
        for (const std::string_view f : {"0264", "1573", "0451", "2376", "0132", "4675"}) {
            if (f == without) continue;
            std::string face = "f";
            for (int k = 0; k < 4; ++k) face += fmt::format(" {}", first_ + f[inside ? k : 3 - k] - '0');
            text_ += face + "\n";
        }
        first_ += 8;
    }

    // Treads of a metre, from a storey at `from` to one at `to`, along x.
    void addStairs(double from, double to, double x, double z) {
        for (double y = from + 0.28; y < to - 0.05; y += 0.28, x += 0.22)
            add({x, y - 0.04, z}, {x + 0.25, y, z + 0.9});
    }

    const std::string& text() const { return text_; }

    geometry::Building building() const {
        const std::string file =
            testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name() + ".obj";
        std::ofstream(file) << text_;
        return geometry::importModel(file);
    }

private:
    static constexpr std::string_view kBottom = "0451", kTop = "2376";

    std::string text_;
    int first_ = 1;
};

} // namespace heliodon::test
