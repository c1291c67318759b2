// Where the light of slats goes: up or down, not evenly (daylight/slats.h). Their even glow is an exitance of
// patches; here is what patches and points get beyond that, as numbers that GlowingBlinds' lobes are
// multiplied with: form factors of the windows' patches, shared out among the nodes by the elevation at which
// light travels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/glowing_blinds.h"
#include "compute/gpu/buffer.h"
#include "compute/point_scene.h"

namespace heliodon::compute {

class SlatLobes {
public:
    // `factors`: float32, patchCount^2, row-major, with what runs through panes. Nothing, at no cost, without
    // slats. Else time and memory grow with pairs of a patch and a window patch that it sees: about 0.1 us
    // and 16 bytes each, near ones up to 250, behind glass twice that (16,000 patches, 1600 of them windows:
    // seconds, 800 MB).
    // Each window's light is kept, lobe by lobe, but for what no lobe towards the horizontal has room for.
    // `scene` and `blinds` outlive this.
    SlatLobes(const PointScene& scene, const GlowingBlinds& blinds, const gpu::Buffer& factors);

    bool empty() const { return windows_.empty(); }
    // Lobes are told apart by window patch, then lobe: row = place in windows() times kSlatLobes, plus lobe.
    struct Window {
        uint32_t patch;
        size_t group; // of blinds
    };
    std::span<const Window> windows() const { return windows_; }
    size_t rows() const { return windows_.size() * daylight::kSlatLobes; }

    // Lobes of all windows: light(group) gives those of a group, lit(patch) what they are multiplied with.
    template<class Light, class Lit>
    void fill(std::span<glm::vec3> lobes, const Light& light, const Lit& lit) const {
        daylight::Window::Lobes ofGroup{};
        for (size_t w = 0; w < windows_.size(); ++w) {
            if (w == 0 || windows_[w].group != windows_[w - 1].group) ofGroup = light(windows_[w].group);
            const glm::dvec3 times(lit(windows_[w].patch));
            for (size_t lobe = 0; lobe < daylight::kSlatLobes; ++lobe)
                lobes[w * daylight::kSlatLobes + lobe] += glm::vec3(times * ofGroup[lobe]);
        }
    }

    // What a patch gets of lobes: row and form factor.
    struct Share {
        uint32_t row;
        float factor;
    };
    std::span<const Share> of(size_t patch) const { return shares_[patch]; } // not where empty()
    // Light on all patches by lobes, added to `onPatches`; nothing where there are no lobes.
    void light(std::span<const glm::vec3> lobes, std::span<glm::vec3> onPatches) const;

    // Adds what a point gets of each row, times `times`: exact form factors of visible parts. Per channel,
    // one or three rows.
    void see(const PointView& view, uint32_t room, glm::vec3 times,
             std::span<std::vector<float>> channels) const;

private:
    void keepLight();

    const PointScene* scene_;
    std::span<const GlowingBlinds::Group> groups_;
    std::vector<Window> windows_;
    std::vector<std::vector<Share>> shares_; // per patch
};

} // namespace heliodon::compute
