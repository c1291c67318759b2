// Rooms, skies and sensors from tests/data/compute.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "compute/daylight/sky.h"
#include "compute/daylight_transport.h"
#include "geometry/model_file.h"

namespace heliodon::test {

inline std::vector<float> readFloats(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::vector<float> values(std::filesystem::file_size(file) / sizeof(float));
    in.read(reinterpret_cast<char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(float)));
    return values;
}

// RMS over the rows of a square matrix of ||F_i - exact_i||.
inline double rowError(const std::vector<float>& values, const std::vector<float>& exact) {
    double squares = 0;
    for (size_t k = 0; k < values.size(); ++k) squares += std::pow(double{values[k]} - exact[k], 2);
    return std::sqrt(squares / std::sqrt(static_cast<double>(values.size())));
}

// Every quad cut into cells about `edge` wide, each cell into two triangles. Cells of neighbours need not
// match.
inline geometry::PatchMesh subdivided(const geometry::PatchMesh& coarse, double edge) {
    geometry::PatchMesh fine;
    fine.materials = coarse.materials;
    for (size_t i = 0; i < coarse.patchCount(); ++i) {
        const auto c = coarse.patch(i);
        const auto corner = [&](size_t k) { return coarse.vertices[c[k]]; };
        const auto cells = [&](size_t a, size_t b, size_t e, size_t f) {
            const double length =
                std::max(glm::length(corner(b) - corner(a)), glm::length(corner(f) - corner(e)));
            return static_cast<uint32_t>(std::max(1.0, std::round(length / edge)));
        };
        const uint32_t nu = cells(0, 1, 3, 2), nv = cells(1, 2, 0, 3);
        const auto first = static_cast<uint32_t>(fine.vertices.size());
        for (uint32_t j = 0; j <= nv; ++j)
            for (uint32_t k = 0; k <= nu; ++k) {
                const double u = double(k) / nu, v = double(j) / nv;
                fine.vertices.push_back((1 - v) * ((1 - u) * corner(0) + u * corner(1)) +
                                        v * ((1 - u) * corner(3) + u * corner(2)));
            }
        for (uint32_t j = 0; j < nv; ++j)
            for (uint32_t k = 0; k < nu; ++k) {
                const uint32_t v0 = first + j * (nu + 1) + k, v1 = v0 + 1, v2 = v1 + nu + 1, v3 = v2 - 1;
                for (const auto& t : {std::vector<uint32_t>{v0, v1, v2}, std::vector<uint32_t>{v0, v2, v3}})
                    fine.addPatch(t, coarse.material[i], coarse.role[i], coarse.surface[i], coarse.room[i]);
            }
    }
    return fine;
}

struct DaylightCase {
    geometry::PatchMesh faces;
    daylight::Sky sky; // dark where surfaces emit
    std::vector<compute::Sensor> sensors;
    std::map<std::string, std::vector<double>> columns; // of sensors.csv
};

inline DaylightCase readCase(const std::filesystem::path& folder) {
    DaylightCase result;
    result.faces = geometry::readPatches(folder / "model.obj", geometry::UpAxis::z);
    if (std::filesystem::exists(folder / "sky.json")) result.sky = daylight::readSky(folder / "sky.json");
    std::ifstream in(folder / "sensors.csv");
    std::string line, field;
    std::vector<std::string> names;
    std::getline(in, line);
    for (std::istringstream s(line); std::getline(s, field, ',');) names.push_back(field);
    while (std::getline(in, line)) {
        std::istringstream s(line);
        for (size_t k = 0; std::getline(s, field, ','); ++k)
            result.columns[names[k]].push_back(std::stod(field));
    }
    auto& column = result.columns;
    for (size_t s = 0; s < column["x"].size(); ++s)
        result.sensors.push_back(
            {geometry::worldFromModel({column["x"][s], column["y"][s], column["z"][s]}, geometry::UpAxis::z),
             geometry::worldFromModel({column["nx"][s], column["ny"][s], column["nz"][s]},
                                      geometry::UpAxis::z)});
    return result;
}

// Relative, of the sensors that count. The reference is random itself, by lux_ref_stderr.
struct Deviation {
    double rms = 0, worst = 0, bias = 0;
    double rmsBeyondNoise = 0, worstBeyondNoise = 0; // its variance taken off; two standard errors taken off
    double inside = 0; // share whose error is within the claimed one and two standard errors
};

// Deviation of lux from lux_ref over the sensors without direct sun (or all).
inline Deviation deviation(const DaylightCase& room, const compute::Moment& moment, bool withSun = false) {
    Deviation d;
    double count = 0, noise = 0;
    const auto &ref = room.columns.at("lux_ref"), &stderrs = room.columns.at("lux_ref_stderr");
    for (size_t s = 0; s < ref.size(); ++s) {
        if (!withSun && room.columns.contains("lux_sun_direct") && room.columns.at("lux_sun_direct")[s] > 0)
            continue;
        const double lux = compute::photometric(moment.sensors[s].total()), relative = lux / ref[s] - 1,
                     random = stderrs[s] / ref[s];
        d.rms += relative * relative;
        noise += random * random;
        d.bias += relative;
        d.worst = std::max(d.worst, std::abs(relative));
        d.worstBeyondNoise = std::max(d.worstBeyondNoise, std::abs(relative) - 2 * random);
        d.inside += std::abs(lux - ref[s]) <= moment.sensors[s].error + 2 * stderrs[s];
        ++count;
    }
    d.rmsBeyondNoise = std::sqrt(std::max(0.0, d.rms - noise) / count);
    d.rms = std::sqrt(d.rms / count);
    d.bias /= count;
    d.inside /= count;
    return d;
}

} // namespace heliodon::test
