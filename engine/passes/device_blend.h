// How projectors share what they show, as shaders/gain.frag reads it.
#pragma once

#include <vector>

#include "compute/gpu/buffer.h"
#include "geometry/projector_blend.h"
#include "geometry/rig.h"
#include "shaders/io/gain.io.h"

namespace heliodon::passes {

struct DeviceBlend {
    DeviceBlend(gpu::Device& device, const geometry::ProjectorBlend& blend, const geometry::Rig& rig) {
        std::vector<io::BlendProjector> list;
        for (size_t p = 0; p < rig.projectors.size(); ++p)
            list.push_back({glm::vec3(rig.projectors[p].centre()), static_cast<float>(blend.candela[p]),
                            static_cast<float>(blend.candela[p] * rig.projectors[p].blackLevel)});
        std::vector<io::BlendTriangle> seen;
        for (size_t t = 0; t < blend.visible.size(); ++t) seen.push_back({blend.visible[t], blend.first[t]});
        seen.push_back({0, static_cast<uint32_t>(blend.borders.size())});
        std::vector<io::BlendBorder> edges;
        for (const geometry::BlendBorder& b : blend.borders)
            edges.push_back({glm::vec3(b.from), b.left, glm::vec3(b.to), b.right});
        if (list.empty()) list.push_back({});
        if (edges.empty()) edges.push_back({});
        projectors = gpu::Buffer::from(device, list, "projectors");
        triangles = gpu::Buffer::from(device, seen, "seen by projectors");
        borders = gpu::Buffer::from(device, edges, "borders of projectors");
    }
    gpu::Buffer projectors, triangles, borders;
};

} // namespace heliodon::passes
