// A model file -> closed rooms. What is repaired is what has one answer: corners that were meant to be one,
// edges that another face's corner divides, boxes that stand on a face without it being cut, faces turned
// over. Everything else is refused with the faces named.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/disjoint_sets.h"
#include "geometry/face_soup.h"
#include "geometry/glass_pairs.h"
#include "geometry/input_error.h"
#include "geometry/model_file.h"
#include "geometry/outline_area.h"
#include "geometry/perpendicular.h"
#include "geometry/plan_arrangement.h"
#include "geometry/plan_regions.h"
#include "geometry/raw_model.h"
#include "geometry/shared_walls.h"
#include "geometry/shell_faces.h"
#include "geometry/shell_nesting.h"

namespace heliodon::geometry {

namespace {

constexpr double kWeldOfExtent = 2e-6; // files hold 6 or 7 digits
// Where that leaves the model open: gaps that nobody sees, 0.5 mm in a room of 5 m.
constexpr std::array kGapsOfExtent{kWeldOfExtent, 2e-5, 1e-4};
constexpr double kPlanarOfExtent = 1e-5;
constexpr double kLeastRoomOfExtent = 1e-15; // of its cube: less is what rounding leaves

template<class Loops>
std::vector<std::vector<glm::dvec3>> placed(const std::vector<glm::dvec3>& vertices, const Loops& loops) {
    std::vector<std::vector<glm::dvec3>> out;
    for (const auto& loop : loops) {
        out.emplace_back();
        for (const uint32_t v : loop) out.back().push_back(vertices[v]);
    }
    return out;
}

class ModelImporter {
public:
    ModelImporter(const std::filesystem::path& file, UpAxis up) : model_(readRawModel(file)) {
        glm::dvec3 low(1e300), high(-1e300);
        for (glm::dvec3& p : model_.vertices) p = worldFromModel(p, up);
        for (const uint32_t v : model_.corners) {
            low = glm::min(low, model_.vertices[v]);
            high = glm::max(high, model_.vertices[v]);
        }
        extent_ = glm::length(high - low);
        if (!(extent_ > 0)) throw InputError(model_.file, model_.place(0), "all faces lie in one point");
    }

    Building import() {
        try {
            weld();
            closeGaps();
            cutFootprints();
            orient();
            nestShells();
            splitSharedCorners();
            finish();
            prove();
        } catch (const InputError&) {
            if (!shareWalls()) throw;
        }
        return std::move(building_);
    }

private:
    void finish() {
        findSurfaces();
        building_.materials = model_.materials;
        for (const auto& [a, b] : pairGlasses(building_, kPlanarOfExtent * extent_, extent_))
            refuse({a, b}, "the glass has another shape than that on the other side of its wall");
        if (turnedOver_ > 0)
            building_.repairs.push_back(
                fmt::format("{} face{} turned over", turnedOver_, turnedOver_ == 1 ? " was" : "s were"));
    }

    bool isOpening(uint32_t source) const { return model_.materials[model_.material[source]].isOpening(); }

    // Rooms whose common walls have no thickness; false when that is not what kept them from closing.
    bool shareWalls() {
        const auto space = divideSpace(soup(), kWeldOfExtent * extent_);
        if (!space || proveShells(space->outside)[0].selfIntersecting) return false;
        for (const auto& [one, other] : space->pairs)
            if (isOpening(one) != isOpening(other))
                throw InputError(
                    model_.file, model_.place(one),
                    fmt::format("an opening and a wall ({}) lie on one another", model_.place(other)));
        building_ = weldFaces(space->faces, space->rooms, kWeldOfExtent * extent_);
        source_.clear();
        for (const Face& face : building_.faces) source_.push_back(face.surface);
        turnedOver_ = 0;
        building_.repairs.insert(building_.repairs.end(), space->repairs.begin(), space->repairs.end());
        building_.warnings = space->warnings;
        finish();
        try {
            proveRooms();
            return true;
        } catch (const InputError&) { // what was wrong before says more
            return false;
        }
    }

    glm::dvec3 areaOf(const std::vector<uint32_t>& loop) const {
        return areaVector(building_.vertices, loop);
    }

    glm::dvec3 normal(const Face& face) const { return glm::normalize(areaOf(face.loops[0])); }

    // "role" of a group that writeModel named ("room0_fill-in"), else projection.
    Role roleOf(size_t face) const {
        return model_.groups[model_.group[face]].ends_with("_fill-in") ? Role::fillIn : Role::projection;
    }

    // A wider tolerance, only when the model is open without it and closed with it.
    void closeGaps() {
        for (const double gap : kGapsOfExtent) {
            if (gap > kWeldOfExtent && !weldsWithin(gap)) continue;
            const auto edges = facesOfEdges(building_);
            if (!building_.faces.empty() &&
                std::ranges::none_of(edges, [](const auto& entry) { return entry.second.size() == 1; })) {
                if (gap > kWeldOfExtent)
                    building_.repairs.push_back(
                        fmt::format("gaps of up to {:.2g} between corners were closed", gap * extent_));
                return;
            }
        }
        // Open whatever the tolerance: it may stand uncut on another face, or be refused by name.
        weldOfExtent_ = kWeldOfExtent;
        weld();
    }

    bool weldsWithin(double gap) {
        weldOfExtent_ = gap;
        try {
            weld();
            return true;
        } catch (const InputError&) { // a face that this bends too far
            return false;
        }
    }

    std::vector<SoupFace> soup() const {
        std::vector<SoupFace> soup;
        for (size_t i = 0; i < model_.faceCount(); ++i) {
            // The surface carries the number of the face through the welding.
            soup.push_back({placed(model_.vertices, model_.loops(i)), model_.material[i], roleOf(i),
                            static_cast<uint32_t>(i)});
        }
        return soup;
    }

    void weld() {
        source_.clear();
        building_ = weldFaces(soup(), 1, weldOfExtent_ * extent_);
        std::set<std::vector<uint32_t>> known;
        size_t dropped = model_.faceCount() - building_.faces.size(); // fewer than three corners are left
        dropped += std::erase_if(building_.faces, [&](const Face& face) {
            std::vector<uint32_t> corners;
            for (const auto& loop : face.loops) corners.insert(corners.end(), loop.begin(), loop.end());
            std::ranges::sort(corners);
            const double size = glm::length(areaOf(face.loops[0]));
            return size < 1e-12 * extent_ * extent_ || !known.insert(corners).second; // no area, or a copy
        });
        if (dropped > 0)
            building_.repairs.push_back(fmt::format("{} face{} without area or drawn twice {} left out",
                                                    dropped, dropped == 1 ? "" : "s",
                                                    dropped == 1 ? "was" : "were"));
        for (const Face& face : building_.faces) {
            source_.push_back(face.surface);
            checkPlanar(face);
        }
    }

    void checkPlanar(const Face& face) const {
        const glm::dvec3 n = normal(face), origin = building_.vertices[face.loops[0][0]];
        const double most = std::max(kPlanarOfExtent, 2 * weldOfExtent_) * extent_;
        for (const auto& loop : face.loops)
            for (const uint32_t v : loop)
                if (std::abs(glm::dot(building_.vertices[v] - origin, n)) > most)
                    throw InputError(model_.file, model_.place(face.surface), "the face is not planar");
    }

    bool coplanar(const Face& face, const std::vector<uint32_t>& loop) const {
        const glm::dvec3 n = normal(face), origin = building_.vertices[face.loops[0][0]];
        return std::ranges::all_of(loop, [&](uint32_t v) {
            return std::abs(glm::dot(building_.vertices[v] - origin, n)) < kPlanarOfExtent * extent_;
        });
    }

    // All corners of the loop strictly inside the face's outline.
    bool inside(const Face& face, const std::vector<uint32_t>& loop) const {
        const glm::dvec3 n = normal(face), size = glm::abs(n);
        const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const int u = (drop + 1) % 3, v = (drop + 2) % 3;
        return std::ranges::all_of(loop, [&](uint32_t corner) {
            const glm::dvec3 p = building_.vertices[corner];
            bool in = false;
            const auto& outline = face.loops[0];
            for (size_t i = 0; i < outline.size(); ++i) {
                const glm::dvec3 a = building_.vertices[outline[i]],
                                 b = building_.vertices[outline[(i + 1) % outline.size()]];
                if (outline[i] == corner) return false;
                if ((a[v] > p[v]) != (b[v] > p[v]) &&
                    p[u] < (b[u] - a[u]) * (p[v] - a[v]) / (b[v] - a[v]) + a[u])
                    in = !in;
            }
            return in;
        });
    }

    // A box that stands on a face: its own bottom goes, and the face gets a hole.
    void cutFootprints() {
        dropHiddenBottoms();
        std::map<uint32_t, uint32_t> next; // missing edges, each from the far end of the one that is there
        for (const auto& [edge, faces] : facesOfEdges(building_)) {
            if (faces.size() != 1) continue;
            for (const auto& loop : building_.faces[faces[0]].loops)
                for (size_t i = 0; i < loop.size(); ++i)
                    if (Edge(std::minmax(loop[i], loop[(i + 1) % loop.size()])) == edge)
                        next[loop[(i + 1) % loop.size()]] = loop[i];
        }
        std::vector<std::vector<uint32_t>> loops;
        while (!next.empty()) {
            std::vector<uint32_t> loop;
            uint32_t at = next.begin()->first;
            while (next.contains(at)) {
                loop.push_back(at);
                const uint32_t to = next[at];
                next.erase(at);
                at = to;
            }
            if (loop.size() >= 3 && at == loop[0]) loops.push_back(std::move(loop));
        }
        bool any = false;
        for (const auto& loop : loops) any = subtract(loop) || any;
        if (any) weldAgain();
    }

    // Takes the polygon out of the faces in its plane that it lies over.
    bool subtract(std::vector<uint32_t> loop) {
        std::vector<uint32_t> under;
        // Not the faces whose own open edges the loop is: a sheet does not stand on itself.
        const std::set<uint32_t> corners(loop.begin(), loop.end());
        const auto owns = [&](const Face& face) {
            return std::ranges::any_of(face.loops, [&](const auto& ring) {
                for (size_t i = 0; i < ring.size(); ++i)
                    if (corners.contains(ring[i]) && corners.contains(ring[(i + 1) % ring.size()]))
                        return true;
                return false;
            });
        };
        for (uint32_t f = 0; f < building_.faces.size(); ++f)
            if (coplanar(building_.faces[f], loop) && !owns(building_.faces[f])) under.push_back(f);
        if (under.empty()) return false;
        const glm::dvec3 n = normal(building_.faces[under[0]]), origin = building_.vertices[loop[0]];
        const glm::dvec3 u = perpendicular(n), v = glm::cross(n, u);
        const auto flat = [&](uint32_t i) {
            const glm::dvec3 p = building_.vertices[i] - origin;
            return glm::dvec2(glm::dot(p, u), glm::dot(p, v));
        };
        if (glm::dot(areaOf(loop), n) < 0) std::ranges::reverse(loop);
        std::vector<PlanSegment> segments;
        std::vector<size_t> owner; // of the segment: face in `under`, or their number for the loop
        const auto add = [&](const std::vector<uint32_t>& ring, size_t id, bool reversed) {
            for (size_t i = 0; i < ring.size(); ++i) {
                const glm::dvec2 a = flat(ring[i]), b = flat(ring[(i + 1) % ring.size()]);
                segments.push_back({reversed ? b : a, reversed ? a : b, static_cast<int32_t>(owner.size())});
                owner.push_back(id);
            }
        };
        for (size_t k = 0; k < under.size(); ++k) {
            const bool turned = glm::dot(normal(building_.faces[under[k]]), n) < 0;
            for (const auto& ring : building_.faces[under[k]].loops) add(ring, k, turned);
        }
        add(loop, under.size(), false);
        const PlanArrangement map = arrange(segments);
        std::vector<int> labels(map.cellCount, -1);
        bool hit = false;
        for (size_t k = 0; k <= under.size(); ++k) {
            const auto depth =
                coverage(map, [&](int32_t tag) { return owner[static_cast<size_t>(tag)] == k; });
            for (uint32_t c = 0; c < map.cellCount; ++c) {
                if (depth[c] <= 0) continue;
                hit = hit || (k == under.size() && labels[c] >= 0);
                labels[c] = k == under.size() ? -1 : static_cast<int>(k);
            }
        }
        if (!hit) return false;
        replaceFaces(
            under, map, labels, [&](glm::dvec2 p) { return origin + p.x * u + p.y * v; }, n);
        return true;
    }

    template<class InSpace>
    void replaceFaces(const std::vector<uint32_t>& under, const PlanArrangement& map,
                      std::vector<int>& labels, InSpace inSpace, glm::dvec3 n) {
        absorbThinCells(map, labels, kWeldOfExtent * extent_);
        std::vector<Face> added;
        std::vector<uint32_t> addedSource;
        for (const PlanRegion& region : traceRegions(map, labels)) {
            const uint32_t f = under[static_cast<size_t>(region.label)];
            Face face = building_.faces[f];
            const bool turned = glm::dot(normal(face), n) < 0;
            face.loops.clear();
            for (const auto& halves : region.loops) {
                face.loops.emplace_back();
                for (const uint32_t h : halves) {
                    face.loops.back().push_back(static_cast<uint32_t>(building_.vertices.size()));
                    building_.vertices.push_back(inSpace(map.points[map.source(h)]));
                }
                if (turned) std::ranges::reverse(face.loops.back());
            }
            added.push_back(std::move(face));
            addedSource.push_back(source_[f]);
        }
        for (size_t k = under.size(); k-- > 0;) {
            building_.faces.erase(building_.faces.begin() + under[k]);
            source_.erase(source_.begin() + under[k]);
        }
        building_.faces.insert(building_.faces.end(), added.begin(), added.end());
        source_.insert(source_.end(), addedSource.begin(), addedSource.end());
    }

    void weldAgain() {
        std::vector<SoupFace> soup;
        for (size_t f = 0; f < building_.faces.size(); ++f) {
            const Face& face = building_.faces[f];
            soup.push_back({placed(building_.vertices, face.loops), face.material, face.role, source_[f]});
        }
        std::vector<std::string> repairs = std::move(building_.repairs);
        building_ = weldFaces(soup, 1, weldOfExtent_ * extent_);
        building_.repairs = std::move(repairs);
        source_.clear();
        for (const Face& face : building_.faces) source_.push_back(face.surface);
    }

    void dropHiddenBottoms() {
        std::vector<bool> hidden(building_.faces.size());
        for (size_t f = 0; f < building_.faces.size(); ++f)
            for (size_t g = 0; g < building_.faces.size() && !hidden[f]; ++g)
                hidden[f] = f != g && coplanar(building_.faces[g], building_.faces[f].loops[0]) &&
                            inside(building_.faces[g], building_.faces[f].loops[0]);
        // A pane that lies in a wall face that was not cut is drawn, not hidden: the user must mend it.
        for (uint32_t f = 0; f < hidden.size(); ++f)
            if (hidden[f] && model_.materials[building_.faces[f].material].isOpening())
                refuse({f}, "an opening lies on another face that is not cut out for it");
        leaveOut(hidden);
    }

    [[noreturn]] void refuse(std::vector<uint32_t> faces, const std::string& what) const {
        std::ranges::sort(faces);
        faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
        std::string more;
        for (size_t i = 1; i < faces.size() && i < 5; ++i)
            more += (i == 1 ? "" : ", ") + model_.place(source_[faces[i]]);
        if (faces.size() > 5) more += fmt::format(" and {} more", faces.size() - 5);
        throw InputError(model_.file, faces.empty() ? "" : model_.place(source_[faces[0]]),
                         what + (more.empty() ? "" : " (also " + more + ")"));
    }

    // Within a shell all faces look the same way: the way of most of its area.
    void orient() {
        if (building_.faces.empty())
            throw InputError(model_.file, model_.place(0), "no face of the model has an area");
        ShellFaces shells = orientShells(building_);
        if (!shells.bad.empty()) refuse(std::move(shells.bad), shells.what);
        shell_ = std::move(shells.shell);
        shellCount_ = shells.count;
        turnedOver_ += shells.turnedOver;
    }

    void nestShells() {
        std::vector<std::vector<ShellTriangle>> shells(shellCount_);
        for (uint32_t f = 0; f < building_.faces.size(); ++f) {
            const auto pieces = triangulateFace(building_, building_.faces[f]);
            if (pieces.empty()) refuse({f}, "the outline of the face crosses itself");
            for (const auto& t : pieces)
                shells[shell_[f]].push_back(
                    {building_.vertices[t[0]], building_.vertices[t[1]], building_.vertices[t[2]]});
        }
        const ShellNesting nesting = geometry::nestShells(shells);
        for (uint32_t f = 0; f < building_.faces.size(); ++f) {
            if (nesting.inverted[shell_[f]]) turnOver(building_.faces[f]);
            building_.faces[f].room = nesting.room[shell_[f]];
        }
        dropOutsides();
        building_.roomCount = nesting.rooms;
    }

    void dropOutsides() {
        std::vector<bool> outside;
        for (const Face& face : building_.faces) outside.push_back(face.room == kNoRoom);
        if (const auto count = std::ranges::count(outside, true); count > 0)
            building_.warnings.push_back(fmt::format(
                "{} faces of the outside of walls were left out: only shells within them are rooms", count));
        leaveOut(outside);
    }

    void leaveOut(const std::vector<bool>& gone) {
        size_t kept = 0;
        for (size_t f = 0; f < gone.size(); ++f) {
            if (gone[f]) continue;
            if (kept < f) building_.faces[kept] = std::move(building_.faces[f]);
            source_[kept++] = source_[f];
        }
        building_.faces.resize(kept);
        source_.resize(kept);
    }

    // Rooms that touch in a corner must not share the vertex.
    void splitSharedCorners() {
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> copies;
        std::vector<int64_t> owner(building_.vertices.size(), -1);
        for (Face& face : building_.faces)
            for (auto& loop : face.loops)
                for (uint32_t& v : loop) {
                    if (owner[v] < 0) owner[v] = face.room;
                    if (owner[v] == face.room) continue;
                    const auto [place, isNew] =
                        copies.try_emplace({v, face.room}, static_cast<uint32_t>(building_.vertices.size()));
                    if (isNew) {
                        building_.vertices.push_back(building_.vertices[v]);
                        owner.push_back(face.room);
                    }
                    v = place->second;
                }
    }

    // Neighbours in one plane and of one material are one surface.
    void findSurfaces() {
        DisjointSets surfaces(building_.faces.size());
        for (const auto& [edge, faces] : facesOfEdges(building_)) {
            const Face &a = building_.faces[faces[0]], &b = building_.faces[faces[1]];
            const glm::dvec3 m = normal(a), n = normal(b);
            if (a.material == b.material && glm::dot(m, n) > 0 && glm::length(glm::cross(m, n)) < 1e-4)
                surfaces.join(faces[0], faces[1]);
        }
        std::map<uint32_t, uint32_t> ids;
        for (uint32_t f = 0; f < building_.faces.size(); ++f)
            building_.faces[f].surface =
                ids.try_emplace(surfaces.root(f), static_cast<uint32_t>(ids.size())).first->second;
    }

    std::vector<uint32_t> facesOfRoom(uint32_t room) const {
        std::vector<uint32_t> out;
        for (uint32_t f = 0; f < building_.faces.size(); ++f)
            if (building_.faces[f].room == room) out.push_back(f);
        return out;
    }

    void proveRooms() {
        const std::vector<ShellProof> proofs = proveShells(building_);
        if (proofs.empty()) refuse({0}, "the model encloses no room");
        for (const ShellProof& proof : proofs) {
            if (!proof.closed)
                refuse(proof.badFaces,
                       "the model is not closed: the faces round a corner form no single fan");
            if (proof.selfIntersecting) refuse(proof.badFaces, "the face crosses another face");
            if (!(proof.volume > kLeastRoomOfExtent * extent_ * extent_ * extent_))
                refuse(facesOfRoom(static_cast<uint32_t>(&proof - proofs.data())),
                       "the faces enclose no room");
        }
    }

    void prove() {
        proveRooms();
        if (building_.roomCount < 2) return;
        Building together = building_; // rooms must not cross each other either
        together.roomCount = 1;
        for (Face& face : together.faces) face.room = 0;
        const ShellProof proof = proveShells(together)[0];
        if (proof.selfIntersecting) refuse(proof.badFaces, "the face crosses a face of another room");
    }

    RawModel model_;
    Building building_;
    std::vector<uint32_t> source_, shell_; // per face
    uint32_t shellCount_ = 0;
    size_t turnedOver_ = 0; // against the others of their shell
    double extent_ = 0, weldOfExtent_ = kWeldOfExtent;
};

} // namespace

Building importModel(const std::filesystem::path& file, UpAxis up) {
    return ModelImporter(file, up).import();
}

} // namespace heliodon::geometry
