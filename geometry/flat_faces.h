// Faces of a building each by itself: plane, corners and triangles in space.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/building.h"
#include "geometry/ray_triangle.h"

namespace heliodon::geometry {

constexpr double kOnePlaneCosine = 0.999; // of normals of faces in one plane

struct FlatFace {
    uint32_t face = 0, surface = 0; // of the building, and what that says of it
    glm::dvec3 origin{0}, normal{0};
    std::vector<std::vector<glm::dvec3>> loops;
    std::vector<ShellTriangle> triangles;
    Bounds box;
    bool isGlass = false, isWindow = false; // the latter: to the outside

    double height(glm::dvec3 p) const { return glm::dot(p - origin, normal); }
};

// Of a convex outline.
FlatFace convexFace(const std::vector<glm::dvec3>& corners, glm::dvec3 normal);

// A convex face cut along the plane of another one; a part that has no area is left out.
std::vector<FlatFace> halves(const FlatFace& convex, const FlatFace& plane);

const ShellTriangle& largestTriangle(const FlatFace& face);

// Without faces that have no area.
std::vector<FlatFace> flatFacesOf(const Building& building);

std::vector<ShellTriangle> trianglesOf(const std::vector<FlatFace>& faces);

// Of each face, so much larger all round: for a BoxTree.
std::vector<Bounds> boxesOf(const std::vector<FlatFace>& faces, double margin);

// Of at least one face.
Bounds boundsOfFaces(const std::vector<FlatFace>& faces);

// Square metres.
double areaFromAbove(const Bounds& box);

// Faces that hang together by edges.
struct Whole {
    uint32_t id = 0; // distinct
    Bounds box{glm::dvec3(1e300), glm::dvec3(-1e300)};
    double area = 0, steep = 0; // square metres; of walls, as they slope
};

// Per face of `faces`, the flat faces of `building`, that which it is of.
std::vector<Whole> wholesOf(const Building& building, const std::vector<FlatFace>& faces);

} // namespace heliodon::geometry
