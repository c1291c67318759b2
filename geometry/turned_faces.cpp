#include "geometry/turned_faces.h"

#include <algorithm>
#include <array>

#include "geometry/bounds.h"
#include "geometry/closed_pieces.h"
#include "geometry/shell_faces.h"
#include "geometry/shell_nesting.h"
#include "geometry/triangle_rays.h"

namespace heliodon::geometry {

namespace {

// Of a piece, and on average: where the rest of it says which way all should look. One face of six may.
constexpr double kMostTurned = 0.2;
constexpr double kScattered = 0.15; // of the edges of a piece
constexpr double kMostMixed = 0.5;  // of all pieces: then the others look one way by chance

Bounds boxOf(const std::vector<ShellTriangle>& triangles) {
    Bounds out = boundsOf(std::array{triangles[0].a, triangles[0].b, triangles[0].c});
    for (const ShellTriangle& t : triangles) out = united(out, boundsOf(std::array{t.a, t.b, t.c}));
    return out;
}

// Of its faces, by number.
double partTurned(const ClosedPiece& piece) {
    const double part =
        static_cast<double>(std::ranges::count(piece.turned, true)) / static_cast<double>(piece.faces.size());
    return std::min(part, 1 - part);
}

// A floor alone may be a third of the area, and small faces many.
bool isUnclear(const ClosedPiece& piece) {
    return std::min(partTurned(piece), piece.turnedArea / piece.area) > kMostTurned;
}

// Each drawn to look its way, as walls round a room in a hall look into both: turned faces lie together.
bool isTwoParts(const ClosedPiece& piece) {
    return partTurned(piece) > kMostTurned && piece.seams < kScattered;
}

// As a room does what stands in it; not where both only run into one another.
bool enclosesOther(const ClosedPiece& piece, const std::vector<ClosedPiece>& all, double tolerance) {
    const Bounds box = boxOf(piece.triangles);
    const TriangleRays rays(piece.triangles, tolerance);
    return std::ranges::any_of(all, [&](const ClosedPiece& other) {
        const Bounds within = boxOf(other.triangles);
        if (&other == &piece || glm::any(glm::lessThan(within.low, box.low - tolerance)) ||
            glm::any(glm::greaterThan(within.high, box.high + tolerance)))
            return false;
        const auto inside = std::ranges::count_if(
            other.triangles, [&](const ShellTriangle& t) { return rays.enclose(t.middle()); });
        return 2 * static_cast<size_t>(inside) > other.triangles.size();
    });
}

} // namespace

size_t turnAlike(std::vector<SoupFace>& faces, const std::function<bool(uint32_t)>& isGlass,
                 double tolerance) {
    std::vector<SoupFace> opaque;
    for (uint32_t k = 0; k < faces.size(); ++k)
        if (!isGlass(faces[k].material)) {
            opaque.push_back(faces[k]);
            opaque.back().surface = k;
        }
    if (opaque.size() == faces.size()) return 0;
    const std::vector<ClosedPiece> pieces = closedPieces(weldFaces(opaque, 1, tolerance, true));
    double parts = 0, mixed = 0;
    size_t closed = 0; // faces
    for (const ClosedPiece& piece : pieces) {
        closed += piece.faces.size();
        if (piece.turnedArea > 0 && !isTwoParts(piece)) parts += partTurned(piece), ++mixed;
    }
    const bool atRandom = parts > kMostTurned * mixed,
               isRule = atRandom && mixed > kMostMixed * static_cast<double>(pieces.size());
    if (atRandom && closed < opaque.size()) return 0; // which way open pieces look would stay unknown
    size_t count = 0;
    for (const ClosedPiece& piece : pieces) {
        if (isTwoParts(piece)) continue;
        const bool unclear = piece.turnedArea > 0 ? atRandom || isUnclear(piece) : isRule;
        const bool over = unclear && piece.looksIn && !enclosesOther(piece, pieces, tolerance);
        for (size_t k = 0; k < piece.faces.size(); ++k)
            if (piece.turned[k] != over) {
                turnOver(faces[piece.faces[k]]);
                ++count;
            }
    }
    return count;
}

} // namespace heliodon::geometry
