// Uniform triangles: every edge of the building is sampled once for all faces that meet there, so there are
// no T-vertices; inside, a hexagonal lattice, a constrained Delaunay triangulation and a few smoothings. The
// number of triangles of a polygon is known before it is triangulated (Euler: 2 inner + boundary - 2 + 2
// holes), which lets the edge length be tuned to the count that was asked for without meshing twice.
#include "geometry/mesher.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <tuple>

#include <glm/geometric.hpp>

#include "geometry/planar_mesher.h"

namespace heliodon::geometry {

namespace {

using Edge = std::pair<uint32_t, uint32_t>;
constexpr int kSmoothings = 6;

// Faces that are meshed together: one flat face, or the facets of a curved wall unrolled.
struct Domain {
    std::vector<uint32_t> faces;
    // Per facet: plane coordinates are (offset + along `u`, along `v`) from `origin`.
    struct Frame {
        glm::dvec3 origin{}, u{}, v{};
        double offset = 0;        // of the origin
        double low = 0, high = 0; // extent along u
    };
    std::vector<Frame> frames;
    std::vector<std::vector<uint32_t>> loops; // boundary corners
    std::vector<std::vector<uint32_t>>
        frameOf; // per loop and corner: the facet that the edge from there belongs to
};

glm::dvec3 normalOf(const Building& building, const Face& face) {
    glm::dvec3 sum{0};
    const glm::dvec3 origin = building.vertices[face.loops[0][0]];
    for (const auto& loop : face.loops)
        for (size_t i = 0; i < loop.size(); ++i)
            sum += glm::cross(building.vertices[loop[i]] - origin,
                              building.vertices[loop[(i + 1) % loop.size()]] - origin);
    return glm::normalize(sum);
}

// Axes of a face: v up along the wall, or any axis of a level one.
Domain::Frame frameOf(const Building& building, const Face& face) {
    Domain::Frame frame;
    const glm::dvec3 n = normalOf(building, face);
    frame.origin = building.vertices[face.loops[0][0]];
    const glm::dvec3 helper = std::abs(n.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
    frame.u = glm::normalize(glm::cross(helper, n));
    frame.v = glm::cross(n, frame.u);
    return frame;
}

class DomainFinder {
public:
    explicit DomainFinder(const Building& building) : building_(building) {}

    std::vector<Domain> find() {
        std::map<std::tuple<uint32_t, uint32_t, Role, uint32_t>, std::vector<uint32_t>> groups;
        for (uint32_t f = 0; f < building_.faces.size(); ++f) {
            const Face& face = building_.faces[f];
            groups[{face.surface, face.material, face.role, face.room}].push_back(f);
        }
        std::vector<Domain> domains;
        for (const auto& [key, faces] : groups) {
            if (!unroll(faces, domains))
                for (const uint32_t f : faces) domains.push_back(flat(f));
        }
        return domains;
    }

private:
    Domain flat(uint32_t f) const {
        Domain domain;
        domain.faces = {f};
        domain.frames = {frameOf(building_, building_.faces[f])};
        domain.loops = building_.faces[f].loops;
        for (const auto& loop : domain.loops) domain.frameOf.emplace_back(loop.size(), 0u);
        return domain;
    }

    // Upright facets that hang together along upright edges, laid out side by side.
    bool unroll(const std::vector<uint32_t>& faces, std::vector<Domain>& domains) const {
        if (faces.size() < 2) return false;
        std::map<Edge, uint32_t> faceOf;
        for (const uint32_t f : faces) {
            if (std::abs(normalOf(building_, building_.faces[f]).y) > 1e-6) return false;
            for (const auto& loop : building_.faces[f].loops)
                for (size_t i = 0; i < loop.size(); ++i) faceOf[{loop[i], loop[(i + 1) % loop.size()]}] = f;
        }
        std::map<uint32_t, size_t> component;
        std::vector<Domain> found;
        bool curved = false;
        for (const uint32_t start : faces) {
            if (component.contains(start)) continue;
            Domain domain;
            std::map<Edge, bool> seam; // edges that are no boundary any more
            std::map<uint32_t, uint32_t> place;
            domain.faces = {start};
            domain.frames = {frameOf(building_, building_.faces[start])};
            place[start] = 0;
            component[start] = found.size();
            for (size_t i = 0; i < domain.faces.size(); ++i)
                for (const auto& loop : building_.faces[domain.faces[i]].loops)
                    for (size_t k = 0; k < loop.size(); ++k) {
                        const Edge edge{loop[k], loop[(k + 1) % loop.size()]};
                        const auto other = faceOf.find({edge.second, edge.first});
                        if (other == faceOf.end() || place.contains(other->second) || !upright(edge))
                            continue;
                        Domain::Frame frame = frameOf(building_, building_.faces[other->second]);
                        const Domain::Frame& own = domain.frames[i];
                        const glm::dvec3 p = building_.vertices[edge.first];
                        curved = curved || glm::dot(frame.u, own.u) < 1 - 1e-9;
                        frame.offset = coordinates(own, p).x;
                        frame.origin = {p.x, own.origin.y, p.z};
                        place[other->second] = static_cast<uint32_t>(domain.faces.size());
                        component[other->second] = found.size();
                        domain.faces.push_back(other->second);
                        domain.frames.push_back(frame);
                        seam[edge] = seam[{edge.second, edge.first}] = true;
                    }
            for (size_t i = 0; i < domain.faces.size(); ++i)
                measure(domain.frames[i], building_.faces[domain.faces[i]]);
            addLoops(domain, seam, place);
            found.push_back(std::move(domain));
        }
        if (!curved) return false; // flat pieces apart: each by itself
        for (Domain& domain : found) domains.push_back(std::move(domain));
        return true;
    }

    void measure(Domain::Frame& frame, const Face& face) const {
        frame.low = 1e300;
        frame.high = -1e300;
        for (const uint32_t v : face.loops[0]) {
            const double x = coordinates(frame, building_.vertices[v]).x;
            frame.low = std::min(frame.low, x);
            frame.high = std::max(frame.high, x);
        }
    }

    bool upright(Edge edge) const {
        const glm::dvec3 d = building_.vertices[edge.second] - building_.vertices[edge.first];
        return std::abs(d.x) + std::abs(d.z) < 1e-9 * glm::length(d) + 1e-12;
    }

    // Two facets may share several edges (a wall with a step in it): all of them are seams.
    void addLoops(Domain& domain, std::map<Edge, bool>& seam,
                  const std::map<uint32_t, uint32_t>& place) const {
        std::map<uint32_t, std::vector<std::pair<uint32_t, uint32_t>>> next; // corner -> (corner, frame)
        size_t count = 0;
        for (const auto& [face, frame] : place)
            for (const auto& loop : building_.faces[face].loops)
                for (size_t k = 0; k < loop.size(); ++k) {
                    const Edge edge{loop[k], loop[(k + 1) % loop.size()]};
                    if (seam.contains(edge)) continue;
                    next[edge.first].emplace_back(edge.second, frame);
                    ++count;
                }
        while (count > 0) {
            auto start = next.begin();
            while (start->second.empty()) ++start;
            std::vector<uint32_t> loop, frames;
            uint32_t at = start->first;
            while (!next[at].empty()) {
                const auto [to, frame] = next[at].back();
                next[at].pop_back();
                --count;
                loop.push_back(at);
                frames.push_back(frame);
                at = to;
            }
            domain.loops.push_back(std::move(loop));
            domain.frameOf.push_back(std::move(frames));
        }
    }

public:
    static glm::dvec2 coordinates(const Domain::Frame& frame, glm::dvec3 p) {
        return {frame.offset + glm::dot(p - frame.origin, frame.u), glm::dot(p - frame.origin, frame.v)};
    }

private:
    const Building& building_;
};

class BuildingMesher {
public:
    BuildingMesher(const Building& building, size_t wanted)
        : building_(building), wanted_(static_cast<double>(wanted)), domains_(DomainFinder(building).find()) {
        mesh_.materials = building.materials;
        mesh_.vertices = building.vertices;
        trianglesOf_.resize(building.faces.size());
    }

    PatchMesh mesh() {
        edge_ = chooseEdge();
        lattice_ = chooseLattice();
        std::vector<bool> done(building_.faces.size());
        for (const Domain& domain : domains_) {
            const Face& face = building_.faces[domain.faces[0]];
            if (face.twin >= 0 && static_cast<uint32_t>(face.twin) < domain.faces[0]) continue;
            meshDomain(domain);
            if (face.twin >= 0) mirror(domain.faces[0], static_cast<uint32_t>(face.twin));
        }
        return std::move(mesh_);
    }

private:
    // Total area by the faces themselves.
    double totalArea() const {
        double sum = 0;
        for (const Face& face : building_.faces) {
            const glm::dvec3 n = normalOf(building_, face);
            const glm::dvec3 origin = building_.vertices[face.loops[0][0]];
            for (const auto& loop : face.loops)
                for (size_t i = 0; i < loop.size(); ++i)
                    sum += 0.5 *
                           glm::dot(n, glm::cross(building_.vertices[loop[i]] - origin,
                                                  building_.vertices[loop[(i + 1) % loop.size()]] - origin));
        }
        return sum;
    }

    static size_t pieces(double length, double edge) {
        return static_cast<size_t>(std::max(1.0, std::floor(length / edge + 0.5 + 1e-7)));
    }

    double length(uint32_t a, uint32_t b) const {
        return glm::length(building_.vertices[b] - building_.vertices[a]);
    }

    // How many triangles this edge length gives.
    double countFor(double edge, double lattice) const {
        double count = 0;
        for (const Domain& domain : domains_) {
            const PlanarDomain plane = sampled(domain, edge);
            const double holes = static_cast<double>(domain.loops.size()) - 1;
            count += 2 * static_cast<double>(hexagonalSeeds(plane, lattice).size()) +
                     static_cast<double>(plane.boundary.size()) - 2 + 2 * holes;
        }
        return count;
    }

    double chooseEdge() const {
        double edge = std::sqrt(4 / std::sqrt(3.0) * totalArea() / wanted_);
        double best = edge, least = 1e300;
        double low = 0, high = 0; // edges that give too many, too few
        for (int round = 0; round < 9; ++round) {
            const double count = countFor(edge, edge), off = std::abs(count - wanted_);
            if (off < least) {
                least = off;
                best = edge;
            }
            if (off <= 0.01 * wanted_) break;
            (count > wanted_ ? low : high) = edge;
            const double guess = edge * std::sqrt(count / wanted_);
            const bool bracketed = low > 0 && high > 0;
            edge = bracketed && (guess <= std::min(low, high) || guess >= std::max(low, high))
                       ? 0.5 * (low + high)
                       : guess;
        }
        return best;
    }

    // Rows and columns come in whole numbers, so that the count jumps; a lattice a little finer or coarser
    // than the boundary settles it.
    double chooseLattice() const {
        double best = edge_, least = 1e300;
        for (const double factor : {1.0, 0.97, 1.03, 0.94, 1.06, 0.91, 1.09}) {
            const double off = std::abs(countFor(edge_, factor * edge_) - wanted_);
            if (off < least - 0.5) {
                least = off;
                best = factor * edge_;
            }
            if (least <= 0.015 * wanted_) break;
        }
        return best;
    }

    PlanarDomain sampled(const Domain& domain, double edge) const {
        PlanarDomain plane;
        for (size_t l = 0; l < domain.loops.size(); ++l) {
            const auto& loop = domain.loops[l];
            for (size_t i = 0; i < loop.size(); ++i) {
                const Domain::Frame& frame = domain.frames[domain.frameOf[l][i]];
                const glm::dvec2 a = DomainFinder::coordinates(frame, building_.vertices[loop[i]]);
                const glm::dvec2 b =
                    DomainFinder::coordinates(frame, building_.vertices[loop[(i + 1) % loop.size()]]);
                const size_t n = pieces(length(loop[i], loop[(i + 1) % loop.size()]), edge);
                for (size_t k = 0; k < n; ++k)
                    plane.boundary.push_back(a + (b - a) * (static_cast<double>(k) / static_cast<double>(n)));
            }
            plane.loopStart.push_back(static_cast<uint32_t>(plane.boundary.size()));
        }
        return plane;
    }

    // The vertices that divide an edge, from a to b, without its ends; the same for both faces.
    std::vector<uint32_t> edgeVertices(uint32_t a, uint32_t b) {
        const Edge key = std::minmax(a, b);
        const auto [place, isNew] = edgeVertices_.try_emplace(key);
        if (isNew) {
            const glm::dvec3 p = building_.vertices[key.first], q = building_.vertices[key.second];
            const size_t n = pieces(glm::length(q - p), edge_);
            for (size_t k = 1; k < n; ++k) {
                place->second.push_back(static_cast<uint32_t>(mesh_.vertices.size()));
                mesh_.vertices.push_back(p + (q - p) * (static_cast<double>(k) / static_cast<double>(n)));
            }
        }
        std::vector<uint32_t> out = place->second;
        if (a > b) std::ranges::reverse(out);
        return out;
    }

    std::vector<uint32_t> boundaryVertices(const Domain& domain) {
        std::vector<uint32_t> out;
        for (const auto& loop : domain.loops)
            for (size_t i = 0; i < loop.size(); ++i) {
                out.push_back(loop[i]);
                const auto inner = edgeVertices(loop[i], loop[(i + 1) % loop.size()]);
                out.insert(out.end(), inner.begin(), inner.end());
            }
        return out;
    }

    // From the unrolled plane back on to the facet there.
    glm::dvec3 inSpace(const Domain& domain, glm::dvec2 p) const {
        const auto beyond = [&](const Domain::Frame& frame) {
            return std::max({0.0, frame.low - p.x, p.x - frame.high});
        };
        const auto best = std::ranges::min_element(domain.frames, {}, beyond);
        return best->origin + (p.x - best->offset) * best->u + p.y * best->v;
    }

    void addTriangle(uint32_t f, const std::array<uint32_t, 3>& t) {
        const Face& face = building_.faces[f];
        trianglesOf_[f].push_back(static_cast<uint32_t>(mesh_.patchCount()));
        mesh_.addPatch(t, face.material, face.role, face.surface, face.room);
    }

    void meshDomain(const Domain& domain) {
        const PlanarDomain plane = sampled(domain, edge_);
        std::vector<uint32_t> vertices = boundaryVertices(domain);
        const PlanarMesh flat = meshPlanar(plane, hexagonalSeeds(plane, lattice_), kSmoothings);
        for (size_t i = vertices.size(); i < flat.points.size(); ++i) {
            vertices.push_back(static_cast<uint32_t>(mesh_.vertices.size()));
            mesh_.vertices.push_back(inSpace(domain, flat.points[i]));
        }
        for (const auto& t : flat.triangles)
            addTriangle(domain.faces[0], {vertices[t[0]], vertices[t[1]], vertices[t[2]]});
    }

    // The other glass of an interior window gets the same triangles, seen from its own side.
    void mirror(uint32_t from, uint32_t to) {
        const auto middle = [&](uint32_t f) {
            glm::dvec3 low(1e300), high(-1e300);
            for (const uint32_t v : building_.faces[f].loops[0]) {
                low = glm::min(low, building_.vertices[v]);
                high = glm::max(high, building_.vertices[v]);
            }
            return 0.5 * (low + high);
        };
        const glm::dvec3 shift = middle(to) - middle(from), n = normalOf(building_, building_.faces[to]);
        const glm::dvec3 onPlane = building_.vertices[building_.faces[to].loops[0][0]];
        Domain domain;
        domain.loops = building_.faces[to].loops;
        const std::vector<uint32_t> border = boundaryVertices(domain);
        Domain source;
        source.loops = building_.faces[from].loops;
        std::map<uint32_t, uint32_t> image;
        for (const uint32_t v : boundaryVertices(source)) {
            const glm::dvec3 p = mesh_.vertices[v] + shift;
            const auto nearest = std::ranges::min_element(
                border, {}, [&](uint32_t b) { return glm::length(mesh_.vertices[b] - p); });
            image[v] = *nearest;
        }
        if (image.size() != border.size())
            throw std::runtime_error("the two sides of an interior window differ");
        const std::vector<uint32_t> triangles = trianglesOf_[from];
        for (const uint32_t patch : triangles) {
            std::array<uint32_t, 3> corner{};
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t v = mesh_.patch(patch)[k];
                const auto [place, isNew] =
                    image.try_emplace(v, static_cast<uint32_t>(mesh_.vertices.size()));
                if (isNew) {
                    const glm::dvec3 p = mesh_.vertices[v] + shift;
                    mesh_.vertices.push_back(p - glm::dot(p - onPlane, n) * n);
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
    double wanted_, edge_ = 0, lattice_ = 0;
    std::vector<Domain> domains_;
    PatchMesh mesh_;
    std::map<Edge, std::vector<uint32_t>> edgeVertices_;
    std::vector<std::vector<uint32_t>> trianglesOf_;
};

} // namespace

PatchMesh meshBuilding(const Building& building, const MeshOptions& options) {
    if (building.faces.empty()) return {};
    return BuildingMesher(building, std::max<size_t>(options.triangles, 1)).mesh();
}

MeshQuality measureMesh(const PatchMesh& mesh) {
    MeshQuality quality;
    quality.triangles = mesh.patchCount();
    quality.minAngleDeg = 180;
    // The angle of the surface itself at each of its vertices: where that is sharp, no mesh can do better.
    std::map<std::pair<uint32_t, uint32_t>, double> whole;
    const auto angle = [&](size_t i, size_t k) {
        const auto corner = mesh.patch(i);
        const size_t n = corner.size();
        const glm::dvec3 p = mesh.vertices[corner[k]];
        const glm::dvec3 a = mesh.vertices[corner[(k + 1) % n]] - p,
                         b = mesh.vertices[corner[(k + n - 1) % n]] - p;
        return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
    };
    double sum = 0, squares = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        for (size_t k = 0; k < mesh.patch(i).size(); ++k)
            whole[{mesh.surface[i], mesh.patch(i)[k]}] += angle(i, k);
        const double area = patchArea(mesh, i);
        sum += area;
        squares += area * area;
    }
    constexpr double kSharp = 72; // degrees: less cannot be divided into two angles of 36
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        for (size_t k = 0; k < mesh.patch(i).size(); ++k)
            if (whole[{mesh.surface[i], mesh.patch(i)[k]}] >= kSharp)
                quality.minAngleDeg = std::min(quality.minAngleDeg, angle(i, k));
    const auto n = static_cast<double>(mesh.patchCount());
    if (n > 0)
        quality.areaDeviation = std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n))) / (sum / n);
    return quality;
}

} // namespace heliodon::geometry
