#include "engine/app/work_plane.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/floors.h"

namespace heliodon::app {

namespace {

constexpr double kStep = 0.5;    // building metres: podiums and steps count as floor, table tops do not
constexpr double kInside = 1e-9; // of the extent, when a point lies on an edge of triangles

struct Room {
    glm::dvec3 low{1e300}, high{-1e300};
    std::vector<size_t> patches; // that a vertical line can cross
    std::set<size_t> lowest;     // of these, floor that lies over no other
    double lowestFloor = 1e300;
    std::vector<size_t> upper; // floor of storeys over others
};

std::vector<Room> roomsOf(const geometry::PatchMesh& mesh, double worldPerBuilding) {
    std::vector<Room> rooms;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (mesh.room[i] >= rooms.size()) rooms.resize(mesh.room[i] + 1);
        Room& room = rooms[mesh.room[i]];
        for (uint32_t corner : mesh.patch(i)) {
            room.low = glm::min(room.low, mesh.vertices[corner]);
            room.high = glm::max(room.high, mesh.vertices[corner]);
        }
        if (std::abs(geometry::patchNormal(mesh, i).y) > 1e-6) room.patches.push_back(i);
    }
    const geometry::Floors floors = geometry::findFloors(mesh, worldPerBuilding);
    for (const size_t i : floors.lowest) {
        Room& room = rooms[mesh.room[i]];
        room.lowest.insert(i);
        for (const uint32_t corner : mesh.patch(i))
            room.lowestFloor = std::min(room.lowestFloor, mesh.vertices[corner].y);
    }
    for (const size_t i : floors.upper) rooms[mesh.room[i]].upper.push_back(i);
    for (Room& room : rooms)
        if (room.lowest.empty()) room.lowestFloor = room.low.y;
    return rooms;
}

// Heights of a room's floors over (x, z), from the lowest; the first is NaN where there is only upper floor.
std::vector<double> floorsAt(const geometry::PatchMesh& mesh, const Room& room, double x, double z,
                             double step) {
    const glm::dvec3 extent = room.high - room.low;
    const double slack = kInside * (extent.x + extent.z) * (extent.x + extent.z);
    std::vector<double> floors{std::nan("")};
    for (size_t i : room.patches) {
        if (geometry::patchNormal(mesh, i).y < 0.9) continue;
        const double h = geometry::heightAt(mesh, i, x, z, slack);
        if (std::isnan(h) || h >= floors[0]) continue;
        if (room.lowest.contains(i) || (h >= room.lowestFloor && h <= room.lowestFloor + step)) floors[0] = h;
    }
    for (size_t i : room.upper)
        if (const double h = geometry::heightAt(mesh, i, x, z, slack); !std::isnan(h)) floors.push_back(h);
    std::sort(floors.begin() + 1, floors.end());
    // An edge lies on two patches.
    floors.erase(
        std::unique(floors.begin() + 1, floors.end(), [&](double a, double b) { return b < a + step; }),
        floors.end());
    return floors;
}

bool isFreeOver(const geometry::PatchMesh& mesh, const Room& room, double x, double z, double floor,
                double height) {
    const glm::dvec3 extent = room.high - room.low;
    const double slack = kInside * (extent.x + extent.z) * (extent.x + extent.z), clear = 1e-6 * extent.y;
    return std::ranges::none_of(room.patches, [&](size_t i) {
        const double h = geometry::heightAt(mesh, i, x, z, slack);
        return h > floor + clear && h <= floor + height + clear;
    });
}

std::vector<glm::dvec3> gridPoints(const geometry::PatchMesh& mesh, const std::vector<Room>& rooms,
                                   const WorkPlane& plane) {
    std::vector<glm::dvec3> points;
    const double spacing = plane.spacing * plane.worldPerBuilding;
    const double height = plane.height * plane.worldPerBuilding;
    for (const Room& room : rooms) {
        const glm::dvec3 extent = room.high - room.low;
        const auto cells = [&](double length) {
            return static_cast<size_t>(std::max(1.0, std::round(length / spacing)));
        };
        const size_t nx = cells(extent.x), nz = cells(extent.z);
        std::vector<std::vector<glm::dvec3>> storeys; // of the room, from the lowest
        for (size_t j = 0; j < nz; ++j)
            for (size_t k = 0; k < nx; ++k) {
                // Rows from the top of the plan down. A hair off the middle: seldom above an edge of the
                // mesh.
                const double x =
                    room.low.x + extent.x * (static_cast<double>(k) + 0.5) / static_cast<double>(nx);
                const double z =
                    room.low.z + extent.z * (static_cast<double>(j) + 0.5) / static_cast<double>(nz);
                const std::vector<double> floors = floorsAt(mesh, room, x, z, kStep * plane.worldPerBuilding);
                storeys.resize(std::max(storeys.size(), floors.size()));
                for (size_t f = 0; f < floors.size(); ++f)
                    if (!std::isnan(floors[f]) && isFreeOver(mesh, room, x, z, floors[f], height))
                        storeys[f].emplace_back(x, floors[f] + height, z);
            }
        for (const auto& storey : storeys) points.insert(points.end(), storey.begin(), storey.end());
    }
    return points;
}

} // namespace

glm::dvec3 modelFromWorld(glm::dvec3 p, geometry::UpAxis up) {
    return up == geometry::UpAxis::y ? p : glm::dvec3(p.x, 0.0 - p.z, p.y); // no negative zero
}

std::string WorkPlane::inWords() const {
    return fmt::format("work plane {:.2f} m above the floors", height);
}

SensorTable workPlaneSensors(const geometry::PatchMesh& mesh, geometry::UpAxis up, WorkPlane plane) {
    const std::vector<Room> rooms = roomsOf(mesh, plane.worldPerBuilding);
    double area = 0;
    for (const Room& room : rooms)
        for (size_t i : room.patches) area += std::max(0.0, 0.5 * geometry::patchAreaVector(mesh, i).y);
    const double wanted = area / std::pow(plane.spacing * plane.worldPerBuilding, 2);
    plane.spacing *= std::max(1.0, std::sqrt(wanted / static_cast<double>(plane.most)));
    SensorTable table;
    table.header = "x,y,z,nx,ny,nz";
    table.points = gridPoints(mesh, rooms, plane);
    table.normals.assign(table.points.size(), {0, 1, 0});
    const glm::dvec3 n = modelFromWorld({0, 1, 0}, up);
    for (glm::dvec3 p : table.points) {
        p = glm::round(modelFromWorld(p, up) * 1e6) / 1e6 + 0.0; // no negative zero
        table.rows.push_back(
            fmt::format("{:.6f},{:.6f},{:.6f},{:.0f},{:.0f},{:.0f}", p.x, p.y, p.z, n.x, n.y, n.z));
    }
    return table;
}

} // namespace heliodon::app
