// Illuminance at points of a small room by paths of rays, which shares nothing with what it checks but the
// formulas of sky and glass: rays meet every patch, openings let them out, walls of rooms reflect on either
// side.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "compute/daylight/glazing.h"
#include "compute/daylight/sky.h"
#include "compute/sensor_gather.h"
#include "geometry/patch_mesh.h"

namespace heliodon::test {

class PathTracer {
public:
    // Time grows with the patches: give few large ones. Panes let light through or, as `mirrors`, reflect it
    // too.
    PathTracer(const geometry::PatchMesh& mesh, const daylight::Sky& sky, bool mirrors = false)
        : mesh_(mesh), sky_(sky), mirrors_(mirrors) {
        for (const geometry::Material& m : mesh.materials) glass_.push_back(daylight::glazingOf(m));
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            const auto corners = mesh.patch(i);
            Face face{i, geometry::patchNormal(mesh, i), mesh.vertices[corners[0]], {}};
            for (size_t k = 0; k < corners.size(); ++k) {
                const glm::dvec3 a = mesh.vertices[corners[k]],
                                 b = mesh.vertices[corners[(k + 1) % corners.size()]];
                const glm::dvec3 inwards = glm::cross(face.normal, b - a);
                face.sides.emplace_back(inwards, glm::dot(inwards, a));
            }
            (mesh.materials[mesh.material[i]].isOpening() ? panes_ : walls_).push_back(std::move(face));
        }
    }

    struct Result {
        double lux = 0, standardError = 0, direct = 0; // direct: sky and ground; the sun is in lux alone
    };
    Result at(const compute::Sensor& sensor, int perSide, uint32_t seed = 1) {
        rng_.seed(seed);
        constexpr int kBatches = 10;
        Result result;
        double squares = 0;
        for (int batch = 0; batch < kBatches; ++batch) {
            double sum = 0, direct = 0;
            for (int i = 0; i < perSide; ++i)
                for (int j = 0; j < perSide; ++j)
                    sum += path(sensor, (i + u()) / perSide, (j + u()) / perSide, direct);
            const double mean = sum / (perSide * perSide);
            result.lux += mean / kBatches, squares += mean * mean / kBatches;
            result.direct += direct / (perSide * perSide) / kBatches;
        }
        result.standardError = std::sqrt(std::max(0.0, squares - result.lux * result.lux) / (kBatches - 1));
        result.lux += bySun(sensor.position, sensor.normal);
        return result;
    }

private:
    struct Face {
        size_t patch;
        glm::dvec3 normal, corner;
        std::vector<std::pair<glm::dvec3, double>> sides;
    };
    struct Hit {
        size_t patch = SIZE_MAX; // none: the ray gets out
        glm::dvec3 point{0};
        double through = 1;      // of the panes on the way
        glm::dvec3 direction{0}; // in the end
    };

    double u() { return std::uniform_real_distribution<double>()(rng_); }

    static bool meets(const Face& face, glm::dvec3 from, glm::dvec3 d, double nearest, double& t) {
        t = glm::dot(face.corner - from, face.normal) / glm::dot(face.normal, d);
        if (!(t > 1e-7 && t < nearest)) return false;
        const glm::dvec3 p = from + t * d;
        for (const auto& [inwards, offset] : face.sides)
            if (glm::dot(inwards, p) < offset) return false;
        return true;
    }

    // With panes that mirror or, to look for the sun, without.
    Hit trace(glm::dvec3 from, glm::dvec3 d, bool mirrors) {
        Hit hit;
        hit.direction = d;
        double nearest = 1e300, t = 0;
        for (const Face& wall : walls_)
            if (meets(wall, from, d, nearest, t))
                nearest = t, hit.patch = wall.patch, hit.point = from + t * d;
        if (mirrors) {
            double first = nearest;
            const Face* mirror = nullptr;
            for (const Face& pane : panes_)
                if (meets(pane, from, d, first, t)) first = t, mirror = &pane;
            if (!mirror) return hit;
            const double cosine = std::abs(glm::dot(mirror->normal, d));
            const daylight::Glazing& glass = glass_[mesh_.material[mirror->patch]];
            const double back = glass.isHole() ? 0
                                               : daylight::slabReflectance(cosine, glass.transmissivity.y,
                                                                           glass.refractiveIndex);
            const glm::dvec3 on = u() < back ? glm::reflect(d, mirror->normal) : d;
            hit = trace(from + first * d, on, true);
            if (on == d) hit.through *= glass.transmittance(cosine).y / (1 - back);
            return hit;
        }
        for (const Face& pane : panes_)
            if (meets(pane, from, d, nearest, t)) {
                const double slope = glm::dot(pane.normal, d);
                if (slope < 0 || mesh_.twin[pane.patch] == geometry::kNoTwin) // twins are one pane
                    hit.through *= glass_[mesh_.material[pane.patch]].transmittance(std::abs(slope)).y;
            }
        return hit;
    }

    double bySun(glm::dvec3 p, glm::dvec3 n) {
        const double cosine = glm::dot(n, sky_.sun.direction);
        if (!sky_.hasSun() || cosine <= 0) return 0;
        const Hit hit = trace(p + 1e-6 * n, sky_.sun.direction, false);
        return hit.patch == SIZE_MAX ? hit.through * cosine * sky_.sun.normalIlluminance : 0;
    }

    double path(const compute::Sensor& sensor, double u1, double u2, double& direct) {
        glm::dvec3 p = sensor.position, n = glm::normalize(sensor.normal);
        double lux = 0, weight = 1;
        for (int bounce = 0; bounce < 40; ++bounce) {
            const double r = std::sqrt(u1), phi = 2 * std::numbers::pi * u2;
            const glm::dvec3 a = glm::normalize(
                glm::cross(n, std::abs(n.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
            const glm::dvec3 d = glm::normalize(r * std::cos(phi) * a + r * std::sin(phi) * glm::cross(n, a) +
                                                std::sqrt(1 - u1) * n);
            const Hit hit = trace(p + 1e-6 * n, d, mirrors_);
            if (hit.patch == SIZE_MAX) {
                const double sky = weight * hit.through * std::numbers::pi * sky_.luminance(hit.direction);
                if (bounce == 0) direct += sky;
                return lux + sky;
            }
            const double rho = mesh_.materials[mesh_.material[hit.patch]].reflectance.y;
            n = geometry::patchNormal(mesh_, hit.patch);
            if (glm::dot(n, hit.direction) > 0) { // from outside, or a solid from within
                if (mesh_.room[hit.patch] == geometry::kNoRoom) return lux;
                n = -n;
            }
            weight *= rho * hit.through;
            p = hit.point;
            lux += weight * bySun(p, n);
            if (bounce > 3) {
                if (u() > rho) return lux;
                weight /= rho;
            }
            u1 = u(), u2 = u();
        }
        return lux;
    }

    const geometry::PatchMesh& mesh_;
    daylight::Sky sky_;
    bool mirrors_;
    std::vector<daylight::Glazing> glass_;
    std::vector<Face> walls_, panes_;
    std::mt19937 rng_{1};
};

} // namespace heliodon::test
