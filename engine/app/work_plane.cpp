#include "engine/app/work_plane.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace heliodon::app {

namespace {

constexpr double kStep = 0.5;    // building metres: podiums and steps count as floor, table tops do not
constexpr double kInside = 1e-9; // of the extent, when a point lies on an edge of triangles

struct Room {
    glm::dvec3 low{1e300}, high{-1e300};
    std::vector<size_t> patches; // that a vertical line can cross
};

// Height at which a vertical line crosses a patch; NaN beside it.
double heightAt(const geometry::PatchMesh& mesh, size_t i, double x, double z, double slack) {
    const auto corners = mesh.patch(i);
    const glm::dvec3 normal = geometry::patchNormal(mesh, i);
    const double sign = normal.y > 0 ? 1 : -1;
    for (size_t k = 0; k < corners.size(); ++k) {
        const glm::dvec3 a = mesh.vertices[corners[k]], b = mesh.vertices[corners[(k + 1) % corners.size()]];
        // Seen from above x is right and z down: counter-clockwise about +y.
        const double side = (b.z - a.z) * (x - a.x) - (b.x - a.x) * (z - a.z);
        if (sign * side < -slack) return std::nan("");
    }
    const glm::dvec3 p = mesh.vertices[corners[0]];
    return p.y - (normal.x * (x - p.x) + normal.z * (z - p.z)) / normal.y;
}

std::vector<Room> roomsOf(const geometry::PatchMesh& mesh) {
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
    return rooms;
}

// The work plane's point over (x, z) of a room, if there is one.
bool pointOver(const geometry::PatchMesh& mesh, const Room& room, double x, double z, double height,
               double step, glm::dvec3& point) {
    const glm::dvec3 extent = room.high - room.low;
    const double slack = kInside * (extent.x + extent.z) * (extent.x + extent.z);
    double floor = std::nan("");
    for (size_t i : room.patches) {
        if (geometry::patchNormal(mesh, i).y < 0.9) continue;
        const double h = heightAt(mesh, i, x, z, slack);
        if (h <= room.low.y + step && !(h >= floor)) floor = h;
    }
    if (std::isnan(floor)) return false;
    const double clear = 1e-6 * extent.y;
    for (size_t i : room.patches) {
        const double h = heightAt(mesh, i, x, z, slack);
        if (h > floor + clear && h <= floor + height + clear) return false;
    }
    point = {x, floor + height, z};
    return true;
}

std::vector<glm::dvec3> gridPoints(const geometry::PatchMesh& mesh, const std::vector<Room>& rooms,
                                   const WorkPlane& plane) {
    std::vector<glm::dvec3> points;
    const double spacing = plane.spacing * plane.worldPerBuilding;
    for (const Room& room : rooms) {
        const glm::dvec3 extent = room.high - room.low;
        const auto cells = [&](double length) {
            return static_cast<size_t>(std::max(1.0, std::round(length / spacing)));
        };
        const size_t nx = cells(extent.x), nz = cells(extent.z);
        for (size_t j = 0; j < nz; ++j)
            for (size_t k = 0; k < nx; ++k) {
                // Rows from the top of the plan down. A hair off the middle: seldom above an edge of the
                // mesh.
                const double x =
                    room.low.x + extent.x * (static_cast<double>(k) + 0.5) / static_cast<double>(nx);
                const double z =
                    room.low.z + extent.z * (static_cast<double>(j) + 0.5) / static_cast<double>(nz);
                glm::dvec3 point;
                if (pointOver(mesh, room, x, z, plane.height * plane.worldPerBuilding,
                              kStep * plane.worldPerBuilding, point))
                    points.push_back(point);
            }
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
    const std::vector<Room> rooms = roomsOf(mesh);
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
