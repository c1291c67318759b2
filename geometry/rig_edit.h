// A rig file with devices put in or replaced; everything else that it holds is kept as it is.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "geometry/rig.h"

namespace heliodon::geometry {

struct RigEdit {
    std::optional<double> tableRadius; // metres
    std::optional<OpticalDevice> camera;
    std::vector<OpticalDevice>
        projectors; // by id: size, K, dist, R and t are replaced, or a new one is put last
};

// A rig file as it was when it was opened: it is read once, so that it may be a pipe.
class RigFile {
public:
    // `file` may be empty: a new rig; or a rig still without a camera. Throws InputError when it is no
    // vh-rig/1.
    explicit RigFile(const std::filesystem::path& file);

    bool namesTable() const; // whether it says how large its table is
    Rig rig() const;         // throws what readRig would

    // The file with the edit, to `target`, which may be the same file. Throws InputError when it cannot be
    // written.
    void write(const std::filesystem::path& target, const RigEdit& edit) const;

private:
    std::filesystem::path file_;
    nlohmann::ordered_json document_; // keeps the file's order
};

} // namespace heliodon::geometry
