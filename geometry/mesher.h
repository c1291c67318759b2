// Building -> PatchMesh: uniform triangles without T-vertices, smaller ones in slots that light comes in by
// (slot_sizes.h), rectangles on boards that face one another (board_rows.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>

#include "geometry/building.h"
#include "geometry/patch_mesh.h"

namespace heliodon::geometry {

struct MeshOptions {
    size_t triangles =
        2000; // aimed at; the result is within a few percent where the building's own edges allow
    // Called before each part of the work (0.2 s of 10^6 triangles); what it throws ends the work.
    std::function<void()> beforePart = [] {};
    // Facets of curved walls much narrower than triangles, which in a model nobody has fitted to these,
    // become as wide: the room loses or gains what lies between the facets and their chords. And boards have
    // rectangles, for louvres are drawn in models alone: the stubs of walls beside a corridor are none.
    bool ofModel = false;
};

constexpr double kSharpCorner = 72; // degrees: below, there is no room for two angles of 36

struct MeshQuality {
    size_t triangles = 0;
    double minAngleDeg = 0;    // smallest angle, but for triangles at sharp corners and in strips
    double minAngleAllDeg = 0; // smallest angle of all triangles
    size_t stripTriangles = 0; // between two borders of their part nearer than half an edge length
    double areaDeviation = 0;  // standard deviation over mean of the areas
};

// Facets of curved walls of this length (inches) make columns of two triangles as large as all others: see
// ClosureOptions::facetLength. Triangles of such walls then lie in the facets' planes.
// `surface`: of the rooms, square metres.
double fittingFacet(double surface, const MeshOptions& options = {});

// Of a face that cannot be meshed: the two sides of an interior window differ, or its outline crosses itself,
// which rounding alone may bring about.
struct MeshError : std::runtime_error {
    MeshError(uint32_t ofFace, const std::string& what) : std::runtime_error(what), face(ofFace) {}
    uint32_t face; // of the building
};

// Throws MeshError.
PatchMesh meshBuilding(const Building& building, const MeshOptions& options = {});
MeshQuality measureMesh(const PatchMesh& mesh);

} // namespace heliodon::geometry
