#include "engine/app/room_plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "engine/app/plan_floors.h"
#include "engine/app/plan_frame.h"

namespace heliodon::app {

namespace {

using geometry::kMetresPerInch;

constexpr Ink kFloor{250, 244, 230}, kTriangle{214, 208, 196}, kGap{240, 130, 0}, kUnused{205, 205, 205},
    kUnusedName{110, 110, 110};

Ink inkOf(geometry::HeightClass height) {
    return height == geometry::HeightClass::red    ? Ink{240, 170, 164}
           : height == geometry::HeightClass::blue ? Ink{166, 190, 240}
                                                   : Ink{172, 220, 170};
}

// From inches on the table to the plan.
glm::dvec2 onTable(glm::dvec2 inches) {
    return kMetresPerInch * glm::dvec2(inches.x, -inches.y);
}

// A strip around a line of the table, as wide as the wall.
Points stripAround(const Points& line, double thickness) {
    Points left, right;
    for (size_t k = 0; k < line.size(); ++k) {
        const glm::dvec2 along =
                             glm::normalize(line[std::min(k + 1, line.size() - 1)] - line[k > 0 ? k - 1 : 0]),
                         out = 0.5 * thickness * glm::dvec2(-along.y, along.x);
        left.push_back(onTable(line[k] + out)), right.push_back(onTable(line[k] - out));
    }
    left.insert(left.end(), right.rbegin(), right.rend());
    return left;
}

struct DrawnWall {
    std::string id;
    Points strip;      // plan
    glm::dvec2 middle; // plan
    geometry::HeightClass height;
};

std::vector<DrawnWall> wallsOf(const geometry::Sketch& sketch) {
    std::vector<DrawnWall> walls;
    for (const geometry::Wall& w : sketch.walls)
        walls.push_back(
            {w.id, stripAround({w.a, w.b}, w.thickness), onTable(0.5 * (w.a + w.b)), w.heightClass});
    for (const geometry::Arc& a : sketch.arcs) {
        Points line;
        const double steps = std::ceil((a.a1Deg - a.a0Deg) / 5);
        for (double k = 0; k <= steps; ++k) {
            const double angle = glm::radians(a.a0Deg + k / steps * (a.a1Deg - a.a0Deg));
            line.push_back(a.center + a.radius * glm::dvec2(std::cos(angle), std::sin(angle)));
        }
        walls.push_back(
            {a.id, stripAround(line, a.thickness), onTable(line[line.size() / 2]), a.heightClass});
    }
    return walls;
}

class RoomPlan {
public:
    RoomPlan(const Scene& scene, const nlohmann::json& report, const std::vector<DrawnWall>& walls,
             Chart& chart)
        : scene_(scene), report_(report), walls_(walls), chart_(chart) {
        for (const nlohmann::json& wall : report.value("walls", nlohmann::json::array()))
            roles_[wall["id"]] = wall;
        findGaps();
    }

    void draw(const PlanFrame& frame, const std::vector<PlanFloor>& floors) {
        for (const PlanFloor& floor : floors) drawFloor(frame, floor);
        for (const DrawnWall& wall : walls_) drawWall(frame, wall);
        for (const PlanFloor& floor : floors) drawOutline(frame, floor);
        if (floors.empty() && scene_.sketch) drawOpeningsOf(frame, *scene_.sketch);
        if (scene_.sketch) drawTokens(frame, *scene_.sketch);
        for (const DrawnWall& wall : walls_)
            chart_.text(frame.pixel(wall.middle) + glm::dvec2(0, 3), wall.id, 9, Anchor::middle,
                        isUsed(wall) ? kBlack : kUnusedName, true);
        for (const PlanFloor& floor : floors) nameRoom(frame, floor);
    }
    bool hasGaps() const { return hasGaps_; }
    bool hasUnused() const { return hasUnused_; }

private:
    using Place = std::array<int64_t, 3>;
    static Place placeOf(glm::dvec3 p) {
        return {std::llround(p.x * 1e6), std::llround(p.y * 1e6), std::llround(p.z * 1e6)};
    }

    // Edges of upright fill-ins, as the floor that ends there has them.
    void findGaps() {
        const geometry::PatchMesh& mesh = scene_.mesh;
        for (size_t i = 0; i < mesh.patchCount(); ++i) {
            if (mesh.role[i] != geometry::Role::fillIn || mesh.materials[mesh.material[i]].isOpening() ||
                std::abs(geometry::patchNormal(mesh, i).y) > 0.5)
                continue;
            const auto corners = mesh.patch(i);
            for (size_t k = 0; k < corners.size(); ++k)
                gaps_.insert({placeOf(mesh.vertices[corners[(k + 1) % corners.size()]]),
                              placeOf(mesh.vertices[corners[k]])});
        }
    }

    void drawFloor(const PlanFrame& frame, const PlanFloor& floor) {
        const geometry::PatchMesh& mesh = scene_.mesh;
        for (size_t i : floor.patches) { // what stands on a floor, as a table, hides it
            Points outline;
            for (uint32_t corner : mesh.patch(i)) outline.push_back(frame.pixel(flat(mesh.vertices[corner])));
            chart_.fill(outline, kFloor);
            outline.push_back(outline.front());
            chart_.line(std::move(outline), kTriangle, 0.5);
        }
    }

    bool isUsed(const DrawnWall& wall) const {
        const auto entry = roles_.find(wall.id);
        return entry == roles_.end() ||
               (entry->second["role"] != "ignored" && entry->second["role"] != "outside_extra");
    }

    void drawWall(const PlanFrame& frame, const DrawnWall& wall) {
        Points strip;
        for (const glm::dvec2& p : wall.strip) strip.push_back(frame.pixel(p));
        chart_.fill(strip, isUsed(wall) ? inkOf(wall.height) : kUnused);
        hasUnused_ |= !isUsed(wall);
        const auto entry = roles_.find(wall.id);
        if (entry == roles_.end()) return;
        const std::string reason = entry->second.value("reason", "");
        chart_.explain(wall.id + ": " + entry->second["role"].get<std::string>() +
                       (reason.empty() ? "" : ", " + reason));
    }

    void drawOutline(const PlanFrame& frame, const PlanFloor& floor) {
        for (const auto& [a, b] : floor.outline) {
            const bool gap = gaps_.contains({placeOf(a), placeOf(b)});
            hasGaps_ |= gap;
            chart_.line({frame.pixel(flat(a)), frame.pixel(flat(b))}, gap ? kGap : kBlack, gap ? 3 : 1.5);
        }
        for (const auto& [a, b] : floor.openings)
            chart_.line({frame.pixel(flat(a)), frame.pixel(flat(b))}, kOpeningInk, 3);
    }

    // As they were drawn, where no room has them.
    void drawOpeningsOf(const PlanFrame& frame, const geometry::Sketch& sketch) {
        for (const geometry::WindowMarker& window : sketch.windows) {
            const auto wall = std::ranges::find(sketch.walls, window.wall, &geometry::Wall::id);
            if (wall == sketch.walls.end()) continue;
            const glm::dvec2 along = glm::normalize(wall->b - wall->a);
            chart_.line({frame.pixel(onTable(wall->a + (window.pos - 0.5 * window.width) * along)),
                         frame.pixel(onTable(wall->a + (window.pos + 0.5 * window.width) * along))},
                        kOpeningInk, 3);
        }
        for (const geometry::Skylight& light : sketch.skylights) {
            const double angle = glm::radians(light.angleDeg);
            const glm::dvec2 u = 0.5 * light.size.x * glm::dvec2(std::cos(angle), std::sin(angle)),
                             v = 0.5 * light.size.y * glm::dvec2(-std::sin(angle), std::cos(angle));
            Points outline;
            for (const glm::dvec2& p : {u + v, v - u, -u - v, u - v, u + v})
                outline.push_back(frame.pixel(onTable(light.center + p)));
            chart_.line(std::move(outline), kOpeningInk, 3);
        }
    }

    void drawTokens(const PlanFrame& frame, const geometry::Sketch& sketch) {
        for (const geometry::Token& token : sketch.tokens) {
            const glm::dvec2 p = frame.pixel(onTable(token.pos));
            const Ink rim = token.kind == geometry::TokenKind::floor     ? Ink{0, 150, 60}
                            : token.kind == geometry::TokenKind::wallAll ? Ink{40, 80, 200}
                                                                         : Ink{200, 40, 40};
            chart_.rectangle(p.x - 7, p.y - 7, 14, 14, rim);
            chart_.rectangle(p.x - 4, p.y - 4, 8, 8,
                             {static_cast<uint8_t>(token.rgb[0]), static_cast<uint8_t>(token.rgb[1]),
                              static_cast<uint8_t>(token.rgb[2])});
        }
    }

    // Where the floor is widest, so far as middles of its triangles tell.
    void nameRoom(const PlanFrame& frame, const PlanFloor& floor) {
        double best = -1;
        glm::dvec2 at(0);
        for (size_t i : floor.patches) {
            const glm::dvec2 p = frame.pixel(flat(geometry::patchCentroid(scene_.mesh, i)));
            double clear = 1e300;
            for (const auto& [a, b] : floor.outline)
                clear =
                    std::min(clear, glm::distance(0.5 * (frame.pixel(flat(a)) + frame.pixel(flat(b))), p));
            if (clear > best) best = clear, at = p;
        }
        if (best < 0) return;
        const nlohmann::json& rooms = report_["rooms"];
        const bool ample = best > 40 && floor.room < rooms.size();
        const std::string name = fmt::format("room {}", floor.room);
        chart_.text(at + glm::dvec2(0, ample ? -3 : 3), name, ample ? 12 : 9, Anchor::middle, kBlack, true);
        if (!ample) return;
        const double feet = rooms[floor.room]["floor_area"], high = rooms[floor.room]["ceiling"];
        const double perFoot = geometry::kMetresPerFoot;
        chart_.text(
            at + glm::dvec2(0, 12),
            fmt::format("{:.0f} ft² ({:.3g} m²), {:.3g} ft high", feet, feet * perFoot * perFoot, high), 10,
            Anchor::middle, kBlack, true);
    }

    const Scene& scene_;
    const nlohmann::json& report_;
    const std::vector<DrawnWall>& walls_;
    Chart& chart_;
    std::map<std::string, nlohmann::json> roles_; // by the walls' names
    std::set<std::pair<Place, Place>> gaps_;
    bool hasGaps_ = false, hasUnused_ = false;
};

} // namespace

Chart roomPlan(const Scene& scene, const nlohmann::json& report, const std::string& title) {
    const std::vector<DrawnWall> walls = scene.sketch ? wallsOf(*scene.sketch) : std::vector<DrawnWall>{};
    const std::vector<PlanFloor> floors =
        scene.mesh.patchCount() > 0 ? planFloors(scene, {}) : std::vector<PlanFloor>{};
    glm::dvec2 low(1e300), high(-1e300);
    const auto hold = [&](glm::dvec2 p) { low = glm::min(low, p), high = glm::max(high, p); };
    for (const DrawnWall& wall : walls) std::ranges::for_each(wall.strip, hold);
    for (const glm::dvec3& p : scene.mesh.vertices) hold(flat(p));
    if (low.x > high.x) hold(glm::dvec2(0)), hold(glm::dvec2(1));
    size_t storeys = 1;
    for (const PlanFloor& floor : floors) storeys = std::max(storeys, floor.storey + 1);
    const PlanFrame first(low, high, 0, storeys, 0);
    Chart chart = first.chart();
    RoomPlan plan(scene, report, walls, chart);
    for (size_t storey = 0; storey < storeys; ++storey) {
        std::vector<PlanFloor> here;
        std::ranges::copy_if(floors, std::back_inserter(here),
                             [&](const PlanFloor& floor) { return floor.storey == storey; });
        const PlanFrame frame(low, high, storey, storeys, 0);
        if (storeys > 1) frame.caption(chart, storeyInWords(here, scene.worldPerBuilding));
        plan.draw(frame, here);
    }
    first.title(chart, title, report.value("code", "") + ": " + report.value("message", ""));
    first.foot(chart, scene.worldPerBuilding, scene.northDeg);
    std::vector<PlanFrame::Key> keys{{kOpeningInk, 3, "opening"}};
    if (plan.hasGaps()) keys.push_back({kGap, 3, "filled gap"});
    if (plan.hasUnused()) keys.push_back({kUnused, 7, "bounds no room"});
    first.keys(chart, keys);
    return chart;
}

} // namespace heliodon::app
