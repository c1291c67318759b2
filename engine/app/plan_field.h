// Values between scattered sensors of a plan, for drawing.
#pragma once

#include <array>
#include <vector>

#include <glm/vec2.hpp>

namespace heliodon::app {

struct Sample {
    glm::dvec2 at;
    double value;
};
using SampleTriangle = std::array<Sample, 3>;

// The Delaunay triangles of the samples, each cut into parts^2. The value is that of the sample at a sample,
// continuous, with one slope on all sides of a sample, and nowhere beyond the range of the samples that its
// triangle's corners touch: slopes are the mean of the triangles around a sample by area, cut back as Barth
// and Jespersen 1989 do, and a smooth weight leads from corner to corner. One part: linear between samples.
std::vector<SampleTriangle> smoothTriangles(const std::vector<Sample>& samples, size_t parts);

// Lines along which the value, linear in each triangle, is `level`: chains of points, closed where first and
// last are the same.
std::vector<std::vector<glm::dvec2>> isoLines(const std::vector<SampleTriangle>& triangles, double level);

} // namespace heliodon::app
