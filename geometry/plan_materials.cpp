#include "geometry/plan_materials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <tuple>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/segment_distance.h"
#include "geometry/srgb.h"

namespace heliodon::geometry {

namespace {

// Linear reflectance of a paint chip: sRGB 0..255 per channel, clamped below 0.95.
glm::vec3 chipReflectance(const std::array<double, 3>& rgb) {
    glm::vec3 out;
    for (int c = 0; c < 3; ++c)
        out[c] = static_cast<float>(std::min(linearOfSrgb(rgb[static_cast<size_t>(c)]), 0.949));
    return out;
}

double distanceToPiece(glm::dvec2 p, const WallPiece& piece) {
    if (!piece.curved) return distanceToSegment(p, piece.a, piece.b);
    const double middle = (piece.a0 + piece.a1) / 2, half = (piece.a1 - piece.a0) / 2;
    const double angle = std::atan2(p.y - piece.center.y, p.x - piece.center.x);
    if (std::abs(std::remainder(angle - middle, 2 * std::numbers::pi)) <= half)
        return std::abs(glm::length(p - piece.center) - piece.radius);
    return std::min(glm::length(p - piece.a), glm::length(p - piece.b));
}

double distanceToRoom(glm::dvec2 p, const RoomPlan& room) {
    if (contains(room, p)) return 0;
    double nearest = std::numeric_limits<double>::infinity();
    for (const OutlineLoop& loop : room.loops) nearest = std::min(nearest, distanceToLoop(p, loop.points));
    return nearest;
}

class MaterialPlanner {
public:
    MaterialPlanner(const Sketch& sketch, const PlanWalls& plan, const std::vector<RoomPlan>& rooms,
                    const std::vector<WallRun>& runs, const ClosureOptions& options)
        : plan_(plan), rooms_(rooms), runs_(runs), options_(options), tokens_(sketch.tokens) {
        // Their order in the file must not matter.
        std::ranges::sort(tokens_, {},
                          [](const Token& t) { return std::tuple(t.pos.x, t.pos.y, t.kind, t.rgb); });
    }

    PlanMaterials make() {
        const uint32_t ceiling = add("ceiling", options_.ceilingReflectance);
        Material glass;
        glass.name = "glazing";
        glass.transmittance = glm::vec3(options_.glazingTransmittance);
        out_.materials.push_back(glass);
        const auto glazing = static_cast<uint32_t>(out_.materials.size() - 1);
        std::vector<uint32_t> wallOfRoom;
        for (const RoomPlan& room : rooms_) {
            const Token* floor = nearest(TokenKind::floor, room);
            const Token* walls = nearest(TokenKind::wallAll, room);
            used_.insert({floor, walls});
            out_.rooms.push_back(
                {add("floor", floor ? chipReflectance(floor->rgb) : options_.floorReflectance), ceiling,
                 glazing});
            wallOfRoom.push_back(add("wall", walls ? chipReflectance(walls->rgb) : options_.wallReflectance));
        }
        paintSingles();
        for (const WallRun& run : runs_) {
            const Paint* paint = paintOf(run);
            if (paint) used_.insert(paint->token);
            out_.runs.push_back(paint ? paint->material : wallOfRoom[run.room]);
        }
        for (size_t i = 0; i < plan_.partitions.size(); ++i) {
            const WallPiece& piece = plan_.partitions[i];
            const auto found = singles_.find(i + plan_.pieces.size());
            if (found != singles_.end() && isInRoom(piece)) used_.insert(found->second.token);
            out_.partitions.push_back(found != singles_.end() ? found->second.material
                                                              : wallOfRoom[roomOf(piece)]);
        }
        for (const Token& token : tokens_) noteUnused(token);
        return std::move(out_);
    }

private:
    struct Paint {
        uint32_t material = 0;
        const Token* token = nullptr;
    };

    uint32_t add(const std::string& kind, glm::vec3 reflectance) {
        int copies = 0;
        for (size_t i = 0; i < out_.materials.size(); ++i) {
            if (!out_.materials[i].name.starts_with(kind)) continue;
            if (out_.materials[i].reflectance == reflectance && !out_.materials[i].isOpening())
                return static_cast<uint32_t>(i);
            ++copies;
        }
        Material material;
        material.name = copies == 0 ? kind : kind + std::to_string(copies + 1);
        material.reflectance = reflectance;
        out_.materials.push_back(material);
        return static_cast<uint32_t>(out_.materials.size() - 1);
    }

    const Token* nearest(TokenKind kind, const RoomPlan& room) const {
        const Token* best = nullptr;
        double least = std::numeric_limits<double>::infinity();
        for (const Token& token : tokens_)
            if (token.kind == kind)
                if (const double d = distanceToRoom(token.pos, room); d < least) {
                    least = d;
                    best = &token;
                }
        return best;
    }

    size_t roomOf(const WallPiece& partition) const {
        size_t best = 0;
        double least = std::numeric_limits<double>::infinity();
        for (size_t r = 0; r < rooms_.size(); ++r)
            if (const double d = distanceToRoom(0.5 * (partition.a + partition.b), rooms_[r]); d < least) {
                least = d;
                best = r;
            }
        return best;
    }

    bool isInRoom(const WallPiece& piece) const {
        for (const glm::dvec2 p : {piece.a, piece.b, 0.5 * (piece.a + piece.b)})
            if (std::ranges::any_of(rooms_, [&](const RoomPlan& room) { return contains(room, p); }))
                return true;
        return false;
    }

    const WallPiece& pieceAt(size_t i) const {
        return i < plan_.pieces.size() ? plan_.pieces[i] : plan_.partitions[i - plan_.pieces.size()];
    }

    size_t nearestPiece(const Token& token) const {
        size_t best = 0;
        double least = std::numeric_limits<double>::infinity();
        for (size_t i = 0; i < plan_.pieces.size() + plan_.partitions.size(); ++i)
            if (const double d = distanceToPiece(token.pos, pieceAt(i)); d < least) {
                least = d;
                best = i;
            }
        return best;
    }

    void paintSingles() {
        for (const Token& token : tokens_)
            if (token.kind == TokenKind::wallSingle)
                singles_[nearestPiece(token)] = {add("painted wall", chipReflectance(token.rgb)), &token};
    }

    // A side made of several pieces is one wall: paint on one of them is paint on all, and on its ends.
    const Paint* paintOf(const WallRun& run) const {
        if (run.line < 0 && run.curved < 0) return paintOfEnd(run);
        for (const auto& [piece, paint] : singles_) {
            if (piece >= plan_.pieces.size()) continue;
            const WallPiece& wall = plan_.pieces[piece];
            if (wall.curved ? run.curved == static_cast<int>(piece)
                            : run.line == wall.line && overlaps(run, wall))
                return &paint;
        }
        return nullptr;
    }

    const Paint* paintOfEnd(const WallRun& end) const {
        const std::vector<OutlineEdge>& edges = rooms_[end.room].loops[end.loop].edges;
        for (size_t k = 0; k < end.count; ++k) {
            const int piece = edges[(end.first + k) % edges.size()].piece;
            if (piece < 0) continue;
            const WallPiece& wall = plan_.pieces[static_cast<size_t>(piece)];
            for (const WallRun& run : runs_)
                if (run.line >= 0 && run.line == wall.line && overlaps(run, wall))
                    if (const Paint* paint = paintOf(run)) return paint;
        }
        return nullptr;
    }

    // Where another one gives the same colour nothing is lost.
    void noteUnused(const Token& token) {
        std::string why;
        if (token.kind == TokenKind::wallSingle) {
            if (used_.contains(&token)) return;
            const size_t nearest = nearestPiece(token);
            const WallPiece& piece = pieceAt(nearest);
            const Token* other = singles_.at(nearest).token;
            for (const WallRun& run : runs_)
                if (nearest < plan_.pieces.size() && run.line >= 0 && run.line == piece.line &&
                    overlaps(run, piece))
                    other = paintOf(run)->token;
            const std::string& wall = std::ranges::min(piece.ids);
            if (other == &token)
                why = fmt::format("the nearest wall, {}, is in no room", wall);
            else if (other->rgb != token.rgb)
                why = fmt::format("the wall {} has the colour of {}", wall, other->id);
        } else if (std::ranges::none_of(used_, [&](const Token* other) {
                       return other && other->kind == token.kind && other->rgb == token.rgb;
                   }))
            why = fmt::format("every room has the colour of its {} from another one",
                              token.kind == TokenKind::floor ? "floor" : "walls");
        if (!why.empty())
            out_.notes.push_back(
                {"TOKEN_UNUSED", fmt::format("token {} colours nothing: {}", token.id, why)});
    }

    bool overlaps(const WallRun& run, const WallPiece& wall) const {
        const WallLine& line = plan_.lines[static_cast<size_t>(wall.line)];
        const auto [low, high] = std::minmax({line.along(run.from), line.along(run.to)});
        return line.along(wall.a) < high && line.along(wall.b) > low;
    }

    const PlanWalls& plan_;
    const std::vector<RoomPlan>& rooms_;
    const std::vector<WallRun>& runs_;
    const ClosureOptions& options_;
    std::vector<Token> tokens_;
    std::map<size_t, Paint> singles_; // by piece, or count of pieces + partition
    std::set<const Token*> used_;
    PlanMaterials out_;
};

} // namespace

PlanMaterials planMaterials(const Sketch& sketch, const PlanWalls& plan, const std::vector<RoomPlan>& rooms,
                            const std::vector<WallRun>& runs, const ClosureOptions& options) {
    return MaterialPlanner(sketch, plan, rooms, runs, options).make();
}

} // namespace heliodon::geometry
