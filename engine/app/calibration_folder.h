// A folder with the pictures of one projector's patterns on planes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/app/arguments.h"
#include "vision/gray_code.h"

namespace heliodon::app {

struct CalibrationFolder {
    std::string id;
    vision::PatternSet patterns;
    struct Plane {
        std::filesystem::path folder;
        double height; // metres
    };
    std::vector<Plane> planes; // by their number
    std::string assumed;       // what nothing in the folder says
    struct Misspelt {
        std::filesystem::path file;
        std::vector<std::string> fields; // geometry/field_names.h
    };
    std::vector<Misspelt> misspelt; // of patterns.json and projector.json
};

constexpr int kMostPixels = 16384; // along an edge of a projector's picture

// What arguments leave open comes from patterns.json (as `calibrate patterns` writes it), else from
// projector.json ("id", "width", "height"), else from patterns/white.png and patterns/x_bit0.png as sent to
// the projector. `index` of the folder among the arguments'. Throws InputError.
CalibrationFolder openCalibrationFolder(const CalibrateProjectorArguments& arguments, size_t index);

// The camera's picture of a pattern, in any format. Throws InputError where it is missing.
std::filesystem::path pictureOf(const std::filesystem::path& plane, const std::string& pattern);

} // namespace heliodon::app
