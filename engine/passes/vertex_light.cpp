#include "engine/passes/vertex_light.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

#include "geometry/corner_normals.h"
#include "geometry/perpendicular.h"

namespace heliodon::passes {

namespace {

using geometry::PatchMesh;

struct Tangents {
    glm::dvec3 u, v;
};

Tangents tangentsOf(glm::dvec3 normal) {
    const glm::dvec3 u = geometry::perpendicular(normal);
    return {u, glm::cross(normal, u)};
}

// Where a patch lies as seen from the vertex, the surface rolled flat: true distance, direction in the
// tangent plane.
glm::dvec2 unrolled(const Tangents& frame, glm::dvec3 offset) {
    const glm::dvec2 flat(glm::dot(frame.u, offset), glm::dot(frame.v, offset));
    const double length = glm::length(flat);
    return length > 0 ? flat * (glm::length(offset) / length) : flat;
}

struct Fit {
    std::vector<double> weights;
    bool sound = false; // well conditioned and not amplifying: no wider ring is needed
};

// Weights that read a weighted least-squares plane off at the origin.
Fit fitPlane(const std::vector<glm::dvec2>& points, const std::vector<double>& importance) {
    double total = 0;
    glm::dvec2 mean{0};
    for (size_t k = 0; k < points.size(); ++k) {
        total += importance[k];
        mean += importance[k] * points[k];
    }
    mean /= total;
    glm::dmat2 spread{0};
    for (size_t k = 0; k < points.size(); ++k)
        spread += importance[k] / total * glm::outerProduct(points[k] - mean, points[k] - mean);
    const double trace = spread[0][0] + spread[1][1], determinant = glm::determinant(spread);
    // Of points in one place, as a surface of one patch has, the spread is rounding.
    const double rounding = 1e-9 * glm::dot(mean, mean);
    // Smaller over larger eigenvalue, nearly; 0.01 means ten times as long as wide.
    const bool conditioned = trace > rounding && determinant > 0.01 * trace * trace;
    Fit fit;
    fit.weights.resize(points.size());
    // Points on a line leave the slope across it open: a little ridge takes it as zero.
    const double ridge = conditioned ? 0 : 1e-6 * trace + rounding + 1e-30;
    const glm::dmat2 inverse = glm::inverse(spread + glm::dmat2(ridge));
    double amplification = 0;
    for (size_t k = 0; k < points.size(); ++k) {
        fit.weights[k] = importance[k] / total * (1 - glm::dot(mean, inverse * (points[k] - mean)));
        amplification += std::abs(fit.weights[k]);
    }
    fit.sound = conditioned && amplification < 4;
    return fit;
}

struct Patches {
    std::vector<glm::dvec3> centroid, normal;
    std::vector<double> area;
};

Patches measure(const PatchMesh& mesh) {
    Patches all;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const glm::dvec3 areaVector = geometry::patchAreaVector(mesh, i);
        const double length = glm::length(areaVector);
        all.centroid.push_back(geometry::patchCentroid(mesh, i));
        all.normal.push_back(length > 0 ? areaVector / length : glm::dvec3(0, 1, 0));
        all.area.push_back(std::max(0.5 * length, 1e-300));
    }
    return all;
}

} // namespace

void VertexLight::findCorners(const PatchMesh& mesh, std::vector<std::vector<uint32_t>>& patchesAt,
                              std::vector<uint32_t>& vertexOf) {
    for (uint32_t p = 0; p < mesh.patchCount(); ++p)
        for (uint32_t c = mesh.firstCorner[p]; c < mesh.firstCorner[p + 1]; ++c) {
            const auto [entry, fresh] = pairs_.try_emplace({mesh.corners[c], mesh.surface[p]},
                                                           static_cast<uint32_t>(patchesAt.size()));
            if (fresh) {
                patchesAt.emplace_back();
                vertexOf.push_back(mesh.corners[c]);
            }
            corners_[c].pair = entry->second;
            patchesAt[entry->second].push_back(p);
        }
}

void VertexLight::weighCorners(const PatchMesh& mesh) {
    std::vector<double> around(pairs_.size()), area(corners_.size());
    for (uint32_t p = 0; p < mesh.patchCount(); ++p) {
        const uint32_t first = firstCorner_[p], end = firstCorner_[p + 1];
        const auto at = [&](uint32_t c) { return mesh.vertices[mesh.corners[c]]; };
        double whole = 1e-300;
        for (uint32_t c = first + 1; c + 1 < end; ++c) { // as drawMesh() fans it out
            const double third = glm::length(glm::cross(at(c) - at(first), at(c + 1) - at(first))) / 6;
            for (const uint32_t corner : {first, c, c + 1}) area[corner] += third;
            whole += 3 * third;
        }
        for (uint32_t c = first; c < end; ++c) {
            corners_[c].share = static_cast<float>(area[c] / whole);
            around[corners_[c].pair] += area[c];
        }
    }
    for (size_t c = 0; c < corners_.size(); ++c)
        corners_[c].pull = static_cast<float>(area[c] / std::max(around[corners_[c].pair], 1e-300));
}

VertexLight::VertexLight(const PatchMesh& mesh)
    : firstCorner_(mesh.firstCorner), corners_(mesh.corners.size()) {
    std::vector<std::vector<uint32_t>> patchesAt; // per pair, the patches that touch it
    std::vector<uint32_t> vertexOf;
    findCorners(mesh, patchesAt, vertexOf);
    weighCorners(mesh);
    const Patches patches = measure(mesh);
    const std::vector<glm::dvec3> normals = geometry::cornerNormals(mesh);
    normal_.resize(pairs_.size());
    for (size_t p = 0; p < mesh.patchCount(); ++p)
        for (uint32_t c = firstCorner_[p]; c < firstCorner_[p + 1]; ++c)
            if (glm::dvec3& normal = normal_[corners_[c].pair]; !normals.empty())
                normal = normals[c];
            else if (patches.area[p] > 1e-300 || normal == glm::dvec3(0)) // others have no direction
                normal = patches.normal[p];
    constexpr int kMostRings = 4;
    for (size_t pair = 0; pair < patchesAt.size(); ++pair) {
        const glm::dvec3 vertex = mesh.vertices[vertexOf[pair]];
        std::set<uint32_t> ring(patchesAt[pair].begin(), patchesAt[pair].end());
        const Tangents frame = tangentsOf(normal_[pair]);
        Fit fit;
        for (int rings = 1; rings <= kMostRings; ++rings) {
            std::vector<glm::dvec2> points;
            std::vector<double> importance;
            for (uint32_t p : ring) {
                const glm::dvec3 offset = patches.centroid[p] - vertex;
                points.push_back(unrolled(frame, offset));
                // Near patches say more; the area in the sum keeps a patch beside the vertex finite.
                importance.push_back(patches.area[p] / (glm::dot(offset, offset) + patches.area[p]));
            }
            fit = fitPlane(points, importance);
            if (fit.sound || rings == kMostRings) break;
            std::set<uint32_t> wider = ring;
            for (uint32_t p : ring)
                for (uint32_t c = mesh.firstCorner[p]; c < mesh.firstCorner[p + 1]; ++c) {
                    const auto& around = patchesAt[corners_[c].pair];
                    wider.insert(around.begin(), around.end());
                }
            if (wider.size() == ring.size()) break; // the whole surface is in use
            ring.swap(wider);
        }
        size_t k = 0;
        for (uint32_t p : ring) {
            patch_.push_back(p);
            weight_.push_back(static_cast<float>(fit.weights[k++]));
        }
        first_.push_back(static_cast<uint32_t>(patch_.size()));
    }
}

std::vector<glm::vec3> VertexLight::evaluate(std::span<const glm::vec3> patchValues) const {
    std::vector<glm::vec3> values(size());
    for (size_t pair = 0; pair < values.size(); ++pair) {
        glm::vec3 sum{0};
        for (uint32_t k = first_[pair]; k < first_[pair + 1]; ++k) sum += weight_[k] * patchValues[patch_[k]];
        values[pair] = glm::max(sum, glm::vec3(0));
    }
    keepMeans(patchValues, values);
    return values;
}

void VertexLight::addCorners(std::span<const glm::vec3> perPatch, std::span<const glm::vec3> corners,
                             std::vector<glm::vec3>& values) const {
    for (size_t p = 0; p < perPatch.size(); ++p)
        for (uint32_t c = firstCorner_[p]; c < firstCorner_[p + 1]; ++c)
            values[corners_[c].pair] += corners_[c].pull * perPatch[p] * corners[c];
}

void VertexLight::keepMeans(std::span<const glm::vec3> patchValues, std::vector<glm::vec3>& values) const {
    constexpr int kRounds = 4; // the first does most; later ones sharpen borders of light
    // A vertex stays between its fit and the patches at it: beyond, dark spots stand beside steep edges.
    std::vector<glm::vec3> low = values, high = values, lacking(values.size());
    for (size_t p = 0; p < patchValues.size(); ++p)
        for (uint32_t c = firstCorner_[p]; c < firstCorner_[p + 1]; ++c) {
            const uint32_t i = corners_[c].pair;
            low[i] = glm::min(low[i], patchValues[p]), high[i] = glm::max(high[i], patchValues[p]);
        }
    for (int round = 0; round < kRounds; ++round) {
        std::fill(lacking.begin(), lacking.end(), glm::vec3(0));
        for (size_t p = 0; p < patchValues.size(); ++p) {
            glm::vec3 lack = patchValues[p];
            for (uint32_t c = firstCorner_[p]; c < firstCorner_[p + 1]; ++c)
                lack -= corners_[c].share * values[corners_[c].pair];
            for (uint32_t c = firstCorner_[p]; c < firstCorner_[p + 1]; ++c)
                lacking[corners_[c].pair] += corners_[c].pull * lack;
        }
        for (size_t i = 0; i < values.size(); ++i)
            values[i] = glm::clamp(values[i] + lacking[i], low[i], high[i]);
    }
}

std::vector<glm::vec3> indirectExitance(const PatchMesh& mesh, const compute::Lighting& lighting) {
    assert(lighting.exitance.size() == mesh.patchCount());
    std::vector<glm::vec3> values(lighting.exitance);
    if (lighting.sunIlluminance.empty()) return values;
    for (size_t i = 0; i < values.size(); ++i)
        values[i] =
            glm::max(values[i] - mesh.materials[mesh.material[i]].reflectance * lighting.sunIlluminance[i],
                     glm::vec3(0));
    return values;
}

std::vector<glm::vec3> indirectIlluminance(const PatchMesh& mesh, const compute::Lighting& lighting) {
    std::vector<glm::vec3> values = indirectExitance(mesh, lighting);
    for (size_t i = 0; i < values.size(); ++i) {
        const geometry::Material& material = mesh.materials[mesh.material[i]];
        float sum = 0;
        int known = 0;
        glm::vec3 illuminance{0};
        for (int c = 0; c < 3; ++c) {
            if (!(material.reflectance[c] > 0)) continue;
            illuminance[c] = std::max(0.0f, (values[i][c] - material.exitance[c]) / material.reflectance[c]);
            sum += illuminance[c];
            ++known;
        }
        for (int c = 0; c < 3; ++c)
            if (!(material.reflectance[c] > 0) && known > 0) illuminance[c] = sum / static_cast<float>(known);
        values[i] = illuminance;
    }
    return values;
}

} // namespace heliodon::passes
