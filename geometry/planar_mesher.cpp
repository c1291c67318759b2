#include "geometry/planar_mesher.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <glm/geometric.hpp>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#pragma GCC diagnostic pop

namespace heliodon::geometry {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<uint32_t, Kernel>;
using FaceBase =
    CGAL::Triangulation_face_base_with_info_2<int, Kernel,
                                              CGAL::Constrained_triangulation_face_base_2<Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::No_constraint_intersection_tag>;

constexpr uint32_t kNone = 0xffffffffu;
constexpr double kFromBoundary = 0.62; // of the edge length

double cross(glm::dvec2 u, glm::dvec2 v) {
    return u.x * v.y - u.y * v.x;
}

size_t loopCount(const PlanarDomain& domain) {
    return domain.loopStart.size() - 1;
}

uint32_t nextOnLoop(const PlanarDomain& domain, size_t loop, uint32_t i) {
    return i + 1 < domain.loopStart[loop + 1] ? i + 1 : domain.loopStart[loop];
}

// Rows of the inside of the domain and the boundary near a point, by bucketing the boundary segments.
class Inside {
public:
    Inside(const PlanarDomain& domain, double edge) : domain_(domain), cell_(edge) {
        low_ = high_ = domain.boundary[0];
        for (const glm::dvec2 p : domain.boundary) {
            low_ = glm::min(low_, p);
            high_ = glm::max(high_, p);
        }
        columns_ = static_cast<int>((high_.x - low_.x) / cell_) + 3;
        rows_ = static_cast<int>((high_.y - low_.y) / cell_) + 3;
        buckets_.resize(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
        rowSegments_.resize(static_cast<size_t>(rows_));
        for (size_t l = 0; l < loopCount(domain); ++l)
            for (uint32_t i = domain.loopStart[l]; i < domain.loopStart[l + 1]; ++i)
                add(i, nextOnLoop(domain, l, i));
    }

    bool contains(glm::dvec2 p) const {
        bool in = false;
        for (const auto& [i, j] : rowSegments_[static_cast<size_t>(row(p.y))]) {
            const glm::dvec2 a = domain_.boundary[i], b = domain_.boundary[j];
            if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x) in = !in;
        }
        return in;
    }

    bool nearBoundary(glm::dvec2 p, double distance) const {
        const int c = column(p.x), r = row(p.y);
        for (int dr = -1; dr <= 1; ++dr)
            for (int dc = -1; dc <= 1; ++dc) {
                if (c + dc < 0 || r + dr < 0 || c + dc >= columns_ || r + dr >= rows_) continue;
                for (const auto& [i, j] : buckets_[static_cast<size_t>((r + dr) * columns_ + c + dc)]) {
                    const glm::dvec2 a = domain_.boundary[i], d = domain_.boundary[j] - a;
                    const double t = std::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.0, 1.0);
                    const glm::dvec2 off = p - a - t * d;
                    if (glm::dot(off, off) < distance * distance) return true;
                }
            }
        return false;
    }

    glm::dvec2 low() const { return low_; }
    glm::dvec2 high() const { return high_; }

private:
    int column(double x) const { return std::clamp(static_cast<int>((x - low_.x) / cell_), 0, columns_ - 1); }
    int row(double y) const { return std::clamp(static_cast<int>((y - low_.y) / cell_), 0, rows_ - 1); }

    void add(uint32_t i, uint32_t j) {
        const glm::dvec2 a = domain_.boundary[i], b = domain_.boundary[j];
        for (int r = row(std::min(a.y, b.y)); r <= row(std::max(a.y, b.y)); ++r)
            rowSegments_[static_cast<size_t>(r)].emplace_back(i, j);
        const int steps = static_cast<int>(glm::length(b - a) / (0.5 * cell_)) + 1;
        size_t last = buckets_.size();
        for (int s = 0; s <= steps; ++s) {
            const glm::dvec2 p = a + (b - a) * (static_cast<double>(s) / steps);
            const auto bucket = static_cast<size_t>(row(p.y) * columns_ + column(p.x));
            if (bucket != last) buckets_[bucket].emplace_back(i, j);
            last = bucket;
        }
    }

    const PlanarDomain& domain_;
    double cell_;
    glm::dvec2 low_{}, high_{};
    int columns_ = 0, rows_ = 0;
    std::vector<std::vector<std::pair<uint32_t, uint32_t>>> buckets_, rowSegments_;
};

// Direction of the longest straight run of the boundary.
glm::dvec2 mainDirection(const PlanarDomain& domain) {
    glm::dvec2 best{1, 0};
    double longest = 0;
    for (size_t l = 0; l < loopCount(domain); ++l) {
        glm::dvec2 run{0};
        for (uint32_t k = 0, n = domain.loopStart[l + 1] - domain.loopStart[l]; k < 2 * n; ++k) {
            const uint32_t i = domain.loopStart[l] + k % n;
            const glm::dvec2 d = domain.boundary[nextOnLoop(domain, l, i)] - domain.boundary[i];
            const bool onward =
                glm::dot(run, d) > 0 && std::abs(cross(run, d)) < 1e-6 * glm::length(run) * glm::length(d);
            run = onward && k < n + n / 2 ? run + d : d;
            if (glm::length(run) > longest * (1 + 1e-9)) {
                longest = glm::length(run);
                best = run / longest;
            }
        }
    }
    return best;
}

// Triangles with neighbours: neighbour k lies across the edge opposite corner k.
struct Mesh {
    std::vector<glm::dvec2> points;
    uint32_t boundaryCount = 0;
    std::vector<std::array<uint32_t, 3>> corner, neighbour;
    std::vector<std::array<bool, 3>> fixed;

    double area(uint32_t a, uint32_t b, uint32_t c) const {
        return cross(points[b] - points[a], points[c] - points[a]);
    }

    // Turns the diagonal between triangle t and its neighbour k when Delaunay asks for it.
    bool flip(uint32_t t, int k) {
        const auto at = static_cast<size_t>(k);
        const uint32_t u = neighbour[t][at];
        if (u == kNone || fixed[t][at]) return false;
        size_t m = 0;
        while (neighbour[u][m] != t) ++m;
        const uint32_t p = corner[t][at], a = corner[t][(at + 1) % 3], b = corner[t][(at + 2) % 3],
                       q = corner[u][m];
        if (!prefersFlip(p, a, b, q)) return false;
        // p a b + q b a  ->  p a q + q b p
        const uint32_t na = neighbour[t][(at + 1) % 3],
                       nb = neighbour[t][(at + 2) % 3]; // across b-p, across p-a
        const uint32_t ma = neighbour[u][(m + 2) % 3], mb = neighbour[u][(m + 1) % 3];
        const bool fa = fixed[t][(at + 1) % 3], fb = fixed[t][(at + 2) % 3];
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

private:
    void relink(uint32_t triangle, uint32_t from, uint32_t to) {
        if (triangle == kNone) return;
        for (uint32_t& n : neighbour[triangle])
            if (n == from) {
                n = to;
                return;
            }
    }

    bool prefersFlip(uint32_t p, uint32_t a, uint32_t b, uint32_t q) const {
        const double least = 1e-9 * (std::abs(area(p, a, b)) + std::abs(area(q, b, a)));
        if (area(p, a, q) <= least || area(q, b, p) <= least) return false;
        // Angles opposite the diagonal add up to more than two right ones.
        const glm::dvec2 pa = points[a] - points[p], pb = points[b] - points[p], qa = points[a] - points[q],
                         qb = points[b] - points[q];
        const double sum = cross(pa, pb) * glm::dot(qb, qa) + glm::dot(pa, pb) * cross(qb, qa);
        return sum < -1e-12 * glm::dot(pa, pa) * glm::dot(qb, qb);
    }
};

void markInside(Triangulation& t) {
    for (auto f = t.all_faces_begin(); f != t.all_faces_end(); ++f) f->info() = -1;
    std::vector<Triangulation::Face_handle> front{t.infinite_face()}, behind;
    front[0]->info() = 0;
    for (int depth = 0; !front.empty(); ++depth) {
        behind.clear();
        for (size_t i = 0; i < front.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                const auto other = front[i]->neighbor(k);
                if (other->info() >= 0) continue;
                if (front[i]->is_constrained(k)) {
                    behind.push_back(other);
                } else {
                    other->info() = depth;
                    front.push_back(other);
                }
            }
        front.clear();
        for (const auto& f : behind)
            if (f->info() < 0) {
                f->info() = depth + 1;
                front.push_back(f);
            }
    }
}

Mesh triangulate(const PlanarDomain& domain, const std::vector<glm::dvec2>& seeds) {
    Mesh mesh;
    mesh.points = domain.boundary;
    mesh.boundaryCount = static_cast<uint32_t>(domain.boundary.size());
    mesh.points.insert(mesh.points.end(), seeds.begin(), seeds.end());

    Triangulation t;
    std::vector<std::pair<Kernel::Point_2, uint32_t>> points;
    for (uint32_t i = 0; i < mesh.points.size(); ++i)
        points.emplace_back(Kernel::Point_2(mesh.points[i].x, mesh.points[i].y), i);
    t.insert(points.begin(), points.end());
    std::vector<Triangulation::Vertex_handle> handles(mesh.points.size());
    for (auto v = t.finite_vertices_begin(); v != t.finite_vertices_end(); ++v) handles[v->info()] = v;
    try {
        for (size_t l = 0; l < loopCount(domain); ++l)
            for (uint32_t i = domain.loopStart[l]; i < domain.loopStart[l + 1]; ++i) {
                const auto a = handles[i], b = handles[nextOnLoop(domain, l, i)];
                if (a == Triangulation::Vertex_handle() || b == Triangulation::Vertex_handle())
                    throw std::runtime_error("a face touches itself in a corner and cannot be meshed");
                t.insert_constraint(a, b);
            }
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
        throw std::runtime_error("the outline of a face crosses itself and cannot be meshed");
    }
    markInside(t);
    std::vector<Triangulation::Face_handle> inside;
    for (auto f = t.finite_faces_begin(); f != t.finite_faces_end(); ++f) {
        const bool in = f->info() % 2 == 1;
        f->info() = in ? static_cast<int>(inside.size()) : -1;
        if (in) inside.push_back(f);
    }
    for (auto f = t.all_faces_begin(); f != t.all_faces_end(); ++f)
        if (t.is_infinite(f)) f->info() = -1;
    for (const auto& f : inside) {
        std::array<uint32_t, 3> corner{}, neighbour{};
        std::array<bool, 3> fixed{};
        for (int k = 0; k < 3; ++k) {
            const auto at = static_cast<size_t>(k);
            corner[at] = f->vertex(k)->info();
            neighbour[at] =
                f->neighbor(k)->info() >= 0 ? static_cast<uint32_t>(f->neighbor(k)->info()) : kNone;
            fixed[at] = f->is_constrained(k);
        }
        mesh.corner.push_back(corner);
        mesh.neighbour.push_back(neighbour);
        mesh.fixed.push_back(fixed);
    }
    return mesh;
}

void flipAll(Mesh& mesh) {
    for (int round = 0; round < 10; ++round) {
        bool flipped = false;
        for (uint32_t t = 0; t < mesh.corner.size(); ++t)
            for (int k = 0; k < 3; ++k) flipped |= mesh.flip(t, k);
        if (!flipped) return;
    }
}

// Moves each inner point to the area-weighted mean of its triangles' centroids, unless that turns one over.
void smooth(Mesh& mesh) {
    const size_t inner = mesh.points.size() - mesh.boundaryCount;
    std::vector<glm::dvec2> sum(inner, glm::dvec2(0));
    std::vector<double> weight(inner, 0);
    for (const auto& c : mesh.corner) {
        const double area = mesh.area(c[0], c[1], c[2]);
        const glm::dvec2 middle = (mesh.points[c[0]] + mesh.points[c[1]] + mesh.points[c[2]]) / 3.0;
        for (const uint32_t v : c)
            if (v >= mesh.boundaryCount) {
                sum[v - mesh.boundaryCount] += area * middle;
                weight[v - mesh.boundaryCount] += area;
            }
    }
    std::vector<glm::dvec2> old(mesh.points.begin() + mesh.boundaryCount, mesh.points.end());
    for (size_t i = 0; i < inner; ++i)
        if (weight[i] > 0) mesh.points[mesh.boundaryCount + i] = sum[i] / weight[i];
    for (bool again = true; again;) {
        again = false;
        for (const auto& c : mesh.corner) {
            if (mesh.area(c[0], c[1], c[2]) > 0) continue;
            for (const uint32_t v : c)
                if (v >= mesh.boundaryCount && mesh.points[v] != old[v - mesh.boundaryCount]) {
                    mesh.points[v] = old[v - mesh.boundaryCount];
                    again = true;
                }
        }
    }
}

} // namespace

std::vector<glm::dvec2> hexagonalSeeds(const PlanarDomain& domain, double edge) {
    const glm::dvec2 u = mainDirection(domain), v{-u.y, u.x};
    PlanarDomain turned = domain;
    for (glm::dvec2& p : turned.boundary) p = {glm::dot(p, u), glm::dot(p, v)};
    const Inside inside(turned, edge);
    const glm::dvec2 extent = inside.high() - inside.low();
    // Whole rows and columns between the sides.
    const double row = extent.y / std::max(1.0, std::round(extent.y / (edge * std::sqrt(3.0) / 2)));
    const double column = extent.x / std::max(1.0, std::round(extent.x / edge));
    std::vector<glm::dvec2> seeds;
    for (int r = 1; r * row < extent.y - 0.25 * row; ++r)
        for (int c = 0; c * column < extent.x + column; ++c) {
            const glm::dvec2 p = inside.low() + glm::dvec2((c + (r % 2 ? 0.5 : 0.0)) * column, r * row);
            if (p.x < inside.high().x && inside.contains(p) && !inside.nearBoundary(p, kFromBoundary * edge))
                seeds.push_back(p.x * u + p.y * v);
        }
    return seeds;
}

PlanarMesh meshPlanar(const PlanarDomain& domain, std::vector<glm::dvec2> seeds, int smoothings) {
    Mesh mesh = triangulate(domain, seeds);
    if (!seeds.empty())
        for (int k = 0; k < smoothings; ++k) {
            smooth(mesh);
            flipAll(mesh);
        }
    return {std::move(mesh.points), std::move(mesh.corner)};
}

} // namespace heliodon::geometry
