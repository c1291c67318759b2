#include "compute/glowing_blinds.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include <glm/geometric.hpp>

#include "compute/daylight/horizon_ribbon.h"

namespace heliodon::compute {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr size_t kBands = 90; // of the whole sphere: 2 degrees
constexpr int kAround = 180;  // cells of a band

// Height between bands of cells.
double bandEdge(size_t k) {
    return std::sin(kPi * (static_cast<double>(k) / kBands - 0.5));
}

// A sky's luminance over cells, by their middles; of a ribbon at the horizon each band has its mean.
class BandSky {
public:
    explicit BandSky(const daylight::Sky& sky) : sky_(&sky), even_(daylight::withoutRibbon(sky)) {
        if (!daylight::hasHorizonRibbon(sky.formula)) return;
        const daylight::HorizonRibbon ribbon(sky.formula);
        for (size_t k = kBands / 2; bandEdge(k) < daylight::kRibbonTop; ++k)
            means_.push_back(ribbon.between(bandEdge(k), bandEdge(k + 1)).light /
                             (bandEdge(k + 1) - bandEdge(k)));
    }
    // cd/m2 of the middle of a cell above the horizon.
    double luminance(glm::dvec3 direction) const {
        const auto band = static_cast<size_t>(std::asin(direction.y) / kPi * kBands);
        double more = 0;
        if (band < means_.size())
            more = means_[band] *
                   std::max(0.0, indicatrix(sky_->formula, glm::dot(direction, sky_->shapeDirection)));
        return even_.luminance(direction) + sky_->formula.scale * more;
    }

private:
    const daylight::Sky* sky_;
    daylight::Sky even_;
    std::vector<double> means_; // of the ribbon's gradation, from the horizon up
};

// work(direction, what arrives from the cell on the plane per unit of luminance) for cells before the window.
template<class Work> void forDirections(glm::dvec3 normal, const Work& work) {
    double sum = 0; // of the hemisphere: pi, but for the cells that the plane cuts
    for (const bool first : {true, false})
        for (size_t band = 0; band < kBands; ++band) {
            const double middle = kPi * ((static_cast<double>(band) + 0.5) / kBands - 0.5);
            const double area = 2 * kPi / kAround * (bandEdge(band + 1) - bandEdge(band));
            for (int k = 0; k < kAround; ++k) {
                const double turn = 2 * kPi * (k + 0.5) / kAround;
                const glm::dvec3 direction(std::cos(middle) * std::sin(turn), std::sin(middle),
                                           -std::cos(middle) * std::cos(turn));
                const double cosine = -glm::dot(direction, normal);
                if (cosine <= 0) continue;
                if (first)
                    sum += area * cosine;
                else
                    work(direction, area * cosine * kPi / sum);
            }
        }
}

} // namespace

GlowingBlinds::GlowingBlinds(const geometry::PatchMesh& mesh) {
    std::vector<uint32_t> materials; // of the groups
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const geometry::Material& material = mesh.materials[mesh.material[i]];
        if (mesh.twin[i] != geometry::kNoTwin || !material.isOpening() ||
            material.blind.kind == geometry::Blind::Kind::none)
            continue;
        const glm::dvec3 normal = geometry::patchNormal(mesh, i);
        size_t g = 0;
        while (g < groups_.size() &&
               (materials[g] != mesh.material[i] || glm::dot(groups_[g].normal, normal) < 1 - 1e-9))
            ++g;
        if (g == groups_.size()) {
            const auto alike = std::ranges::find(materials, mesh.material[i]);
            groups_.push_back({alike == materials.end()
                                   ? daylight::Window(material)
                                   : groups_[static_cast<size_t>(alike - materials.begin())].window,
                               normal,
                               {}});
            materials.push_back(mesh.material[i]);
        }
        groups_[g].patches.push_back(static_cast<uint32_t>(i));
    }
    for (const Group& group : groups_) {
        std::vector<Sample>& samples = sky_.emplace_back();
        glm::dvec3& ground = ground_.emplace_back(0);
        std::vector<daylight::Window::Lobes>& profiles = profiles_.emplace_back();
        LitProfiles& groundInside = groundInside_.emplace_back();
        groundInside.fill(glm::dvec3(0));
        if (group.window.hasSlats())
            for (size_t k = 0; k < kProfiles; ++k)
                profiles.push_back(
                    group.window.lobesBehindGlass(kPi * (0.5 - (double(k) + 0.5) / kProfiles)));
        forDirections(group.normal, [&](glm::dvec3 direction, double arriving) {
            const glm::dvec3 weight = arriving * group.window.scattered(direction, group.normal);
            glm::dvec3 inside(0);
            size_t profile = 0;
            if (!profiles.empty()) {
                inside = arriving * group.window.glazing().transmittance(glm::dot(direction, group.normal));
                const double elevation = daylight::Window::slatElevation(-direction, group.normal);
                profile = std::min(static_cast<size_t>((elevation / kPi + 0.5) * kProfiles), kProfiles - 1);
            }
            if (direction.y > 0)
                samples.push_back({glm::vec3(direction), glm::vec3(weight), glm::vec3(inside), profile});
            else
                ground += weight, groundInside[profile] += inside;
        });
    }
}

daylight::Window::Lobes GlowingBlinds::lobesOf(size_t group, const LitProfiles& inside) const {
    daylight::Window::Lobes lobes{};
    for (size_t k = 0; k < kProfiles; ++k)
        for (size_t lobe = 0; lobe < lobes.size(); ++lobe)
            lobes[lobe] += inside[k] * profiles_[group][k][lobe];
    return lobes;
}

daylight::Window::Lobes GlowingBlinds::lobesBySky(size_t group, const daylight::Sky& sky) const {
    LitProfiles inside = groundInside_[group];
    for (glm::dvec3& lux : inside) lux *= sky.ground.luminance;
    const BandSky cells(sky);
    if (sky.formula.scale > 0)
        for (const Sample& sample : sky_[group])
            inside[sample.profile] +=
                glm::dvec3(sample.inside) * cells.luminance(glm::dvec3(sample.direction));
    return lobesOf(group, inside);
}

std::vector<float> GlowingBlinds::lobeCoefficients(size_t group, const daylight::SkyPatches& sky,
                                                   uint32_t channels) const {
    const size_t elements = sky.elementCount();
    std::vector<LitProfiles> inside(elements);
    for (LitProfiles& of : inside) of.fill(glm::dvec3(0));
    for (const Sample& sample : sky_[group])
        inside[sky.elementOf(glm::dvec3(sample.direction))][sample.profile] +=
            glm::dvec3(sample.inside) / kPi;
    for (size_t k = 0; k < kProfiles; ++k) inside[sky.groundElement()][k] = groundInside_[group][k] / kPi;
    std::vector<float> values(daylight::kSlatLobes * channels * elements);
    for (size_t e = 0; e < elements; ++e) {
        const daylight::Window::Lobes lobes = lobesOf(group, inside[e]);
        for (size_t lobe = 0; lobe < lobes.size(); ++lobe)
            for (uint32_t c = 0; c < channels; ++c)
                values[(lobe * channels + c) * elements + e] =
                    static_cast<float>(lobes[lobe][static_cast<int>(c)]);
    }
    return values;
}

glm::vec3 GlowingBlinds::bySky(size_t group, const daylight::Sky& sky) const {
    glm::dvec3 sum = ground_[group] * sky.ground.luminance;
    const BandSky cells(sky);
    if (sky.formula.scale > 0)
        for (const Sample& sample : sky_[group])
            sum += glm::dvec3(sample.weight) * cells.luminance(glm::dvec3(sample.direction));
    return glm::vec3(sum);
}

std::vector<float> GlowingBlinds::coefficients(size_t group, const daylight::SkyPatches& sky,
                                               uint32_t channels) const {
    const size_t elements = sky.elementCount();
    std::vector<double> sums(channels * elements);
    for (const Sample& sample : sky_[group])
        for (uint32_t c = 0; c < channels; ++c)
            sums[c * elements + sky.elementOf(glm::dvec3(sample.direction))] +=
                double{sample.weight[static_cast<int>(c)]} / kPi;
    for (uint32_t c = 0; c < channels; ++c)
        sums[c * elements + sky.groundElement()] = ground_[group][static_cast<int>(c)] / kPi;
    std::vector<float> values;
    for (const double sum : sums) values.push_back(static_cast<float>(sum));
    return values;
}

glm::vec3 GlowingBlinds::bySun(size_t group, uint32_t patch, const SunPatches& sun,
                               glm::dvec3 towardsSun) const {
    const Group& g = groups_[group];
    const glm::dvec3 scattered = g.window.scattered(glm::normalize(towardsSun), g.normal);
    if (scattered == glm::dvec3(0)) return glm::vec3(0);
    return glm::vec3(scattered * sun.onOutside(patch));
}

} // namespace heliodon::compute
