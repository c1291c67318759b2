#include "compute/sun_edges.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "compute/lighting.h"

namespace heliodon::compute {

namespace {

constexpr float kNear = 0.02F, kMostNearer = 3; // form factor from which patches are seen exactly
// Share of all that the sun gives a sensor by way of patches in an hour. An edge that cannot send more, or
// that its middle shifts by less, is told by this; all together were off by 3e-5 in the root mean square.
constexpr float kNegligible = 1e-3F;
// So much nearer or farther than its patch light is seen exactly: its middle says little.
constexpr float kMuch = 0.5F;
// Less than this share of a patch's height below the horizon, or hidden, does not count. A sliver above does:
// close by it is all that a sensor below the top of a partition sees of it, and no middle tells of it.
constexpr double kSliver = 0.05;

struct Middles {
    const float *x, *y, *z;
    size_t count;
};
// A point, and what its nearness to a patch is measured in.
struct From {
    glm::vec3 position, up; // up: the point's normal over the height of the patch's middle above its plane
    float square;           // of the distance of that middle
};

// How many times nearer and squarer the middle of light stands, x, y, z from the point, than that of its
// patch, less one. The point's height over the patch's plane is the same for both. F: float, or a vector,
// which functions would hand over differently with AVX: by reference.
template<class F>
[[gnu::always_inline]] inline void tellNearer(const F& x, const F& y, const F& z, const F& upX, const F& upY,
                                              const F& upZ, const F& square, F& nearer) {
    const F above = x * upX + y * upY + z * upZ, closer = square / (x * x + y * y + z * z + 1e-30F);
    const F times = (above > 0 ? above : F{}) * closer * closer;
    nearer = (times < kMostNearer ? times : F{} + kMostNearer) - 1;
}

[[gnu::always_inline]] inline void howMuchNearer(const Middles& middles, const From& from,
                                                 float* __restrict nearer) {
    for (size_t k = 0; k < middles.count; ++k)
        tellNearer(middles.x[k] - from.position.x, middles.y[k] - from.position.y,
                   middles.z[k] - from.position.z, from.up.x, from.up.y, from.up.z, from.square, nearer[k]);
}

// Edges of one patch at sensors side by side, as many as vectors hold.
constexpr size_t kTogether = SunEdges::kTogether, kLanes = 8;
using Floats [[gnu::vector_size(kLanes * sizeof(float)), gnu::may_alias]] = float;
using Flags [[gnu::vector_size(kLanes * sizeof(float))]] = int32_t;
struct alignas(sizeof(Floats)) Lux {
    float of[kTogether];
};
struct Edge {
    float x, y, z, exitance, beyond;
};
struct alignas(sizeof(Floats)) Seen { // a patch; the first seven as of From
    float x[kTogether], y[kTogether], z[kTogether], upX[kTogether], upY[kTogether], upZ[kTogether],
        square[kTogether];
    float share[kTogether];
    // How many times nearer, less one, light is not to be told by its middle, and of how much of it that
    // makes a difference: `most` whatever its place.
    float much[kTogether], most[kTogether];
};

// Adds to `lux` what edges send that middles tell. False where there are no others, else `rest` says which.
[[gnu::always_inline]] inline bool addByMiddles(const Edge& edge, const Seen& seen, const Lux& least,
                                                Lux& lux, int32_t* rest) {
    const auto part = [](const float* lanes) -> const Floats& {
        return *reinterpret_cast<const Floats*>(lanes);
    };
    bool any = false;
    for (size_t v = 0; v < kTogether; v += kLanes) {
        Floats more;
        tellNearer<Floats>(edge.x - part(seen.x + v), edge.y - part(seen.y + v), edge.z - part(seen.z + v),
                           part(seen.upX + v), part(seen.upY + v), part(seen.upZ + v), part(seen.square + v),
                           more);
        const Floats far = more < 0 ? -more : more, share = part(seen.share + v),
                     shift = edge.exitance * share * far,
                     most = (edge.exitance + std::abs(edge.beyond)) * part(seen.most + v);
        const Flags exact =
            (far > part(seen.much + v)) & ((shift > most ? shift : most) > part(least.of + v));
        const Floats sum =
            part(lux.of + v) + (exact ? Floats{} : share * (edge.exitance * more - edge.beyond));
        std::memcpy(lux.of + v, &sum, sizeof sum);
        std::memcpy(rest + v, &exact, sizeof exact);
        int64_t flags[sizeof exact / sizeof(int64_t)], all = 0;
        std::memcpy(flags, &exact, sizeof exact);
        for (const int64_t flag : flags) all |= flag;
        any |= all != 0;
    }
    return any;
}

struct Kernels {
    void (*howMuchNearer)(const Middles&, const From&, float*);
    bool (*addByMiddles)(const Edge&, const Seen&, const Lux&, Lux&, int32_t*);
};

constexpr Kernels kNarrow{
    [](const Middles& middles, const From& from, float* nearer) { howMuchNearer(middles, from, nearer); },
    [](const Edge& edge, const Seen& seen, const Lux& least, Lux& lux, int32_t* rest) {
        return addByMiddles(edge, seen, least, lux, rest);
    }};

#if defined(__x86_64__)
[[gnu::target("avx2")]] void howMuchNearerWide(const Middles& middles, const From& from, float* nearer) {
    howMuchNearer(middles, from, nearer);
}

[[gnu::target("avx2")]] bool addByMiddlesWide(const Edge& edge, const Seen& seen, const Lux& least, Lux& lux,
                                              int32_t* rest) {
    return addByMiddles(edge, seen, least, lux, rest);
}
#endif

Kernels kernelsOf([[maybe_unused]] VectorWidth width) {
#if defined(__x86_64__)
    if (width >= VectorWidth::avx2) return {howMuchNearerWide, addByMiddlesWide};
#endif
    return kNarrow;
}

// Form factor of a patch with nothing before it.
double openFactorOf(const geometry::PatchMesh& mesh, const PointView& view, uint32_t patch) {
    std::vector<glm::dvec3> above;
    return view.openFactor(geometry::patchCorners(mesh, patch), above);
}

} // namespace

std::vector<SunEdges::Edge> SunEdges::edgesOf(const geometry::PatchMesh& mesh,
                                              const std::vector<SunlitParts>& partly, double strength) {
    std::vector<Edge> edges;
    for (const SunlitParts& lit : partly) {
        const glm::vec3 rho = mesh.materials[mesh.material[lit.patch]].reflectance;
        Edge edge{lit.patch, {}, {}, {}, {}};
        glm::dvec3 middle(0), leaving(0);
        double flux = 0;
        for (const SunlitParts::Part& part : lit.parts) {
            const glm::vec3 exitance = static_cast<float>(strength) * rho * part.light;
            for (size_t k = 1; k + 1 < part.polygon.size(); ++k) {
                const glm::dvec3 a = part.polygon[0], b = part.polygon[k], c = part.polygon[k + 1];
                const double area = 0.5 * glm::length(glm::cross(b - a, c - a)),
                             share = area * photometric(exitance);
                flux += share;
                leaving += area * glm::dvec3(exitance);
                middle += share / 3 * (a + b + c);
            }
            edge.parts.push_back({part.polygon, exitance});
        }
        if (!(flux > 0)) continue;
        edge.exitance = glm::vec3(leaving / geometry::patchArea(mesh, lit.patch));
        edge.middle = glm::vec3(middle / flux);
        edges.push_back(std::move(edge));
    }
    return edges;
}

SunEdges::Patch SunEdges::patchOf(const geometry::PatchMesh& mesh, uint32_t patch, size_t first) {
    const glm::dvec3 middle = geometry::patchCentroid(mesh, patch);
    double reach = 0;
    for (const uint32_t v : mesh.patch(patch))
        reach = std::max(reach, glm::length(mesh.vertices[v] - middle));
    return {patch,
            first,
            glm::vec3(middle),
            glm::vec3(geometry::patchNormal(mesh, patch)),
            static_cast<float>(geometry::patchArea(mesh, patch)),
            static_cast<float>(reach)};
}

// The largest factors under the integral of the form factor, with the whole area.
double SunEdges::mostOf(const Patch& patch, const PointView& view) {
    const glm::vec3 middle = patch.middle - glm::vec3(view.position());
    const float nearest = glm::length(middle) - patch.reach;
    if (nearest < patch.reach) return 1;
    const float above = glm::dot(middle, glm::vec3(view.normal())) + patch.reach,
                before = -glm::dot(middle, patch.normal);
    if (above <= 0) return 0;
    const float square = nearest * nearest, least = 1e-3F * nearest; // rounding
    return patch.area * above * std::max(before, least) / (std::numbers::pi_v<float> * square * square);
}

SunEdges::SunEdges(const geometry::PatchMesh& mesh, std::vector<std::vector<Edge>> ofHours)
    : hours_(ofHours.size()) {
    std::vector<size_t> next(mesh.patchCount() + 1, 0);
    for (const auto& edges : ofHours)
        for (const Edge& edge : edges) ++next[edge.patch + 1];
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (next[i + 1] > 0) patches_.push_back(patchOf(mesh, static_cast<uint32_t>(i), next[i]));
        next[i + 1] += next[i];
    }
    const size_t count = next.back();
    std::vector<std::pair<uint32_t, const Edge*>> ordered(count); // with their hours
    for (size_t h = 0; h < ofHours.size(); ++h)
        for (const Edge& edge : ofHours[h]) ordered[next[edge.patch]++] = {static_cast<uint32_t>(h), &edge};
    for (const auto& [hour, edge] : ordered) {
        hour_.push_back(hour);
        colour_.push_back(edge->exitance);
        colourBeyond_.push_back(edge->beyond);
        exitance_.push_back(static_cast<float>(photometric(edge->exitance)));
        beyond_.push_back(static_cast<float>(photometric(edge->beyond)));
        x_.push_back(edge->middle.x), y_.push_back(edge->middle.y), z_.push_back(edge->middle.z);
        firstPart_.push_back(parts_.size());
        for (const Edge::Part& part : edge->parts) {
            parts_.push_back({corners_.size(), part.exitance});
            corners_.insert(corners_.end(), part.polygon.begin(), part.polygon.end());
        }
    }
    firstPart_.push_back(parts_.size());
    parts_.push_back({corners_.size(), {}});
}

bool SunEdges::findNearer(const PointView& view, size_t patch, VectorWidth width,
                          std::vector<float>& nearer) const {
    const Patch& of = patches_[patch];
    const glm::vec3 middle = of.middle - glm::vec3(view.position());
    const float above = glm::dot(middle, glm::vec3(view.normal()));
    if (!(above > 0 && glm::dot(middle, of.normal) < 0)) return false;
    const size_t first = of.first, count = edgesEnd(patch) - first;
    nearer.resize(count);
    const Middles middles{&x_[first], &y_[first], &z_[first], count};
    const From from{glm::vec3(view.position()), glm::vec3(view.normal()) / above, glm::dot(middle, middle)};
    kernelsOf(width).howMuchNearer(middles, from, nearer.data());
    return true;
}

struct SunEdges::Lanes : Seen {
    enum class As : uint8_t { straight, aboveHorizon } as[kTogether];
    double straight[kTogether]; // form factor of what is not seen through windows
    float even[kTogether];      // of all
    double open[kTogether];     // `aboveHorizon`: with nothing before the patch
};

bool SunEdges::look(const PointScene& scene, const Place& from, size_t p, Lanes& lanes, size_t k) const {
    const Patch& patch = patches_[p];
    const float share = from.even[patch.patch];
    if (share < kEdgeShare || scene.mesh().room[patch.patch] != from.room) return false; // glass: from afar
    const PointView& view = from.view;
    const glm::vec3 position(view.position()), middle = patch.middle - position;
    const float above = glm::dot(middle, glm::vec3(view.normal()));
    const bool seesMiddle = above > 0 && glm::dot(middle, patch.normal) < 0;
    const glm::vec3 up = seesMiddle ? glm::vec3(view.normal()) / above : glm::vec3(0);
    lanes.x[k] = position.x, lanes.y[k] = position.y, lanes.z[k] = position.z;
    lanes.upX[k] = up.x, lanes.upY[k] = up.y, lanes.upZ[k] = up.z;
    lanes.square[k] = glm::dot(middle, middle);
    lanes.share[k] = seesMiddle ? share : 0;
    lanes.even[k] = share;
    lanes.much[k] = kMuch, lanes.most[k] = 0;
    lanes.as[k] = Lanes::As::straight;
    // Not what of the share is seen through windows.
    lanes.straight[k] = scene.hasRoomsBeyond() ? scene.factor(view, patch.patch) : double{share};
    const auto notByMiddles = [&](double most) {
        lanes.much[k] = -1, lanes.most[k] = static_cast<float>(most);
    };
    if (share >= kNear) {
        notByMiddles(std::numeric_limits<float>::infinity());
    } else if (isPartlyHidden(scene.mesh(), view, patch.patch, lanes.straight[k])) {
        notByMiddles(mostOf(patch, view));
    } else if (isCut(scene.mesh(), patch.patch, view)) {
        notByMiddles(mostOf(patch, view));
        lanes.as[k] = Lanes::As::aboveHorizon;
        lanes.open[k] = openFactorOf(scene.mesh(), view, patch.patch);
    }
    return true;
}

void SunEdges::addTo(float* lux, size_t stride, const PointScene& scene, std::span<const Place> places,
                     VectorWidth width) const {
    const auto addByMiddlesOf = kernelsOf(width).addByMiddles;
    std::vector<Lux> more(hours_), least(hours_);
    for (size_t h = 0; h < hours_; ++h)
        for (size_t k = 0; k < places.size(); ++k)
            least[h].of[k] = kNegligible * std::max(0.0f, lux[h * stride + k]);
    for (size_t p = 0; p < patches_.size(); ++p) {
        Lanes lanes{};
        bool any = false;
        for (size_t k = 0; k < places.size(); ++k) any |= look(scene, places[k], p, lanes, k);
        if (!any) continue;
        for (size_t e = patches_[p].first; e < edgesEnd(p); ++e) {
            int32_t rest[kTogether];
            if (!addByMiddlesOf({x_[e], y_[e], z_[e], exitance_[e], beyond_[e]}, lanes, least[hour_[e]],
                                more[hour_[e]], rest))
                continue;
            for (size_t k = 0; k < places.size(); ++k)
                if (rest[k]) more[hour_[e]].of[k] += exactly(places[k].view, e, lanes, k);
        }
    }
    for (size_t h = 0; h < hours_; ++h)
        for (size_t k = 0; k < places.size(); ++k) lux[h * stride + k] += more[h].of[k];
}

float SunEdges::exactly(const PointView& view, size_t e, const Lanes& lanes, size_t k) const {
    if (lanes.as[k] == Lanes::As::straight)
        return static_cast<float>(photometric(exactly(view, e, lanes.straight[k])));
    // Of what is above; as much is hidden from each part as from the patch.
    if (!(lanes.open[k] > 0)) return 0;
    std::vector<glm::dvec3> above;
    double light = 0;
    for (const Part& part : partsOf(e))
        light += view.openFactor(cornersOf(part), above) * photometric(part.exitance);
    return lanes.even[k] * (static_cast<float>(light / lanes.open[k]) - exitance_[e] - beyond_[e]);
}

bool SunEdges::isCut(const geometry::PatchMesh& mesh, uint32_t patch, const PointView& view) {
    double lowest = 0, highest = 0;
    for (const uint32_t v : mesh.patch(patch)) {
        const double height = glm::dot(mesh.vertices[v] - view.position(), view.normal());
        lowest = std::min(lowest, height), highest = std::max(highest, height);
    }
    return highest > 0 && -lowest > kSliver * (highest - lowest);
}

bool SunEdges::isPartlyHidden(const geometry::PatchMesh& mesh, const PointView& view, uint32_t patch,
                              double straight) {
    return view.isHindered(geometry::patchCorners(mesh, patch)) &&
           straight < (1 - kSliver) * openFactorOf(mesh, view, patch);
}

glm::dvec3 SunEdges::exactly(const PointView& view, size_t e, double straight) const {
    glm::dvec3 more = -straight * glm::dvec3(colour_[e] + colourBeyond_[e]);
    for (const Part& part : partsOf(e)) more += view.factor(cornersOf(part)) * glm::dvec3(part.exitance);
    return more;
}

void SunEdges::addTo(std::span<float> lux, const PointScene& scene, const NearLight& near, uint32_t room,
                     VectorWidth width) const {
    std::vector<float> nearer;
    for (const NearLight::Cell& cell : near.cells) {
        const PointView view(scene.blockers(), cell.middle, cell.normal, room);
        const double answer = photometric(cell.answer);
        for (size_t p = 0; p < patches_.size(); ++p) {
            const Patch& patch = patches_[p];
            if (scene.mesh().room[patch.patch] != room || mostOf(patch, view) * answer < kEdgeOnCells)
                continue;
            const double straight = scene.factor(view, patch.patch);
            if (straight * answer < kEdgeOnCells) continue;
            if (straight >= double{kNear})
                for (size_t e = patch.first; e < edgesEnd(p); ++e)
                    lux[hour_[e]] +=
                        static_cast<float>(photometric(cell.answer * glm::vec3(exactly(view, e, straight))));
            else if (findNearer(view, p, width, nearer))
                for (size_t k = 0; k < nearer.size(); ++k) {
                    const size_t e = patch.first + k;
                    const glm::vec3 more = nearer[k] * colour_[e] - colourBeyond_[e];
                    lux[hour_[e]] += static_cast<float>(straight * photometric(cell.answer * more));
                }
        }
    }
}

size_t SunEdges::bytesOf(std::span<const Edge> edges) {
    size_t sum = edges.size() * sizeof(Edge);
    for (const Edge& edge : edges)
        for (const Edge::Part& part : edge.parts)
            sum += sizeof part + part.polygon.size() * sizeof(glm::dvec3);
    return sum;
}

} // namespace heliodon::compute
