#include "engine/app/model_hints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/bounds.h"
#include "geometry/lower_case.h"

namespace heliodon::app {

namespace {

// Metres from the lowest to the highest corner of the room of which that is least.
double lowestRoom(const geometry::Building& building) {
    std::vector<double> low(building.roomCount, 1e300), high(building.roomCount, -1e300);
    for (const geometry::Face& face : building.faces)
        for (const uint32_t v : face.loops[0]) {
            low[face.room] = std::min(low[face.room], building.vertices[v].y);
            high[face.room] = std::max(high[face.room], building.vertices[v].y);
        }
    double least = 1e300;
    for (size_t r = 0; r < low.size(); ++r) least = std::min(least, high[r] - low[r]);
    return least;
}

bool isLevelByName(const std::string& material) {
    const std::string name = geometry::lowered(material);
    return std::ranges::any_of(std::array{"floor", "ceiling", "ground", "roof", "slab"},
                               [&](const char* part) { return name.find(part) != std::string::npos; });
}

// Whether some surfaces of a mesh are, by area, mostly what the second function asks.
template<class Which, class What>
bool mostly(const geometry::PatchMesh& mesh, double least, const Which& which, const What& what) {
    double area = 0, found = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (!which(i)) continue;
        area += geometry::patchArea(mesh, i);
        if (what(i)) found += geometry::patchArea(mesh, i);
    }
    return area > 0 && found > least * area;
}

// One room as high as a storey is wide, on its side: as deep as rooms are high, higher than deep, and long.
bool isStoreyOnItsSide(const geometry::Bounds& box, double worldPerBuilding) {
    constexpr double kLowest = 2, kHighest = 4.51; // metres, of storeys
    constexpr double kUpright = 1.4, kLong = 0.75;
    const glm::dvec3 size = (box.high - box.low) / worldPerBuilding;
    const double deep = std::min(size.x, size.z), wide = std::max(size.x, size.z);
    return deep > kLowest && deep < kHighest && size.y > kUpright * deep && wide > kLong * size.y;
}

// What says that the file has another axis up than was taken; "" for nothing.
std::string signOfLying(const geometry::PatchMesh& mesh, double worldPerBuilding) {
    constexpr double kLevel = 0.5;             // of a normal's height
    constexpr double kMost = 0.9, kSome = 0.1; // of the area
    const auto height = [&](size_t i) { return geometry::patchNormal(mesh, i).y; };
    const auto isNamed = [&](size_t i) { return isLevelByName(mesh.materials[mesh.material[i]].name); };
    if (mostly(mesh, kMost, isNamed, [&](size_t i) { return std::abs(height(i)) < kLevel; }))
        return "the model's floors and ceilings stand upright";
    const bool isNamedLevel =
        mostly(mesh, kMost, isNamed, [&](size_t i) { return std::abs(height(i)) > kLevel; });
    if (mostly(
            mesh, kSome,
            [&](size_t i) {
                return mesh.materials[mesh.material[i]].isOpening() && mesh.twin[i] == geometry::kNoTwin;
            },
            [&](size_t i) { return height(i) > kLevel; }))
        return "windows of the model lie in its floor";
    if (const geometry::Bounds box = geometry::boundsOf(mesh.vertices);
        !isNamedLevel && isStoreyOnItsSide(box, worldPerBuilding))
        return fmt::format("the model is {:.1f} m high and {:.1f} m deep",
                           (box.high.y - box.low.y) / worldPerBuilding,
                           std::min(box.high.x - box.low.x, box.high.z - box.low.z) / worldPerBuilding);
    return "";
}

} // namespace

double modelScale(Run& run, const std::optional<double>& given, const geometry::Building& building) {
    if (given) return 1 / *given;
    constexpr double kTallRoom = 6.5; // few work in higher rooms: a file in other units
    const double scale = geometry::assumedWorldPerBuilding(building.vertices), room = lowestRoom(building);
    constexpr double kFeet = 20, kInches = 150, kCentimetres = 1000; // rooms of 6 m, 4 m and 10 m
    const auto [unit, metres] = room < kFeet          ? std::pair("feet", 0.3048)
                                : room < kInches      ? std::pair("inches", 0.0254)
                                : room < kCentimetres ? std::pair("centimetres", 0.01)
                                                      : std::pair("millimetres", 0.001);
    // On its side a storey is as deep as it is high: in such a unit it would be a gap.
    constexpr double kNarrowest = 1;
    const geometry::Bounds box = geometry::boundsOf(building.vertices);
    const double deep = std::min(box.high.x - box.low.x, box.high.z - box.low.z);
    const bool small = scale < 1;
    const bool large = room > kTallRoom && deep * metres > kNarrowest;
    std::string what = small ? "model 12 times smaller than its building" : "model as large as its building";
    if (large)
        what += fmt::format(", whose rooms are {:.4g} m high and more; for one in {} give --model-scale {}",
                            room, unit, metres);
    run.assume(what, small || large);
    return scale;
}

void warnOfLying(Run& run, const geometry::PatchMesh& mesh, double worldPerBuilding, geometry::UpAxis up) {
    const bool isY = up == geometry::UpAxis::y;
    if (const std::string sign = signOfLying(mesh, worldPerBuilding); !sign.empty())
        run.warn(fmt::format("{} with {} up: is it --up {}?", sign, isY ? "y" : "z", isY ? "z" : "y"));
}

} // namespace heliodon::app
