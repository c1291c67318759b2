// A rig file with devices put in or replaced; everything else that it holds is kept as it is.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "geometry/rig.h"

namespace heliodon::geometry {

struct RigEdit {
    std::optional<double> tableRadius; // metres
    std::optional<OpticalDevice> camera;
    std::vector<OpticalDevice>
        projectors; // by id: size, K, dist, R and t are replaced, or a new one is put last
};

// Writes `base` with the edit to `target`, which may be the same file. `base` may be empty: a new rig; or a
// rig still without a camera. Throws InputError when `base` is no vh-rig/1, or when `target` cannot be
// written.
void writeRig(const std::filesystem::path& target, const std::filesystem::path& base, const RigEdit& edit);

// Whether a rig, which may have no camera yet, says how large its table is.
bool namesTable(const std::filesystem::path& base);

// Throws what writeRig would, before there is anything to write.
void refuseRigEdit(const std::filesystem::path& target, const std::filesystem::path& base);

} // namespace heliodon::geometry
