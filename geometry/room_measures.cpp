#include "geometry/room_measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/face_soup.h"
#include "geometry/floors.h"

namespace heliodon::geometry {

namespace {

constexpr double kLevel = 0.7; // panes nearer to level than to upright are skylights'
constexpr double kBend = 0.8;  // cosine of the turn, 37 degrees, that facets of one pane may make

size_t roomCount(const PatchMesh& mesh) {
    return mesh.room.empty() ? 0 : 1 + *std::ranges::max_element(mesh.room);
}

class RoomMeasurer {
public:
    explicit RoomMeasurer(const PatchMesh& mesh) : mesh_(mesh), shells_(mesh) {
        rooms_.resize(roomCount(mesh));
    }

    std::vector<RoomMeasures> measure(double worldPerBuilding) {
        measureVolumes();
        measureFloors(findFloors(mesh_, worldPerBuilding));
        countElements();
        return std::move(rooms_);
    }

    std::vector<RoomMeasures> measureOnlyVolumes() {
        measureVolumes();
        return std::move(rooms_);
    }

private:
    void measureVolumes() {
        std::set<std::pair<uint32_t, uint32_t>> seen;
        for (size_t i = 0; i < mesh_.patchCount(); ++i)
            if (seen.insert({mesh_.room[i], shells_.of(i)}).second)
                rooms_[mesh_.room[i]].volume += shells_.volume(i);
        for (size_t i = 0; i < mesh_.patchCount(); ++i) {
            rooms_[mesh_.room[i]].surface += patchArea(mesh_, i);
            if (mesh_.materials[mesh_.material[i]].isOpening())
                rooms_[mesh_.room[i]].openings += patchArea(mesh_, i);
        }
    }

    void measureFloors(const Floors& floors) {
        constexpr double kInfinite = std::numeric_limits<double>::infinity();
        std::vector<double> top(rooms_.size(), -kInfinite), bottom(rooms_.size(), kInfinite);
        for (size_t i = 0; i < mesh_.patchCount(); ++i)
            for (const uint32_t v : mesh_.patch(i))
                top[mesh_.room[i]] = std::max(top[mesh_.room[i]], mesh_.vertices[v].y);
        for (const size_t i : floors.lowest) {
            rooms_[mesh_.room[i]].floorArea += patchArea(mesh_, i);
            for (const uint32_t v : mesh_.patch(i))
                bottom[mesh_.room[i]] = std::min(bottom[mesh_.room[i]], mesh_.vertices[v].y);
        }
        for (const size_t i : floors.lowest)
            rooms_[mesh_.room[i]].overFloor +=
                patchArea(mesh_, i) * (top[mesh_.room[i]] - patchCentroid(mesh_, i).y);
        for (const size_t i : floors.upper) rooms_[mesh_.room[i]].upperFloor += patchArea(mesh_, i);
        for (const size_t i : floors.undecided) rooms_[mesh_.room[i]].mayBeFloor.push_back(i);
        for (size_t r = 0; r < rooms_.size(); ++r)
            if (rooms_[r].floorArea > 0) {
                rooms_[r].height = top[r] - bottom[r];
                rooms_[r].floorArea += rooms_[r].upperFloor;
            }
    }

    void countElements() {
        std::set<std::pair<uint32_t, uint32_t>> vertices; // room, vertex
        std::set<std::tuple<uint32_t, uint32_t, uint32_t>> edges;
        for (size_t i = 0; i < mesh_.patchCount(); ++i) {
            const auto corner = mesh_.patch(i);
            for (size_t k = 0; k < corner.size(); ++k) {
                const auto [a, b] = std::minmax(corner[k], corner[(k + 1) % corner.size()]);
                vertices.insert({mesh_.room[i], corner[k]});
                edges.insert({mesh_.room[i], a, b});
            }
            ++rooms_[mesh_.room[i]].euler;
        }
        for (const auto& [room, v] : vertices) ++rooms_[room].euler;
        for (const auto& [room, a, b] : edges) --rooms_[room].euler;
    }

    const PatchMesh& mesh_;
    Shells shells_;
    std::vector<RoomMeasures> rooms_;
};

std::vector<double> roomVolumes(const PatchMesh& mesh) {
    std::vector<double> volumes(roomCount(mesh), 0);
    for (size_t i = 0; i < mesh.patchCount(); ++i) // normals point into the air
        volumes[mesh.room[i]] -= glm::dot(patchAreaVector(mesh, i), patchCentroid(mesh, i)) / 6;
    return volumes;
}

bool sameGlass(const Material& a, const Material& b) {
    return a.transmittance == b.transmittance && a.refractiveIndex == b.refractiveIndex && a.blind == b.blind;
}

// Neighbours across an edge that go on in one pane: facets of a curved one bend, corners of a room turn.
bool oneGlass(const PatchMesh& mesh, size_t i, size_t j) {
    return mesh.room[i] == mesh.room[j] && glm::dot(patchNormal(mesh, i), patchNormal(mesh, j)) > kBend &&
           sameGlass(mesh.materials[mesh.material[i]], mesh.materials[mesh.material[j]]);
}

} // namespace

PatchMesh ownTriangles(const Building& building) {
    PatchMesh mesh;
    mesh.vertices = building.vertices;
    mesh.materials = building.materials;
    for (const Face& face : building.faces)
        for (const auto& t : triangulateFace(building, face))
            mesh.addPatch(t, face.material, face.role, face.surface, face.room);
    return mesh;
}

double meanDepth(const RoomMeasures& room) {
    return 2 * room.volume / room.surface;
}

bool isLikeInsideOfWalls(const RoomMeasures& room, double worldPerBuilding) {
    constexpr double kThin = 0.4; // metres
    return meanDepth(room) < kThin * worldPerBuilding && room.openings < 0.5 * room.surface;
}

bool isLikeFloorAndWalls(const RoomMeasures& room) {
    constexpr double kFilled = 0.45;
    return room.openings == 0 && room.volume < kFilled * room.overFloor;
}

std::vector<RoomMeasures> measureRooms(const PatchMesh& own, double worldPerBuilding) {
    return RoomMeasurer(own).measure(worldPerBuilding);
}

std::vector<RoomMeasures> measureVolumes(const PatchMesh& own) {
    return RoomMeasurer(own).measureOnlyVolumes();
}

VolumeError worstVolumeError(const PatchMesh& own, const PatchMesh& mesh) {
    const std::vector<double> whole = roomVolumes(own), meshed = roomVolumes(mesh);
    VolumeError worst;
    for (uint32_t r = 0; r < whole.size(); ++r)
        if (const double share = whole[r] > 0 ? meshed[r] / whole[r] - 1 : 0;
            std::abs(share) > std::abs(worst.share))
            worst = {r, share};
    return worst;
}

PaneCount countPanes(const PatchMesh& mesh) {
    DisjointSets panes(mesh.patchCount());
    std::vector<uint32_t> glass;
    std::multimap<std::pair<uint32_t, uint32_t>, uint32_t> atEdge;
    for (uint32_t i = 0; i < mesh.patchCount(); ++i) {
        if (!mesh.materials[mesh.material[i]].isOpening()) continue;
        glass.push_back(i);
        if (mesh.twin[i] != kNoTwin) panes.join(static_cast<uint32_t>(mesh.twin[i]), i);
        const auto corner = mesh.patch(i);
        for (size_t k = 0; k < corner.size(); ++k) {
            const auto edge = std::minmax(corner[k], corner[(k + 1) % corner.size()]);
            const auto [first, last] = atEdge.equal_range(edge);
            for (auto other = first; other != last; ++other)
                if (oneGlass(mesh, i, other->second)) panes.join(i, other->second);
            atEdge.emplace(edge, i);
        }
    }
    PaneCount count;
    std::set<uint32_t> seen;
    for (const uint32_t i : glass)
        if (seen.insert(panes.root(i)).second)
            ++(std::abs(patchNormal(mesh, i).y) > kLevel ? count.skylightPanes : count.windows);
    return count;
}

} // namespace heliodon::geometry
