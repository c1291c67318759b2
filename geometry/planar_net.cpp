#include "geometry/planar_net.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace heliodon::geometry {

bool PlanarNet::flip(uint32_t t, size_t k) {
    const uint32_t u = neighbour[t][k];
    if (u == kNoTriangle || fixed[t][k]) return false;
    size_t m = 0;
    while (neighbour[u][m] != t) ++m;
    const uint32_t p = corner[t][k], a = corner[t][(k + 1) % 3], b = corner[t][(k + 2) % 3], q = corner[u][m];
    if (!prefersFlip(p, a, b, q)) return false;
    // p a b + q b a  ->  p a q + q b p
    const uint32_t na = neighbour[t][(k + 1) % 3], nb = neighbour[t][(k + 2) % 3]; // across b-p, across p-a
    const uint32_t ma = neighbour[u][(m + 2) % 3], mb = neighbour[u][(m + 1) % 3];
    const bool fa = fixed[t][(k + 1) % 3], fb = fixed[t][(k + 2) % 3];
    const bool ga = fixed[u][(m + 2) % 3], gb = fixed[u][(m + 1) % 3];
    // In u the corners are q, b, a: (m+1) is b, (m+2) is a; across a-q lies the neighbour opposite b.
    corner[t] = {p, a, q};
    neighbour[t] = {mb, u, nb};
    fixed[t] = {gb, false, fb};
    corner[u] = {q, b, p};
    neighbour[u] = {na, t, ma};
    fixed[u] = {fa, false, ga};
    relink(mb, u, t);
    relink(na, t, u);
    return true;
}

void PlanarNet::relink(uint32_t triangle, uint32_t from, uint32_t to) {
    if (triangle == kNoTriangle) return;
    for (uint32_t& n : neighbour[triangle])
        if (n == from) {
            n = to;
            return;
        }
}

bool PlanarNet::prefersFlip(uint32_t p, uint32_t a, uint32_t b, uint32_t q) const {
    // Angles opposite the diagonal add up to more than two right ones.
    const glm::dvec2 pa = points[a] - points[p], pb = points[b] - points[p], qa = points[a] - points[q],
                     qb = points[b] - points[q];
    const double sum = cross(pa, pb) * glm::dot(qb, qa) + glm::dot(pa, pb) * cross(qb, qa);
    if (sum >= -1e-12 * glm::dot(pa, pa) * glm::dot(qb, qb)) return false;
    const double least = 1e-9 * (std::abs(twiceArea(p, a, b)) + std::abs(twiceArea(q, b, a)));
    return twiceArea(p, a, q) > least && twiceArea(q, b, p) > least;
}

void PlanarNet::flipAll() {
    for (int round = 0; round < 10; ++round) {
        bool flipped = false;
        for (uint32_t t = 0; t < corner.size(); ++t)
            for (size_t k = 0; k < 3; ++k)
                // Each edge from one side; those on the boundary have none.
                if (neighbour[t][k] != kNoTriangle && neighbour[t][k] > t) flipped |= flip(t, k);
        if (!flipped) return;
    }
}

uint32_t PlanarNet::locate(uint32_t t, glm::dvec2 p) const {
    for (size_t step = 0; step < 64; ++step) {
        size_t k = 0;
        for (; k < 3; ++k) {
            const glm::dvec2 a = points[corner[t][(k + 1) % 3]], b = points[corner[t][(k + 2) % 3]];
            if (cross(b - a, p - a) < 0) break;
        }
        if (k == 3) return t;
        if (fixed[t][k] || neighbour[t][k] == kNoTriangle) return kNoTriangle;
        t = neighbour[t][k];
    }
    return kNoTriangle;
}

void PlanarNet::insert(uint32_t t, glm::dvec2 p) {
    const auto v = static_cast<uint32_t>(points.size());
    points.push_back(p);
    slides.push_back(false);
    const auto [a, b, c] = corner[t];
    const auto n = neighbour[t];
    const auto f = fixed[t];
    const auto second = static_cast<uint32_t>(corner.size()), third = second + 1;
    corner[t] = {a, b, v};
    neighbour[t] = {second, third, n[2]};
    fixed[t] = {false, false, f[2]};
    corner.push_back({b, c, v});
    neighbour.push_back({third, t, n[0]});
    fixed.push_back({false, false, f[0]});
    corner.push_back({c, a, v});
    neighbour.push_back({t, second, n[1]});
    fixed.push_back({false, false, f[1]});
    relink(n[0], t, second);
    relink(n[1], t, third);
    std::vector<uint32_t> asked{t, second, third};
    while (!asked.empty()) {
        const uint32_t own = asked.back();
        asked.pop_back();
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t other = neighbour[own][k];
            if (corner[own][k] == v && flip(own, k)) {
                asked.push_back(own);
                asked.push_back(other);
                break;
            }
        }
    }
}

Stars::Stars(const PlanarNet& net) : first(net.points.size() + 1, 0) {
    for (const auto& c : net.corner)
        for (const uint32_t v : c) ++first[v + 1];
    for (size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    triangles.resize(first.back());
    std::vector<uint32_t> at(first.begin(), first.end() - 1);
    for (uint32_t t = 0; t < net.corner.size(); ++t)
        for (const uint32_t v : net.corner[t]) triangles[at[v]++] = t;
}

NetPart::NetPart(const PlanarNet& whole, const Stars& stars, uint32_t triangle, int rings)
    : triangles_{triangle} {
    // Parts are small: looking through them takes less time than hashing.
    const auto indexIn = [](const std::vector<uint32_t>& all, uint32_t of) {
        const auto found = std::ranges::find(all, of);
        return found != all.end() ? static_cast<uint32_t>(found - all.begin()) : kNoTriangle;
    };
    std::vector<uint32_t> passed; // points whose triangles are there
    for (size_t from = 0, ring = 0; ring < static_cast<size_t>(rings); ++ring) {
        const size_t to = triangles_.size();
        for (; from < to; ++from)
            for (const uint32_t v : whole.corner[triangles_[from]]) {
                if (indexIn(passed, v) != kNoTriangle) continue;
                passed.push_back(v);
                for (uint32_t i = stars.first[v]; i < stars.first[v + 1]; ++i)
                    if (indexIn(triangles_, stars.triangles[i]) == kNoTriangle)
                        triangles_.push_back(stars.triangles[i]);
            }
    }
    const auto add = [&](uint32_t v) {
        if (indexIn(points_, v) == kNoTriangle) points_.push_back(v);
    };
    for (const uint32_t t : triangles_)
        for (size_t k = 0; k < 3; ++k) {
            if (!whole.inner(whole.corner[t][k])) add(whole.corner[t][k]);
            if (indexIn(triangles_, whole.neighbour[t][k]) != kNoTriangle) continue;
            add(whole.corner[t][(k + 1) % 3]);
            add(whole.corner[t][(k + 2) % 3]);
        }
    net.boundaryCount = static_cast<uint32_t>(points_.size());
    for (const uint32_t v : points_)
        net.kinds.push_back(whole.inner(v) ? PlanarNet::Kind::rim : whole.kinds[v]);
    for (const uint32_t t : triangles_)
        for (const uint32_t v : whole.corner[t]) add(v);
    for (const uint32_t v : points_) {
        net.points.push_back(whole.points[v]);
        net.slides.push_back(whole.slides[v]);
    }
    for (const uint32_t t : triangles_) {
        std::array<uint32_t, 3> corner{}, neighbour{};
        std::array<bool, 3> fixed = whole.fixed[t];
        for (size_t k = 0; k < 3; ++k) corner[k] = indexIn(points_, whole.corner[t][k]);
        for (size_t k = 0; k < 3; ++k) {
            neighbour[k] = indexIn(triangles_, whole.neighbour[t][k]);
            if (neighbour[k] != kNoTriangle) continue;
            rims_.push_back({corner[(k + 1) % 3], corner[(k + 2) % 3], whole.neighbour[t][k], fixed[k]});
            fixed[k] = true;
        }
        net.corner.push_back(corner);
        net.neighbour.push_back(neighbour);
        net.fixed.push_back(fixed);
    }
    std::ranges::sort(rims_, {}, [](const Rim& r) { return std::pair(r.a, r.b); });
}

const NetPart::Rim& NetPart::rim(uint32_t a, uint32_t b) const {
    return *std::ranges::lower_bound(rims_, std::pair(a, b), {},
                                     [](const Rim& r) { return std::pair(r.a, r.b); });
}

void NetPart::putBack(PlanarNet& whole) const {
    std::vector<uint32_t> triangles = triangles_, points = points_;
    for (size_t t = triangles.size(); t < net.corner.size(); ++t) {
        triangles.push_back(static_cast<uint32_t>(whole.corner.size()));
        whole.corner.emplace_back();
        whole.neighbour.emplace_back();
        whole.fixed.emplace_back();
    }
    for (size_t v = points.size(); v < net.points.size(); ++v) {
        points.push_back(static_cast<uint32_t>(whole.points.size()));
        whole.points.emplace_back();
        whole.slides.push_back(false);
    }
    for (size_t v = net.boundaryCount; v < points.size(); ++v) whole.points[points[v]] = net.points[v];
    for (size_t t = 0; t < triangles.size(); ++t) {
        const uint32_t own = triangles[t];
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t a = net.corner[t][(k + 1) % 3], b = net.corner[t][(k + 2) % 3];
            whole.corner[own][k] = points[net.corner[t][k]];
            whole.fixed[own][k] = net.fixed[t][k];
            if (net.neighbour[t][k] != kNoTriangle) {
                whole.neighbour[own][k] = triangles[net.neighbour[t][k]];
                continue;
            }
            const Rim& edge = rim(a, b);
            whole.neighbour[own][k] = edge.outside;
            whole.fixed[own][k] = edge.fixed;
            if (edge.outside == kNoTriangle) continue;
            for (size_t m = 0; m < 3; ++m)
                if (whole.corner[edge.outside][(m + 1) % 3] == points[b] &&
                    whole.corner[edge.outside][(m + 2) % 3] == points[a])
                    whole.neighbour[edge.outside][m] = own;
        }
    }
}

} // namespace heliodon::geometry
