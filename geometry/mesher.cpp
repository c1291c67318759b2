// Uniform triangles: every edge of the building is sampled once for all faces that meet there, so there are
// no T-vertices; inside, a hexagonal lattice, a constrained Delaunay triangulation, smoothing and
// optimisation. The number of triangles of a polygon is known before it is triangulated (Euler: 2 inner +
// boundary - 2 + 2 holes), which lets the edge length be tuned to the count that was asked for without
// meshing often.
#include "geometry/mesher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "geometry/board_rows.h"
#include "geometry/edge_sampling.h"
#include "geometry/mesh_domains.h"
#include "geometry/perpendicular.h"
#include "geometry/planar_mesher.h"
#include "geometry/second_tries.h"
#include "geometry/slot_sizes.h"
#include "geometry/twin_faces.h"
#include "geometry/unused_vertices.h"

namespace heliodon::geometry {

namespace {

constexpr double kCountTolerance = 0.012;
constexpr double kCountReached = 0.028; // of the count that was asked for
constexpr int kAttempts = 3;
// Optimisation may add so many points, at most that share of the count; each makes two triangles.
constexpr double kMostAdditions = 40, kAdditionsOfCount = 0.014;
// Of the edge length: halves of rectangles this wide and high are as large as regular triangles.
constexpr double kColumn = 0.93;
// Of the edge length: triangles lean across facets that are narrower. Models may have any number of them.
constexpr double kNarrowest = 0.25, kNarrowestOfMany = 0.36;
constexpr double kTriedAgain = 0.3; // of the count: triangles that are meshed a second time for better angles
constexpr double kUniform = std::numeric_limits<double>::infinity();
// Where the count comes in steps, as many edges are equally long; a better count is worth no worse angles.
constexpr double kSpread = 0.25;
constexpr double kOneStep = 0.15; // of the count: where it comes in larger steps nothing is gained
constexpr double kWideAngle = 36; // degrees
// From the gentlest growth of sizes round small parts to none at all, for when triangles are few; slots take
// more of them than was thought where walls have small parts of their own. The longer edges become for what
// small parts take, times those of as many equal triangles, the faster sizes grow: all else is large then.
struct Trial {
    Grading grading;
    double longest = kUniform;
};
constexpr double kGentle = 1.06, kLongest = 1.12;
constexpr std::array kTrials{
    Trial{{1.4, 0.6}, kGentle},         Trial{{1.8, 0.9}, kLongest},
    Trial{{2.0, 1.5}, kLongest},        Trial{{1.4, 0.6, false}, kGentle},
    Trial{{1.8, 0.9, false}, kLongest}, Trial{{kUniform, kUniform}},
    Trial{{kUniform, kUniform, false}}, Trial{{kUniform, kUniform, false, false, 0, kSpread}}};
constexpr double kLongestBesideSlots = 1.6; // likewise: longer ones no longer save triangles
constexpr double kFarTooMany = 1.4;         // times what was asked for: such grading is for finer meshes
// Of them, in narrow strips: where it is more, others are large beside them whatever is done about angles.
constexpr double kManyNarrow = 0.15;

// Of regular triangles, so many, that cover the area.
double regularEdge(double area, double count) {
    return std::sqrt(4 / std::sqrt(3.0) * area / count);
}

double regularEdge(const Building& building, double count) {
    double twice = 0;
    for (const Face& face : building.faces) {
        glm::dvec3 sum{0};
        for (const auto& loop : face.loops)
            for (size_t i = 1; i + 1 < loop.size(); ++i)
                sum += glm::cross(building.vertices[loop[i]] - building.vertices[loop[0]],
                                  building.vertices[loop[i + 1]] - building.vertices[loop[0]]);
        twice += glm::length(sum);
    }
    return regularEdge(twice / 2, count);
}

class BuildingMesher {
public:
    BuildingMesher(const Building& building, const MeshOptions& options, bool careful)
        : building_(building), beforePart_(options.beforePart),
          wanted_(static_cast<double>(std::max<size_t>(options.triangles, 1))),
          narrowest_(options.ofModel ? kNarrowestOfMany : kNarrowest),
          regular_(regularEdge(building, wanted_)),
          domains_(findMeshDomains(building, regular_, options.ofModel, careful)),
          sampler_(building, domains_, slotSizes(building, domains_, regular_, wanted_),
                   options.ofModel ? boardRows(building, domains_, regular_, wanted_)
                                   : std::vector<uint32_t>(domains_.size(), 0)) {
        std::map<std::vector<double>, size_t> known;
        for (const MeshDomain& domain : domains_) {
            std::vector<double> key; // what has the same may still be divided otherwise
            for (const auto& loop : domain.planar)
                for (const glm::dvec2 p : loop) key.insert(key.end(), {p.x, p.y});
            equal_.push_back(known.try_emplace(std::move(key), equal_.size()).first->second);
            areas_.push_back(domainArea(domain));
        }
    }

    // Optimisation adds no more points than the count has room for, so that it is known before.
    PatchMesh mesh() {
        const bool sparing = sampler_.narrowTriangles(regular_) > kManyNarrow * wanted_;
        std::optional<Plan> best, spread;
        for (const auto& [grading, longest] : kTrials) {
            if (grading.spread > 0 ? off(best->count) > kOneStep * wanted_
                                   : !grading.slots && !sampler_.hasSlots())
                continue; // the building has more edges of its own; nothing else was tried
            longest_ = regular_ * (sampler_.hasSlots() ? kLongestBesideSlots : longest);
            grading_ = grading;
            grading_.sparing = sparing;
            grading_.narrowest = narrowest_;
            edge_ = added_ = lastEdge_ = lastCount_ = draftedEdge_ = earlierEdge_ = 0;
            addedKnown_ = false;
            counts_.clear();
            double aim = wanted_; // half of the additions are expected
            if (sampler_.hasSmallParts(regular_)) aim -= mostAdditions(grading);
            for (int attempt = 0; attempt < kAttempts; ++attempt) {
                // Without grading there is no way but this one.
                if (!chooseSizes(aim) && std::isfinite(grading.growth)) break;
                const double count = settle(finishDrafts());
                const bool reached = off(count) <= kCountReached * wanted_;
                std::optional<Plan>& plan = grading.spread > 0 ? spread : best;
                const double nearest = plan ? off(plan->count) : best ? off(best->count) : kUniform;
                if (reached || off(count) < nearest)
                    plan.emplace(grading, count, std::move(drafts_), sampler_);
                if (reached && !spread) return meshOnce(*best);
                if (reached) break;
                draftedEdge_ = 0; // drafts may be gone
                aim *= wanted_ / count;
            }
        }
        PatchMesh even = meshOnce(*best);
        if (!spread) return even;
        PatchMesh uneven = meshOnce(*spread);
        const double angle = std::min(kWideAngle, measureMesh(even).minAngleDeg);
        return measureMesh(uneven).minAngleDeg >= angle ? uneven : even;
    }

private:
    const Face& faceOf(size_t domain) const { return building_.faces[domains_[domain].faces[0]]; }

    // What a domain will be meshed from.
    struct Draft {
        PlanarDomain plane;
        double lattice = 1; // times the edge length there
        LatticeSeeds seeds;
        std::optional<PlanarNet> net;            // of the seeds, where it was asked for already
        double count = 0;                        // of triangles, without those that refinement adds
        std::optional<EdgeSampler::Grid> grid{}; // of a board: nothing else is needed
    };

    // All that is left to do is to raise angles.
    struct Plan {
        Grading grading;
        double count; // of triangles
        std::vector<Draft> drafts;
        EdgeSampler sampler;
    };

    double off(double count) const { return std::abs(count - wanted_); }

    // Of an equal domain, as walls of equal rooms are, whose draft is the same; null where it has none.
    const Draft* equalDraft(size_t d, const Draft& draft) const {
        if (equal_[d] >= std::min(d, drafts_.size())) return nullptr;
        const Draft& other = drafts_[equal_[d]];
        const bool same = !other.grid && other.lattice == draft.lattice && other.plane == draft.plane;
        return same ? &other : nullptr;
    }

    Draft draftOf(size_t d, double lattice) const {
        beforePart_();
        Draft draft{sampler_.planar(d), lattice, {}, {}};
        draft.grid = sampler_.grid(d);
        if (draft.grid) {
            draft.count = static_cast<double>(draft.grid->columns) * draft.grid->rows;
            return draft;
        }
        const Draft* equal = equalDraft(d, draft);
        draft.seeds = equal ? equal->seeds : latticeSeeds(draft.plane, lattice * draft.plane.size.edge());
        draft.count = 2 * static_cast<double>(draft.seeds.points.size()) +
                      static_cast<double>(draft.plane.boundary.size()) - 2 +
                      2 * (static_cast<double>(domains_[d].loops.size()) - 1);
        return draft;
    }

    void draftFor(double edge) {
        if (draftedEdge_ == edge) return;
        // Often that of the time before: what was looked at since is no better.
        std::swap(drafts_, earlierDrafts_);
        std::swap(draftedEdge_, earlierEdge_);
        sampler_.choose(edge, grading_);
        if (draftedEdge_ == edge) return;
        draftedEdge_ = edge;
        drafts_.clear();
        for (size_t d = 0; d < domains_.size(); ++d) drafts_.push_back(draftOf(d, 1));
    }

    struct Count {
        double sum = 0, unevenness = 0; // standard deviation over mean of the domains' mean areas
    };

    Count countFor(double edge) {
        const auto [known, isNew] = counts_.try_emplace(edge);
        Count& count = known->second;
        if (!isNew) return count;
        draftFor(edge);
        double area = 0, squares = 0;
        for (size_t d = 0; d < domains_.size(); ++d) {
            const double own = std::max(1.0, drafts_[d].count);
            count.sum += own;
            area += areas_[d];
            squares += areas_[d] * areas_[d] / own;
        }
        count.unevenness = std::sqrt(std::max(0.0, squares * count.sum / (area * area) - 1));
        return count;
    }

    void triangulate(size_t d) {
        Draft& draft = drafts_[d];
        if (draft.net || draft.grid) return;
        if (const Draft* equal = equalDraft(d, draft)) draft.net = equal->net;
        if (draft.net) return;
        beforePart_();
        draft.net = draftMesh(draft.plane, draft.seeds);
        if (!draft.net)
            throw MeshError(domains_[d].faces[0],
                            "the outline of a face crosses or touches itself and cannot be meshed");
    }

    // Triangulates what is left to; returns how many triangles there are.
    double finishDrafts() {
        double count = 0;
        for (size_t d = 0; d < drafts_.size(); ++d) {
            triangulate(d);
            const Draft& draft = drafts_[d];
            count += draft.grid ? draft.count : static_cast<double>(draft.net->corner.size());
        }
        return count;
    }

    // Where the count is a few too high or too low, once that is known, lattices a little coarser or finer.
    double settle(double count) {
        const double most = kCountReached * wanted_;
        for (const double step : {0.03, 0.06})
            for (size_t d = 0; d < drafts_.size(); ++d) {
                if (off(count) <= most || off(count) > 2 * most) return count;
                if (drafts_[d].count < 8 || drafts_[d].grid || faceOf(d).twin >= 0) continue;
                Draft old = std::exchange(drafts_[d], draftOf(d, count > wanted_ ? 1 + step : 1 - step));
                triangulate(d);
                const double now = count + static_cast<double>(drafts_[d].net->corner.size()) -
                                   static_cast<double>(old.net->corner.size());
                if (off(now) < off(count))
                    count = now;
                else
                    drafts_[d] = std::move(old);
            }
        return count;
    }

    // How many triangles refinement adds; less where those known would make edges too long already that are
    // to be chosen anew.
    double addedTriangles(double wanted, bool chosenAnew) {
        double added = 0;
        for (size_t d = 0; d < drafts_.size(); ++d) {
            const Draft& draft = drafts_[d];
            if (draft.plane.size.uniform() || draft.grid) continue;
            if (chosenAnew && tooLong(wanted - added)) break;
            triangulate(d);
            added += 2 * static_cast<double>(draft.net->points.size() - draft.plane.boundary.size() -
                                             draft.seeds.points.size());
        }
        return added;
    }

    // With so many added the drafts have the count, with room for half of what optimisation may add.
    bool fits(double added) const {
        for (const Draft& draft : drafts_) added += draft.count;
        return added >= wanted_ * (1 - kCountReached) &&
               added <= wanted_ * (1 + kCountReached) - mostAdditions(grading_);
    }

    // False when there are too few triangles for such grading.
    bool chooseSizes(double wanted) {
        for (int round = 0;; ++round) {
            // What refinement adds changes the edge length once more, so that near is good enough at first.
            const bool roughly =
                round == 0 && !addedKnown_ && sampler_.hasSmallParts(regularEdge(building_, wanted));
            if (!chooseEdge(wanted - added_, roughly) && std::isfinite(grading_.growth)) return false;
            chooseLattices(wanted - added_, roughly);
            // A few triangles more change the edge length, and so their own number, by next to nothing.
            if (round == 2 || addedKnown_) return true;
            const double now = addedTriangles(wanted, roughly);
            const bool settled = !roughly && (std::abs(now - added_) < 0.01 * wanted_ || fits(now));
            added_ = now;
            addedKnown_ = settled || round == 1;
            if (settled) return true;
        }
    }

    double scoreOf(double count, double unevenness, double wanted) const {
        constexpr double kMissed = 3.5; // a hundredth of the count too many is as bad as 0.035 of unevenness
        return kMissed * std::max(0.0, std::abs(count - wanted) - slack()) / wanted + unevenness;
    }

    void keepBest(double edge, double score, double& best) {
        if (score >= best) return;
        best = score;
        edge_ = edge;
    }

    // Edges a little longer or shorter may fit the walls better; fine meshes are worth a longer search.
    void lookAround(double wanted, double edge, double towards, double& best) {
        constexpr double kFine = 5000;
        for (const double step : {0.01, -0.01, 0.02}) {
            const double tried = edge * (1 + towards * step);
            const auto [count, unevenness] = countFor(tried);
            keepBest(tried, scoreOf(count, unevenness, wanted), best);
            if (wanted < kFine) break;
        }
    }

    // False when even the longest edges leave many more.
    bool chooseEdge(double wanted, bool roughly) {
        constexpr int kRounds = 5;
        constexpr double kRough = 0.04; // of the count
        double edge = edge_ > 0 ? edge_ : regularEdge(building_, wanted), least = 1e300;
        double low = 0, high = 0; // edges that give too many, too few
        double best = 1e300;
        for (int round = 0; round < kRounds; ++round) {
            const auto [count, unevenness] = countFor(edge);
            const double off = std::abs(count - wanted);
            if (round == 0 && edge_ == 0 && count > kFarTooMany * wanted && std::isfinite(grading_.growth))
                return false;
            least = std::min(least, off);
            keepBest(edge, scoreOf(count, unevenness, wanted), best);
            if (off <= (roughly ? kRough * wanted : slack())) {
                if (!roughly) lookAround(wanted, edge, count > wanted ? 1 : -1, best);
                break;
            }
            (count > wanted ? low : high) = edge;
            const bool bracketed = low > 0 && high > 0;
            const double guess = guessFrom(edge, count, wanted);
            lastEdge_ = edge;
            lastCount_ = count;
            if (high == 0 && guess > longest_ && std::isfinite(grading_.growth)) return false;
            edge = bracketed && (guess <= std::min(low, high) || guess >= std::max(low, high))
                       ? 0.5 * (low + high)
                       : guess;
        }
        return high > 0 || least <= (roughly ? kRough : kCountReached) * wanted;
    }

    double guessFrom(double edge, double count, double wanted) const {
        // Small parts have their triangles whatever the edge is: the count changes less than its square.
        double power = 2;
        if (lastEdge_ > 0 && lastCount_ != count && lastEdge_ != edge)
            power = std::clamp(-std::log(count / lastCount_) / std::log(edge / lastEdge_), 0.8, 2.5);
        return edge * std::pow(count / wanted, 1 / power);
    }

    // Whether the search from the edge chosen would end at once.
    bool tooLong(double wanted) {
        const double count = countFor(edge_).sum;
        return std::isfinite(grading_.growth) && count - wanted > slack() &&
               guessFrom(edge_, count, wanted) > longest_;
    }

    // How far the count may be off before what optimisation adds.
    double slack() const {
        return std::max(kCountTolerance * wanted_,
                        0.95 * (kCountReached * wanted_ - mostAdditions(grading_)));
    }

    double mostAdditions(const Grading& grading) const {
        return std::isfinite(grading.growth) ? std::min(kMostAdditions, kAdditionsOfCount * wanted_) : 0;
    }

    // Rows and columns come in whole numbers, so that the count jumps; lattices a little finer or coarser
    // than the boundary, one domain after the other, settle it.
    void chooseLattices(double wanted, bool roughly) {
        draftFor(edge_);
        if (roughly) return;
        double sum = 0;
        for (const Draft& draft : drafts_) sum += draft.count;
        for (const double step : {0.03, 0.06, 0.09}) // little everywhere rather than much in one place
            for (size_t d = 0; d < domains_.size() && std::abs(sum - wanted) > slack(); ++d) {
                if (drafts_[d].count < 8) continue;
                Draft draft = draftOf(d, sum > wanted ? 1 + step : 1 - step);
                const double now = sum - drafts_[d].count + draft.count;
                if (std::abs(now - wanted) >= std::abs(sum - wanted)) continue;
                drafts_[d] = std::move(draft);
                draftedEdge_ = 0; // not of this edge alone any more
                sum = now;
            }
    }

    // The vertices that divide an edge, from a to b, without its ends; the same for both faces.
    std::vector<uint32_t> edgeVertices(uint32_t a, uint32_t b) {
        const auto [place, isNew] = edgeVertices_.try_emplace(std::minmax(a, b));
        if (isNew) {
            const auto [from, to] = place->first;
            const glm::dvec3 p = building_.vertices[from], q = building_.vertices[to];
            for (const double t : plan_->sampler.divisions(from, to)) {
                place->second.push_back(static_cast<uint32_t>(mesh_.vertices.size()));
                mesh_.vertices.push_back(p + t * (q - p));
            }
        }
        std::vector<uint32_t> out = place->second;
        if (a > b) std::ranges::reverse(out);
        return out;
    }

    std::vector<uint32_t> loopVertices(const std::vector<uint32_t>& loop) {
        std::vector<uint32_t> out;
        for (size_t i = 0; i < loop.size(); ++i) {
            out.push_back(loop[i]);
            const auto inner = edgeVertices(loop[i], loop[(i + 1) % loop.size()]);
            out.insert(out.end(), inner.begin(), inner.end());
        }
        return out;
    }

    std::vector<uint32_t> boundaryVertices(const MeshDomain& domain) {
        std::vector<uint32_t> out;
        for (const auto& loop : domain.loops) {
            const auto vertices = loopVertices(loop);
            out.insert(out.end(), vertices.begin(), vertices.end());
        }
        return out;
    }

    void addTriangle(size_t domain, const std::array<uint32_t, 3>& t) {
        const Face& face = faceOf(domain);
        trianglesOf_[domain].push_back(static_cast<uint32_t>(mesh_.patchCount()));
        mesh_.addPatch(t, face.material, face.role, face.surface, face.room);
    }

    PatchMesh meshOnce(Plan& plan) {
        plan_ = &plan;
        count_ = plan.count;
        secondTries_ = SecondTries(kTriedAgain * wanted_);
        const double room = 0.5 * (wanted_ * (1 + kCountReached) - plan.count);
        additions_ = static_cast<size_t>(std::max(0.0, std::min(mostAdditions(plan.grading), room)));
        mesh_ = {};
        mesh_.materials = building_.materials;
        mesh_.vertices = building_.vertices;
        edgeVertices_.clear();
        trianglesOf_.assign(domains_.size(), {});
        std::map<uint32_t, size_t> domainOf; // of faces with a twin
        for (size_t d = 0; d < domains_.size(); ++d) {
            const Face& face = faceOf(d);
            const auto other =
                face.twin >= 0 ? domainOf.find(static_cast<uint32_t>(face.twin)) : domainOf.end();
            if (other != domainOf.end())
                mirror(other->second, d);
            else
                meshDomain(d);
            if (face.twin >= 0) domainOf[domains_[d].faces[0]] = d;
        }
        dropUnusedVertices(mesh_); // corners of seams
        return std::move(mesh_);
    }

    void meshDomain(size_t d) {
        beforePart_();
        Draft& draft = plan_->drafts[d];
        std::vector<uint32_t> vertices = boundaryVertices(domains_[d]);
        if (draft.grid) return meshGrid(d, vertices, *draft.grid);
        const double drafted = static_cast<double>(draft.net->corner.size()),
                     copies = faceOf(d).twin >= 0 ? 2 : 1, off = kCountReached * wanted_;
        const SecondTries::Range range{drafted + (wanted_ - off - count_) / copies,
                                       drafted + (wanted_ + off - count_) / copies};
        const PlanarMesh flat = secondTries_.best(
            improvedMesh(std::move(*draft.net), draft.plane, additions_), draft.plane, additions_, range);
        count_ += copies * (static_cast<double>(flat.triangles.size()) - drafted);
        const double room = std::max(0.0, 0.5 * (wanted_ + off - count_));
        additions_ = std::min(additions_ - flat.added, static_cast<size_t>(room));
        for (size_t i = vertices.size(); i < flat.points.size(); ++i) {
            vertices.push_back(static_cast<uint32_t>(mesh_.vertices.size()));
            mesh_.vertices.push_back(domains_[d].inSpace(flat.points[i]));
        }
        for (const auto& t : flat.triangles) addTriangle(d, {vertices[t[0]], vertices[t[1]], vertices[t[2]]});
    }

    // `border`: from the first corner on, round the board.
    void meshGrid(size_t d, const std::vector<uint32_t>& border, EdgeSampler::Grid grid) {
        const auto [columns, rows] = grid;
        const auto cornerAt = [&](size_t k) { return building_.vertices[domains_[d].loops[0][k]]; };
        const glm::dvec3 origin = cornerAt(0), column = (cornerAt(1) - origin) / static_cast<double>(columns),
                         row = (cornerAt(3) - origin) / static_cast<double>(rows);
        const auto inner = static_cast<uint32_t>(mesh_.vertices.size());
        for (uint32_t r = 1; r < rows; ++r)
            for (uint32_t c = 1; c < columns; ++c)
                mesh_.vertices.push_back(origin + static_cast<double>(c) * column +
                                         static_cast<double>(r) * row);
        const auto at = [&, columns = columns, rows = rows](uint32_t c, uint32_t r) {
            if (r == 0) return border[c];
            if (c == columns) return border[columns + r];
            if (r == rows) return border[2 * columns + rows - c];
            if (c == 0) return border[2 * (columns + rows) - r];
            return inner + (r - 1) * (columns - 1) + c - 1;
        };
        const Face& face = faceOf(d);
        for (uint32_t r = 0; r < rows; ++r)
            for (uint32_t c = 0; c < columns; ++c)
                mesh_.addPatch(std::array{at(c, r), at(c + 1, r), at(c + 1, r + 1), at(c, r + 1)},
                               face.material, face.role, face.surface, face.room);
    }

    // Per vertex on the border of a glass the one that stands opposite.
    std::map<uint32_t, uint32_t> oppositeVertices(size_t from, size_t to) {
        const auto loops = oppositeLoops(building_, faceOf(from), faceOf(to), kUniform);
        std::map<uint32_t, uint32_t> image;
        for (size_t l = 0; loops && l < loops->size(); ++l) {
            const auto& other = domains_[to].loops[(*loops)[l].loop];
            const auto own = loopVertices(domains_[from].loops[l]);
            auto its = loopVertices(other);
            if (own.size() != its.size())
                throw MeshError(domains_[from].faces[0], "the two sides of an interior window differ");
            std::ranges::reverse(its);
            std::ranges::rotate(its, std::ranges::find(its, other[(*loops)[l].first]));
            for (size_t k = 0; k < own.size(); ++k) image[own[k]] = its[k];
        }
        return image;
    }

    // From the plane of one glass to that of the other, by least squares of what is opposite: the two faces
    // of a wall need not be quite parallel.
    glm::dmat3 planeMap(size_t from, size_t to, const std::map<uint32_t, uint32_t>& image) const {
        glm::dmat3 own(0), both(0);
        for (const auto& [v, w] : image) {
            const glm::dvec3 p(domains_[from].frames[0].coordinates(mesh_.vertices[v]), 1),
                q(domains_[to].frames[0].coordinates(mesh_.vertices[w]), 1);
            own += glm::outerProduct(p, p);
            both += glm::outerProduct(q, p);
        }
        return both * glm::inverse(own);
    }

    // The other glass of an interior window gets the same triangles, seen from its own side.
    void mirror(size_t from, size_t to) {
        std::map<uint32_t, uint32_t> image = oppositeVertices(from, to);
        const glm::dmat3 onPlane = planeMap(from, to, image);
        const std::vector<uint32_t> triangles = trianglesOf_[from];
        for (const uint32_t patch : triangles) {
            std::array<uint32_t, 3> corner{};
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t v = mesh_.patch(patch)[k];
                const auto [place, isNew] =
                    image.try_emplace(v, static_cast<uint32_t>(mesh_.vertices.size()));
                if (isNew) {
                    const glm::dvec2 p = domains_[from].frames[0].coordinates(mesh_.vertices[v]);
                    mesh_.vertices.push_back(domains_[to].inSpace(glm::dvec2(onPlane * glm::dvec3(p, 1))));
                }
                corner[2 - k] = place->second;
            }
            addTriangle(to, corner);
            const size_t last = mesh_.patchCount() - 1;
            mesh_.twin[last] = static_cast<int32_t>(patch);
            mesh_.twin[patch] = static_cast<int32_t>(last);
        }
    }

    const Building& building_;
    const std::function<void()>& beforePart_;
    // `regular_`: the edge length of so many equal triangles, metres.
    double wanted_, narrowest_, regular_;
    double longest_ = kUniform;   // edge that is worth looking at with this grading, metres
    double edge_ = 0, added_ = 0; // added: triangles that refinement adds, as far as known
    size_t additions_ = 0;        // points that optimisation may still add
    double count_ = 0;            // of triangles, as far as known when a domain is meshed
    SecondTries secondTries_{0};
    std::vector<double> areas_; // per domain
    std::vector<size_t> equal_; // per domain: the first one with the same outlines
    std::vector<Draft> drafts_; // per domain, for the edge and lattices chosen
    double draftedEdge_ = 0;    // of all drafts, with the grading; the sampler's too
    std::vector<Draft> earlierDrafts_;
    double earlierEdge_ = 0;         // of these
    std::map<double, Count> counts_; // by edge, of those looked at with this grading
    double lastEdge_ = 0, lastCount_ = 0;
    Grading grading_;
    bool addedKnown_ = false; // at this grading
    std::vector<MeshDomain> domains_;
    EdgeSampler sampler_;
    Plan* plan_ = nullptr; // that is being meshed
    PatchMesh mesh_;
    std::map<std::pair<uint32_t, uint32_t>, std::vector<uint32_t>> edgeVertices_;
    std::vector<std::vector<uint32_t>> trianglesOf_; // per domain
};

PatchMesh meshOf(const Building& building, const MeshOptions& options) {
    try {
        return BuildingMesher(building, options, false).mesh();
    } catch (const MeshError&) {
        return BuildingMesher(building, options, true).mesh();
    }
}

} // namespace

double fittingFacet(double surface, const MeshOptions& options) {
    return kColumn * regularEdge(surface, static_cast<double>(options.triangles)) / kMetresPerInch;
}

PatchMesh meshBuilding(const Building& building, const MeshOptions& options) {
    if (building.faces.empty()) return {};
    PatchMesh mesh = meshOf(building, options);
    mesh.outside = building.outside;
    return mesh;
}

} // namespace heliodon::geometry
