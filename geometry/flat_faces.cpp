#include "geometry/flat_faces.h"

#include <utility>

#include "geometry/face_soup.h"
#include "geometry/outline_area.h"

namespace heliodon::geometry {

std::vector<FlatFace> flatFacesOf(const Building& building) {
    std::vector<FlatFace> out;
    for (const Face& face : building.faces) {
        FlatFace flat;
        flat.face = static_cast<uint32_t>(&face - building.faces.data());
        flat.surface = face.surface;
        for (const auto& loop : face.loops) {
            flat.loops.emplace_back();
            for (const uint32_t v : loop) flat.loops.back().push_back(building.vertices[v]);
        }
        for (const auto& t : triangulateFace(building, face))
            flat.triangles.push_back(
                {building.vertices[t[0]], building.vertices[t[1]], building.vertices[t[2]]});
        const glm::dvec3 area = areaVector(flat.loops[0]);
        if (!(glm::length(area) > 0)) continue;
        flat.origin = flat.loops[0][0];
        flat.normal = glm::normalize(area);
        flat.box = boundsOf(flat.loops[0]);
        flat.isGlass = !building.materials.empty() && building.materials[face.material].isOpening();
        flat.isWindow = flat.isGlass && face.twin == kNoTwin;
        out.push_back(std::move(flat));
    }
    return out;
}

std::vector<ShellTriangle> trianglesOf(const std::vector<FlatFace>& faces) {
    std::vector<ShellTriangle> out;
    for (const FlatFace& face : faces) out.insert(out.end(), face.triangles.begin(), face.triangles.end());
    return out;
}

} // namespace heliodon::geometry
