#include "geometry/glass_panes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <span>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "geometry/bounds.h"
#include "geometry/counted.h"
#include "geometry/disjoint_sets.h"
#include "geometry/outline_area.h"
#include "geometry/pane_in_hole.h"
#include "geometry/shell_faces.h"

namespace heliodon::geometry {

namespace {

using glm::dvec3;

constexpr double kThickOfSide = 0.2; // of the square root of a side's area
constexpr double kSameArea = 0.03;   // of it: one side may have a chamfer
constexpr double kSameHole = 1e-6;   // of a pane's area
constexpr double kBeside = 0.1;      // of the root of a pane's area: how far from its plane others may lie
constexpr double kPulledIn = 25;     // tolerances
constexpr size_t kMostJoints = 16;   // flat panes whose joints are looked at
constexpr double kAngle = 0.1;       // radians
constexpr double kMostOnGlass = 0.7; // of the outer borders of slabs that hang together: the rest is walls
constexpr size_t kMostTogether = 64; // slabs that hang together
constexpr uint32_t kBarrier = std::numeric_limits<uint32_t>::max(); // a material that is no glass

dvec3 twiceAreaVector(const SoupFace& face) {
    dvec3 sum{0};
    for (const auto& loop : face.loops) sum += areaVector(loop);
    return sum;
}

// Faces of the soup that hang together.
struct Body {
    std::vector<uint32_t> faces;
    bool closed = true; // and of one material
};

// Of each face, whether it is one of an even number with its corners and material: where bodies touch.
std::vector<bool> facesWithin(const Building& welded) {
    std::map<std::vector<uint32_t>, std::vector<uint32_t>> alike;
    for (uint32_t f = 0; f < welded.faces.size(); ++f) {
        std::vector<uint32_t> key{welded.faces[f].material};
        for (const auto& loop : welded.faces[f].loops) key.insert(key.end(), loop.begin(), loop.end());
        std::sort(key.begin() + 1, key.end());
        alike[key].push_back(f);
    }
    std::vector<bool> within(welded.faces.size(), false);
    for (const auto& [key, faces] : alike)
        if (faces.size() % 2 == 0)
            for (const uint32_t f : faces) within[f] = true;
    return within;
}

// What hangs together by edges between two faces that are not `within`: closed bodies that touch along an
// edge alone, as slabs that meet at a corner, are told apart. Of each face its body's, and those that are
// open.
struct HangingTogether {
    DisjointSets sets;
    std::vector<uint32_t> open;
};

HangingTogether hangingTogether(const Building& welded, const std::vector<bool>& within) {
    HangingTogether out{DisjointSets(welded.faces.size()), {}};
    const auto join = [&](const std::vector<uint32_t>& faces) {
        for (const uint32_t f : faces) out.sets.join(f, faces[0]);
    };
    std::vector<std::vector<uint32_t>> crowded; // what is of one material at an edge of more than two
    for (const auto& [edge, faces] : facesOfEdges(welded)) {
        std::map<uint32_t, std::vector<uint32_t>> bounds; // by material
        for (const uint32_t f : faces) bounds[welded.faces[f].material].push_back(f);
        for (auto& [material, alike] : bounds) {
            const auto count = std::ranges::count_if(alike, [&](uint32_t f) { return !within[f]; });
            if (count > 2) {
                crowded.push_back(std::move(alike));
                continue;
            }
            join(alike);
            if (count == 1) out.open.push_back(alike[0]);
        }
    }
    for (const auto& faces : crowded) {
        std::map<uint32_t, size_t> count; // by root
        for (const uint32_t f : faces) count[out.sets.root(f)] += within[f] ? 0 : 1;
        if (std::ranges::all_of(count, [](const auto& c) { return c.second == 2 || c.second == 0; }))
            continue;
        join(faces);
        out.open.push_back(faces[0]);
    }
    return out;
}

std::vector<Body> bodiesOf(const std::vector<SoupFace>& soup, const std::function<bool(uint32_t)>& isGlass,
                           double tolerance) {
    std::vector<SoupFace> glass;
    for (uint32_t f = 0; f < soup.size(); ++f) {
        if (!isGlass(soup[f].material)) continue;
        glass.push_back(soup[f]);
        glass.back().surface = f;
    }
    const Building welded = weldFaces(glass, 1, tolerance);
    const std::vector<bool> within = facesWithin(welded);
    auto [sets, open] = hangingTogether(welded, within);
    std::map<uint32_t, Body> found; // by root
    std::map<uint32_t, bool> outer;
    for (uint32_t f = 0; f < welded.faces.size(); ++f) {
        found[sets.root(f)].faces.push_back(welded.faces[f].surface);
        outer[sets.root(f)] |= !within[f];
    }
    for (const uint32_t f : open) found[sets.root(f)].closed = false;
    std::vector<Body> out;
    for (auto& [root, body] : found) {
        body.closed &= outer[root];
        out.push_back(std::move(body));
    }
    return out;
}

struct Slab {
    std::array<std::vector<uint32_t>, 2> sides; // faces; none where the body is no pane, one where it is flat
    dvec3 across{0};                            // from the first side to the second
    double area = 0;                            // of the first side
};

Slab slabOf(const std::vector<uint32_t>& body, const std::vector<SoupFace>& soup, double tolerance) {
    const uint32_t largest = *std::ranges::max_element(
        body, {}, [&](uint32_t f) { return glm::length(twiceAreaVector(soup[f])); });
    const dvec3 origin = soup[largest].loops[0][0], normal = glm::normalize(twiceAreaVector(soup[largest]));
    Slab slab;
    std::array<double, 2> areas{};
    std::array<double, 2> at{0, std::numeric_limits<double>::quiet_NaN()}; // along the normal
    double least = 0, most = 0;                                            // the same, of all
    for (const uint32_t f : body) {
        const dvec3 area = twiceAreaVector(soup[f]);
        double low = 1e300, high = -1e300;
        for (const auto& loop : soup[f].loops)
            for (const dvec3 p : loop) {
                low = std::min(low, glm::dot(p - origin, normal));
                high = std::max(high, glm::dot(p - origin, normal));
            }
        least = std::min(least, low);
        most = std::max(most, high);
        if (high - low > tolerance) continue;
        const size_t side = std::abs(low) <= tolerance ? 0 : 1;
        if (side == 1 && slab.sides[1].empty()) at[1] = low;
        if (std::abs(low - at[side]) > tolerance) return {};
        slab.sides[side].push_back(f);
        areas[side] += 0.5 * glm::length(area);
    }
    slab.across = at[1] * normal;
    slab.area = areas[0];
    const bool isSlab = most - least <= std::abs(at[1]) + 2 * tolerance &&
                        std::abs(areas[0] - areas[1]) <= kSameArea * areas[0] &&
                        std::abs(at[1]) <= kThickOfSide * std::sqrt(areas[0]);
    return isSlab ? slab : Slab{};
}

// Of a pane without thickness; none where it is not flat.
Slab flatOf(const std::vector<uint32_t>& pane, const std::vector<SoupFace>& soup, double tolerance) {
    Slab out;
    const dvec3 origin = soup[pane[0]].loops[0][0], normal = glm::normalize(twiceAreaVector(soup[pane[0]]));
    for (const uint32_t f : pane) {
        for (const dvec3 p : soup[f].loops[0])
            if (std::abs(glm::dot(p - origin, normal)) > tolerance) return {};
        out.area += 0.5 * glm::length(twiceAreaVector(soup[f]));
    }
    out.sides[0] = pane;
    return out;
}

double areaOf(std::span<const SoupFace> faces) {
    double sum = 0;
    for (const SoupFace& face : faces) sum += 0.5 * glm::length(twiceAreaVector(face));
    return sum;
}

class PanePlacer {
public:
    PanePlacer(const std::vector<SoupFace>& soup, const std::function<bool(uint32_t)>& isGlass,
               double tolerance)
        : soup_(soup), isGlass_(isGlass), tolerance_(tolerance), holes_(soup, isGlass, tolerance),
          gone_(soup.size(), false), edge_(soup.size(), false) {
        for (const SoupFace& face : soup) {
            if (isGlass(face.material)) continue;
            walls_ = united(walls_, boundsOf(face.loops[0]));
        }
    }

    std::optional<PanesInHoles> place(const std::vector<Body>& bodies) {
        for (const Body& body : bodies) {
            Pane pane{&body, body.closed ? slabOf(body.faces, soup_, tolerance_)
                                         : flatOf(body.faces, soup_, tolerance_)};
            const std::vector<SoupFace> made = panesOf(pane.slab);
            if (made.empty())
                unfit_.push_back(std::move(pane));
            else if (body.closed || std::abs(areaOf(made) - pane.slab.area) > kSameHole * pane.slab.area)
                replace({&pane}, made); // else it is as it is drawn
        }
        placeGroups();
        placeTogether();
        for (const Pane& pane : unfit_) loosen(pane);
        if (out_.slabs + out_.flat + out_.loose.size() == 0 && !out_.openFlat) return std::nullopt;
        for (size_t f = 0; f < soup_.size(); ++f) {
            if (gone_[f]) continue;
            if (edge_[f]) out_.edges.push_back(static_cast<uint32_t>(out_.soup.size()));
            const auto smaller = pulledIn_.find(static_cast<uint32_t>(f));
            out_.soup.push_back(smaller == pulledIn_.end() ? soup_[f] : smaller->second);
        }
        return std::move(out_);
    }

private:
    struct Pane {
        const Body* body;
        Slab slab;
    };

    // Nothing where it stands in no hole.
    std::vector<SoupFace> panesOf(const Slab& slab) const {
        if (slab.sides[0].empty()) return {};
        std::vector<SoupFace> out = holes_.fit(slab.sides[0], 0.5 * slab.across);
        if (!out.empty() || slab.sides[1].empty()) return out;
        for (const auto& side : slab.sides) {
            const std::vector<SoupFace> pane = holes_.fit(side, dvec3(0));
            out.insert(out.end(), pane.begin(), pane.end());
        }
        return out;
    }

    void replace(const std::vector<const Pane*>& panes, const std::vector<SoupFace>& made) {
        for (const Pane* pane : panes) {
            ++(pane->body->closed ? out_.slabs : out_.flat);
            for (const uint32_t f : pane->body->faces) gone_[f] = true;
        }
        for (const SoupFace& face : made) out_.made.push_back(face.surface);
        out_.soup.insert(out_.soup.end(), made.begin(), made.end());
    }

    Bounds boxOf(const std::vector<uint32_t>& faces) const {
        std::vector<dvec3> corners;
        for (const uint32_t f : faces)
            corners.insert(corners.end(), soup_[f].loops[0].begin(), soup_[f].loops[0].end());
        return boundsOf(corners);
    }

    bool beside(const Pane& a, const Pane& b) const {
        return soup_[a.slab.sides[0][0]].material == soup_[b.slab.sides[0][0]].material && inOnePlane(a, b);
    }

    // Nearly, and near one another.
    bool inOnePlane(const Pane& a, const Pane& b) const {
        const SoupFace &one = soup_[a.slab.sides[0][0]], &other = soup_[b.slab.sides[0][0]];
        const dvec3 n = glm::normalize(twiceAreaVector(one)), m = glm::normalize(twiceAreaVector(other)),
                    apart = other.loops[0][0] + 0.5 * b.slab.across - one.loops[0][0] - 0.5 * a.slab.across;
        const double near = kBeside * std::sqrt(std::min(a.slab.area, b.slab.area));
        if (glm::length(glm::cross(n, m)) > 1e-3 || std::abs(glm::dot(n, apart)) > near) return false;
        return boxOf(a.slab.sides[0]).isNear(boxOf(b.slab.sides[0]), near);
    }

    // Those beside one another, in the plane of the largest.
    void placeGroups() {
        std::ranges::stable_sort(unfit_, std::greater(), [](const Pane& pane) { return pane.slab.area; });
        DisjointSets sets(unfit_.size());
        for (uint32_t i = 0; i < unfit_.size(); ++i)
            for (uint32_t j = 0; j < i; ++j)
                if (!unfit_[i].slab.sides[0].empty() && !unfit_[j].slab.sides[0].empty() &&
                    beside(unfit_[i], unfit_[j]))
                    sets.join(i, j);
        std::map<uint32_t, std::vector<uint32_t>> groups;
        for (uint32_t i = 0; i < unfit_.size(); ++i) groups[sets.root(i)].push_back(i);
        std::vector<bool> placed(unfit_.size(), false);
        for (const auto& [root, group] : groups) {
            if (group.size() < 2) continue;
            std::vector<uint32_t> sides;
            std::vector<const Pane*> panes;
            for (const uint32_t i : group) {
                panes.push_back(&unfit_[i]);
                sides.insert(sides.end(), unfit_[i].slab.sides[0].begin(), unfit_[i].slab.sides[0].end());
            }
            const auto made = holes_.fit(sides, 0.5 * panes[0]->slab.across);
            if (made.empty()) continue;
            replace(panes, made);
            for (const uint32_t i : group) placed[i] = true;
        }
        keepUnfit(placed);
    }

    void keepUnfit(const std::vector<bool>& placed) {
        std::vector<Pane> left;
        for (uint32_t i = 0; i < unfit_.size(); ++i)
            if (!placed[i]) left.push_back(std::move(unfit_[i]));
        unfit_ = std::move(left);
    }

    // Slabs that meet at an angle, as round a corner.
    bool meetAtAngle(const Pane& a, const Pane& b) const {
        const dvec3 n = glm::normalize(twiceAreaVector(soup_[a.slab.sides[0][0]])),
                    m = glm::normalize(twiceAreaVector(soup_[b.slab.sides[0][0]]));
        return glm::length(glm::cross(n, m)) > kAngle &&
               boxOf(a.body->faces).isNear(boxOf(b.body->faces), 10 * tolerance_);
    }

    // From the first side of a slab to the plane in the middle of another one that is parallel to it.
    dvec3 toMiddle(const Pane& pane, const Pane& of) const {
        const SoupFace &side = soup_[pane.slab.sides[0][0]], &other = soup_[of.slab.sides[0][0]];
        const dvec3 n = glm::normalize(twiceAreaVector(side));
        return glm::dot(n, other.loops[0][0] + 0.5 * of.slab.across - side.loops[0][0]) * n;
    }

    // The first side of a slab, moved, and larger by twice `more` all round.
    std::vector<SoupFace> barrierOf(const Pane& pane, dvec3 shift, double more) const {
        const dvec3 middle = boxOf(pane.slab.sides[0]).centre();
        std::vector<SoupFace> out;
        for (const uint32_t f : pane.slab.sides[0]) {
            out.push_back(soup_[f]);
            out.back().material = kBarrier;
            for (auto& loop : out.back().loops)
                for (dvec3& p : loop) p += shift + more * (p - middle);
        }
        return out;
    }

    // Of slabs that hang together, each up to the middles of those that it meets at an angle and to the ends
    // of those beside it, of whatever glass: faces for all, or for none where one fits no hole so.
    std::vector<std::vector<SoupFace>> fitTogether(const std::vector<uint32_t>& cluster) const {
        std::vector<std::vector<SoupFace>> out;
        std::map<uint32_t, dvec3> shift;
        for (const uint32_t i : cluster) {
            const uint32_t first = *std::ranges::find_if(
                cluster, [&](uint32_t j) { return j == i || inOnePlane(unfit_[i], unfit_[j]); });
            shift[i] = toMiddle(unfit_[i], unfit_[first]);
        }
        double around = 0, onGlass = 0; // lengths of borders, but for those between slabs of one plane
        for (const uint32_t i : cluster) {
            std::vector<SoupFace> soup = soup_, beside;
            const auto add = [&](std::vector<SoupFace> faces, std::vector<SoupFace>& to) {
                for (SoupFace& face : faces) face.material = kBarrier;
                to.insert(to.end(), faces.begin(), faces.end());
            };
            for (size_t k = 0; k < cluster.size(); ++k) {
                const uint32_t j = cluster[k];
                if (j == i) continue;
                if (meetAtAngle(unfit_[i], unfit_[j]))
                    add(barrierOf(unfit_[j], shift[j], kThickOfSide), soup);
                else if (inOnePlane(unfit_[i], unfit_[j]))
                    add(k < out.size() ? out[k] : barrierOf(unfit_[j], shift[j], 0), beside);
            }
            const size_t angled = soup.size();
            soup.insert(soup.end(), beside.begin(), beside.end());
            for (const SoupFace& face : beside) addRim(face, soup); // rounding leaves a gap before the walls
            const std::function<bool(uint32_t)> isGlass = [&](uint32_t m) {
                return m != kBarrier && isGlass_(m);
            };
            out.push_back(PaneFitter(soup, isGlass, tolerance_).fit(unfit_[i].slab.sides[0], shift[i]));
            if (out.back().empty()) return {};
            const auto touches = [&](std::span<const SoupFace> faces, dvec3 p) {
                return std::ranges::any_of(faces, [&](const SoupFace& face) { return liesOn(face, p); });
            };
            for (const SoupFace& face : out.back())
                for (size_t k = 0; k < face.loops[0].size(); ++k) {
                    const dvec3 a = face.loops[0][k], b = face.loops[0][(k + 1) % face.loops[0].size()];
                    if (touches(beside, 0.5 * (a + b))) continue;
                    around += glm::length(b - a);
                    if (touches(std::span(soup).subspan(soup_.size(), angled - soup_.size()), 0.5 * (a + b)))
                        onGlass += glm::length(b - a);
                }
        }
        if (onGlass > kMostOnGlass * around) return {}; // a body of its own, as an aquarium
        return out;
    }

    // Along the borders of a face, across its plane: where a pane meets that, its edges run on a little.
    void addRim(const SoupFace& face, std::vector<SoupFace>& to) const {
        const dvec3 across = 10 * tolerance_ * glm::normalize(twiceAreaVector(face));
        for (const auto& loop : face.loops)
            for (size_t k = 0; k < loop.size(); ++k) {
                const dvec3 a = loop[k], b = loop[(k + 1) % loop.size()];
                to.push_back(
                    {.loops = {{a - across, b - across, b + across, a + across}}, .material = kBarrier});
            }
    }

    bool liesOn(const SoupFace& face, dvec3 p) const {
        const dvec3 n = glm::normalize(twiceAreaVector(face));
        const double near = 10 * tolerance_;
        return std::abs(glm::dot(n, p - face.loops[0][0])) <= near &&
               boundsOf(face.loops[0]).isNear({p, p}, near);
    }

    void placeTogether() {
        DisjointSets sets(unfit_.size());
        for (uint32_t i = 0; i < unfit_.size(); ++i)
            for (uint32_t j = 0; j < i; ++j)
                if (!unfit_[i].slab.sides[1].empty() && !unfit_[j].slab.sides[1].empty() &&
                    (inOnePlane(unfit_[i], unfit_[j]) || meetAtAngle(unfit_[i], unfit_[j])))
                    sets.join(i, j);
        std::map<uint32_t, std::vector<uint32_t>> clusters;
        for (uint32_t i = 0; i < unfit_.size(); ++i) clusters[sets.root(i)].push_back(i);
        std::vector<bool> placed(unfit_.size(), false);
        for (const auto& [root, cluster] : clusters) {
            if (cluster.size() < 2 || cluster.size() > kMostTogether) continue;
            const auto made = fitTogether(cluster);
            for (size_t k = 0; k < made.size(); ++k) {
                replace({&unfit_[cluster[k]]}, made[k]);
                placed[cluster[k]] = true;
            }
        }
        keepUnfit(placed);
    }

    // `holds` of one of the sides of a slab or its middle.
    template<class Holds> static bool anyLevel(const Slab& slab, const Holds& holds) {
        return holds(slab.sides[0], dvec3(0)) || holds(slab.sides[0], 0.5 * slab.across) ||
               holds(slab.sides[1], dvec3(0));
    }

    bool isNearGlass(const Pane& pane) const {
        const Bounds here = boxOf(pane.body->faces);
        return std::ranges::any_of(unfit_, [&](const Pane& other) {
            return other.body != pane.body && other.body->closed &&
                   here.isNear(boxOf(other.body->faces), tolerance_);
        });
    }

    // A slab that touches other faces with its rim at most; where it does it is pulled in.
    bool isKept(const Pane& pane) {
        const Slab& slab = pane.slab;
        if (slab.sides[1].empty()) return false;
        const bool touches =
            anyLevel(slab, [&](const auto& side, dvec3 at) { return holes_.touches(side, at); });
        if (!touches && !isNearGlass(pane)) return true;
        const double by = kPulledIn * tolerance_;
        if (touches &&
            anyLevel(slab, [&](const auto& side, dvec3 at) { return holes_.crosses(side, at, 0.5 * by); }))
            return false;
        const auto smaller = holes_.pulledIn(slab.sides[0], pane.body->faces, by);
        if (!smaller) return false;
        for (size_t k = 0; k < smaller->size(); ++k) pulledIn_[pane.body->faces[k]] = (*smaller)[k];
        return true;
    }

    void loosen(const Pane& pane) {
        const Slab& slab = pane.slab;
        const Bounds box = boxOf(pane.body->faces);
        if (glm::any(glm::lessThan(box.high, walls_.low)) || glm::any(glm::greaterThan(box.low, walls_.high)))
            return; // a building of its own, as a greenhouse
        LooseGlass glass;
        glass.diagonal = box.diagonal();
        if (!slab.sides[0].empty() && (pane.body->closed || jointsLookedAt_++ < kMostJoints))
            glass.joint = holes_.joint(slab.sides[0], 0.5 * slab.across);
        for (const uint32_t f : pane.body->faces) glass.faces.push_back(soup_[f].surface);
        if (!pane.body->closed) {
            if (glass.joint && !out_.openFlat) out_.openFlat = glass;
            return;
        }
        glass.middle = box.centre();
        glass.kept = isKept(pane);
        for (const uint32_t f : pane.body->faces) (glass.kept ? edge_ : gone_)[f] = true;
        if (glass.kept)
            for (const auto& side : slab.sides)
                for (const uint32_t f : side) edge_[f] = false;
        out_.loose.push_back(std::move(glass));
    }

    const std::vector<SoupFace>& soup_;
    const std::function<bool(uint32_t)>& isGlass_;
    double tolerance_;
    PaneFitter holes_;
    std::vector<bool> gone_, edge_;             // per face
    Bounds walls_{dvec3(1e300), dvec3(-1e300)}; // of all that is no glass
    std::vector<Pane> unfit_;
    std::map<uint32_t, SoupFace> pulledIn_; // by face
    size_t jointsLookedAt_ = 0;
    PanesInHoles out_;
};

} // namespace

std::optional<PanesInHoles> panesInHoles(const std::vector<SoupFace>& soup,
                                         const std::function<bool(uint32_t)>& isGlass, double tolerance,
                                         Drawn drawn) {
    std::vector<Body> bodies = bodiesOf(soup, isGlass, tolerance);
    if (drawn == Drawn::slabs) std::erase_if(bodies, [](const Body& body) { return !body.closed; });
    if (bodies.empty()) return std::nullopt; // as of most models: no walls are sorted for nothing
    return PanePlacer(soup, isGlass, tolerance).place(bodies);
}

bool leaveOutFree(PanesInHoles& panes, const std::set<uint32_t>& first) {
    std::set<uint32_t> gone;
    for (LooseGlass& glass : panes.loose)
        if (glass.kept && (first.empty() || first.contains(glass.faces[0]))) {
            glass.kept = false;
            gone.insert(glass.faces.begin(), glass.faces.end());
        }
    return std::erase_if(panes.soup, [&](const SoupFace& f) { return gone.contains(f.surface); }) > 0;
}

void reportGlass(const PanesInHoles& panes, Building& out,
                 const std::function<std::string(uint32_t)>& place) {
    if (panes.slabs > 0)
        out.repairs.push_back(counted(panes.slabs, "slab") +
                              (panes.slabs == 1 ? " of glass taken as a pane" : " of glass taken as panes"));
    if (panes.flat > 0) out.repairs.push_back(counted(panes.flat, "pane") + " taken to fill the hole");
    const LooseGlass* first = nullptr; // left out
    size_t kept = 0, left = 0;
    for (const LooseGlass& glass : panes.loose) {
        ++(glass.kept ? kept : left);
        if (!glass.kept && !first) first = &glass;
    }
    if (kept > 0)
        out.repairs.push_back(fmt::format("{} of glass {} free: seen through, with edges that are black",
                                          counted(kept, "slab"), kept == 1 ? "stands" : "stand"));
    if (left > 0)
        out.warnings.push_back(
            fmt::format("{} of glass (the first at {}) {} no hole: left out, as if light passed unhindered",
                        left == 1 ? std::string("1 body") : fmt::format("{} bodies", left),
                        place(first->faces[0]), left == 1 ? "fills" : "fill"));
}

} // namespace heliodon::geometry
