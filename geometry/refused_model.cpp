#include "geometry/refused_model.h"

#include "geometry/model_faces.h"
#include "geometry/shell_faces.h"
#include "geometry/space_sheets.h"

namespace heliodon::geometry {

RefusedModel refusedModel(const RawModel& model, const ModelPlace& where, double extent,
                          double worldPerBuilding) {
    RefusedModel out;
    out.worldPerBuilding = worldPerBuilding;
    out.northDeg = model.northDeg.value_or(kModelNorthDeg);
    const auto outlinesOf = [&](size_t face) {
        RefusedModel::Outlines outlines;
        for (const auto& loop : model.loops(face)) {
            outlines.emplace_back();
            for (const uint32_t v : loop) outlines.back().push_back(model.vertices[v]);
        }
        return outlines;
    };
    for (size_t f = 0; f < model.faceCount(); ++f)
        for (auto& outline : outlinesOf(f))
            (model.materials[model.material[f]].isOpening() ? out.glass : out.walls)
                .push_back(std::move(outline));
    for (const uint32_t f : where.faces) out.named.push_back(outlinesOf(f));
    out.border = where.border;
    // Where others end on a face that is not cut, an edge of one face alone is none that is open.
    const double tolerance = kWeldOfExtent * extent;
    const Building welded =
        weldSheets(cutIntoSheets(flatFaces(model, extent, worldPerBuilding).soup, tolerance), tolerance);
    for (const auto& [edge, faces] : facesOfEdges(welded))
        if (faces.size() == 1)
            out.open.insert(out.open.end(), {welded.vertices[edge.first], welded.vertices[edge.second]});
    return out;
}

} // namespace heliodon::geometry
