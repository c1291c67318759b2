// Boards that stand close before one another, as louvres do, with the sill and the head that the outer ones
// face. Light passes between them to and fro and falls off across their depth, which patches as deep as a
// board do not tell; along them it changes little. So they are grids of long, narrow cells.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/building.h"
#include "geometry/mesh_domains.h"

namespace heliodon::geometry {

constexpr double kBoardColumn = 1.5; // times the edge length elsewhere: of a cell, along the board

// Per domain: into how many rows its depth is divided, six or as many fewer as keep all these cells at a
// third of `triangles`; nought where it is no board, or has room for one row only. Boards are parallelograms
// four or more times as long as deep, not much deeper than `edge`, the length of edges elsewhere in metres,
// that face one another across no more than 1.3 times that depth, where one of the two is the side of a thin
// solid, as is the other side of such a one. What joins two boards across a third of their depth or less, as
// their rims do, is one row and counts among the cells.
// Cost: the square of the number of such parallelograms; none is a board where there are more than a
// thousand.
std::vector<uint32_t> boardRows(const Building& building, const std::vector<MeshDomain>& domains, double edge,
                                double triangles);

} // namespace heliodon::geometry
