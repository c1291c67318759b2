// What the light solvers measured and decided, as fields of the report; and figures about one moment's light.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "compute/daylight_transport.h"
#include "engine/app/run.h"
#include "geometry/patch_mesh.h"

namespace heliodon::app {

struct Scene;
struct SceneArguments;
struct SensorTable;

// What a form-factor kernel measured, as `form_factors` of the report, and what it skipped.
void reportFormFactors(Run& run, size_t patches, const compute::FormFactorReport& report);

// A note, with what would take less, as FormFactorOptions::longWork.
std::function<void(double secondsLeft)> noteOfLongWork(Run& run, const std::string& remedy);

// Whether a window leads outside or anything emits light.
bool mayBeLit(const geometry::PatchMesh& mesh);

// Form factors with the sky coefficients of a mesh; fills `stages.formfactors` and `form_factors`. Notes long
// work where the options tell nobody of it.
std::unique_ptr<compute::DaylightTransport> makeTransport(Run& run, const geometry::PatchMesh& mesh,
                                                          const compute::TransportOptions& options = {});
// On another device than the run's.
std::unique_ptr<compute::DaylightTransport> makeTransport(Run& run, gpu::Device& device,
                                                          const geometry::PatchMesh& mesh,
                                                          const compute::TransportOptions& options);

// Solves one sky; fills `stages.solve` and what reportMoment does.
compute::Moment solveLight(Run& run, compute::DaylightTransport& transport, const daylight::Sky& sky,
                           double worldPerBuilding);

// Solves several at once; fills `stages.solve`, and warns of solutions that did not reach their tolerance.
// Throws std::runtime_error where light is no finite number.
std::vector<compute::Moment> solveLights(Run& run, compute::DaylightTransport& transport,
                                         std::span<const daylight::Sky> skies);

// What one moment's solution measured: `radiosity`, `modelled` and `skipped`. worldPerBuilding: Scene's.
void reportMoment(Run& run, const compute::MomentReport& report, double worldPerBuilding);

// What the solutions of a film's frames measured.
class FrameTally {
public:
    void add(const compute::MomentReport& report);
    // `radiosity` of the frame with the largest bound; `modelled` and `skipped` with the number of frames,
    // where it was not for all.
    void report(Run& run, double worldPerBuilding) const;

private:
    size_t frames_ = 0;
    compute::MomentReport worst_;
    std::map<std::string, size_t> modelled_, skipped_;
};

// Throws InputError naming `file`, where the sensors and where the model lie, when no sensor is in a room:
// their units or axes are not the model's. Cheap: found before there are form factors.
void refuseAllOutside(const std::filesystem::path& file, const SensorTable& sensors, const Scene& scene,
                      const SceneArguments& arguments);

// A warning that names the rows, counted from 0, of sensors that lie in no room; none without any.
void warnOfSensorsOutside(Run& run, const std::vector<size_t>& outside, size_t count);

struct LightFigures {
    double meanLux = 0, maxLux = 0; // of the illuminance on the surfaces that are shown, by area
    // Brightest over darkest exitance there, 95th over 5th percentile of area; 0 in the dark.
    double glareRatio = 0;
};
LightFigures lightFigures(const geometry::PatchMesh& mesh, const compute::Moment& moment);

} // namespace heliodon::app
