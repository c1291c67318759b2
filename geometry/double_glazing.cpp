#include "geometry/double_glazing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "geometry/face_soup.h"
#include "geometry/kept_rooms.h"
#include "geometry/outline_area.h"
#include "geometry/twin_faces.h"

namespace heliodon::geometry {

namespace {

constexpr double kMostlyGlass = 0.8;

struct Side {
    std::vector<uint32_t> faces; // of the space, all of one glass
    size_t twins = 0;
    uint32_t material(const Building& building) const { return building.faces[faces[0]].material; }
};

class PaneJoiner {
public:
    PaneJoiner(Building& building, double deepest, double tolerance)
        : building_(building), deepest_(deepest), tolerance_(tolerance), facesOf_(building.roomCount),
          isRoom_(building.roomCount, true), drawnMaterials_(building.materials.size()) {
        for (uint32_t f = 0; f < building.faces.size(); ++f) facesOf_[building.faces[f].room].push_back(f);
    }

    DoubleGlazing join() {
        for (bool changed = true; changed;) { // of three panes the inner space may follow the outer one
            changed = false;
            for (uint32_t room = 0; room < building_.roomCount; ++room)
                if (isRoom_[room] && joinRound(room)) isRoom_[room] = false, changed = true;
        }
        if (out_.spaces == 0) return out_;
        keepRooms(building_, isRoom_);
        settleMaterials();
        return out_;
    }

private:
    Face& face(uint32_t f) const { return building_.faces[f]; }
    Face& twinOf(uint32_t f) const { return face(static_cast<uint32_t>(face(f).twin)); }

    bool isGlass(uint32_t f) const { return building_.materials[face(f).material].isOpening(); }

    glm::dvec3 areaOf(const Face& of) const {
        glm::dvec3 sum(0);
        for (const auto& loop : of.loops) sum += 0.5 * areaVector(building_.vertices, loop);
        return sum;
    }

    bool joinRound(uint32_t room) {
        std::array<Side, 2> sides;
        const std::optional<double> depth = sidesOf(room, sides);
        if (!depth) return false;
        Side &inner = sides[sides[0].twins > 0 ? 0 : 1], &outer = sides[sides[0].twins > 0 ? 1 : 0];
        if (inner.twins != inner.faces.size() || (outer.twins != 0 && outer.twins != outer.faces.size()))
            return false;
        if (outer.twins > 0) {
            if (!joinBetweenRooms(inner, outer)) return false;
        } else {
            const uint32_t second = outer.material(building_);
            for (const uint32_t f : inner.faces) {
                Face& pane = twinOf(f);
                pane.material = joined(pane.material, second);
                pane.twin = kNoTwin;
            }
            addOutside(room);
        }
        ++out_.spaces;
        out_.deepest = std::max(out_.deepest, *depth);
        return true;
    }

    // How deep the space is; none where it does not lie between two panes.
    std::optional<double> sidesOf(uint32_t room, std::array<Side, 2>& sides) const {
        const std::vector<uint32_t>& faces = facesOf_[room];
        const auto first = std::ranges::find_if(faces, [&](uint32_t f) { return isGlass(f); });
        if (first == faces.end()) return std::nullopt;
        const glm::dvec3 normal = glm::normalize(areaOf(face(*first)));
        double all = 0, glass = 0, low = std::numeric_limits<double>::infinity(), high = -low;
        for (const uint32_t f : faces) {
            const glm::dvec3 vector = areaOf(face(f));
            const double along = glm::dot(vector, normal), area = glm::length(vector);
            all += std::abs(along); // the rim, which is no wider than the space is deep, does not count
            if (!isGlass(f)) continue;
            if (!(std::abs(along) > -kBackToBack * area)) return std::nullopt;
            Side& side = sides[along > 0 ? 0 : 1];
            side.faces.push_back(f);
            glass += std::abs(along);
            side.twins += face(f).twin != kNoTwin && twinOf(f).room != room;
            if (face(f).material != side.material(building_)) return std::nullopt;
            for (const uint32_t v : face(f).loops[0]) {
                const double at = glm::dot(building_.vertices[v], normal);
                low = std::min(low, at), high = std::max(high, at);
            }
        }
        const bool isBetween =
            !sides[0].faces.empty() && !sides[1].faces.empty() && glass > kMostlyGlass * all;
        return isBetween && high - low <= deepest_ + tolerance_ ? std::optional(high - low) : std::nullopt;
    }

    bool joinBetweenRooms(const Side& a, const Side& b) {
        std::vector<std::pair<uint32_t, uint32_t>> pairs;
        std::vector<uint32_t> left = b.faces;
        for (const uint32_t f : a.faces) {
            const auto found = std::ranges::find_if(left, [&](uint32_t g) {
                return twinOf(f).room != twinOf(g).room &&
                       oppositeLoops(building_, twinOf(f), twinOf(g), tolerance_);
            });
            if (found == left.end()) return false;
            pairs.emplace_back(face(f).twin, face(*found).twin);
            left.erase(found);
        }
        if (!left.empty()) return false;
        for (const auto& [f, g] : pairs) {
            const uint32_t ofF = face(f).material, ofG = face(g).material;
            face(f).twin = static_cast<int32_t>(g), face(g).twin = static_cast<int32_t>(f);
            face(f).material = joined(ofF, ofG), face(g).material = joined(ofG, ofF);
        }
        return true;
    }

    void addOutside(uint32_t room) {
        Occluders& outside = building_.outside;
        for (const uint32_t f : facesOf_[room]) {
            if (isGlass(f)) continue;
            for (const auto& triangle : triangulateFace(building_, face(f))) {
                for (const uint32_t v : triangle) {
                    outside.triangles.push_back(static_cast<uint32_t>(outside.vertices.size()));
                    outside.vertices.push_back(building_.vertices[v]);
                }
                outside.material.push_back(face(f).material);
            }
        }
    }

    // Of a pane before another one, seen from the room.
    uint32_t joined(uint32_t pane, uint32_t behind) {
        const auto [place, isNew] =
            made_.try_emplace({pane, behind}, static_cast<uint32_t>(building_.materials.size()));
        if (!isNew) return place->second;
        Material material = building_.materials[pane];
        const Material other = building_.materials[behind];
        material.name += "+" + other.name;
        material.transmittance *= other.transmittance;
        material.refractiveIndex = std::max(material.refractiveIndex, other.refractiveIndex);
        if (material.blind == Blind{}) material.blind = other.blind;
        building_.materials.push_back(std::move(material));
        const uint32_t a = drawnOf(pane), b = drawnOf(behind);
        alone_.push_back(a == b ? a : kSeveral);
        return place->second;
    }

    // The one material that all panes were drawn with.
    uint32_t drawnOf(uint32_t material) const {
        return material < drawnMaterials_ ? material : alone_[material - drawnMaterials_];
    }

    // A glass of which no pane is left alone keeps its name, for --blinds.
    void settleMaterials() {
        std::vector<Material>& materials = building_.materials;
        std::vector<bool> isUsed(materials.size(), false);
        for (const Face& one : building_.faces) isUsed[one.material] = true;
        std::vector<uint32_t> place(materials.size());
        std::iota(place.begin(), place.end(), 0u);
        size_t kept = drawnMaterials_;
        for (size_t m = drawnMaterials_; m < materials.size(); ++m) {
            if (!isUsed[m]) continue;
            const uint32_t drawn = drawnOf(static_cast<uint32_t>(m));
            if (drawn != kSeveral && !isUsed[drawn]) {
                materials[m].name = materials[drawn].name;
                materials[drawn] = materials[m];
                isUsed[drawn] = true;
                place[m] = drawn;
            } else {
                place[m] = static_cast<uint32_t>(kept);
                materials[kept++] = materials[m];
            }
        }
        materials.resize(kept);
        for (Face& one : building_.faces) one.material = place[one.material];
    }

    static constexpr uint32_t kSeveral = UINT32_MAX;

    Building& building_;
    double deepest_, tolerance_;
    std::vector<std::vector<uint32_t>> facesOf_; // per room
    std::vector<bool> isRoom_;                   // and no space between panes
    size_t drawnMaterials_;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> made_;
    std::vector<uint32_t> alone_; // per material that is made: drawnOf()
    DoubleGlazing out_;
};

} // namespace

DoubleGlazing joinPanes(Building& building, double deepest, double tolerance) {
    return PaneJoiner(building, deepest, tolerance).join();
}

} // namespace heliodon::geometry
