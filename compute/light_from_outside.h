// The first step of a moment: what sun, sky and ground give patches and sensors straight through the
// openings, and what blinds scatter of it. Holds all that depends on which patches are glass
// (DaylightTransport).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight/sky.h"
#include "compute/daylight/sky_patches.h"
#include "compute/daylight_transport.h"
#include "compute/glowing_blinds.h"
#include "compute/gpu/buffer.h"
#include "compute/hidden_sky.h"
#include "compute/near_pairs.h"
#include "compute/outside_on_blinds.h"
#include "compute/outside_reflection.h"
#include "compute/point_scene.h"
#include "compute/ribbon_light.h"
#include "compute/sensor_gather.h"
#include "compute/sky_detail.h"
#include "compute/slat_lobes.h"
#include "compute/sun_bounce.h"
#include "compute/sun_glow.h"
#include "compute/sun_patches.h"

namespace heliodon::compute {

class LightFromOutside {
public:
    // All outlive this. `rowSums` of form factors; `factors`: patchCount^2, with what runs through panes.
    // Cost: sky coefficients (patchSkyCoefficients), and what the parts of blinds and pictures say of theirs.
    LightFromOutside(const PointScene& points, const NearPairs& pairs, std::span<const float> rowSums,
                     const gpu::Buffer& factors, const daylight::SkyPatches& sky,
                     const TransportOptions& options);
    LightFromOutside(const LightFromOutside&) = delete; // its parts refer to one another
    LightFromOutside& operator=(const LightFromOutside&) = delete;

    // Direct light of patches and sensors, glow, lobes, what the sun's first bounce lacks (sunSent and
    // interreflected), and what of Lighting they decide; the report says what was skipped.
    Moment light(const daylight::Sky& sky, const SensorGather& sensors) const;
    // Of a moment of this sky, the same of these sensors, which are dark so far.
    void lightSensors(Moment& moment, const daylight::Sky& sky, const SensorGather& sensors) const;
    // What patches send of the sun's light before it goes round, as far as others get it, lux.
    std::vector<glm::vec3> firstBounce(const Moment& moment) const;

    bool hasOpenings() const { return hasOpenings_; }
    const PatchSky& patchSky() const { return patchSky_; } // empty without openings
    uint32_t skyElements() const { return skyElements_; }  // likewise 0
    uint32_t skyChannels() const { return skyChannels_; }
    double skySeconds() const { return skySeconds_; }
    const SunScene& sunScene() const { return sunScene_; }
    const SunBounce* sunBounce() const { return sunBounce_.get(); } // null without openings
    const GlowingBlinds& blinds() const { return blinds_; }
    const SlatLobes& slats() const { return slats_; }
    const HiddenSky& hiddenSky() const { return hiddenSky_; }
    const OutsideOnBlinds& outsideOnBlinds() const { return outsideOnBlinds_; }
    const OutsideReflection& reflection() const {
        return reflection_;
    } // its cells are those of patchSky().walls

private:
    bool isLitBySky(const daylight::Sky& sky) const;
    std::optional<RibbonLight> ribbonOf(const daylight::Sky& sky) const;
    void skyOn(Moment& moment, const daylight::Sky& sky, const SensorGather& sensors) const;
    void skyOnPatches(Moment& moment, std::span<const float> luminance) const;
    void skyAtSensors(Moment& moment, const daylight::Sky& even, const std::optional<RibbonLight>& ribbon,
                      const SensorGather& sensors) const;
    void addRibbon(Moment& moment, const RibbonLight& ribbon) const;
    template<class Light> void glow(Moment& moment, const Light& light) const;
    void hideSky(Moment& moment, std::span<const double> luminances) const;
    std::optional<SunPatches> sunOf(const daylight::Sky& sky) const;
    // `sun` of this sky, null where it has none.
    std::vector<glm::vec3> outsideExitance(const daylight::Sky& sky, const SunPatches* sun) const;
    void reflect(Moment& moment, const daylight::Sky& sky, const SensorGather& sensors,
                 const SunPatches* sun) const;
    void reflectAtSensors(Moment& moment, std::span<const glm::vec3> exitance,
                          const SensorGather& sensors) const;
    void sunOn(Moment& moment, const daylight::SunDisc& disc, const SensorGather& sensors,
               const SunPatches& sun) const;
    void sunAtSensors(Moment& moment, const SunPatches& sun, std::span<const SunlitParts> partly,
                      const SensorGather& sensors) const;

    const PointScene& points_;
    const geometry::PatchMesh& mesh_;
    const daylight::SkyPatches& sky_;
    bool skipNothing_, hasOpenings_ = false;
    SunScene sunScene_;
    std::unique_ptr<SunBounce> sunBounce_; // none without openings
    std::unique_ptr<SunGlow> sunGlow_;     // likewise, and where no pictures are made
    std::unique_ptr<SkyDetail> skyDetail_; // likewise
    GlowingBlinds blinds_;
    SlatLobes slats_;
    HiddenSky hiddenSky_; // before blinds
    OutsideReflection reflection_;
    OutsideOnBlinds outsideOnBlinds_;
    PatchSky patchSky_;
    uint32_t skyElements_ = 0, skyChannels_ = 1;
    double skySeconds_ = 0;
};

} // namespace heliodon::compute
