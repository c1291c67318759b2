#include "engine/passes/projector_share.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace heliodon::passes {

namespace {

using geometry::PatchMesh;

// The weight of a projector that sees a piece of surface, beside the smooth shares of one that may be used
// freely: it decides only where no such share exists.
constexpr double kLastResort = 1e-3;
// Surfaces lie this close to the solids that they belong to.
constexpr double kLift = 1e-3;

std::vector<glm::dvec3> blockingTriangles(const PatchMesh& mesh, const geometry::Occluders& occluders) {
    std::vector<glm::dvec3> corners;
    for (uint32_t v : occluders.triangles) corners.push_back(occluders.vertices[v]);
    if (!corners.empty()) return corners;
    for (size_t p = 0; p < mesh.patchCount(); ++p) {
        if (mesh.role[p] != geometry::Role::projection) continue;
        const auto corner = mesh.patch(p);
        for (size_t k = 1; k + 1 < corner.size(); ++k)
            for (uint32_t v : {corner[0], corner[k], corner[k + 1]}) corners.push_back(mesh.vertices[v]);
    }
    return corners;
}

// What one projector sees. Blockers are sorted into cells of its picture plane, so that a question meets few.
class Sight {
public:
    Sight(const geometry::Projector& projector, const std::vector<glm::dvec3>& blockers,
          const ShareOptions& options)
        : projector_(&projector), blockers_(&blockers), options_(&options), centre_(projector.centre()) {
        low_ = glm::dvec2(std::numeric_limits<double>::max());
        glm::dvec2 high = -low_;
        std::vector<std::array<glm::dvec2, 2>> boxes(blockers.size() / 3);
        std::vector<bool> behind(boxes.size());
        for (size_t i = 0; i < boxes.size(); ++i) {
            boxes[i] = {glm::dvec2(std::numeric_limits<double>::max()),
                        glm::dvec2(std::numeric_limits<double>::lowest())};
            for (size_t k = 0; k < 3; ++k) {
                const auto p = plane(blockers[3 * i + k]);
                behind[i] = behind[i] || !p;
                if (!p) continue;
                boxes[i] = {glm::min(boxes[i][0], *p), glm::max(boxes[i][1], *p)};
            }
            if (behind[i]) continue;
            low_ = glm::min(low_, boxes[i][0]);
            high = glm::max(high, boxes[i][1]);
        }
        size_ = glm::max((high - low_) / double{kCells}, glm::dvec2(1e-9));
        for (uint32_t i = 0; i < boxes.size(); ++i) {
            const auto from = behind[i] ? std::array{0, 0} : cell(boxes[i][0]);
            const auto to = behind[i] ? std::array{kCells - 1, kCells - 1} : cell(boxes[i][1]);
            for (int y = from[1]; y <= to[1]; ++y)
                for (int x = from[0]; x <= to[0]; ++x)
                    cells_[static_cast<size_t>(y * kCells + x)].push_back(i);
        }
    }

    bool sees(glm::dvec3 point, glm::dvec3 normal) const {
        const glm::dvec3 towards = centre_ - point;
        if (glm::dot(normal, towards) <= options_->grazingLimit * glm::length(towards)) return false;
        if (!(border(point) > 0)) return false;
        const glm::dvec3 lifted = point + kLift * normal;
        const auto p = plane(lifted);
        if (!p) return false;
        const auto [x, y] = cell(*p);
        for (uint32_t i : cells_[static_cast<size_t>(y * kCells + x)])
            if (between(lifted, i)) return false;
        return true;
    }
    // How well it serves a point: the illuminance that it can give, fading out at the edge of its picture.
    double strength(glm::dvec3 point, glm::dvec3 normal) const {
        const glm::dvec3 towards = centre_ - point;
        const double r2 = glm::dot(towards, towards);
        return std::max(0.0, glm::dot(normal, towards) / std::sqrt(r2)) / r2 * border(point);
    }

private:
    static constexpr int kCells = 48;

    std::optional<glm::dvec2> plane(glm::dvec3 world) const {
        const glm::dvec3 p = projector_->deviceFromWorld * world + projector_->translation;
        if (p.z < 1e-3) return std::nullopt;
        return glm::dvec2(p.x / p.z, p.y / p.z);
    }
    std::array<int, 2> cell(glm::dvec2 p) const {
        const glm::dvec2 at = (p - low_) / size_;
        return {std::clamp(static_cast<int>(std::clamp(at.x, -1.0, 1e6)), 0, kCells - 1),
                std::clamp(static_cast<int>(std::clamp(at.y, -1.0, 1e6)), 0, kCells - 1)};
    }
    double border(glm::dvec3 point) const {
        const auto pixel = projector_->pixelFromWorld(point);
        if (!pixel) return 0;
        const double inside = std::min(
            {pixel->x, pixel->y, projector_->width - 1 - pixel->x, projector_->height - 1 - pixel->y});
        return std::clamp(inside / options_->borderPixels, 0.0, 1.0);
    }
    bool between(glm::dvec3 from, uint32_t triangle) const {
        const glm::dvec3* c = blockers_->data() + 3 * size_t{triangle};
        const glm::dvec3 d = centre_ - from, e1 = c[1] - c[0], e2 = c[2] - c[0], p = glm::cross(d, e2);
        const double determinant = glm::dot(e1, p);
        if (std::abs(determinant) < 1e-18) return false;
        const glm::dvec3 s = from - c[0], q = glm::cross(s, e1);
        const double u = glm::dot(s, p) / determinant, v = glm::dot(d, q) / determinant,
                     t = glm::dot(e2, q) / determinant;
        return u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < 1;
    }

    const geometry::Projector* projector_;
    const std::vector<glm::dvec3>* blockers_;
    const ShareOptions* options_;
    glm::dvec3 centre_;
    glm::dvec2 low_{0}, size_{1};
    std::array<std::vector<uint32_t>, size_t{kCells} * kCells> cells_;
};

class Sharing {
public:
    Sharing(const PatchMesh& mesh, const VertexLight& vertexLight, const std::vector<Sight>& sights,
            const ShareOptions& options)
        : mesh_(mesh), vertexLight_(vertexLight), sights_(sights), options_(options) {
        out.share.resize(sights.size());
        smooth_.assign(sights.size(), std::vector<double>(vertexLight.size()));
        for (size_t i = 0; i < sights.size(); ++i) smoothShares(i);
    }

    void add(size_t patch) {
        normal_ = geometry::patchNormal(mesh_, patch);
        reflectance_ = mesh_.materials[mesh_.material[patch]].reflectance;
        const uint32_t first = mesh_.firstCorner[patch];
        for (uint32_t c = first + 1; c + 1 < mesh_.firstCorner[patch + 1]; ++c) {
            const std::array<uint32_t, 3> corner{first, c, c + 1};
            for (size_t k = 0; k < 3; ++k) {
                at_[k] = mesh_.vertices[mesh_.corners[corner[k]]];
                pair_[k] = vertexLight_.ofCorner(corner[k]);
            }
            divide({glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)});
        }
    }

    DrawMesh out;

private:
    using Piece = std::array<glm::dvec3, 3>; // barycentric corners within the triangle at hand

    // 1 where the projector sees every triangle round a vertex, times its strength.
    void smoothShares(size_t i) {
        std::vector<double>& share = smooth_[i];
        std::vector<bool> all(share.size(), true);
        for (size_t p = 0; p < mesh_.patchCount(); ++p) {
            if (mesh_.role[p] != geometry::Role::projection) continue;
            const glm::dvec3 centroid = geometry::patchCentroid(mesh_, p),
                             normal = geometry::patchNormal(mesh_, p);
            bool seen = sights_[i].sees(centroid, normal);
            for (uint32_t v : mesh_.patch(p)) // corners drawn in a little, to stay on this side of an edge
                seen = seen && sights_[i].sees(glm::mix(mesh_.vertices[v], centroid, 0.02), normal);
            for (uint32_t c = mesh_.firstCorner[p]; c < mesh_.firstCorner[p + 1]; ++c) {
                const uint32_t pair = vertexLight_.ofCorner(c);
                if (!seen) all[pair] = false;
                share[pair] = sights_[i].strength(mesh_.vertices[mesh_.corners[c]], normal);
            }
        }
        for (size_t pair = 0; pair < share.size(); ++pair)
            if (!all[pair]) share[pair] = 0;
    }

    glm::dvec3 point(glm::dvec3 b) const { return b.x * at_[0] + b.y * at_[1] + b.z * at_[2]; }

    uint32_t seenBy(glm::dvec3 b) const {
        uint32_t mask = 0;
        for (size_t i = 0; i < sights_.size(); ++i)
            if (sights_[i].sees(point(b), normal_)) mask |= 1u << i;
        return mask;
    }

    void divide(const Piece& piece) {
        const glm::dvec3 centroid = (piece[0] + piece[1] + piece[2]) / 3.0;
        const uint32_t mask = seenBy(centroid);
        const Piece middle{(piece[0] + piece[1]) / 2.0, (piece[1] + piece[2]) / 2.0,
                           (piece[2] + piece[0]) / 2.0};
        double longest = 0;
        bool same = true;
        for (size_t k = 0; k < 3; ++k) {
            longest = std::max(longest, glm::length(point(piece[k]) - point(piece[(k + 1) % 3])));
            same = same && seenBy(glm::mix(piece[k], centroid, 0.02)) == mask &&
                   seenBy(glm::mix(middle[k], centroid, 0.02)) == mask;
        }
        if (same || longest < 2 * options_.finestMetres) {
            emit(piece, mask);
            return;
        }
        for (size_t k = 0; k < 3; ++k) divide({piece[k], middle[k], middle[(k + 2) % 3]});
        divide(middle);
    }

    void emit(const Piece& piece, uint32_t mask) {
        for (const glm::dvec3& b : piece) {
            out.corners.push_back({glm::vec3(point(b)), glm::vec3(normal_), reflectance_});
            out.light.push_back({pair_, glm::vec3(b)});
            std::array<double, 32> weight{};
            double total = 0;
            for (size_t i = 0; i < sights_.size(); ++i) {
                if (!(mask >> i & 1)) continue;
                weight[i] = b.x * smooth_[i][pair_[0]] + b.y * smooth_[i][pair_[1]] +
                            b.z * smooth_[i][pair_[2]] +
                            kLastResort * std::max(1e-3, sights_[i].strength(point(b), normal_));
                total += weight[i];
            }
            for (size_t i = 0; i < sights_.size(); ++i)
                out.share[i].push_back(total > 0 ? static_cast<float>(weight[i] / total) : 0.0f);
        }
    }

    const PatchMesh& mesh_;
    const VertexLight& vertexLight_;
    const std::vector<Sight>& sights_;
    const ShareOptions& options_;
    std::vector<std::vector<double>> smooth_; // per projector and pair
    glm::dvec3 normal_{0};
    glm::vec3 reflectance_{0};
    std::array<glm::dvec3, 3> at_;
    std::array<uint32_t, 3> pair_{};
};

} // namespace

DrawMesh shownMesh(const PatchMesh& mesh, const VertexLight& vertexLight,
                   const geometry::Occluders& occluders, const geometry::Rig& rig,
                   const ShareOptions& options) {
    const std::vector<glm::dvec3> blockers = blockingTriangles(mesh, occluders);
    std::vector<Sight> sights;
    for (size_t i = 0; i < std::min<size_t>(rig.projectors.size(), 32); ++i)
        sights.emplace_back(rig.projectors[i], blockers, options);
    Sharing sharing(mesh, vertexLight, sights, options);
    for (size_t p = 0; p < mesh.patchCount(); ++p)
        if (mesh.role[p] == geometry::Role::projection) sharing.add(p);
    sharing.out.share.resize(rig.projectors.size(), std::vector<float>(sharing.out.corners.size(), 0.0f));
    return std::move(sharing.out);
}

} // namespace heliodon::passes
