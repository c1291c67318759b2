#include "compute/patch_slopes.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"

namespace heliodon::compute {

using glm::dvec3;

namespace {

// The patches of a mesh that share a corner.
class Neighbours {
public:
    explicit Neighbours(const geometry::PatchMesh& mesh) : mesh_(mesh), atVertex_(mesh.vertices.size()) {
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            for (uint32_t v : mesh.patch(i)) atVertex_[v].push_back(static_cast<uint32_t>(i));
    }

    // Those of one patch on its own surface and of its material, ascending.
    std::vector<uint32_t> of(size_t i) const {
        std::vector<uint32_t> around;
        for (uint32_t v : mesh_.patch(i))
            for (uint32_t j : atVertex_[v])
                if (j != i && mesh_.surface[j] == mesh_.surface[i] && mesh_.material[j] == mesh_.material[i])
                    around.push_back(j);
        std::sort(around.begin(), around.end());
        around.erase(std::unique(around.begin(), around.end()), around.end());
        return around;
    }

private:
    const geometry::PatchMesh& mesh_;
    std::vector<std::vector<uint32_t>> atVertex_;
};

// Weighted least squares for the slope of a function at the origin of a plane, from its differences there.
class LeastSquares {
public:
    // A curved surface is rolled out: true distance, direction in the plane.
    void add(dvec3 d, dvec3 u, dvec3 v) {
        const double length = glm::length(d), du = glm::dot(d, u), dv = glm::dot(d, v);
        const double flat = std::hypot(du, dv), stretch = flat > 0 ? length / flat : 0;
        const Place place{{du * stretch, dv * stretch}, length > 0 ? 1 / (length * length) : 0};
        uu_ += place.importance * place.at.x * place.at.x;
        uv_ += place.importance * place.at.x * place.at.y;
        vv_ += place.importance * place.at.y * place.at.y;
        places_.push_back(place);
    }

    bool determined() const { return trace() > 0; }

    // What the k-th difference adds to the slope. Where all places lie in a row, as along a strip, the slope
    // is that along the row.
    glm::dvec2 weight(size_t k) const {
        const auto& [p, importance] = places_[k];
        const double determinant = uu_ * vv_ - uv_ * uv_;
        if (determinant > kInRow * trace() * trace())
            return {importance * (vv_ * p.x - uv_ * p.y) / determinant,
                    importance * (uu_ * p.y - uv_ * p.x) / determinant};
        const double turn = 0.5 * std::atan2(2 * uv_, uu_ - vv_);
        const glm::dvec2 row(std::cos(turn), std::sin(turn));
        return importance * (p.x * row.x + p.y * row.y) / trace() * row;
    }

private:
    static constexpr double kInRow = 0.01; // least share of the squared trace that the determinant must have
    struct Place {
        glm::dvec2 at;
        double importance;
    };

    double trace() const { return uu_ + vv_; }

    double uu_ = 0, uv_ = 0, vv_ = 0;
    std::vector<Place> places_;
};

} // namespace

PatchSlopes::PatchSlopes(const geometry::PatchMesh& mesh) {
    std::vector<dvec3> centre(mesh.patchCount());
    for (size_t i = 0; i < centre.size(); ++i) centre[i] = geometry::patchCentroid(mesh, i);
    const Neighbours neighbours(mesh);
    for (size_t i = 0; i < centre.size(); ++i) {
        const std::vector<uint32_t> around = neighbours.of(i);
        const dvec3 normal = geometry::patchNormal(mesh, i);
        const dvec3 u = geometry::perpendicular(normal), v = glm::cross(normal, u);
        LeastSquares fit;
        for (uint32_t j : around) fit.add(centre[j] - centre[i], u, v);
        if (fit.determined()) {
            dvec3 own(0);
            for (size_t k = 0; k < around.size(); ++k) {
                const glm::dvec2 w = fit.weight(k);
                const dvec3 weight = w.x * u + w.y * v;
                own -= weight;
                terms_.push_back({around[k], glm::vec3(weight)});
            }
            terms_.push_back({static_cast<uint32_t>(i), glm::vec3(own)});
        }
        first_.push_back(terms_.size());
    }
}

} // namespace heliodon::compute
