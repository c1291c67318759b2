// Tables as files: sensors in, CSV and NumPy arrays out.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/model_file.h"

namespace heliodon::app {

// A sensor table keeps every column that the file has, as text, so that results can be appended.
struct SensorTable {
    std::string header;
    std::vector<std::string> rows;           // without line ends
    std::vector<glm::dvec3> points, normals; // world axes, normals of unit length
};

// CSV with a header that names x,y,z,nx,ny,nz, in any order among other columns; model units and axes.
// Throws InputError naming the line: missing columns, text or NaN where a number belongs, a normal of length
// zero, no rows.
SensorTable readSensors(const std::filesystem::path& file, geometry::UpAxis up);

// NumPy .npy format 1.0, little-endian float32, C order, in pieces: a matrix need never be whole in memory.
class NpyWriter {
public:
    // `fill` hands over rowCount x columnCount values in any number of write()s; the file appears when all
    // are there. Throws std::runtime_error when the disk is full.
    static void writeWhole(const std::filesystem::path& file, size_t rowCount, size_t columnCount,
                           const std::function<void(NpyWriter&)>& fill);
    void write(std::span<const float> values);

private:
    explicit NpyWriter(std::ostream& out) : out_(out) {}
    std::ostream& out_;
    size_t written_ = 0;
};

void writeNpy(const std::filesystem::path& file, size_t rowCount, size_t columnCount,
              std::span<const float> values);

// The same for matrices that need not fit into memory: `fill` is called with a function that puts a tile of
// rows x columns values (row-major) at its place, in any order; what is never put is zero. Throws InputError
// before `fill` is called where the file cannot be written.
using PutTile = std::function<void(size_t firstRow, size_t rows, size_t firstColumn, size_t columns,
                                   std::span<const float> values)>;
void writeNpyTiles(const std::filesystem::path& file, size_t rowCount, size_t columnCount,
                   const std::function<void(const PutTile&)>& fill);

// A float32 matrix of rowCount x columnCount from .npy (version 1, '<f4', C order) or raw little-endian .f32.
std::vector<float> readMatrix(const std::filesystem::path& file, size_t rowCount, size_t columnCount);

} // namespace heliodon::app
