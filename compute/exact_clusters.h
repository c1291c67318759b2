// Pieces in an order in which neighbours stand together, cut into clusters of at most kClusterPieces: what
// holds for a cluster's rectangle (not facing, hidden, nothing between) holds for all of its pieces.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace heliodon::compute {

constexpr uint32_t kClusterPieces = 16;

struct RadiatingPiece {
    std::vector<glm::dvec3> corners;
    glm::dvec3 normal{0};
    uint32_t patch = 0, room = 0;
    uint32_t plane = 0; // number of its plane: pieces of one number lie in one plane
    uint32_t place = 0; // where it stands before ordering, in its tile
    double size = 0;    // of its farthest corner from the first
};

struct PieceCluster {
    uint32_t first = 0, count = 0;
    uint32_t room = 0;
    bool flat = false;
    glm::dvec3 normal{0};
    std::vector<glm::dvec3>
        rectangle; // that holds all corners, counter-clockwise about the normal; empty unless flat
};

// Reorders `pieces` and returns clusters that cover them; `firstPiece` is added to their indices. Cost n log
// n.
std::vector<PieceCluster> clusterPieces(std::span<RadiatingPiece> pieces, uint32_t firstPiece);

} // namespace heliodon::compute
