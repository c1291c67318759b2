// Tables as files: sensors in, CSV and NumPy arrays out.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "geometry/model_file.h"

namespace heliodon::app {

// Text as a field of CSV (RFC 4180): in quotes where it holds a comma, a quote or a line end.
std::string csvField(const std::string& text);

// A sensor table keeps every column that the file has, as text, so that results can be appended.
struct SensorTable {
    std::string header;
    std::vector<std::string> rows;           // without line ends, commas between cells
    std::vector<glm::dvec3> points, normals; // world axes, normals of unit length
};

// CSV with a header that names x,y,z,nx,ny,nz, in any order among other columns; model units and axes. Cells
// may be quoted (RFC 4180), but not go over several lines. Semicolons, tabs or blanks between cells, and then
// decimal commas, are read too, and become commas and points; capitals in the header, too.
// Throws InputError naming the line: missing columns, text or NaN where a number belongs, a normal of length
// zero, no rows.
SensorTable readSensors(const std::filesystem::path& file, geometry::UpAxis up);

// NumPy .npy format 1.0, little-endian float32, C order, in pieces: a matrix need never be whole in memory.
// What is never written is zero.
class NpyWriter {
public:
    // The file is opened before `fill` is called, so that no work is lost to a folder that cannot be written
    // to, and appears under its name when `fill` returns. Throws InputError where it cannot be written,
    // std::runtime_error when the disk is full.
    static void writeWhole(const std::filesystem::path& file, size_t rowCount, size_t columnCount,
                           const std::function<void(NpyWriter&)>& fill);

    // The next values, in order.
    void write(std::span<const float> values);
    // A tile of rows x columns values, row-major, at its place.
    void put(size_t firstRow, size_t rows, size_t firstColumn, size_t columns, std::span<const float> values);

private:
    NpyWriter(std::ostream& out, std::string name, size_t begin, size_t columnCount)
        : out_(out), name_(std::move(name)), begin_(begin), columnCount_(columnCount) {}
    void writeAt(size_t place, std::span<const float> values);
    void flush();

    std::ostream& out_;
    std::string name_;
    size_t begin_, columnCount_; // byte of the first value
    size_t written_ = 0;
};

// A float32 matrix of rowCount x columnCount in a file, .npy (version 1, '<f4', C order) or raw little-endian
// .f32, of which parts are read. Throws InputError where the file is no such matrix.
class MatrixFile {
public:
    MatrixFile(const std::filesystem::path& file, size_t rowCount, size_t columnCount);

    // Rows x columns values from there on, row-major.
    std::vector<float> read(size_t firstRow, size_t rows, size_t firstColumn, size_t columns);

private:
    std::string name_;
    std::ifstream in_;
    size_t begin_ = 0, columnCount_; // byte of the first value
};

// All of it. Throws InputError where a value is not finite, too.
std::vector<float> readMatrix(const std::filesystem::path& file, size_t rowCount, size_t columnCount);

} // namespace heliodon::app
