// `heliodon formfactors` as a user runs it, on matrices of several tiles.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/app/program.h"

namespace heliodon::test {
namespace {

constexpr int kSide = 26; // quadrilaterals along an edge: 4056 in all

// A cube's inside, each wall in kSide x kSide.
std::string cube() {
    std::string text;
    for (int axis = 0; axis < 3; ++axis)
        for (int far = 0; far < 2; ++far)
            for (int i = 0; i < kSide; ++i)
                for (int j = 0; j < kSide; ++j) {
                    for (const auto &[u, v] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
                        double p[3]{};
                        p[axis] = far;
                        p[(axis + 1) % 3] = (i + (far ? v : u)) / double{kSide};
                        p[(axis + 2) % 3] = (j + (far ? u : v)) / double{kSide};
                        text += fmt::format("v {} {} {}\n", p[0], p[1], p[2]);
                    }
                    text += "f -4 -3 -2 -1\n";
                }
    return text;
}

class FormFactorsCommand : public InFolder {
protected:
    nlohmann::json reportOf(const std::string& model) {
        writeText(folder / "m.obj", model);
        const Outcome outcome =
            heliodon("formfactors " + in("m.obj") + " --kernel exact --max-error 5e-3 --quiet -o " +
                     in("F.npy") + " --report " + in("r.json"));
        EXPECT_EQ(outcome.exitCode, 0) << outcome.output;
        return nlohmann::json::parse(readText(folder / "r.json"))["form_factors"];
    }
};

// Tiles go to the file as they are made: both halves of each from one number.
TEST_F(FormFactorsCommand, matrices_of_several_tiles_are_written_tile_by_tile) {
    const nlohmann::json report = reportOf(cube());
    EXPECT_EQ(report["reciprocity_rms"], 0.0);
    EXPECT_LT(report["closure_max"], 1e-3);
    constexpr size_t kPatches = 6 * kSide * kSide;
    EXPECT_EQ(std::filesystem::file_size(folder / "F.npy"), 128 + 4 * kPatches * kPatches);
}

// What faces in one place get is told from columns, thus from the whole matrix.
TEST_F(FormFactorsCommand, faces_in_one_place_are_claimed_in_large_matrices_too) {
    const nlohmann::json report = reportOf(cube() + "f 1 2 3 4\n");
    EXPECT_GT(report["claimed_row_error"], 1e-3);
}

} // namespace
} // namespace heliodon::test
