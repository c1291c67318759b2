// The openings of a mesh as few flat panes, ready for the question of one drawn point: through which panes
// does its ray to the sun pass, and what is left of the light behind them?
// Every sun ray meets a pane at the same angle, so its transmittance is one number for all points.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "compute/daylight/window.h"
#include "geometry/patch_mesh.h"

namespace heliodon::passes {

// What the sun pass reads: io::SunPanes (header and panes) as bytes, and the outlines' edges as (u0, v0, u1,
// v1) in the plane across the sun's rays.
struct SunPaneData {
    std::vector<std::byte> panes;
    std::vector<glm::vec4> edges; // never empty
};

class Panes {
public:
    explicit Panes(const geometry::PatchMesh& mesh);

    size_t size() const { return panes_.size(); }
    // Every room is closed: a ray that passes no pane has slipped through an edge.
    bool closed() const { return closed_; }
    // Panes parallel to the rays are left out: no light passes them. A pane with a twin counts only where the
    // ray leaves its room, so that the glass of an interior window counts once.
    SunPaneData seenFromSun(glm::dvec3 towardsSun) const;

private:
    struct Pane {
        glm::dvec3 point, normal;
        uint32_t material;
        bool hasTwin;
        std::vector<glm::dvec3> edges; // pairs: the outline without order
    };

    void addPane(const geometry::PatchMesh& mesh, const std::vector<uint32_t>& patches);

    std::vector<Pane> panes_;
    std::vector<daylight::Window> windows_; // per material
    bool closed_ = false;
};

} // namespace heliodon::passes
