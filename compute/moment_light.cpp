#include "compute/moment_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "compute/float_dot.h"
#include "compute/parallel.h"
#include "compute/stopwatch.h"

namespace heliodon::compute {

namespace {

// Shares of light by which errors are estimated. The first is of what is measured: how much light varies
// within the patches that a sensor sees. Set so that rooms of 600 to 2000 triangles stay inside on 99 of 100
// sensors, against Radiance.
constexpr float kSpreadShare = 0.05F;  // of light's variation within patches, after its slope is allowed for
constexpr double kNearShare = 0.5;     // of a patch's light, times its own share of the view
constexpr float kSlopeTells = 0.5F;    // of a slope: light that falls off towards a wall is no straight line
constexpr double kUnevenShare = 2;     // the same of how its sky light varies but for its slope ...
constexpr double kViewChange = 0.06;   // ... or of that, times how the view changes across the patch ...
constexpr double kMostUneven = 0.5;    // ... and no more than of a sensor that sees one end of it
constexpr double kChangesFrom = 0.01;  // of the view: smaller patches are too many to be asked one by one
constexpr double kApartShare = 0.25;   // the same where such patches are taken apart (near_light.h)
constexpr double kApartSunShare = 0.2; // of that light, the sun's first bounce, whose shape is known
constexpr double kBounceError = 0.006; // of reflected light, at least: what earlier bounces leave
constexpr double kSensorSkyError = 0.008; // of sky light, from its cubature and that of glass
// The same of patches' means, against meshes four and sixteen times as fine (docs/accuracy.md).
constexpr double kPatchBounceError = 0.007;
constexpr double kPatchSkyError = 0.012; // of sky light, from sky elements and glass
constexpr double kLaterShare = 6;        // of what patches send on in error, for reflected light anywhere
constexpr double kSeenShare = 1.8;       // the same of what single sensors see
constexpr double kSlotShare = 8; // the same of slots as deep as their patches, whose errors do not even out
constexpr double kSunSharedOut = 0.25; // of sunlight between near patches, which lies unevenly
constexpr float kPatchSpreadShare = 0.3F,
                kFarSpreadShare = 0.05F; // of light's variation within patches nearby, and farther off
constexpr float kPatchBendShare = 1.5F;  // of how light bends within a patch nearby, times its form factor
// Slats against slats traced one by one (docs/accuracy.md#blinds): of their glow that a place gets straight,
// of what it would get were that even, of the room's own light that they send back and a place sees straight,
// which they are taken to send evenly; and of what comes by way of the room, by the share of both in its
// light.
constexpr double kSlatsSeen = 0.03, kSlatsEven = 0.02, kSlatsBack = 0.25;
constexpr double kSlatsLater = 0.015, kSlatsBackLater = 0.5;
constexpr double kSlatsBent = 0.1; // of how sharply it bends between the elevations that it is told by

// How much light that runs on smoothly, photometric, changes across each patch.
std::vector<float> spreadWithin(const MomentScene& scene, std::span<const float> light) {
    std::vector<float> spread(light.size());
    for (size_t i = 0; i < light.size(); ++i) {
        glm::vec3 slope(0);
        for (const PatchSlopes::Term& term : scene.slopes.terms(i)) slope += light[term.patch] * term.weight;
        spread[i] = glm::length(slope) * static_cast<float>(scene.points.patches()[i].size);
    }
    return spread;
}

// How much each patch's light bends: towards a neighbour that fills much of its view it changes from what it
// gets of the whole room to what it gets of that one. Nothing where both are alike, as in corners of white
// rooms.
std::vector<float> bendWithin(const MomentScene& scene, const Moment& moment, std::span<const float> light) {
    std::vector<float> bend(light.size(), 0), lit(light.size()), reflectance(light.size());
    for (size_t i = 0; i < light.size(); ++i) {
        const LightParts& parts = moment.patches[i];
        lit[i] = static_cast<float>(photometric(parts.sky + parts.ground + parts.interreflected));
        reflectance[i] =
            static_cast<float>(photometric(scene.mesh.materials[scene.mesh.material[i]].reflectance));
    }
    for (size_t j = 0; j < light.size(); ++j)
        for (const NearPairs::Pair& pair : scene.pairs.nearest(j))
            bend[pair.to] += reflectance[pair.to] * pair.factor * std::abs(light[j] - lit[pair.to]);
    return bend;
}

// What the light of patches nearby leaves open on each patch: the mesh spreads it evenly over them.
std::vector<float> nearErrors(const MomentScene& scene, const Moment& moment) {
    const size_t n = scene.mesh.patchCount();
    std::vector<float> light(n), errors(n);
    for (size_t i = 0; i < n; ++i) // but for sunlight, which is sent from where it lies
        light[i] = static_cast<float>(
            photometric(moment.lighting.exitance[i] -
                        scene.mesh.materials[scene.mesh.material[i]].reflectance * moment.patches[i].sun));
    const std::vector<float> spread = spreadWithin(scene, light), bend = bendWithin(scene, moment, light);
    for (size_t j = 0; j < n; ++j) {
        const auto all = scene.pairs.of(j), nearest = scene.pairs.nearest(j);
        for (const NearPairs::Pair& pair : nearest)
            errors[pair.to] +=
                pair.factor * (kPatchSpreadShare * spread[j] + kPatchBendShare * pair.factor * bend[j]);
        for (const NearPairs::Pair& pair : all.subspan(nearest.size()))
            errors[pair.to] += kFarSpreadShare * pair.factor * spread[j];
    }
    return errors;
}

// Rows of SlatLobes, photometric: second differences of light over the nodes, large where slats are seen
// edge-on. At the first and last node, beyond which nothing is told, all of the step to the next one counts.
std::vector<float> slatBends(std::span<const glm::vec3> lobes) {
    using daylight::kSlatNodes;
    std::vector<float> bends(lobes.size());
    for (size_t row = 0; row < lobes.size(); ++row) {
        const size_t node = row % kSlatNodes;
        glm::vec3 bend(0);
        if (node > 0) bend += lobes[row - 1] - lobes[row];
        if (node + 1 < kSlatNodes) bend += lobes[row + 1] - lobes[row];
        bends[row] = static_cast<float>(std::abs(photometric(bend)));
    }
    return bends;
}

// What patches' own errors leave on light by way of the room, as a share of it. Single patches' even out; in
// shafts and reveals all light passes by a few, and each of them sends too much of it on. Those of slots that
// the mesh does not resolve all err the same way; so does sunlight that ends in a slot, of which more goes to
// and fro there than patches as large as the slot tell.
double laterShare(const MomentScene& scene, const Moment& moment, std::span<const float> near) {
    const size_t n = near.size();
    std::vector<double> reflectance(n), bySun(n, 0); // bySun: exitance, of sunlight that patches nearby send
    for (size_t i = 0; i < n; ++i)
        reflectance[i] = photometric(scene.mesh.materials[scene.mesh.material[i]].reflectance);
    for (size_t i = 0; i < n; ++i) {
        const double sun = photometric(moment.patches[i].sun);
        if (sun == 0) continue;
        for (const auto& [to, factor] : scene.pairs.nearest(i))
            bySun[to] += reflectance[to] * double{factor} * reflectance[i] * sun;
    }
    double squares = 0, slots = 0, all = 0; // lumens
    for (size_t i = 0; i < n; ++i) {
        if (bySun[i] != 0)
            for (const auto& [to, factor] : scene.pairs.nearest(i))
                slots += kSunSharedOut * scene.areas[to] * reflectance[to] * double{factor} * bySun[i];
        const double off = scene.areas[i] * reflectance[i] * double{near[i]};
        squares += off * off;
        if (scene.pairs.largest(i) > NearPairs::kAcrossGap) slots += kSlotShare * off;
        all += scene.areas[i] * photometric(moment.lighting.exitance[i]);
    }
    return all > 0 ? (kLaterShare * std::sqrt(squares) + slots) / all : 0;
}

// Of slats, photometric exitance per patch: their glow, and what they send back of the room's own light.
// Empty without any. Needs report.lumensIn, of which `unsure` lumens by way of the room are off.
struct SlatsLight {
    std::vector<float> glow, back;
    std::vector<float> bends; // rows of SlatLobes
    double unsure = 0;        // share

    bool isEmpty() const { return glow.empty(); }
};

SlatsLight slatsLight(const MomentScene& scene, const Moment& moment) {
    SlatsLight light;
    double glowing = 0, back = 0; // lumens
    for (size_t i = 0; i < moment.glow.size(); ++i) {
        if (scene.mesh.materials[scene.mesh.material[i]].blind.kind != geometry::Blind::Kind::slats) continue;
        for (auto* values : {&light.glow, &light.back}) values->resize(scene.mesh.patchCount(), 0);
        const double all = photometric(moment.lighting.exitance[i]), glow = photometric(moment.glow[i]);
        light.glow[i] = static_cast<float>(glow);
        light.back[i] = static_cast<float>(std::max(0.0, all - glow));
        glowing += scene.areas[i] * glow, back += scene.areas[i] * double{light.back[i]};
    }
    if (!light.isEmpty()) light.bends = slatBends(moment.lobes);
    if (glowing + back > 0)
        light.unsure = (kSlatsLater * glowing + kSlatsBackLater * back) / moment.report.lumensIn;
    return light;
}

// What a place gets of bends, lux: off one way at one node and the other way at the next, so a wide view
// evens them out and a narrow one does not.
class SlatsBent {
public:
    void add(size_t row, double lux) { byLobe_[row % daylight::kSlatLobes] += lux; }
    double lux() const {
        double squares = 0;
        for (const double lobe : byLobe_) squares += lobe * lobe;
        return std::sqrt(squares);
    }

private:
    std::array<double, daylight::kSlatLobes> byLobe_{};
};

// Lux of slats that a place gets straight.
struct SlatsSeen {
    double even = 0, lobes = 0; // their glow were it even, and what goes up or down beyond that
    double back = 0;            // of the room's own light
    double bent = 0;            // SlatsBent
};

float slatsError(const LightParts& parts, const SlatsSeen& slats, double unsure) {
    const double seen = std::max(0.0, slats.even + slats.lobes);
    return static_cast<float>(kSlatsSeen * seen + kSlatsEven * slats.even + kSlatsBack * slats.back +
                              kSlatsBent * slats.bent +
                              unsure * std::max(0.0, photometric(parts.interreflected) - seen - slats.back));
}

// Of light by way of the room, for what comes in and may be off. Needs report.lumensIn.
double unsureShare(const Moment& moment) {
    return moment.unsureLumens > 0 ? moment.unsureLumens / moment.report.lumensIn : 0;
}

// `mean`: of the exitance, photometric. Needs report.lumensIn.
void setPatchErrors(const MomentScene& scene, const SolvedColumns& solved, double mean, Moment& moment) {
    const SlatsLight slats = slatsLight(scene, moment);
    std::vector<float> even(slats.glow.size()), back(even.size()); // straight
    std::vector<glm::vec3> lobes(even.size(), glm::vec3(0));
    if (!slats.isEmpty()) {
        scene.factors.gather(slats.glow, even, 1);
        scene.factors.gather(slats.back, back, 1);
        scene.slats.light(moment.lobes, lobes);
    }
    const std::vector<float> near = nearErrors(scene, moment);
    moment.laterShare = laterShare(scene, moment, near);
    for (size_t i = 0; i < near.size(); ++i)
        moment.meshErrors.push_back(near[i] * static_cast<float>(photometric(
                                                  scene.mesh.materials[scene.mesh.material[i]].reflectance)));
    for (size_t i = 0; i < moment.patches.size(); ++i) {
        LightParts& parts = moment.patches[i];
        parts.error +=
            static_cast<float>(
                std::abs(1 - scene.rowSums[i]) * mean +
                (solved.gatheredError.empty() ? moment.solverError : double{solved.gatheredError[i]}) +
                (scene.rowError + unsureShare(moment) + std::max(kPatchBounceError, moment.laterShare)) *
                    photometric(parts.interreflected) +
                (kPatchSkyError + (scene.skyError.empty() ? 0 : double{scene.skyError[i]})) *
                    photometric(parts.sky + parts.ground)) +
            near[i];
        if (slats.isEmpty()) continue;
        SlatsBent bent;
        for (const SlatLobes::Share& share : scene.slats.of(i))
            bent.add(share.row, double{share.factor} * double{slats.bends[share.row]});
        parts.error += slatsError(
            parts, {double{even[i]}, photometric(lobes[i]), double{back[i]}, bent.lux()}, slats.unsure);
    }
}

// What of errors on patches reaches a sensor, by way of the walls beside it too.
double solverError(const SensorGather& sensors, size_t sensor, std::span<const float> errors) {
    const size_t n = errors.size();
    double sum = dot({&sensors.even[sensor * n], n}, errors), most = 0;
    for (const std::vector<float>& more : sensors.near[sensor].smooth) {
        double byWalls = 0;
        for (size_t i = 0; i < more.size(); ++i) byWalls += double{std::abs(more[i])} * double{errors[i]};
        most = std::max(most, byWalls);
    }
    return sum + most;
}

// Light on patches as sensors' rows are multiplied with it: sunlight has edges, and is even but for those
// (sunEdges has put them in already); all else runs on smoothly.
struct SensedLight {
    bool sun = false;
    std::vector<float> even[3], smooth[3]; // per channel, exitance; grey: the first alone
    std::vector<float> lobes[3];           // of slats
    std::vector<float> whole, apart; // photometric: all of it; with what of the sun's first bounce is unknown
    std::vector<float> uneven; // photometric: by how much sky light varies that has no slope, as round a peak
};

SensedLight sensedLight(const MomentScene& scene, const Moment& moment) {
    const geometry::PatchMesh& mesh = scene.mesh;
    const size_t n = mesh.patchCount();
    SensedLight light;
    light.sun = glm::length(moment.lighting.sunDirection) > 0;
    for (int c = 0; c < (scene.grey ? 1 : 3); ++c) {
        for (const glm::vec3& exitance : moment.lighting.exitance) light.smooth[c].push_back(exitance[c]);
        if (!light.sun) continue;
        light.even[c].resize(n);
        for (size_t i = 0; i < n; ++i) {
            light.even[c][i] = mesh.materials[mesh.material[i]].reflectance[c] * moment.patches[i].sun[c];
            light.smooth[c][i] -= light.even[c][i];
            light.even[c][i] += moment.sunSent[i][c];
        }
    }
    for (const glm::vec3& lobe : moment.lobes)
        for (int c = 0; c < 3; ++c) light.lobes[c].push_back(lobe[c]);
    for (size_t i = 0; i < n; ++i) {
        const auto whole = static_cast<float>(photometric(moment.lighting.exitance[i]));
        light.whole.push_back(whole);
        light.apart.push_back(whole);
        if (light.sun)
            light.apart[i] -= static_cast<float>(
                (1 - kApartSunShare) *
                photometric(mesh.materials[mesh.material[i]].reflectance * moment.patches[i].sun));
    }
    return light;
}

// Photometric, per patch.
std::vector<float> smoothLux(const MomentScene& scene, const SensedLight& light) {
    const auto& smooth = light.smooth;
    if (scene.grey) return smooth[0];
    std::vector<float> sum(smooth[0].size());
    for (size_t i = 0; i < sum.size(); ++i)
        sum[i] = static_cast<float>(photometric(glm::vec3(smooth[0][i], smooth[1][i], smooth[2][i])));
    return sum;
}

// Per patch: what of its sky light's range is more than its slope tells for sure.
std::vector<float> unevenSky(const MomentScene& scene, const Moment& moment, std::span<const float> spread) {
    std::vector<float> uneven;
    for (size_t i = 0; i < scene.skyRange.size(); ++i) {
        const LightParts& parts = moment.patches[i];
        const glm::vec3 sent =
            scene.mesh.materials[scene.mesh.material[i]].reflectance * (parts.sky + parts.ground);
        uneven.push_back(std::max(0.0F, scene.skyRange[i] * static_cast<float>(photometric(sent)) -
                                            kSlopeTells * spread[i]));
    }
    return uneven;
}

// Lux of one channel at a sensor; what of it slats' lobes give, in `byLobes`, and what comes back from
// outside, in `returned`.
double receivedIn(const SensorGather& sensors, const SensedLight& light, size_t sensor, int c,
                  double& byLobes, double& returned) {
    const std::vector<float>&smooth = light.smooth[c], &even = light.even[c], &lobes = light.lobes[c];
    const size_t n = smooth.size();
    double lux = dot({&sensors.smooth[sensor * n], n}, smooth);
    if (light.sun) lux += dot({&sensors.even[sensor * n], n}, even);
    if (!lobes.empty()) {
        const auto& rows = sensors.slats[sensor];
        byLobes = dot(rows[rows[c].empty() ? 0 : c], lobes);
        lux += byLobes;
    }
    const auto add = [&](const std::vector<TintedShare>& more) {
        double sum = 0;
        for (const TintedShare& share : more)
            sum += double{share.more[c]} * (smooth[share.patch] + (light.sun ? even[share.patch] : 0));
        lux += sum;
        return sum;
    };
    add(sensors.tinted[sensor]);
    returned = add(sensors.returned[sensor]);
    if (const NearLight& near = sensors.near[sensor]; !near.isEmpty()) {
        lux += double{near.own[c]} + dot(near.smooth[c], smooth);
        if (light.sun) lux += dot(near.even[c], even);
        if (!lobes.empty()) lux += dot(near.slats[c], lobes);
    }
    return lux;
}

// Adds that to what a sensor gets; returns what lobes give, photometric.
double receive(const MomentScene& scene, const SensedLight& light, size_t sensor, LightParts& parts) {
    glm::dvec3 byLobes(0), returned(0);
    for (int c = 0; c < (scene.grey ? 1 : 3); ++c)
        parts.interreflected[c] +=
            static_cast<float>(receivedIn(scene.sensors, light, sensor, c, byLobes[c], returned[c]));
    parts.error +=
        static_cast<float>(kReturnUnsure * (scene.grey ? returned.x : photometric(glm::vec3(returned))));
    if (!scene.grey) return photometric(glm::vec3(byLobes));
    parts.interreflected = glm::vec3(parts.interreflected.x);
    return byLobes.x;
}

// Slopes can leave light that is nearly nothing below it. What is left out counts as error.
void keepFromNegative(LightParts& parts) {
    const glm::vec3 below = glm::min(parts.interreflected, glm::vec3(0));
    parts.interreflected -= below;
    parts.error -= static_cast<float>(photometric(below));
}

// By how much form factors of pieces of a patch differ over their mean, to first order: what is close by, or
// near the horizon of the sensor, is seen by one end, however little of the view it fills.
double viewChange(const PointScene::Patch& patch, const Sensor& sensor) {
    const glm::dvec3 away = patch.centre - sensor.position;
    const double height = std::max(glm::dot(away, sensor.normal), 1e-3 * patch.size);
    const glm::dvec3 slope = sensor.normal / height - 4.0 * away / glm::dot(away, away);
    return patch.size * glm::length(slope - patch.normal * glm::dot(slope, patch.normal));
}

// What errors of the patches that a sensor sees leave on its light: those of many even out, but one that
// looks at a dark corner, or stands in a room that gets its light by a few patches, sees few.
double seenError(const MomentScene& scene, const Moment& moment, size_t sensor) {
    const size_t n = moment.meshErrors.size();
    double squares = 0;
    for (size_t i = 0; i < n; ++i) {
        const double off = double{scene.sensors.even[sensor * n + i]} * double{moment.meshErrors[i]};
        squares += off * off;
    }
    return kSeenShare * std::sqrt(squares);
}

// Of the light of patches nearby or seen by one end, which the mesh does not resolve.
double nearError(const MomentScene& scene, const SensedLight& light, size_t sensor) {
    const SensorGather& sensors = scene.sensors;
    const bool apart = sensors.nearWall[sensor];
    const std::vector<float>& exitance = apart ? light.apart : light.whole;
    double sum = 0, uneven = 0;
    for (size_t i = 0; i < exitance.size(); ++i) {
        const double share = sensors.even[sensor * exitance.size() + i];
        sum += share * share * double{exitance[i]};
        if (apart || light.uneven.empty() || light.uneven[i] == 0) continue;
        double seen = kUnevenShare * share;
        if (share > kChangesFrom)
            seen =
                std::max(seen, kViewChange * viewChange(scene.points.patches()[i], sensors.sensors[sensor]));
        uneven += share * std::min(seen, kMostUneven) * double{light.uneven[i]};
    }
    return apart ? kApartShare * sum : kNearShare * sum + uneven;
}

} // namespace

void lightPatches(const MomentScene& scene, const SolvedColumns& solved, Moment& moment) {
    const geometry::PatchMesh& mesh = scene.mesh;
    const size_t n = mesh.patchCount();
    moment.lighting.exitance.resize(n);
    double in = 0, absorbed = 0, lost = 0, mean = 0, total = 0;
    for (size_t i = 0; i < n; ++i) {
        LightParts& parts = moment.patches[i];
        const geometry::Material& m = mesh.materials[mesh.material[i]];
        glm::vec3 out(0), tau(0), straight(0);
        for (int c = 0; c < 3; ++c) {
            const size_t channel = static_cast<size_t>(scene.grey ? 0 : c),
                         at = solved.first + channel * n + i;
            out[c] = std::max(solved.exitance[at], 0.0F);
            parts.interreflected[c] += solved.gathered[at];
            tau[c] = scene.matter.transmittance[channel][i];
            straight[c] = scene.clear[channel][i];
        }
        keepFromNegative(parts);
        moment.lighting.exitance[i] = out;
        const glm::vec3 direct = parts.sun + parts.sky + parts.ground;
        in += scene.areas[i] * photometric(m.exitance + direct);
        if (!moment.glow.empty()) in += scene.areas[i] * photometric(moment.glow[i]);
        // What goes straight on counts where it lands.
        const glm::vec3 on = straight * direct + tau * parts.sun;
        in -= scene.areas[i] * photometric(on);
        absorbed += scene.areas[i] *
                    photometric((glm::vec3(1) - m.reflectance - tau) * parts.total() - straight * direct);
        if (!scene.linked.empty()) absorbed -= scene.areas[i] * photometric(scene.linked[i] * out);
        lost += scene.areas[i] * (1 - double{scene.rowSums[i]}) * photometric(out);
        mean += scene.areas[i] * photometric(out);
        total += scene.areas[i];
    }
    mean /= std::max(total, 1e-30);
    moment.report.lumensIn = in;
    for (size_t i = 0; scene.returns && i < n; ++i)
        moment.unsureLumens +=
            kReturnUnsure * scene.areas[i] * photometric(scene.linked[i] * moment.lighting.exitance[i]);
    setPatchErrors(scene, solved, mean, moment);
    moment.report.lumensAbsorbed = absorbed;
    moment.report.lumensLost = lost;
    moment.report.energyImbalance = in > 0 ? std::abs(in - absorbed - lost) / in : 0;
}

void lightSensors(const MomentScene& scene, Moment& moment) {
    const Stopwatch clock;
    if (moment.sensors.empty()) return;
    const SensorGather& sensors = scene.sensors;
    const size_t n = scene.mesh.patchCount();
    SensedLight light = sensedLight(scene, moment);
    const std::vector<float> smooth = smoothLux(scene, light), spread = spreadWithin(scene, smooth);
    light.uneven = unevenSky(scene, moment, spread);
    std::vector<float> unsure(n);  // of patches' exitance
    for (size_t i = 0; i < n; ++i) // and what its slope takes below nought: it cannot be that steep
        unsure[i] = kSpreadShare * spread[i] + std::max(0.0F, spread[i] / 2 - std::max(0.0F, smooth[i]));
    const SlatsLight slats = slatsLight(scene, moment);
    inParallel(moment.sensors.size(), [&](size_t s) {
        LightParts& parts = moment.sensors[s];
        const std::span<const float> even{&sensors.even[s * n], n};
        const double byLobes = receive(scene, light, s, parts);
        keepFromNegative(parts);
        const double bySolver = moment.exitanceErrors.empty()
                                    ? moment.solverError
                                    : solverError(sensors, s, moment.exitanceErrors);
        const double reflected = photometric(parts.interreflected),
                     byMesh = std::max({kBounceError * reflected, moment.laterShare * reflected,
                                        seenError(scene, moment, s)});
        parts.error += static_cast<float>(bySolver + nearError(scene, light, s) + dot(even, unsure) +
                                          (scene.rowError + unsureShare(moment)) * reflected + byMesh +
                                          kSensorSkyError * photometric(parts.sky + parts.ground));
        if (slats.isEmpty()) return;
        SlatsBent bent;
        const auto& rows = sensors.slats[s][scene.grey || sensors.slats[s][1].empty() ? 0 : 1];
        for (size_t row = 0; row < rows.size(); ++row)
            bent.add(row, double{rows[row]} * double{slats.bends[row]});
        parts.error += slatsError(parts, {dot(even, slats.glow), byLobes, dot(even, slats.back), bent.lux()},
                                  slats.unsure);
    });
    moment.report.sensorSeconds = clock.seconds();
}

} // namespace heliodon::compute
