// Clusters that face each other across so little that float32, in which shaders place them, takes both planes
// for one: slabs a micrometre apart in a room.
#pragma once

#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "compute/patch_tree.h"
#include "shaders/io/hierarchical.io.h"

namespace heliodon::compute {

// Whether two clusters lie so; never where their discs do not overlap. Shaders drop such pairs.
bool acrossNarrowGap(const PatchTree::Node& a, const PatchTree::Node& b);

// Links between the triangles of such pairs: each sends all its light to what lies over it. The error is what
// passes the borders, about half the gap times their length. Narrower gaps come first, and no triangle gives
// more than it has: of sheets in a pile only the next counts. As many tests as triangles of one times those
// of the other.
std::vector<io::HierarchicalLink> linksAcrossNarrowGaps(const PatchTree& tree,
                                                        std::span<const glm::uvec2> pairs);

} // namespace heliodon::compute
