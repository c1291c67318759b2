// The faces of a Building by the closed shells that they form, and the way they look.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "geometry/building.h"

namespace heliodon::geometry {

using Edge = std::pair<uint32_t, uint32_t>; // smaller vertex first

std::map<Edge, std::vector<uint32_t>> facesOfEdges(const Building& building);

// A Face, or a SoupFace.
template<class AnyFace> void turnOver(AnyFace& face) {
    for (auto& loop : face.loops) std::ranges::reverse(loop);
}

struct ShellFaces {
    std::vector<uint32_t> shell; // per face
    uint32_t count = 0;
    size_t turnedOver = 0;          // faces, against the others of their shell
    std::vector<uint32_t> bad;      // faces that keep the shells from closing; empty when they do
    std::string what;               // is wrong with those
    bool isOpen = false;            // namely that edges of them have one face alone
    std::vector<glm::dvec3> border; // both ends of each open edge of a hole that bad[0] lies along
    bool isHole = false;            // closing that may be all; else it is of the largest open part
};

// Turns faces over until within a shell all look the same way: the way of most of its area.
ShellFaces orientShells(Building& building);

} // namespace heliodon::geometry
