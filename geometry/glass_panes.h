// Panes that a model draws as they are built, as slabs that reach into frames -> the faces that rooms need.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "geometry/building.h"
#include "geometry/face_soup.h"

namespace heliodon::geometry {

// A body of glass, or a flat pane, that fills no hole.
struct LooseGlass {
    std::vector<uint32_t> faces; // SoupFace::surface
    glm::dvec3 middle{0};        // of the box round it
    double diagonal = 0;         // of that
    bool kept = false;           // a slab, smaller where its rim touched others: other bodies are left out
    std::optional<double> joint; // metres, that would be left round it in the hole where it stands
};

struct PanesInHoles {
    std::vector<SoupFace> soup;
    size_t slabs = 0, flat = 0;  // panes that are other ones now
    std::vector<uint32_t> made;  // SoupFace::surface of these
    std::vector<uint32_t> edges; // of the soup: what joins the two sides of slabs that are kept
    std::vector<LooseGlass> loose;
    std::optional<LooseGlass> openFlat; // the first flat pane round which a joint is left
};

enum class Drawn { slabs, slabsAndFlat };

// In the place of each slab that stands in a hole (PaneFitter), what of its middle lies there; where nothing
// does, what of its two sides lies in holes (both where it is glass between two rooms). Slabs of one glass
// side by side or nearly in one plane, as of sliding windows, that fill no hole each are one pane where they
// do together; others that hang together, of two kinds of glass in one plane or at an angle as round a
// corner, up to 64, end at the middles of one another. A slab is a closed body whose faces are all of one
// glass (`isGlass` of a material): two flat sides of one size, no farther apart than a fifth of it, and what
// joins them between. One that fills no hole and touches other faces and slabs with its rim at most stands
// free, smaller by 25 `tolerance` where it does. Other closed bodies of glass are no part of a room's
// boundary, unless they lie beside the box round all that is no glass. Drawn::slabsAndFlat: so also flat
// panes that are larger or smaller than their hole. Corners are one within `tolerance` (metres). None where
// nothing is to be changed. Cost: O(n log n) for n faces, for each pane what is near it, and m^2 for m panes
// that fill no hole.
std::optional<PanesInHoles> panesInHoles(const std::vector<SoupFace>& soup,
                                         const std::function<bool(uint32_t)>& isGlass, double tolerance,
                                         Drawn drawn);

// Takes glass that stands free out of the soup: that whose first faces (SoupFace::surface) are given, or all.
// False where there is none.
bool leaveOutFree(PanesInHoles& panes, const std::set<uint32_t>& first);

// Adds what was done to the building's repairs and warnings; `place` of a SoupFace::surface in the file.
void reportGlass(const PanesInHoles& panes, Building& out, const std::function<std::string(uint32_t)>& place);

} // namespace heliodon::geometry
