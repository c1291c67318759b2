#include "geometry/edge_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "geometry/board_rows.h"
#include "geometry/lattice_seeds.h"
#include "geometry/perpendicular.h"
#include "geometry/surroundings.h"
#include "geometry/twin_faces.h"

namespace heliodon::geometry {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kWorthGrading = 0.8; // of the edge length: sizes above make no difference
// A strip w wide with its sides divided in steps of s, staggered by half a step, has angles atan(2 w / s) and
// atan(s / 2 w): at least 36 degrees for w / s within the first two, 26.6 from the third on. That is enough
// for thin strips: shorter steps would only make what lies beside them as small as they are.
constexpr double kNarrowStrip = 0.363, kWideStrip = 0.688, kThinStrip = 0.25;
constexpr double kThin = 0.5;          // of the edge length
constexpr double kThinnest = 0.4;      // likewise: wider ones have steps as short as their ends
constexpr double kFinestStrip = 0.7;   // of the edge length
constexpr double kRowLength = 1.1;     // of the next side: as long, but for slanted ends
constexpr double kHalfStep = 0.55;     // of the step beside it: what half a step is at most
constexpr double kNearEnd = 0.8;       // of half a step: nearer to an end of an edge none is pinned
constexpr double kUniformStrip = 0.76; // of the edge length: a strip this wide needs no staggering
// Where rectangles of a strip are halved: their width over their length, for angles of 36 degrees. So wide a
// strip has room for points inside.
constexpr double kHalvedStrip = 1.376, kRoomInside = 1.45;

// The places that divide the way from the first to the last pair into n parts of as many steps each.
void divideEvenly(const std::vector<std::pair<double, double>>& steps, double n, std::vector<double>& out) {
    size_t i = 0;
    for (double k = 1; k < n; ++k) {
        const double wanted = steps.back().second * k / n;
        while (steps[i + 1].second < wanted) ++i;
        const auto [from, before] = steps[i];
        const auto [to, after] = steps[i + 1];
        out.push_back(from + (to - from) * (wanted - before) / (after - before));
    }
}

} // namespace

EdgeSampler::EdgeSampler(const Building& building, const std::vector<MeshDomain>& domains, SlotSizes slots,
                         std::vector<uint32_t> boardRows)
    : building_(building), domains_(domains), slots_(std::move(slots)), boardRows_(std::move(boardRows)),
      leaning_(building, domains) {
    for (const MeshDomain& domain : domains) directions_.push_back(mainDirection(domain));
    collectEdges();
    for (const MeshDomain& domain : domains) surroundings_.push_back(surroundingsOf(domain));
    pairTwins();
    findStrips();
}

void EdgeSampler::collectEdges() {
    for (uint32_t d = 0; d < domains_.size(); ++d) {
        loopEdges_.emplace_back();
        for (const auto& loop : domains_[d].loops) {
            loopEdges_.back().emplace_back();
            for (size_t k = 0; k < loop.size(); ++k) {
                const auto [a, b] = std::minmax(loop[k], loop[(k + 1) % loop.size()]);
                const auto [found, isNew] = edgeOf_.try_emplace({a, b}, static_cast<uint32_t>(edges_.size()));
                if (isNew)
                    edges_.push_back({a, b, glm::length(position(b) - position(a)), kInfinity, {}, {}});
                SampledEdge& edge = edges_[found->second];
                edge.domains.push_back(d);
                edge.finest = std::min(edge.finest, slots_.longest[d]);
                loopEdges_.back().back().push_back(found->second);
            }
        }
    }
}

void EdgeSampler::pairTwins() {
    std::map<uint32_t, size_t> domainOf;
    std::vector<std::vector<TwinEdge>> opposite(edges_.size());
    for (size_t d = 0; d < domains_.size(); ++d) {
        const Face& face = building_.faces[domains_[d].faces[0]];
        if (face.twin < 0) continue;
        domainOf[domains_[d].faces[0]] = d;
        if (const auto other = domainOf.find(static_cast<uint32_t>(face.twin)); other != domainOf.end())
            matchTwins(other->second, d, opposite);
    }
    std::vector<bool> seen(edges_.size(), false);
    for (uint32_t start = 0; start < edges_.size(); ++start)
        if (!opposite[start].empty() && !seen[start]) collectTwins(start, opposite, seen);
}

void EdgeSampler::matchTwins(size_t from, size_t to, std::vector<std::vector<TwinEdge>>& opposite) const {
    const auto loops = oppositeLoops(building_, building_.faces[domains_[from].faces[0]],
                                     building_.faces[domains_[to].faces[0]], kInfinity);
    if (!loops) throw std::runtime_error("the two sides of an interior window differ");
    for (size_t l = 0; l < loops->size(); ++l) {
        const auto &loop = domains_[from].loops[l], &other = domains_[to].loops[(*loops)[l].loop];
        for (size_t k = 0, n = loop.size(); k < n; ++k) {
            const size_t start = (*loops)[l].corner(k, n), end = (*loops)[l].corner(k + 1, n);
            const uint32_t e = loopEdges_[from][l][k], f = loopEdges_[to][(*loops)[l].loop][end];
            const uint32_t oppositeA = loop[k] == edges_[e].a ? other[start] : other[end];
            const bool reversed = edges_[f].a != oppositeA;
            opposite[e].push_back({f, reversed});
            opposite[f].push_back({e, reversed});
        }
    }
}

// An edge may belong to glasses of several windows, and so have several others opposite.
void EdgeSampler::collectTwins(uint32_t start, const std::vector<std::vector<TwinEdge>>& opposite,
                               std::vector<bool>& seen) {
    TwinEdges group{{{start, false}}, false};
    std::map<uint32_t, bool> reversed{{start, false}};
    seen[start] = true;
    for (size_t i = 0; i < group.edges.size(); ++i)
        for (const TwinEdge& next : opposite[group.edges[i].edge]) {
            const bool turned = group.edges[i].reversed != next.reversed;
            const auto [place, isNew] = reversed.try_emplace(next.edge, turned);
            if (isNew) {
                group.edges.push_back({next.edge, turned});
                seen[next.edge] = true;
            } else if (place->second != turned) // only what is symmetric fits both ways
                group.even = true;
        }
    twins_.push_back(std::move(group));
}

// The finest of the divisions that were chosen for the edges one by one.
void EdgeSampler::shareDivisions(const TwinEdges& group) {
    const auto finest = std::ranges::max_element(
        group.edges, {}, [&](const TwinEdge& e) { return edges_[e.edge].divisions.size(); });
    std::vector<double> forth = edges_[finest->edge].divisions;
    if (group.even)
        for (size_t k = 0; k < forth.size(); ++k)
            forth[k] = static_cast<double>(k + 1) / static_cast<double>(forth.size() + 1);
    std::vector<double> back = forth;
    std::ranges::reverse(back);
    for (double& t : back) t = 1 - t;
    for (const TwinEdge& e : group.edges)
        edges_[e.edge].divisions = e.reversed == finest->reversed ? forth : back;
}

bool EdgeSampler::hasSlots() const {
    return std::ranges::any_of(boardRows_, [](uint32_t rows) { return rows > 0; }) ||
           std::ranges::any_of(slots_.longest, [](double size) { return std::isfinite(size); }) ||
           std::ranges::any_of(slots_.parts, [](const auto& sources) { return !sources.empty(); });
}

bool EdgeSampler::hasSmallParts(double edge) const {
    const double least = kWorthGrading * edge / Grading{}.first;
    const auto isSmall = [&](const std::vector<double>& loop) { return std::ranges::min(loop) < least; };
    return std::ranges::any_of(slots_.longest, [&](double size) { return size < edge; }) ||
           std::ranges::any_of(slots_.parts, [](const auto& sources) { return !sources.empty(); }) ||
           std::ranges::any_of(strips_, [&](const Strip& s) { return s.width < kUniformStrip * edge; }) ||
           std::ranges::any_of(surroundings_,
                               [&](const auto& loops) { return std::ranges::any_of(loops, isSmall); });
}

double EdgeSampler::narrowTriangles(double edge) const {
    double count = 0;
    for (const Strip& strip : strips_) {
        if (strip.width < 0.5 * edge) count += 2 * edges_[strip.side].length / stepIn(strip, edge);
    }
    return count;
}

double EdgeSampler::stepIn(const Strip& strip, double edge) const {
    const double longest = strip.width < kThin * edge ? kThinStrip : kNarrowStrip;
    return std::clamp(edge, strip.width / kWideStrip, strip.width / longest);
}

double EdgeSampler::longestEdge(double finest) const {
    return sizesSlots() ? std::min(edge_, finest) : edge_;
}

double EdgeSampler::sizeOf(uint32_t corner, double surroundings) const {
    const double size = grading_.first * surroundings;
    return std::min(size < kWorthGrading * edge_ ? size : kInfinity, eased_[corner]);
}

void EdgeSampler::choose(double edge, const Grading& grading) {
    edge_ = edge;
    grading_ = grading;
    if (std::isfinite(grading.growth) && edge > reach_) findNearCorners(2 * edge);
    eased_.assign(building_.vertices.size(), kInfinity);
    for (SampledEdge& e : edges_) {
        e.even = e.graded = false;
        e.thinIn = kNone;
        e.pins.clear();
        e.most = kInfinity;
    }
    for (const bool rims : {false, true})
        for (size_t d = 0; d < domains_.size(); ++d)
            if (grading.slots && boardRows_[d] > 0 && rims == (boardRows_[d] == 1)) divideBoard(d);
    if (std::isfinite(grading.growth)) {
        for (size_t d = 0; d < domains_.size(); ++d) divideEnds(d);
        for (const Strip& strip : strips_) stagger(strip);
    }
    for (SampledEdge& e : edges_) divide(e);
    if (std::isfinite(grading.growth)) easeCorners();
    for (const TwinEdges& group : twins_) shareDivisions(group);
}

// What is divided already, as a rim's sides along the boards that it joins, stays.
void EdgeSampler::divideBoard(size_t d) {
    const auto& sides = loopEdges_[d][0];
    const size_t lengthwise = edges_[sides[0]].length > edges_[sides[1]].length ? 0 : 1;
    for (size_t k = 0; k < 4; ++k) {
        SampledEdge& edge = edges_[sides[k]];
        if (edge.even) continue;
        const double count = k % 2 == lengthwise
                                 ? std::max(1.0, std::round(edge.length / (kBoardColumn * edge_)))
                                 : static_cast<double>(boardRows_[d]);
        edge.divisions.clear();
        for (double i = 1; i < count; ++i) edge.divisions.push_back(i / count);
        edge.even = true;
    }
}

std::optional<EdgeSampler::Grid> EdgeSampler::grid(size_t d) const {
    if (!grading_.slots || boardRows_[d] == 0) return std::nullopt;
    std::array<uint32_t, 4> steps;
    for (size_t k = 0; k < 4; ++k)
        steps[k] = static_cast<uint32_t>(edges_[loopEdges_[d][0][k]].divisions.size() + 1);
    // What lies beside it may have divided one side of it otherwise.
    if (steps[0] != steps[2] || steps[1] != steps[3]) return std::nullopt;
    return Grid{steps[0], steps[1]};
}

// The ends of a wall as its folds are divided, where it has narrow facets there.
void EdgeSampler::divideEnds(size_t d) {
    const std::vector<double> folds = leaning_.folds(d, edge_, grading_.narrowest);
    if (folds.empty()) return;
    const MeshDomain& domain = domains_[d];
    const auto [low, high] = extentOf(domain);
    for (const auto& [width, x] :
         {std::pair(folds.front() - low, low), std::pair(high - folds.back(), high)}) {
        const ColumnSteps steps(width, edge_, true);
        if (!steps.staggered) continue;
        for (size_t l = 0; l < domain.loops.size(); ++l)
            for (size_t k = 0, n = domain.loops[l].size(); k < n; ++k) {
                SampledEdge& edge = edges_[loopEdges_[d][l][k]];
                const MeshDomain::Frame& frame = domain.frames[domain.frameOf[l][k]];
                const double same = 0.1 * width, from = frame.coordinates(position(domain.loops[l][k])).x,
                             to = frame.coordinates(position(domain.loops[l][(k + 1) % n])).x;
                if (edge.even || std::abs(from - x) > same || std::abs(to - x) > same) continue;
                const auto sizes = stepsAlong(edge, steps.step);
                edge.divisions.clear();
                divideEvenly(sizes, steps.count(edge.length, sizes.back().second), edge.divisions);
                edge.even = true;
            }
    }
}

double EdgeSampler::spreadOf(const SampledEdge& edge) const {
    constexpr double kGoldenRatio = 0.6180339887498949; // its multiples lie evenly between whole numbers
    const double place = kGoldenRatio * static_cast<double>(&edge - edges_.data());
    return grading_.spread * (place - std::floor(place) - 0.5);
}

void EdgeSampler::divide(SampledEdge& edge) const {
    if (edge.even) return;
    if (!edge.pins.empty()) return fillBetweenPins(edge);
    const auto steps = stepsAlong(edge, longestEdge(edge.finest));
    edge.graded = steps.size() > 2;
    edge.divisions.clear();
    // Steps as many times too long or too short: one of 1.45 is worse than two of 0.73.
    const double count = steps.back().second * (1 + spreadOf(edge)), fewer = std::floor(count),
                 wanted = count * count > fewer * (fewer + 1) - 1e-7 ? fewer + 1 : fewer;
    divideEvenly(steps, std::max(1.0, std::min(wanted, edge.graded ? kInfinity : edge.most)), edge.divisions);
}

// For each edge the corners of its domains that may want steps along it shorter than `reach`.
void EdgeSampler::findNearCorners(double reach) {
    constexpr Grading kFinest{};
    reach_ = reach;
    for (SampledEdge& edge : edges_) {
        edge.nearCorners.clear();
        const glm::dvec3 a = position(edge.a), along = position(edge.b) - a;
        for (const uint32_t d : edge.domains)
            for (size_t l = 0; l < domains_[d].loops.size(); ++l)
                for (size_t k = 0; k < domains_[d].loops[l].size(); ++k) {
                    const double own = surroundings_[d][l][k], size = kFinest.first * own;
                    if (size >= reach) continue;
                    const uint32_t v = domains_[d].loops[l][k];
                    const glm::dvec3 p = position(v);
                    const double t = std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0, 1.0),
                                 distance = glm::length(p - a - t * along),
                                 least = size + kFinest.growth * distance;
                    if (least < reach) edge.nearCorners.push_back({least, distance, own, v, d});
                }
        std::ranges::stable_sort(edge.nearCorners, {}, &NearCorner::least);
    }
}

void EdgeSampler::findStrips() {
    constexpr size_t kMostEdges = 400; // of a domain: pairs are looked at one by one
    for (size_t d = 0; d < domains_.size(); ++d) {
        const MeshDomain& domain = domains_[d];
        if (domain.frames.size() != 1) continue;
        struct Side {
            uint32_t edge;
            glm::dvec2 a, b;
        };
        std::vector<Side> sides;
        for (size_t l = 0; l < domain.loops.size(); ++l)
            for (size_t k = 0, n = domain.loops[l].size(); k < n; ++k)
                sides.push_back({loopEdges_[d][l][k], domain.planar[l][k], domain.planar[l][(k + 1) % n]});
        if (sides.size() > kMostEdges) continue;
        for (const Side& s : sides)
            for (const Side& o : sides)
                if (edges_[s.edge].length < edges_[o.edge].length ||
                    (edges_[s.edge].length == edges_[o.edge].length && s.edge < o.edge))
                    considerStrip(static_cast<uint32_t>(d), s.edge, s.a, s.b, o.edge, o.a, o.b);
    }
    std::ranges::stable_sort(strips_, {}, &Strip::width);
}

// They run against one another, and the other one stands before all of the shorter one.
void EdgeSampler::considerStrip(uint32_t domain, uint32_t side, glm::dvec2 a, glm::dvec2 b, uint32_t other,
                                glm::dvec2 c, glm::dvec2 d) {
    constexpr double kParallelCosine = -0.995;
    const glm::dvec2 along = glm::normalize(b - a), back = glm::normalize(d - c);
    if (glm::dot(along, back) > kParallelCosine) return;
    const glm::dvec2 inward(-along.y, along.x);
    const double width = 0.5 * (glm::dot(c - a, inward) + glm::dot(d - a, inward)),
                 length = glm::length(b - a);
    const double from = glm::dot(d - a, along), to = glm::dot(c - a, along);
    if (width <= 0 || length < 1.5 * width || from > 0.3 * width || to < length - 0.3 * width) return;
    strips_.push_back({domain, side, other, width});
}

void EdgeSampler::stagger(const Strip& strip) {
    constexpr double kLongest = 0.8; // of as many steps as there would be
    SampledEdge &side = edges_[strip.side], &other = edges_[strip.other];
    const double edge = longestEdge(std::min(side.finest, other.finest)), step = stepIn(strip, edge);
    if (strip.width > kUniformStrip * edge && strip.width < kRoomInside * edge)
        for (SampledEdge* e : {&side, &other}) // rather a little longer than sharp
            if (const double most = std::floor(kHalvedStrip * e->length / strip.width);
                most * edge > kLongest * e->length)
                e->most = std::min(e->most, most);
    if (strip.width > kUniformStrip * edge || step < kFinestStrip * edge) return;
    // The one that a strip beside this one has divided leads: strips in a row go by turns.
    const bool turned = other.even || !other.pins.empty();
    if (turned && (side.even || !side.pins.empty())) return;
    SampledEdge &lead = turned ? other : side, &follower = turned ? side : other;
    if (!lead.pins.empty()) {
        if (lead.length > kRowLength * follower.length) return; // pins may come from elsewhere too
        fillBetweenPins(lead);
        lead.pins.clear();
        lead.even = true;
    } else if (!lead.even) {
        // Its own ends, which are as short as it is wide, ask for no shorter steps of a very thin one.
        const auto steps = stepsAlong(lead, step, strip.width < kThinnest * edge ? strip.domain : kNone);
        lead.divisions.clear();
        divideEvenly(steps, std::max(1.0, std::round(steps.back().second)), lead.divisions);
        lead.even = true;
    }
    if (strip.width < kThin * edge) follower.thinIn = strip.domain;
    pinBetween(lead, follower);
}

// Half a step off the divisions of the edge on the other side of a strip.
void EdgeSampler::pinBetween(const SampledEdge& lead, SampledEdge& follower) const {
    const glm::dvec3 from = position(follower.a), along = (position(follower.b) - from) / follower.length;
    const glm::dvec3 a = position(lead.a), d = position(lead.b) - a;
    std::vector<double> at{glm::dot(a - from, along)}; // of the leading side's points on this one
    for (const double t : lead.divisions) at.push_back(glm::dot(a + t * d - from, along));
    at.push_back(glm::dot(a + d - from, along));
    // Half a step at an end counts as none: else steps would shrink from strip to strip.
    const auto isHalf = [&](size_t end, size_t next, size_t after) {
        return at.size() > 3 && std::abs(at[next] - at[end]) < kHalfStep * std::abs(at[after] - at[next]);
    };
    const size_t last = at.size() - 1;
    const bool shortLast = isHalf(last, last - 1, last - 2);
    if (isHalf(0, 1, 2)) at.erase(at.begin());
    if (shortLast) at.pop_back();
    // Beyond the ends of a shorter side too, where this one goes on.
    at.insert(at.begin(), 2 * at[0] - at[1]);
    at.push_back(2 * at.back() - at[at.size() - 2]);
    for (size_t k = 0; k + 1 < at.size(); ++k) {
        const double middle = 0.5 * (at[k] + at[k + 1]), half = 0.5 * std::abs(at[k + 1] - at[k]);
        if (middle > kNearEnd * half && middle < follower.length - kNearEnd * half)
            follower.pins.push_back(middle);
    }
}

void EdgeSampler::fillBetweenPins(SampledEdge& edge) const {
    std::ranges::sort(edge.pins);
    std::vector<double> kept{0};
    for (const double at : edge.pins) // pins of two strips that end side by side
        if (at - kept.back() > 0.3 * edge_ || kept.size() == 1)
            kept.push_back(at);
        else
            kept.back() = 0.5 * (kept.back() + at);
    kept.push_back(edge.length);
    const auto steps = stepsAlong(edge, longestEdge(edge.finest));
    const auto countAt = [&](double fraction) {
        size_t i = 0;
        while (i + 2 < steps.size() && steps[i + 1].first < fraction) ++i;
        const auto [from, before] = steps[i];
        const auto [to, after] = steps[i + 1];
        return before + (after - before) * (fraction - from) / (to - from);
    };
    edge.divisions.clear();
    for (size_t i = 0; i + 1 < kept.size(); ++i) {
        const double from = kept[i] / edge.length, to = kept[i + 1] / edge.length;
        const double count = countAt(to) - countAt(from), n = std::max(1.0, std::floor(count + 0.4));
        if (i > 0) edge.divisions.push_back(from);
        std::vector<std::pair<double, double>> part{{from, 0.0}};
        for (const auto& [at, before] : steps)
            if (at > from + 1e-9 && at < to - 1e-9) part.emplace_back(at, before - countAt(from));
        part.emplace_back(to, count);
        divideEvenly(part, n, edge.divisions);
    }
}

std::vector<std::pair<double, double>> EdgeSampler::stepsAlong(const SampledEdge& edge, double largest,
                                                               uint32_t besides) const {
    const glm::dvec3 a = position(edge.a), d = position(edge.b) - a;
    std::vector<std::pair<glm::dvec3, double>> sources;
    for (const NearCorner& near : edge.nearCorners) {
        if (near.least >= largest || !std::isfinite(grading_.growth)) break;
        if (near.domain == besides) continue;
        const double size = sizeOf(near.corner, near.surroundings);
        if (size + grading_.growth * near.distance < largest)
            sources.emplace_back(position(near.corner), size);
    }
    for (const uint32_t end : {edge.a, edge.b})
        if (eased_[end] < largest) sources.emplace_back(position(end), eased_[end]);
    if (sources.empty()) return {{0.0, 0.0}, {1.0, edge.length / largest}};
    std::vector<std::pair<double, double>> steps{{0.0, 0.0}};
    for (double s = 0, count = 0; s < edge.length;) {
        double size = largest;
        const glm::dvec3 at = a + d * (s / edge.length);
        for (const auto& [p, own] : sources) { // most are too far away to matter
            const double reach = (size - own) / grading_.growth, square = glm::dot(at - p, at - p);
            if (reach > 0 && square < reach * reach) size = own + grading_.growth * std::sqrt(square);
        }
        const double step = std::min(0.25 * size, edge.length - s);
        s = edge.length - s - step < 1e-9 * edge.length ? edge.length : s + step;
        count += step / size;
        steps.emplace_back(s / edge.length, count);
    }
    return steps;
}

// A long step beside a short one at a right corner makes a sharp triangle: evenly divided edges take one step
// more, and, where that made their own too short for the next ones, those too.
void EdgeSampler::easeCorners() {
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds && easeOnce(); ++round) {
    }
    for (int round = 0; !grading_.sparing && round < kRounds && easeGraded(); ++round) {
    }
}

double EdgeSampler::stepAt(const SampledEdge& edge, uint32_t end) const {
    if (edge.divisions.empty()) return edge.length;
    return edge.length * (end == edge.a ? edge.divisions.front() : 1 - edge.divisions.back());
}

// Beside the short steps of a strip those of other edges begin with shorter ones too, and grow from there.
bool EdgeSampler::easeGraded() {
    constexpr double kMostBeside = 1.4, kFirst = 0.9, kShorter = 0.85, kFinestEased = 0.2;
    constexpr double kMostCosine = -0.3; // of the corner: no triangle goes round a wider one
    std::vector<bool> finer(edges_.size());
    for (size_t d = 0; d < domains_.size(); ++d)
        for (size_t l = 0; l < loopEdges_[d].size(); ++l)
            for (size_t k = 0, n = loopEdges_[d][l].size(); k < n; ++k) {
                const std::vector<glm::dvec2>& p = domains_[d].planar[l];
                const glm::dvec2 in = p[k] - p[(k + n - 1) % n], out = p[(k + 1) % n] - p[k];
                if (cross(in, out) <= 0 ||
                    -glm::dot(in, out) < kMostCosine * glm::length(in) * glm::length(out))
                    continue;
                const uint32_t v = domains_[d].loops[l][k];
                uint32_t e = loopEdges_[d][l][(k + n - 1) % n], f = loopEdges_[d][l][k];
                double own = stepAt(edges_[e], v), next = stepAt(edges_[f], v);
                if (own > next) {
                    std::swap(own, next);
                    std::swap(e, f);
                }
                if (next < kMostBeside * own || own < kFinestEased * edge_ || edges_[f].even ||
                    edges_[f].thinIn == d || edges_[f].divisions.empty())
                    continue;
                eased_[v] = std::min(kFirst * own, kShorter * eased_[v]);
                finer[f] = true;
            }
    bool any = false;
    for (size_t e = 0; e < edges_.size(); ++e) {
        if (!finer[e]) continue;
        divide(edges_[e]);
        any = true;
    }
    return any;
}

bool EdgeSampler::easeOnce() {
    constexpr double kMostBeside = 1.42;
    std::vector<bool> finer(edges_.size());
    for (size_t d = 0; d < domains_.size(); ++d)
        for (const auto& loop : loopEdges_[d])
            for (size_t k = 0; k < loop.size(); ++k) {
                const uint32_t e = loop[k], f = loop[(k + 1) % loop.size()];
                const double own = edges_[e].length / static_cast<double>(edges_[e].divisions.size() + 1),
                             next = edges_[f].length / static_cast<double>(edges_[f].divisions.size() + 1);
                const auto mayGrow = [&](uint32_t edge) {
                    return !edges_[edge].even && edges_[edge].pins.empty() && !edges_[edge].graded;
                };
                if (edges_[f].graded || edges_[e].graded) continue;
                if (own > kMostBeside * next && mayGrow(e)) finer[e] = true;
                if (next > kMostBeside * own && mayGrow(f)) finer[f] = true;
            }
    bool any = false;
    for (size_t e = 0; e < edges_.size(); ++e) {
        if (!finer[e]) continue;
        any = true;
        const auto n = static_cast<double>(edges_[e].divisions.size() + 2);
        edges_[e].divisions.clear();
        for (double k = 1; k < n; ++k) edges_[e].divisions.push_back(k / n);
    }
    return any;
}

std::vector<double> EdgeSampler::divisions(uint32_t a, uint32_t b) const {
    const auto found = edgeOf_.find(std::minmax(a, b));
    if (found == edgeOf_.end()) return {};
    std::vector<double> out = edges_[found->second].divisions;
    if (a > b) {
        std::ranges::reverse(out);
        for (double& t : out) t = 1 - t;
    }
    return out;
}

PlanarDomain EdgeSampler::planar(size_t d) const {
    const MeshDomain& domain = domains_[d];
    PlanarDomain plane;
    std::vector<SizeSource> sources;
    if (sizesSlots()) sources = slots_.parts[d];
    for (size_t l = 0; l < domain.loops.size(); ++l) {
        const auto& loop = domain.loops[l];
        for (size_t i = 0, n = loop.size(); i < n; ++i) {
            const SampledEdge& edge = edges_[loopEdges_[d][l][i]];
            const MeshDomain::Frame& frame = domain.frames[domain.frameOf[l][i]];
            const glm::dvec2 from = domain.planar[l][i], to = frame.coordinates(position(loop[(i + 1) % n]));
            if (const double size = sizeOf(loop[i], surroundings_[d][l][i]); size < kInfinity)
                sources.push_back({from, size});
            plane.boundary.push_back(from);
            const size_t count = edge.divisions.size();
            const double beside = longestEdge(edge.finest) < kWorthGrading * longestEdge(slots_.longest[d])
                                      ? edge.length / static_cast<double>(count + 1)
                                      : kInfinity;
            if (beside < kInfinity) sources.push_back({from, beside});
            for (size_t k = 0; k < count; ++k) {
                const double t = loop[i] == edge.a ? edge.divisions[k] : 1 - edge.divisions[count - 1 - k];
                plane.boundary.push_back(from + t * (to - from));
                if (beside < kInfinity) sources.push_back({plane.boundary.back(), beside});
            }
        }
        plane.loopStart.push_back(static_cast<uint32_t>(plane.boundary.size()));
    }
    plane.direction = directions_[d];
    plane.folds = leaning_.folds(d, edge_, grading_.narrowest);
    plane.mayLean = !plane.folds.empty() && leaning_.mayLean(d, edge_);
    plane.graded = std::isfinite(grading_.growth);
    plane.dividesSlim = !grading_.sparing;
    plane.size = {std::move(sources), longestEdge(slots_.longest[d]), grading_.growth};
    return plane;
}

} // namespace heliodon::geometry
