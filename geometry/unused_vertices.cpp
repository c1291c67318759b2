#include "geometry/unused_vertices.h"

namespace heliodon::geometry {

void dropUnusedVertices(PatchMesh& mesh) {
    constexpr uint32_t kUnused = 0xffffffffu;
    std::vector<uint32_t> place(mesh.vertices.size(), kUnused);
    for (const uint32_t v : mesh.corners) place[v] = 0;
    uint32_t count = 0;
    for (size_t v = 0; v < place.size(); ++v)
        if (place[v] != kUnused) {
            mesh.vertices[count] = mesh.vertices[v];
            place[v] = count++;
        }
    mesh.vertices.resize(count);
    for (uint32_t& v : mesh.corners) v = place[v];
}

} // namespace heliodon::geometry
