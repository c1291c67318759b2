// The cases of tests/data/formfactor, read once for several tests.
#pragma once

#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "compute/reference/exact_form_factors.h"
#include "geometry/patch_mesh.h"

namespace heliodon::test {

struct FormFactorCase {
    std::string name, category;
    std::vector<compute::reference::Polygon> polygons;
    struct Entry {
        size_t i, j;
        double value, uncertainty;
    };
    std::vector<Entry> entries;
};

struct ElementCase {
    std::string name;
    glm::dvec3 point, normal;
    compute::reference::Polygon polygon;
    double value;
};

inline nlohmann::json readCases() {
    std::ifstream file(HELIODON_TEST_DATA "/formfactor/cases.json");
    return nlohmann::json::parse(file);
}

inline glm::dvec3 pointOf(const nlohmann::json& j) {
    return {j[0], j[1], j[2]};
}

inline compute::reference::Polygon polygonOf(const nlohmann::json& corners) {
    compute::reference::Polygon polygon;
    for (const auto& corner : corners) polygon.push_back(pointOf(corner));
    return polygon;
}

inline std::vector<FormFactorCase> formFactorCases(const std::string& category) {
    std::vector<FormFactorCase> result;
    const nlohmann::json all = readCases();
    for (const auto& c : all["cases"]) {
        if (c["category"] != category) continue;
        FormFactorCase one{c["name"], category, {}, {}};
        for (const auto& polygon : c["polygons"]) one.polygons.push_back(polygonOf(polygon));
        for (const auto& f : c["F"]) one.entries.push_back({f[0], f[1], f[2], f[3]});
        result.push_back(std::move(one));
    }
    return result;
}

inline std::vector<ElementCase> elementCases() {
    std::vector<ElementCase> result;
    const nlohmann::json all = readCases();
    for (const auto& c : all["elements"])
        result.push_back(
            {c["name"], pointOf(c["point"]), pointOf(c["normal"]), polygonOf(c["polygon"]), c["value"]});
    return result;
}

inline geometry::PatchMesh meshOf(const std::vector<compute::reference::Polygon>& polygons) {
    geometry::PatchMesh mesh;
    mesh.materials.push_back({});
    for (const auto& polygon : polygons) {
        std::vector<uint32_t> corners;
        for (const glm::dvec3& p : polygon) {
            corners.push_back(static_cast<uint32_t>(mesh.vertices.size()));
            mesh.vertices.push_back(p);
        }
        mesh.addPatch(corners, 0, geometry::Role::projection, 0, 0);
    }
    return mesh;
}

} // namespace heliodon::test
