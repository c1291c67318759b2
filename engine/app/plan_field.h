// Values between scattered sensors of a plan, for drawing.
#pragma once

#include <array>
#include <vector>

#include <glm/vec2.hpp>

namespace heliodon::app {

struct Sample {
    glm::dvec2 at;
    double value;
    double height = 0; // in a room; linear between samples
};
// Places and values alike, as geometry::clip wants them.
inline Sample operator+(const Sample& a, const Sample& b) {
    return {a.at + b.at, a.value + b.value, a.height + b.height};
}
inline Sample operator-(const Sample& a, const Sample& b) {
    return {a.at - b.at, a.value - b.value, a.height - b.height};
}
inline Sample operator*(const Sample& a, double times) {
    return {a.at * times, a.value * times, a.height * times};
}
using SampleTriangle = std::array<Sample, 3>;

// The Delaunay triangles of the samples, each cut into parts^2. The value is that of the sample at a sample,
// continuous, with one slope on all sides of a sample, and nowhere beyond the range of the samples that its
// triangle's corners touch: slopes are the mean of the triangles around a sample by area, cut back as Barth
// and Jespersen 1989 do, and a smooth weight leads from corner to corner. One part: linear between samples.
std::vector<SampleTriangle> smoothTriangles(const std::vector<Sample>& samples, size_t parts);

// Metres from a sample to the one nearest to it: the median over at most some hundreds of the samples. 0 of
// one.
double spacingOf(const std::vector<Sample>& samples);

// The convex polygon around the samples, its sides moved outwards by `reach` > 0. Corners of 90 degrees and
// more stay corners, sharper ones are cut at `reach`. One sample has a round one.
std::vector<glm::dvec2> reachOf(const std::vector<Sample>& samples, double reach);

// Of a polygon, any way round.
double areaOf(const std::vector<glm::dvec2>& polygon);

bool isWithin(const std::vector<glm::dvec2>& convex, glm::dvec2 p);

// The part of the triangles within a convex polygon as reachOf() returns it.
std::vector<SampleTriangle> within(const std::vector<SampleTriangle>& triangles,
                                   const std::vector<glm::dvec2>& convex);

// The triangles with `more` added within a convex polygon, any way round: cut along its outline where it
// crosses them. Cut pieces of less than a millionth of a triangle are left out.
std::vector<SampleTriangle> raisedWithin(const std::vector<SampleTriangle>& triangles,
                                         std::vector<glm::dvec2> convex, double more);

// Where disjoint convex polygons, any way round, with a value each border on others or on nothing: sides, but
// for the parts of them that have the same value on both sides. What lies nearer together than `eps` is as
// one.
std::vector<std::array<glm::dvec2, 2>> stepsBetween(const std::vector<std::vector<glm::dvec2>>& polygons,
                                                    const std::vector<double>& values, double eps);

// Outlines of the union of polygons, any way round, that overlap nowhere and share whole sides: sides that
// two of them have are gone. Corners are joined and returned on a grid of `step`; holes have an outline too.
std::vector<std::vector<glm::dvec2>> unitedOutlines(std::vector<std::vector<glm::dvec2>> polygons,
                                                    double step);

// Lines along which the value, linear in each triangle, is `level`: chains of points, closed where first and
// last are the same.
std::vector<std::vector<glm::dvec2>> isoLines(const std::vector<SampleTriangle>& triangles, double level);

} // namespace heliodon::app
