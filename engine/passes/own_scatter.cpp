#include "engine/passes/own_scatter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "engine/passes/frame_light.h"

namespace heliodon::passes {

namespace {

using Values = std::vector<glm::vec3>; // per patch

// What a patch is to show, lux of the simulation: where the sun does not reach it, and where it does.
struct Wanted {
    glm::vec3 shade{0}, sun{0};
    float lit = 0; // share of the patch that the sun reaches
};

// Direct sun on a surface that faces it, behind the clearest glass: what patches that are wholly lit have.
double clearSun(const geometry::PatchMesh& mesh, const compute::Lighting& light) {
    constexpr double kLeastCosine = 0.05;
    double most = 0;
    for (size_t p = 0; p < light.sunIlluminance.size(); ++p) {
        const double cosine = glm::dot(geometry::patchNormal(mesh, p), light.sunDirection);
        if (cosine > kLeastCosine)
            most = std::max(most, geometry::photometric(light.sunIlluminance[p]) / cosine);
    }
    return most;
}

std::vector<Wanted> wantedOf(const geometry::PatchMesh& mesh, const compute::Lighting& light) {
    const Values shade = pictureLight(mesh, light);
    const double clear = light.sunIlluminance.empty() ? 0 : clearSun(mesh, light);
    std::vector<Wanted> wanted(mesh.patchCount());
    for (size_t p = 0; p < wanted.size(); ++p) {
        Wanted& w = wanted[p];
        w.shade = w.sun = shade[p];
        if (!(clear > 0) || !(geometry::photometric(light.sunIlluminance[p]) > 0)) continue;
        const double cosine = glm::dot(geometry::patchNormal(mesh, p), light.sunDirection),
                     all = clear * std::max(cosine, 0.0),
                     has = geometry::photometric(light.sunIlluminance[p]);
        w.lit = has < all ? static_cast<float>(has / all) : 1.0f;
        w.sun += mesh.materials[mesh.material[p]].reflectance * light.sunIlluminance[p] / w.lit;
    }
    return wanted;
}

// As shaders/display.frag has it.
glm::vec3 withinWhite(glm::vec3 light, float white) {
    const float most = std::max({light.x, light.y, light.z});
    if (most <= white) return light;
    const float grey = std::min(static_cast<float>(geometry::photometric(light)), white);
    return grey + (light - grey) * ((white - grey) / (most - grey));
}

// The physical model under its projectors, in lux of the simulation.
class PaintedModel {
public:
    PaintedModel(const geometry::PatchMesh& mesh, const PaintedPatches& painted, double whiteLux,
                 compute::FormFactorOperator& factors, const compute::Lighting& light)
        : mesh_(mesh), painted_(painted), reflectance_(static_cast<float>(painted.reflectance)),
          simulated_(painted.white > 0 ? static_cast<float>(whiteLux / painted.white) : 0),
          white_(static_cast<float>(whiteLux)), factors_(factors), wanted_(wantedOf(mesh, light)) {}

    // Leaves in `scatter` what the surfaces send back, rho F B, and returns passes over F.
    int solve(bool leaveOut, Values& scatter) {
        constexpr int kMostPasses = 100;
        constexpr double kSettled = 1e-3; // of the mean
        scatter.assign(wanted_.size(), glm::vec3(0));
        for (int pass = 1; pass < kMostPasses; ++pass) {
            Values next = sentBack(exitances(leaveOut, scatter));
            double change = 0, mean = 0;
            for (size_t p = 0; p < next.size(); ++p) {
                change = std::max<double>(change, glm::length(next[p] - scatter[p]));
                mean += glm::length(next[p]);
            }
            scatter.swap(next);
            if (change <= kSettled * mean / static_cast<double>(scatter.size())) return pass;
        }
        return kMostPasses;
    }

    void report(bool leaveOut, const Values& scatter, ScatterReport& out) const {
        double area = 0, wanted = 0, physical = 0, own = 0, square = 0, tooBright = 0;
        for (size_t p = 0; p < wanted_.size(); ++p) {
            const double part = geometry::patchArea(mesh_, p) * double{painted_.share[p]};
            if (!(part > 0)) continue;
            for (const bool sun : {false, true}) {
                const double here = part * (sun ? wanted_[p].lit : 1.0 - double{wanted_[p].lit});
                const glm::vec3 all = sun ? wanted_[p].sun : wanted_[p].shade,
                                target = glm::min(all, scatter[p]) + added(p, all - scatter[p]);
                const double is = geometry::photometric(shown(p, leaveOut, sun, scatter[p])),
                             was = geometry::photometric(target), back = geometry::photometric(scatter[p]);
                area += here, wanted += here * was, physical += here * is, own += here * back;
                square += here * (is - was) * (is - was);
                tooBright += back > was ? here : 0;
            }
        }
        if (!(wanted > 0) || !(physical > 0)) return;
        (leaveOut ? out.error : out.errorBefore) = std::sqrt(square * area) / wanted;
        if (!leaveOut) return;
        out.ownShare = own / physical;
        out.tooBright = tooBright / area;
    }

private:
    // What projectors add where `light` is to be added.
    glm::vec3 added(size_t p, glm::vec3 light) const {
        const glm::vec3 paint = withinWhite(glm::max(light, glm::vec3(0)), white_);
        return glm::min(paint, glm::vec3(painted_.reach[p] * simulated_));
    }
    glm::vec3 shown(size_t p, bool leaveOut, bool sun, glm::vec3 scatter) const {
        const glm::vec3 wanted = sun ? wanted_[p].sun : wanted_[p].shade;
        return scatter + added(p, leaveOut ? wanted - scatter : wanted);
    }
    // Mean over each patch; of surfaces that are not there nothing.
    Values exitances(bool leaveOut, const Values& scatter) const {
        Values means(wanted_.size(), glm::vec3(0));
        for (size_t p = 0; p < means.size(); ++p) {
            if (mesh_.role[p] != geometry::Role::projection) continue;
            const glm::vec3 painted = glm::mix(shown(p, leaveOut, false, scatter[p]),
                                               shown(p, leaveOut, true, scatter[p]), wanted_[p].lit);
            means[p] = glm::mix(scatter[p], painted, painted_.share[p]);
        }
        return means;
    }
    Values sentBack(const Values& exitance) {
        const size_t n = exitance.size();
        std::vector<float> in(3 * n), out(3 * n);
        for (size_t p = 0; p < n; ++p)
            for (size_t c = 0; c < 3; ++c) in[c * n + p] = exitance[p][static_cast<int>(c)];
        factors_.gatherIn(std::array{0u, 1u, 2u}, in, out);
        Values back(n, glm::vec3(0));
        for (size_t p = 0; p < n; ++p)
            if (mesh_.role[p] == geometry::Role::projection)
                back[p] = reflectance_ * glm::vec3(out[p], out[n + p], out[2 * n + p]);
        return back;
    }

    const geometry::PatchMesh& mesh_;
    const PaintedPatches& painted_;
    float reflectance_;
    float simulated_; // exitance over the physical one
    float white_;
    compute::FormFactorOperator& factors_;
    std::vector<Wanted> wanted_;
};

} // namespace

ScatterReport leaveOutScatter(const geometry::PatchMesh& mesh, const PaintedPatches& painted, double whiteLux,
                              compute::FormFactorOperator& factors, bool compare, compute::Lighting& light) {
    PaintedModel model(mesh, painted, whiteLux, factors, light);
    ScatterReport report;
    if (compare) {
        Values scatter;
        model.solve(false, scatter);
        model.report(false, scatter, report);
    }
    report.passes = model.solve(true, light.ownScatter);
    model.report(true, light.ownScatter, report);
    return report;
}

} // namespace heliodon::passes
