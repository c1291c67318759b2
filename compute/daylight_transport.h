// Daylight in closed rooms: holds what only geometry decides (form factors, sky coefficients), recombines it
// when time, weather or north change, solves again when light or materials do.
//   change              what is done again
//   geometry            a new object: everything
//   glass, what stands  sky coefficients (setMaterials)
//   outside
//   reflectance, Ke     solve only (setMaterials)
//   time, weather       combine coefficients, sun on patches, solve (light)
// Sky coefficients are fixed to world axes: north is in the sky's directions, so turning it costs no more
// than time does.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "compute/daylight/sky.h"
#include "compute/daylight/sky_patches.h"
#include "compute/form_factors.h"
#include "compute/glowing_blinds.h"
#include "compute/hidden_sky.h"
#include "compute/lighting.h"
#include "compute/outside_on_blinds.h"
#include "compute/outside_reflection.h"
#include "compute/radiosity.h"
#include "compute/sensor_gather.h"
#include "compute/slat_lobes.h"
#include "compute/sloped_factors.h"
#include "compute/window_links.h"
#include "geometry/patch_mesh.h"

namespace heliodon::compute {

struct TransportOptions {
    // By default within 1e-3 of every row, which costs no more than a hemicube of 64 x 64 and errs 20 times
    // less; within 5e-3 behind crowds of blockers, where that would take minutes (kernel_choice.h).
    FormFactorOptions formFactors;
    uint32_t skyDivision = 2; // Reinhart's MF: 2 is 577 sky elements
    RadiosityOptions radiosity;
    NearWalls nearWalls;
    // Where the solver's bound is much of what dark places get, as behind a door from a room in the sun, its
    // share of `error` is found place by place, for as many passes over F again. For tables; pictures show
    // none.
    bool errorByPlace = false;
    bool sunDisc = false;     // direct sun at sensors has a penumbra (SunPatches::beamAtPoint)
    bool forPictures = false; // fills in the detail of Lighting; nothing else depends on it
    // Computes in full what is known to give nothing, or the same: dark skies, suns that cannot enter, light
    // where there is none, three channels of grey, the sky of rooms without openings. To check the rules that
    // skip these.
    bool skipNothing = false;
};

// Illuminance by where it comes from, lux per channel.
struct LightParts {
    glm::vec3 sun{0}, sky{0}, ground{0}; // direct, through openings
    glm::vec3 interreflected{0}; // from surfaces of the room, with their own emission and the glow of blinds
    float error = 0; // estimate of the error of the photometric total, lux; see DaylightTransport::light

    glm::vec3 total() const { return sun + sky + ground + interreflected; }
};

struct MomentReport {
    RadiosityReport radiosity;
    double combineSeconds = 0, sunSeconds = 0, solveSeconds = 0, sensorSeconds = 0;
    double lumensIn = 0, lumensAbsorbed = 0; // photometric; absorbed includes what leaves through openings
    double lumensLost = 0;      // to the open, or by rows of F that do not sum to one; negative: made by them
    double energyImbalance = 0; // |in - absorbed - lost| / in: what residual and rounding leave
    std::vector<std::string> modelled, skipped; // with reasons
};

// One moment of light.
struct Moment {
    Lighting lighting;
    std::vector<LightParts> patches; // averages over patches
    std::vector<LightParts> sensors; // in setSensors' order
    std::vector<glm::vec3> glow; // per patch: exitance of blinds by light from outside; empty without blinds
    std::vector<glm::vec3>
        lobes; // of slats, rows of SlatLobes: how luminance x pi differs from that; or empty
    // What the solver leaves on patches' exitance, photometric: on each, or place by place where that is
    // told.
    double solverError = 0;
    std::vector<float> exitanceErrors;
    double unsureLumens = 0;       // of what is reflected from outside on to patches: may be off
    double laterShare = 0;         // of light by way of the room: what the mesh leaves on it
    std::vector<float> meshErrors; // the same of patches' exitance by itself, photometric
    // Per patch: by how much what it sends far of the sun's first bounce differs from its exitance, for where
    // on it the light lies (SunBounce).
    std::vector<glm::vec3> sunSent;
    MomentReport report;
};

struct TransportReport {
    FormFactorReport formFactors;
    double skySeconds = 0; // sky coefficients of patches, where they are not part of the form-factor pass
    double sensorSeconds = 0;
    uint32_t skyElements = 0, channels = 1;
    std::vector<size_t> sensorsOutside; // in no room: dark
    size_t sensorsNearWalls = 0;        // so near that walls are taken apart (near_light.h)
    std::vector<std::string> skipped;
};

class SunBounce;

// The linear parts behind DaylightTransport::light, for products over many moments at once. They hold until
// materials or sensors change.
struct TransportParts {
    gpu::Device& device;
    RadiositySolver& solver;
    FormFactorOperator& gather; // F', for light that runs on smoothly
    const SlopedFactors& sloped;
    size_t gatherBytes = 0;                    // of the host, beside the form factors
    uint32_t channels = 1;                     // of the solver: 1 where all materials are grey
    uint32_t skyElements = 0, skyChannels = 1; // sky coefficients; 0 elements without openings
    std::span<const float> patchSky;           // patches x skyChannels x skyElements
    const SkyView& sensorSky;                  // what sensors see of the outside straight
    std::span<const float> sensorFactors;      // sensors x patches: light that runs on smoothly
    std::span<const float> sensorEven;         // the same for light that does not, the sun's first bounce
    std::span<const Sensor> sensors;
    std::span<const uint32_t> sensorRooms;
    std::span<const std::vector<TintedShare>> tinted;   // per sensor, to be added to these in each channel
    std::span<const std::vector<TintedShare>> returned; // likewise
    std::span<const NearLight> near;                    // per sensor
    const WindowLinks& links;                           // part of what `gather` does
    const OutsideReturn& returnedOutside;               // likewise
    const PointScene& points;                           // for what points see
    const daylight::SkyPatches& sky;
    const SunScene& sun;        // for SunPatches of many hours
    const SunBounce* sunBounce; // null without openings
    const GlowingBlinds& blinds;
    const HiddenSky& hiddenSky; // to be taken off what those scatter
    const SlatLobes& slats;
    std::span<const std::array<std::vector<float>, 3>> sensorSlats;
    const OutsideReflection& reflection; // its cells, as patches (none without cells) and sensors see them
    std::span<const std::vector<OutsideShare>> patchWalls, sensorWalls;
    const OutsideOnBlinds& outsideOnBlinds;
};

class DaylightTransport {
public:
    // Keeps a copy of the mesh. Throws geometry::InputError on an unknown kernel and on reflectances outside
    // [0, 1).
    DaylightTransport(gpu::Device& device, const geometry::PatchMesh& mesh,
                      const TransportOptions& options = {});
    ~DaylightTransport();
    DaylightTransport(const DaylightTransport&) = delete;
    DaylightTransport& operator=(const DaylightTransport&) = delete;

    // New values for the mesh's materials, same count. Cost: nothing now where only reflectance or exitance
    // changed.
    void setMaterials(const std::vector<geometry::Material>& materials);

    // About 0.4 ms a sensor with 2000 patches on two cores. Sensors outside of all rooms are dark
    // (report().sensorsOutside).
    void setSensors(std::vector<Sensor> sensors);

    // What walls beside sensors give (near_light.h), 4 to 20 ms of one core for each that has one; else the
    // first light() or parts() after setSensors or setMaterials makes it. `done` is told sensors.
    void makeNearLight(const std::function<void(size_t)>& done = {});

    // Light of one sky. `error` is an estimate, meant to hold on 99 of 100 places, not a proven bound. It
    // adds up: the solver's bound; a share of how much light varies within the patches that a sensor sees
    // (what the mesh leaves open: falls as the mesh gets finer; of patches' means, that of patches nearby);
    // shares of reflected light for form factors and earlier bounces, small but where few patches, as in
    // shafts, send most of it; and of sky light for its cubature (constants in the source).
    Moment light(const daylight::Sky& sky);
    // Several moments through shared passes over F; bits may differ from one at a time by the solver's
    // tolerance.
    // Sensors so near to patches that one fills a fifth of their view or several 0.35 of it, as in corners,
    // get their light anew (makeNearLight).
    std::vector<Moment> light(std::span<const daylight::Sky> skies);

    // light() answers in part from what it found before, and so gives the same bits only after the same
    // calls; from here on, those that a new object gives. Cost: the next few moments take some ten passes
    // over F again.
    void forgetLights();

    // The sensors of now in a moment of this sky that was made for others: as the call of light() that
    // made it would have them, without its work on patches.
    void lightSensors(Moment& moment, const daylight::Sky& sky);

    TransportParts parts();
    const geometry::PatchMesh& mesh() const;
    const FormFactors& formFactors() const;
    const TransportReport& report() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace heliodon::compute
