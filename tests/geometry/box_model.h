#pragma once

#include <fstream>
#include <string>

#include <fmt/format.h>
#include <glm/vec3.hpp>
#include <gtest/gtest.h>

#include "geometry/building.h"
#include "geometry/model_file.h"

namespace heliodon::test {

// A model in a file of boxes: a room of 6 m x 5 m seen from inside, what stands in it from outside.
class BoxModel {
public:
    explicit BoxModel(double height = 3) { add({0, 0, 0}, {6, height, 5}, true); }

    void add(glm::dvec3 low, glm::dvec3 high, bool inside = false) {
        for (int k = 0; k < 8; ++k)
            text_ += fmt::format("v {} {} {}\n", k & 1 ? high.x : low.x, k & 2 ? high.y : low.y,
                                 k & 4 ? high.z : low.z);
        for (const auto& f : {"0264", "1573", "0451", "2376", "0132", "4675"}) {
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
    std::string text_;
    int first_ = 1;
};

} // namespace heliodon::test
