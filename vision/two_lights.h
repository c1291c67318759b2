// A neutral table in two lights of different colours, daylight from a window and lamps: each throws shadows
// that only the other reaches.
#pragma once

#include <optional>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace heliodon::vision {

// Mean light of a square of pixels.
struct LitBlock {
    glm::vec3 light{0};
    bool isTable = false;
    bool isEven = false; // its pixels have one colour
};

// Mixtures of two lights lie on a straight line of chromaticity.
class TwoLights {
public:
    // From the blocks of the table, row by row. None where most of the table has one colour, or colours that
    // are no mixtures of two, or where one of them alone falls nowhere. `typical`: the table's colour;
    // `noise`: of a block's channel, over its value.
    static std::optional<TwoLights> find(const std::vector<LitBlock>& blocks, glm::vec3 typical, float noise);

    // Within what the noise, a standard deviation of a channel over its value, makes of it.
    bool isMixture(glm::vec3 light, float noise = 0) const;
    // 0: the first light alone, 1: the second one, the bluer; beyond for what is no mixture.
    float shareOfSecond(glm::vec3 light) const;
    float typicalGreen() const { return typical_.g; }
    // Amounts of both lights that add up to that one, none below 0.
    glm::vec2 amounts(glm::vec3 light) const;
    glm::vec3 mix(glm::vec2 amounts) const { return amounts[0] * first_ + amounts[1] * second_; }

private:
    glm::vec2 chromaticity(glm::vec3 light) const;

    glm::vec3 typical_{1};
    glm::vec2 middle_{0}, along_{1, 0}; // of the line; a unit vector
    float begin_ = 0, end_ = 0;         // from the middle
    glm::vec3 first_{1}, second_{1};    // green 1
};

// What both lights together are on the table and on what stands on it, per block.
struct MixedLight {
    std::vector<glm::vec3> local; // on the table, shadows included
    std::vector<glm::vec3> full;  // without the shadows of what stands on it, as tops of walls have it
    std::vector<char> open;       // whether nothing keeps either light from the table near by
};

// None where too little of the table is seen.
std::optional<MixedLight> mixedLight(const TwoLights& lights, const std::vector<LitBlock>& blocks, int rows,
                                     int columns, float typicalGreen, double blocksPerInch);

} // namespace heliodon::vision
