#include "vision/detect.h"

#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "tests/vision/perturb.h"
#include "tests/vision/sketch_score.h"

namespace heliodon::vision {
namespace {

const std::string kExamples = HELIODON_SOURCE "/examples/";
const std::string kData = HELIODON_TEST_DATA "/vision/";

geometry::Rig exampleRig() {
    return geometry::readRig(kExamples + "rig.json");
}

// Everything that is stated is found, nothing else is, and it lies where it should.
void expectAll(const Score& score, double placeInches, double angleDegrees) {
    for (const auto& [kind, k] : score) {
        EXPECT_EQ(k.found, k.stated) << kind << "\n" << table(score);
        EXPECT_EQ(k.extra, 0) << kind << "\n" << table(score);
        EXPECT_LT(k.placeWorst, placeInches) << kind;
        EXPECT_LT(k.angleWorst, angleDegrees) << kind;
    }
}

TEST(Detect, reads_every_kind_of_primitive_from_a_bright_picture) {
    const auto photo = readPhotograph(kExamples + "i01_mixed.png");
    const auto result = detectSketch(photo, exampleRig());
    const auto stated = geometry::readSketch(kData + "i01_mixed.sketch.json");
    // A pixel is 0.04 in at the walls' tops; 0.06 in is the skylight's corner, the farthest of 26 marks.
    expectAll(scoreSketch(stated, result.sketch), 0.06, 0.3);
    EXPECT_TRUE(result.warnings.empty());
}

TEST(Detect, refuses_a_photograph_of_another_size) {
    const Photograph small{64, 48, std::vector<uint8_t>(64 * 48 * 3, 200)};
    try {
        detectSketch(small, exampleRig());
        FAIL() << "accepted";
    } catch (const geometry::InputError& error) {
        EXPECT_STREQ(error.what(), "photograph: 64 x 48 pixels, but the rig's camera has 1392 x 1032");
    }
}

} // namespace
} // namespace heliodon::vision
