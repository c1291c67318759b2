// Panes as they are built reach into frames and walls, or leave a joint: what of their plane lies in the
// hole.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "geometry/bounds.h"
#include "geometry/box_tree.h"
#include "geometry/face_soup.h"

namespace heliodon::geometry {

class PaneFitter {
public:
    // `isGlass` of a material: all other faces bound holes. Faces end in a plane within `tolerance` (metres).
    PaneFitter(const std::vector<SoupFace>& soup, const std::function<bool(uint32_t)>& isGlass,
               double tolerance);

    // The pane of the given faces of the soup, which lie in parallel planes, in that of the first one moved
    // by `shift`: a face for each part of that plane, no farther out than these (and 0.5 % of their
    // diagonal), that other faces bound all round where they cross or lie in it, but for what lies within
    // bars (closed shells of other faces); of the first face's material. None where less than half of the
    // pane would be left.
    std::vector<SoupFace> fit(std::span<const uint32_t> pane, glm::dvec3 shift) const;

    // Of a pane that does not fit: how far (metres) it would have to grow to fill the hole in which it
    // stands; none where there is no such hole that it fills by half.
    std::optional<double> joint(std::span<const uint32_t> pane, glm::dvec3 shift) const;

    // Whether another face meets the pane, or ends less than that 0.5 % from it.
    bool touches(std::span<const uint32_t> pane, glm::dvec3 shift) const;

    // Whether another face meets the pane farther than `rim` (metres) from its border, or lies on it.
    bool crosses(std::span<const uint32_t> pane, glm::dvec3 shift, double rim) const;

    // The faces of a slab `body` smaller all round by `by` (metres), in the plane of `side`; none where not
    // all corners are over the border of that, or one is sharp.
    std::optional<std::vector<SoupFace>> pulledIn(std::span<const uint32_t> side,
                                                  std::span<const uint32_t> body, double by) const;

private:
    struct Cut; // the plane through all near the pane
    // `reach`: a share of the pane's diagonal.
    Cut cut(std::span<const uint32_t> pane, glm::dvec3 shift, double reach) const;
    std::vector<SoupFace> fit(std::span<const uint32_t> pane, glm::dvec3 shift, double reach) const;
    bool meets(std::span<const uint32_t> pane, glm::dvec3 shift, double reach, double rim) const;
    double distanceToBorder(std::span<const uint32_t> pane, glm::dvec3 p) const;

    const std::vector<SoupFace>& soup_;
    std::vector<uint32_t> others_; // faces of the soup
    std::vector<Bounds> boxes_;    // of these
    std::vector<uint32_t> shells_; // of these, where they are closed
    std::map<uint32_t, std::vector<uint32_t>> facesOfShells_;
    BoxTree tree_;
    double tolerance_;
};

} // namespace heliodon::geometry
