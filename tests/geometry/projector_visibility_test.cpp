#include "geometry/projector_visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>

#include <unistd.h>

#include <fmt/ranges.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "geometry/flat_part.h"
#include "geometry/mesher.h"
#include "geometry/model_file.h"
#include "geometry/projector_blend.h"

using namespace heliodon::geometry;

namespace {

constexpr int kRays = 100000;

// Looks from `from` at `to`, without lens errors.
OpticalDevice lookingAt(glm::dvec3 from, glm::dvec3 to, double focal = 900) {
    OpticalDevice device;
    device.width = 1024;
    device.height = 768;
    device.lens.fx = device.lens.fy = focal;
    device.lens.cx = 511.5;
    device.lens.cy = 383.5;
    const glm::dvec3 z = glm::normalize(to - from), x = glm::normalize(glm::cross(z, glm::dvec3(0, 1, 0)));
    device.deviceFromWorld = glm::transpose(glm::dmat3(x, glm::cross(z, x), z));
    device.translation = -(device.deviceFromWorld * from);
    return device;
}

std::vector<OpticalDevice> fourProjectors() {
    std::vector<OpticalDevice> out;
    for (const glm::dvec3 from : {glm::dvec3(1, 1.1, 0.2), glm::dvec3(-0.2, 1.1, 1),
                                  glm::dvec3(-1, 1.1, -0.2), glm::dvec3(0.2, 1.1, -1)})
        out.push_back(lookingAt(from, {0, 0.05, 0}));
    return out;
}

std::vector<glm::dvec3> centresOf(const std::vector<OpticalDevice>& devices) {
    std::vector<glm::dvec3> out;
    for (const OpticalDevice& device : devices) out.push_back(device.centre());
    return out;
}

Building buildingOf(const std::string& name) {
    Closure closure = closeSketch(readSketch(std::string(HELIODON_TEST_DATA "/geometry/sketches/") + name));
    EXPECT_TRUE(closure.building) << closure.report.message;
    return std::move(*closure.building);
}

// Moeller and Trumbore, front and back. A solid that rises less than 2.5 mm over the plane at `from` casts no
// shadow on it: it is the wall that the plane is the face of (outlines are straightened by up to 0.1 in).
// `each`: indices of a solid.
constexpr size_t kPrism = 36, kTriangle = 3;
bool blocked(const Occluders& occluders, glm::dvec3 from, glm::dvec3 normal, glm::dvec3 to,
             size_t each = kPrism) {
    const glm::dvec3 d = to - from;
    double highest = 0;
    for (size_t i = 0; i < occluders.triangles.size(); i += 3) {
        if (i % each == 0) {
            highest = -1e9;
            for (size_t k = i; k < i + each; ++k)
                highest =
                    std::max(highest, glm::dot(normal, occluders.vertices[occluders.triangles[k]] - from));
        }
        if (highest <= 0.0025) continue;
        const glm::dvec3 a = occluders.vertices[occluders.triangles[i]],
                         e1 = occluders.vertices[occluders.triangles[i + 1]] - a,
                         e2 = occluders.vertices[occluders.triangles[i + 2]] - a;
        const glm::dvec3 p = glm::cross(d, e2);
        const double det = glm::dot(e1, p);
        if (std::abs(det) < 1e-15) continue;
        const glm::dvec3 s = from - a, q = glm::cross(s, e1);
        const double u = glm::dot(s, p) / det, v = glm::dot(d, q) / det, t = glm::dot(e2, q) / det;
        if (u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < 1) return true;
    }
    return false;
}

// Normals that turn smoothly over the facets of each surface.
class SmoothNormals {
public:
    explicit SmoothNormals(const PatchMesh& mesh) : mesh_(mesh) {
        for (size_t p = 0; p < mesh.patchCount(); ++p)
            for (const uint32_t v : mesh.patch(p)) sums_[{v, mesh.surface[p]}] += patchAreaVector(mesh, p);
    }
    // Where the vertex of a split mesh lies.
    glm::dvec3 at(const ProjectorMesh& split, uint32_t v, uint32_t patch) const {
        glm::dvec3 mean(0);
        for (size_t s = 0; s < 3; ++s)
            mean += double{split.sourceWeight[v][static_cast<int>(s)]} *
                    glm::normalize(sums_.at({split.sourceVertex[v][s], mesh_.surface[patch]}));
        return glm::normalize(mean);
    }

private:
    const PatchMesh& mesh_;
    std::map<std::pair<uint32_t, uint32_t>, glm::dvec3> sums_;
};

double areaOf(const ProjectorMesh& mesh, size_t t) {
    const glm::dvec3 a = mesh.vertices[mesh.triangles[3 * t]];
    return 0.5 * glm::length(glm::cross(mesh.vertices[mesh.triangles[3 * t + 1]] - a,
                                        mesh.vertices[mesh.triangles[3 * t + 2]] - a));
}

// The share of random rays from the surfaces to fourProjectors() that say otherwise than the labels.
double disagreement(const PatchMesh& mesh, const ProjectorMesh& split, const Occluders& occluders,
                    size_t each = kPrism, uint32_t atAnyAngle = 0) {
    const auto projectors = fourProjectors();
    const SmoothNormals smooth(mesh);
    std::vector<double> cumulative;
    double total = 0;
    for (size_t t = 0; t < split.triangleCount(); ++t) cumulative.push_back(total += areaOf(split, t));
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(0, 1);
    int wrong = 0;
    for (int k = 0; k < kRays; ++k) {
        const auto t = static_cast<size_t>(std::ranges::lower_bound(cumulative, uniform(random) * total) -
                                           cumulative.begin());
        double u = uniform(random), v = uniform(random);
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        const glm::dvec3 a = split.vertices[split.triangles[3 * t]],
                         b = split.vertices[split.triangles[3 * t + 1]],
                         c = split.vertices[split.triangles[3 * t + 2]];
        const glm::dvec3 p = a + u * (b - a) + v * (c - a), n = patchNormal(mesh, split.sourcePatch[t]);
        const size_t which = static_cast<size_t>(k) % 4;
        const glm::dvec3 d = glm::normalize(projectors[which].centre() - p);
        const auto pixel = projectors[which].pixelFromWorld(p);
        const bool inPicture =
            pixel && pixel->x > -0.5 && pixel->y > -0.5 && pixel->x < 1023.5 && pixel->y < 767.5;
        const auto turned = [&](size_t corner) {
            return smooth.at(split, split.triangles[3 * t + corner], split.sourcePatch[t]);
        };
        const glm::dvec3 m = glm::normalize((1 - u - v) * turned(0) + u * turned(1) + v * turned(2));
        const bool steep = glm::dot(m, d) > 0.2 || (atAnyAngle >> which & 1u);
        const bool sees = steep && glm::dot(n, d) > 0 && inPicture &&
                          !blocked(occluders, p, n, projectors[which].centre(), each);
        wrong += sees != ((split.visible[t] >> which & 1u) != 0);
    }
    return wrong / static_cast<double>(kRays);
}

} // namespace

TEST(ProjectorVisibility, labels_agree_with_random_rays) {
    uint32_t atAnyAngle = 0;
    for (const char* name : {"p04_L.json", "p08_cubicle.json", "i01_mixed.sketch.json",
                             "i02_pinwheel.sketch.json", "three_arcs.json", "walls20.json"}) {
        atAnyAngle ^= 0b100; // in every other sketch
        const Building building = buildingOf(name);
        const PatchMesh mesh = meshBuilding(building);
        const double wrong =
            disagreement(mesh,
                         splitByProjectorVisibility(mesh, building.occluders, fourProjectors(),
                                                    {.atAnyAngle = atAnyAngle}),
                         building.occluders, kPrism, atAnyAngle);
        printf("%s: %.5f of the rays disagree\n", name, wrong);
        EXPECT_LE(wrong, 0.001) << name; // of the area: what the paper's meshes leave to a pixel or two
    }
}

// What importModel makes of a file that `write` writes.
template<class Write> Building throughFile(const char* extension, const Write& write) {
    std::filesystem::path file = std::filesystem::temp_directory_path() /
                                 ("heliodon_visibility_" + std::to_string(::getpid()) + extension);
    write(file);
    Building building = importModel(file);
    std::filesystem::remove(file);
    std::filesystem::remove(file.replace_extension(".mtl"));
    return building;
}

// Walls of one height, all of rooms, and no cracks between them: a model says all of them. With windows, two
// rooms, two buildings, partitions and curved walls.
TEST(ProjectorVisibility, models_hide_what_the_walls_of_their_sketch_do) {
    for (const char* name : {"p05_T_two_rooms.json", "p08_cubicle.json", "p11_two_buildings.json",
                             "three_arcs.json", "round_column.json"}) {
        const Building building = buildingOf(name);
        const PatchMesh mesh = meshBuilding(
            throughFile(".obj", [&](const auto& file) { writeModel(meshBuilding(building), file); }));
        const double wrong =
            disagreement(mesh, splitByProjectorVisibility(mesh, {}, fourProjectors()), building.occluders);
        printf("%s: %.5f of the rays disagree\n", name, wrong);
        EXPECT_LE(wrong, 0.005) << name; // nothing hidden: 0.2 to 0.3
    }
}

TEST(ProjectorVisibility, walls_in_single_precision_are_flat) {
    const PatchMesh mesh = meshBuilding(buildingOf("p06_U.json"));
    const Building again = throughFile(".glb", [&](const auto& file) { writeModel(mesh, file); });
    EXPECT_LT(flatParts(meshBuilding(again)).size(), 2 * flatParts(mesh).size());
}

// Faces of prisms as an .obj, from corners of the plan, counter-clockwise seen from above.
class Prisms {
public:
    void add(const std::vector<glm::dvec2>& base, double low, double high, bool looksIn = false) {
        const size_t n = base.size(), first = count_ + 1;
        for (const double y : {low, high})
            for (const glm::dvec2 p : base) text_ += fmt::format("v {} {} {}\n", p.x, y, -p.y);
        count_ += 2 * n;
        std::vector<size_t> bottom, top;
        for (size_t k = 0; k < n; ++k) {
            const size_t a = first + k, b = first + (k + 1) % n;
            face({a, b, b + n, a + n}, looksIn);
            bottom.push_back(first + n - 1 - k);
            top.push_back(first + n + k);
        }
        face(bottom, looksIn);
        face(top, looksIn);
    }
    // Regular; `turn` in radians.
    void addColumn(glm::dvec2 middle, double radius, size_t sides, double turn, double low, double high) {
        std::vector<glm::dvec2> base;
        for (size_t k = 0; k < sides; ++k) {
            const double angle =
                turn + 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(sides);
            base.push_back(middle + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
        }
        add(base, low, high);
    }
    const std::string& text() const { return text_; }

private:
    // Every fifth looks the wrong way.
    void face(std::vector<size_t> corners, bool reversed) {
        if (reversed != (++faces_ % 5 == 0)) std::ranges::reverse(corners);
        text_ += fmt::format("f {}\n", fmt::join(corners, " "));
    }

    std::string text_;
    size_t count_ = 0, faces_ = 0;
};

// The faces of a mesh that no projector looks through.
Occluders facesThatStand(const PatchMesh& mesh) {
    Occluders out{mesh.vertices, {}, {}};
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        if (patchNormal(mesh, i).y > -0.1)
            out.triangles.insert(out.triangles.end(), mesh.patch(i).begin(), mesh.patch(i).end());
    return out;
}

// Two rooms of unlike height with columns, a shelf in the air and a partition that does not reach the
// ceiling.
TEST(ProjectorVisibility, faces_of_any_model_hide_one_another) {
    const auto box = [](double left, double front, double right, double back) {
        return std::vector<glm::dvec2>{{left, front}, {right, front}, {right, back}, {left, back}};
    };
    Prisms model;
    model.add(box(-0.25, -0.2, 0.1, 0.2), 0, 0.2, true);
    model.add(box(0.11, -0.2, 0.3, 0.2), 0, 0.12, true);
    model.addColumn({-0.1, 0.1}, 0.03, 7, 0.2, 0, 0.2);
    model.addColumn({-0.15, -0.08}, 0.025, 24, 0.1, 0, 0.15);
    model.addColumn({0.2, 0.02}, 0.02, 4, 0.6, 0, 0.12);
    model.add({{-0.05, -0.1}, {0.05, -0.02}, {0.045, -0.012}, {-0.055, -0.092}}, 0, 0.12);
    model.add(box(-0.02, 0.05, 0.07, 0.15), 0.06, 0.065);
    const Building building =
        throughFile(".obj", [&](const auto& file) { std::ofstream(file) << model.text(); });
    EXPECT_EQ(building.roomCount, 2u);
    const PatchMesh mesh = meshBuilding(building);
    const ProjectorMesh split = splitByProjectorVisibility(mesh, {}, fourProjectors());
    const double wrong = disagreement(mesh, split, facesThatStand(mesh), kTriangle);
    printf("%.5f of the rays disagree\n", wrong);
    EXPECT_LE(wrong, 0.001);
}

// The inside of a cylinder of 20 facets, painted as far as the limit lies on the cylinder itself: facet by
// facet it would be off by half an angle between facets, 0.08 of n . d, and end in teeth.
TEST(ProjectorVisibility, the_limit_runs_smoothly_over_a_curved_wall) {
    PatchMesh mesh;
    mesh.materials = {{}};
    const double radius = 0.18, height = 0.25;
    constexpr uint32_t kFacets = 20, kRows = 8;
    for (uint32_t j = 0; j <= kRows; ++j)
        for (uint32_t i = 0; i <= kFacets; ++i) {
            const double angle = std::numbers::pi * i / kFacets;
            mesh.vertices.push_back(
                {radius * std::cos(angle), height * j / kRows, -radius * std::sin(angle)});
        }
    for (uint32_t j = 0; j < kRows; ++j)
        for (uint32_t i = 0; i < kFacets; ++i) {
            const uint32_t a = j * (kFacets + 1) + i, up = a + kFacets + 1;
            mesh.addPatch(std::array{a + 1, a, up}, 0, Role::projection, 0, 0);
            mesh.addPatch(std::array{a + 1, up, up + 1}, 0, Role::projection, 0, 0);
        }
    const OpticalDevice projector = lookingAt({0.3, 1.1, 0.4}, {0, 0.1, -0.05});
    const ProjectorMesh split = splitByProjectorVisibility(mesh, {}, std::array{projector});
    double worst = 0;
    int seen = 0, hidden = 0;
    for (size_t t = 0; t < split.triangleCount(); ++t) {
        glm::dvec3 p(0);
        for (size_t k = 0; k < 3; ++k) p += split.vertices[split.triangles[3 * t + k]] / 3.0;
        const glm::dvec3 inward = -glm::normalize(glm::dvec3(p.x, 0, p.z));
        if (std::abs(inward.x) > 0.98) continue; // the outermost facets turn on one side only
        const double over = glm::dot(inward, glm::normalize(projector.centre() - p)) - 0.2;
        const bool label = split.visible[t] != 0;
        ++(label ? seen : hidden);
        if (label != (over > 0)) worst = std::max(worst, std::abs(over));
    }
    EXPECT_GT(seen, 50);
    EXPECT_GT(hidden, 10);
    EXPECT_LT(worst, 0.01); // chords lie inside the cylinder, and normals turn evenly along them
}

// Triangles that lean across the folds of a round column would lie in its solids, up to 6 mm deep here.
TEST(ProjectorVisibility, a_round_column_does_not_hide_its_own_outside) {
    const Building building = buildingOf("round_column.json");
    const PatchMesh mesh = meshBuilding(building);
    const auto projectors = fourProjectors();
    const ProjectorMesh split = splitByProjectorVisibility(mesh, building.occluders, projectors);
    constexpr double kInch = 0.0254, kOutside = 4.1875 * kInch, kProud = 0.001;
    const glm::dvec3 axis(2 * kInch, 0, -1 * kInch);
    double wrong = 0, seen = 0, all = 0;
    for (size_t t = 0; t < split.triangleCount(); ++t) {
        glm::dvec3 middle(0);
        for (size_t k = 0; k < 3; ++k) middle += split.vertices[split.triangles[3 * t + k]] / 3.0;
        const glm::dvec3 from(middle.x - axis.x, 0, middle.z - axis.z), outward = glm::normalize(from);
        if (std::abs(patchNormal(mesh, split.sourcePatch[t]).y) > 0.5 ||
            glm::length(from) < kOutside - 0.008 || glm::length(from) > kOutside + kProud)
            continue;
        const glm::dvec3 p = middle + (kOutside + kProud - glm::length(from)) * outward;
        for (size_t which = 0; which < projectors.size(); ++which) {
            const glm::dvec3 centre = projectors[which].centre();
            const double cosine = glm::dot(outward, glm::normalize(centre - p));
            const auto pixel = projectors[which].pixelFromWorld(p);
            if (std::abs(cosine - 0.2) < 0.1 || !pixel || pixel->x < 5 || pixel->y < 5 || pixel->x > 1018 ||
                pixel->y > 762)
                continue;
            const bool sees = cosine > 0.2 && !blocked(building.occluders, p, outward, centre);
            all += areaOf(split, t), seen += sees * areaOf(split, t);
            wrong += (sees != ((split.visible[t] >> which & 1u) != 0)) * areaOf(split, t);
        }
    }
    EXPECT_GT(seen, 0.2 * all);
    EXPECT_LT(wrong, 0.01 * all);
}

// Uniform facets of four sides: at a vertex between two of them the normal is that of the cylinder.
TEST(ProjectorVisibility, facets_of_four_sides_turn_as_smoothly_as_triangles) {
    PatchMesh mesh;
    mesh.materials = {{}};
    constexpr uint32_t kFacets = 10;
    for (uint32_t i = 0; i <= kFacets; ++i)
        for (const double y : {0.0, 0.25}) {
            const double angle = std::numbers::pi * i / kFacets;
            mesh.vertices.push_back({std::cos(angle), y, -std::sin(angle)});
        }
    for (uint32_t v = 0; v < 2 * kFacets; v += 2)
        mesh.addPatch(std::array{v + 2, v, v + 1, v + 3}, 0, Role::projection, 0, 0);
    const std::vector<FlatPart> parts = flatParts(mesh);
    EXPECT_EQ(parts.size(), kFacets);
    for (const FlatPart& part : parts) {
        ASSERT_EQ(part.normals.size(), 4u);
        for (size_t k = 0; k < 4; ++k) {
            const glm::dvec3 at = mesh.vertices[part.vertices[k]];
            if (std::abs(at.x) > 0.999) continue; // the ends
            EXPECT_NEAR(glm::dot(glm::normalize(part.normals[k]), glm::dvec3(-at.x, 0, -at.z)), 1, 1e-12);
        }
    }
}

TEST(ProjectorVisibility, no_t_vertices_within_or_between_surfaces) {
    for (const char* name : {"i01_mixed.sketch.json", "arc_with_partitions.json", "walls20.json"}) {
        const Building building = buildingOf(name);
        const PatchMesh mesh = meshBuilding(building);
        const ProjectorMesh split = splitByProjectorVisibility(mesh, building.occluders, fourProjectors());
        // By position: copies of a vertex on different surfaces are alike bit for bit.
        const auto key = [&](uint32_t v) {
            const glm::dvec3 p = split.vertices[v];
            return std::array<double, 3>{p.x, p.y, p.z};
        };
        std::map<std::pair<std::array<double, 3>, std::array<double, 3>>, int> edges;
        for (size_t t = 0; t < split.triangleCount(); ++t)
            for (size_t k = 0; k < 3; ++k)
                ++edges[{key(split.triangles[3 * t + k]), key(split.triangles[3 * t + (k + 1) % 3])}];
        // An edge without its opposite must be on the rim towards patches that are not shown.
        std::map<std::array<double, 3>, bool> rim;
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            if (mesh.role[i] != Role::projection)
                for (const uint32_t v : mesh.patch(i))
                    rim[{mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z}] = true;
        int loose = 0, twice = 0;
        for (const auto& [edge, count] : edges) {
            twice += count != 1;
            if (edges.contains({edge.second, edge.first})) continue;
            loose += !(rim.contains(edge.first) || rim.contains(edge.second));
        }
        // Rim edges that cuts divide have inner ends that are no mesh vertices; they are few.
        EXPECT_EQ(twice, 0) << name;
        EXPECT_LT(loose, 0.02 * static_cast<double>(edges.size())) << name;
    }
}

TEST(ProjectorVisibility, area_is_kept_and_triangles_grow_little) {
    for (const char* name : {"p04_L.json", "p06_U.json", "i01_mixed.sketch.json", "i02_pinwheel.sketch.json",
                             "arc_with_partitions.json", "walls20.json"}) {
        const Building building = buildingOf(name);
        const PatchMesh mesh = meshBuilding(building);
        double before = 0;
        size_t patches = 0;
        for (size_t i = 0; i < mesh.patchCount(); ++i)
            if (mesh.role[i] == Role::projection) {
                before += patchArea(mesh, i);
                ++patches;
            }
        const auto projectors = fourProjectors();
        double best = 1e300;
        ProjectorMesh split;
        for (int run = 0; run < 5; ++run) {
            const std::clock_t start = std::clock();
            split = splitByProjectorVisibility(mesh, building.occluders, projectors);
            best = std::min(best, 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
        }
        const double growth = static_cast<double>(split.triangleCount()) / static_cast<double>(patches);
        printf("%s: %zu occluders, %.2f times the triangles, %.1f ms\n", name,
               building.occluders.triangles.size() / 36, growth, best);
        EXPECT_LT(growth, 1.55) << name;
        double after = 0;
        for (size_t t = 0; t < split.triangleCount(); ++t) {
            ASSERT_GT(areaOf(split, t), 0);
            after += areaOf(split, t);
        }
        EXPECT_NEAR(after, before, 1e-9 * before) << name;
        double reached = 0, total = 0;
        for (const SurfaceReach& s : split.surfaces) {
            EXPECT_LE(s.unreachable, s.area * (1 + 1e-12));
            total += s.area;
            reached += s.area - s.unreachable;
        }
        EXPECT_NEAR(total, before, 1e-9 * before);
        EXPECT_GT(reached, 0.5 * total); // four projectors round the table
    }
}

// What no outline comes near is drawn as it was simulated.
TEST(ProjectorVisibility, triangles_away_from_outlines_stay_as_they_are) {
    const Building building = buildingOf("p04_L.json");
    const PatchMesh mesh = meshBuilding(building);
    const ProjectorMesh split = splitByProjectorVisibility(mesh, building.occluders, fourProjectors());
    size_t same = 0, patches = 0;
    for (size_t t = 0; t < split.triangleCount(); ++t) {
        bool all = true;
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t v = split.triangles[3 * t + k];
            all = all && split.sourceWeight[v] == glm::vec3(1, 0, 0) &&
                  split.sourceVertex[v][0] == mesh.patch(split.sourcePatch[t])[k];
        }
        same += all;
    }
    for (const Role role : mesh.role) patches += role == Role::projection;
    printf("%zu of %zu stay\n", same, patches);
    EXPECT_GT(static_cast<double>(same), 0.4 * static_cast<double>(patches));
}

TEST(ProjectorVisibility, light_at_a_vertex_is_mixed_from_that_of_its_place) {
    const Building building = buildingOf("p06_U.json");
    const PatchMesh mesh = meshBuilding(building);
    const ProjectorMesh split = splitByProjectorVisibility(mesh, building.occluders, fourProjectors());
    for (size_t v = 0; v < split.vertices.size(); ++v) {
        glm::dvec3 p(0);
        float total = 0;
        for (size_t k = 0; k < 3; ++k) {
            p += static_cast<double>(split.sourceWeight[v][static_cast<int>(k)]) *
                 mesh.vertices[split.sourceVertex[v][k]];
            total += split.sourceWeight[v][static_cast<int>(k)];
        }
        ASSERT_NEAR(glm::length(p - split.vertices[v]), 0, 1e-6); // weights are floats
        ASSERT_NEAR(total, 1, 1e-6);
    }
}

// Across an edge of the mesh shares agree, and those of a projector that ends there are nothing, where any
// other goes on.
TEST(ProjectorBlend, shares_sum_to_one_and_run_on_over_every_edge) {
    for (const char* name : {"p06_U.json", "i01_mixed.sketch.json"}) {
        const Building building = buildingOf(name);
        const PatchMesh mesh = meshBuilding(building);
        const auto projectors = fourProjectors();
        const std::vector<glm::dvec3> centres = centresOf(projectors);
        const ProjectorMesh split = splitByProjectorVisibility(mesh, building.occluders, projectors);
        const ProjectorBlend blend = blendProjectors(split, mesh, centres);
        std::map<std::pair<uint32_t, uint32_t>, size_t> sides;
        for (size_t i = 0; i < split.triangles.size(); ++i)
            sides[{split.triangles[i], split.triangles[i - i % 3 + (i + 1) % 3]}] = i / 3;
        size_t compared = 0, ended = 0, off = 0;
        for (const auto& [edge, t] : sides) {
            const auto other = sides.find({edge.second, edge.first});
            if (other == sides.end() || !split.visible[t] || !split.visible[other->second]) continue;
            // A third: where distances are not alike by symmetry.
            const glm::dvec3 p = glm::mix(split.vertices[edge.first], split.vertices[edge.second], 1.0 / 3);
            const glm::dvec3 n = patchNormal(mesh, split.sourcePatch[t]); // one for both: of the place
            const auto here = blendShares(blend, t, p, n, centres),
                       there = blendShares(blend, other->second, p, n, centres);
            double sum = 0;
            for (const double share : here) sum += share;
            ASSERT_NEAR(sum, 1, 1e-12);
            if ((split.visible[t] & split.visible[other->second]) == 0) continue; // one hands over to another
            for (size_t k = 0; k < centres.size(); ++k) {
                compared += 1;
                ended += (split.visible[t] ^ split.visible[other->second]) >> k & 1u;
                off += std::abs(here[k] - there[k]) > 1e-3;
            }
        }
        EXPECT_GT(compared, 5000u);
        EXPECT_GT(ended, 100u);
        // Where those that see both sides end within a hair, too, one must hand over to another.
        EXPECT_LT(off, 0.002 * static_cast<double>(compared)) << name;
    }
}

// A block on a table between two projectors: towards the far edge of its top each leaves more to the other.
TEST(ProjectorBlend, a_projector_hands_over_where_it_sees_past_the_end_of_a_surface) {
    PatchMesh mesh;
    mesh.materials = {{}};
    const double w = 0.1, h = 0.1;
    mesh.vertices = {{-w, h, w}, {w, h, w}, {w, h, -w}, {-w, h, -w},
                     {-w, 0, w}, {w, 0, w}, {w, 0, -w}, {-w, 0, -w}};
    const auto add = [&](std::array<uint32_t, 4> corners, uint32_t surface) {
        mesh.addPatch(corners, 0, Role::projection, surface, 0);
    };
    add({0, 1, 2, 3}, 0);
    add({1, 5, 6, 2}, 1); // to the right
    add({3, 7, 4, 0}, 2); // to the left
    const std::vector<OpticalDevice> two{lookingAt({-1, 1.1, 0}, {0, 0, 0}),
                                         lookingAt({1, 1.1, 0}, {0, 0, 0})};
    const ProjectorMesh split = splitByProjectorVisibility(mesh, {}, two);
    const ProjectorBlend blend = blendProjectors(split, mesh, centresOf(two));
    const auto shareOnTop = [&](size_t projector, glm::dvec3 p) {
        for (size_t t = 0; t < split.triangleCount(); ++t) {
            const auto corner = [&](size_t k) { return split.vertices[split.triangles[3 * t + k % 3]]; };
            bool inside = mesh.surface[split.sourcePatch[t]] == 0;
            for (size_t k = 0; k < 3; ++k)
                inside = inside && glm::cross(corner(k + 1) - corner(k), p - corner(k)).y > 0;
            if (inside) return blendShares(blend, t, p, {0, 1, 0}, centresOf(two))[projector];
        }
        ADD_FAILURE() << "outside";
        return 0.0;
    };
    EXPECT_NEAR(shareOnTop(0, {0.001, h, 0.003}), 0.5, 0.01);
    EXPECT_LT(shareOnTop(0, {w - 0.001, h, 0.003}), 0.2); // from the left past the right edge
    EXPECT_LT(shareOnTop(1, {0.001 - w, h, 0.003}), 0.2);
}

// The share of a projector is the same at all points as far from a straight border, whatever the mesh: here a
// wall between a projector and half of a table of ever finer triangles.
TEST(ProjectorBlend, shares_do_not_follow_the_mesh) {
    const auto shareOf = [](int n, double x) {
        PatchMesh mesh;
        mesh.materials = {{}};
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i) mesh.vertices.push_back({-0.3 + 0.6 * i / n, 0, 0.3 - 0.6 * j / n});
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const auto at = static_cast<uint32_t>(j * (n + 1) + i),
                           up = at + static_cast<uint32_t>(n + 1);
                mesh.addPatch(std::array{at, at + 1, up + 1}, 0, Role::projection, 0, 0);
                mesh.addPatch(std::array{at, up + 1, up}, 0, Role::projection, 0, 0);
            }
        // The picture of the second ends at x = 0.
        const std::vector<OpticalDevice> two{lookingAt({0.01, 1.5, 0.01}, {0, 0, 0}),
                                             lookingAt({0.256, 1.5, 0.0001}, {0.256, 0, 0}, 3000)};
        const ProjectorMesh split = splitByProjectorVisibility(mesh, {}, two);
        const ProjectorBlend blend = blendProjectors(split, mesh, centresOf(two));
        std::vector<double> shares;
        for (const double z : {-0.1, -0.03, 0.05, 0.12})
            for (size_t t = 0; t < split.triangleCount(); ++t) {
                const auto corner = [&](size_t k) { return split.vertices[split.triangles[3 * t + k % 3]]; };
                const glm::dvec3 p(x, 0, z);
                bool inside = true;
                for (size_t k = 0; k < 3; ++k)
                    inside = inside && glm::cross(corner(k + 1) - corner(k), p - corner(k)).y > 0;
                if (inside) shares.push_back(blendShares(blend, t, p, {0, 1, 0}, centresOf(two))[1]);
            }
        return shares;
    };
    for (const double x : {0.005, 0.02, 0.035}) {
        const std::vector<double> coarse = shareOf(5, x), fine = shareOf(23, x);
        ASSERT_EQ(coarse.size(), 4u);
        ASSERT_EQ(fine.size(), 4u);
        for (size_t k = 0; k < 4; ++k) {
            EXPECT_NEAR(coarse[k], fine[k], 1e-6);
            EXPECT_NEAR(coarse[k], coarse[0], 0.01); // cos / r^2 differs along the border
        }
    }
}

TEST(ProjectorVisibility, nothing_stands_between_an_empty_table_and_its_projector) {
    PatchMesh mesh;
    mesh.vertices = {{-0.3, 0, 0.3}, {0.3, 0, 0.3}, {0.3, 0, -0.3}, {-0.3, 0, -0.3}};
    mesh.materials = {{}};
    const std::array<uint32_t, 4> corners{0, 1, 2, 3};
    mesh.addPatch(corners, 0, Role::projection, 0, 0);
    const std::vector<OpticalDevice> one{lookingAt({0.01, 1.5, 0.01}, {0, 0, 0})};
    const ProjectorMesh split = splitByProjectorVisibility(mesh, {}, one);
    for (const uint32_t seen : split.visible) EXPECT_EQ(seen, 1u);
    EXPECT_EQ(split.surfaces.at(0).unreachable, 0);
    // Half as wide a picture leaves a rim dark: 1.5 m away, 1024 px at 3000 px/m are 0.512 m by 0.384 m.
    const std::vector<OpticalDevice> narrow{lookingAt({0.0, 1.5, 0.0001}, {0, 0, 0}, 3000)};
    const ProjectorMesh partly = splitByProjectorVisibility(mesh, {}, narrow);
    EXPECT_NEAR(partly.surfaces.at(0).area - partly.surfaces.at(0).unreachable, 0.512 * 0.384, 1e-4);
}
