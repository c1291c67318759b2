// Checklist 28: the sun per pixel, against ray casting in double precision on the same pixels.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include "compute/daylight/glazing.h"
#include "engine/passes/frame_renderer.h"
#include "engine/passes/glow_grids.h"
#include "engine/passes/panes.h"
#include "geometry/projector_visibility.h"
#include "tests/gpu/test_device.h"
#include "tests/passes/room_builder.h"

namespace heliodon::passes {
namespace {

using geometry::PatchMesh;
using test::RoomBuilder;

struct Hit {
    double distance;
    size_t patch;
};

// Ray against a planar convex polygon, from either side.
std::optional<double> meet(const PatchMesh& mesh, size_t p, glm::dvec3 n, glm::dvec3 origin,
                           glm::dvec3 direction) {
    const auto corner = mesh.patch(p);
    const double denominator = glm::dot(n, direction);
    if (std::abs(denominator) < 1e-14) return std::nullopt;
    const double t = glm::dot(n, mesh.vertices[corner[0]] - origin) / denominator;
    if (!(t > 1e-7)) return std::nullopt;
    const glm::dvec3 hit = origin + t * direction;
    for (size_t k = 0; k < corner.size(); ++k) {
        const glm::dvec3 &a = mesh.vertices[corner[k]], &b = mesh.vertices[corner[(k + 1) % corner.size()]];
        if (glm::dot(n, glm::cross(b - a, hit - a)) < 0) return std::nullopt;
    }
    return t;
}

struct Reference {
    Reference(const PatchMesh& m, glm::dvec3 sun) : mesh(m), towardsSun(sun) {
        for (size_t p = 0; p < mesh.patchCount(); ++p) normals.push_back(geometry::patchNormal(mesh, p));
        outside.vertices = mesh.outside.vertices;
        for (size_t t = 0; t < mesh.outside.triangles.size(); t += 3)
            outside.addPatch(std::span(mesh.outside.triangles).subspan(t, 3), 0, geometry::Role::extra, 0, 0);
    }
    const PatchMesh& mesh;
    PatchMesh outside; // of it
    glm::dvec3 towardsSun;
    std::vector<glm::dvec3> normals;

    // Reflected sun of what a ray sees, per unit of normal illuminance; none where it sees nothing.
    struct Seen {
        int surface = -1;
        bool lit = false;
        glm::dvec3 value{0};
        bool operator==(const Seen& o) const { return surface == o.surface && lit == o.lit; }
    };
    Seen look(glm::dvec3 eye, glm::dvec3 direction) const {
        std::optional<Hit> nearest;
        for (size_t p = 0; p < mesh.patchCount(); ++p) {
            if (glm::dot(normals[p], direction) >= 0) continue; // its back
            const auto t = meet(mesh, p, normals[p], eye, direction);
            if (t && (!nearest || *t < nearest->distance)) nearest = Hit{*t, p};
        }
        if (!nearest) return {};
        Seen seen;
        seen.surface = static_cast<int>(mesh.surface[nearest->patch]);
        const glm::dvec3 normal = normals[nearest->patch];
        const double cosine = glm::dot(normal, towardsSun);
        const geometry::Material& material = mesh.materials[mesh.material[nearest->patch]];
        if (cosine <= 0 || material.isOpening()) return seen;
        const glm::dvec3 left = sunAt(eye + nearest->distance * direction);
        seen.value = glm::dvec3(material.reflectance) * cosine * left;
        seen.lit = left.x > 0;
        return seen;
    }
    glm::dvec3 sunAt(glm::dvec3 point) const {
        glm::dvec3 left(1);
        for (size_t p = 0; p < outside.patchCount(); ++p)
            if (meet(outside, p, geometry::patchNormal(outside, p), point, towardsSun)) return glm::dvec3(0);
        for (size_t p = 0; p < mesh.patchCount(); ++p) {
            if (!meet(mesh, p, normals[p], point, towardsSun)) continue;
            const geometry::Material& material = mesh.materials[mesh.material[p]];
            if (!material.isOpening()) return glm::dvec3(0);
            const double cosine = glm::dot(normals[p], towardsSun);
            if (mesh.twin[p] == geometry::kNoTwin || cosine < 0)
                left *= daylight::glazingOf(material).transmittance(cosine);
        }
        return left;
    }
};

struct Tally {
    size_t compared = 0, wrong = 0, lit = 0;
    double worstValue = 0;
};

Tally compare(FrameRenderer& renderer, const PatchMesh& mesh, const View& view, glm::dvec3 towardsSun) {
    compute::Lighting light;
    light.exitance.assign(mesh.patchCount(), glm::vec3(0));
    light.sunIlluminance.assign(mesh.patchCount(), glm::vec3(0));
    light.sunDirection = towardsSun;
    light.sunNormalIlluminance = glm::vec3(1000, 500, 250);
    const ImageF picture = renderer.exitance(light, view);
    const Reference reference(mesh, towardsSun);
    const glm::dmat4 worldFromClip = glm::inverse(view.clipFromWorld);
    const int w = view.outputWidth, h = view.outputHeight;
    std::vector<Reference::Seen> seen;
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            const glm::dvec4 far =
                worldFromClip * glm::dvec4(2 * (x + 0.5) / w - 1, 2 * (y + 0.5) / h - 1, 1, 1);
            seen.push_back(reference.look(view.eye, glm::normalize(glm::dvec3(far) / far.w - view.eye)));
        }
    Tally tally;
    for (int y = 1; y + 1 < h; ++y)
        for (int x = 1; x + 1 < w; ++x) {
            const Reference::Seen& here = seen[static_cast<size_t>(y * w + x)];
            bool edge = false;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx)
                    edge |= !(seen[static_cast<size_t>((y + dy) * w + x + dx)] == here);
            if (edge) continue;
            ++tally.compared;
            const float* drawn = picture.pixel(x, y);
            const bool lit = drawn[0] > 0;
            tally.lit += here.lit;
            if (lit != here.lit) ++tally.wrong;
            if (lit && here.lit)
                for (int c = 0; c < 3; ++c) {
                    const double want = here.value[c] * light.sunNormalIlluminance[c];
                    tally.worstValue = std::max(tally.worstValue, std::abs(drawn[c] - want) / want);
                }
        }
    return tally;
}

// South wall with a window in its middle third, and a smaller hole up in a corner.
uint32_t southWall(int i, int j) {
    if (i >= 2 && i < 4 && j >= 2 && j < 4) return test::kGlass;
    return i == 0 && j == 5 ? test::kHole : test::kWhite;
}

// Two rooms side by side that share a thin wall with a window, a screen without thickness in the first, and a
// second building to the south whose windows face one another.
PatchMesh manyRooms() {
    RoomBuilder b;
    const auto sixth = [](int i, int j) { return southWall(i, j); };
    const auto wholeWindow = [](int i, int j) {
        return i >= 1 && i < 5 && j >= 1 && j < 5 ? test::kGlass : test::kWhite;
    };
    b.box({-1, 0, -1}, {1, 0.6, 1}, 6, sixth, 0);
    b.box({0.05, 0, -1}, {1, 0.6, 1}, 6, wholeWindow, 1);
    b.wall({-0.8, 0, -0.3}, {0.5, 0, 0.2}, {0, 0.3, 0}, 3, 2, test::kGrey, 0);
    b.wall({-0.3, 0, -0.1}, {-0.5, 0, -0.2}, {0, 0.3, 0}, 3, 2, test::kGrey, 0); // its other side
    b.box({-1, 0, 0.4}, {1.4, 0.5, 0.5}, 6, wholeWindow, 2);
    return b.mesh;
}

class Shadow : public testing::Test {
protected:
    void expectAgreement(const PatchMesh& mesh, const std::vector<View>& views,
                         const std::vector<glm::dvec3>& suns, size_t leastLit) {
        FrameRenderer renderer(test::device(), mesh, {}, nullptr);
        size_t compared = 0, wrong = 0, lit = 0;
        double worst = 0;
        for (const View& view : views)
            for (const glm::dvec3& sun : suns) {
                const Tally t = compare(renderer, mesh, view, glm::normalize(sun));
                compared += t.compared, wrong += t.wrong, lit += t.lit;
                worst = std::max(worst, t.worstValue);
                EXPECT_LE(double(t.wrong), 0.001 * double(t.compared))
                    << t.wrong << " of " << t.compared << ", sun " << sun.x << " " << sun.y << " " << sun.z
                    << ", eye " << view.eye.x << " " << view.eye.y << " " << view.eye.z;
            }
        EXPECT_GE(lit, leastLit);
        // A few products of floats.
        EXPECT_LT(worst, 1e-5);
        RecordProperty("wrong", std::to_string(wrong) + " of " + std::to_string(compared));
    }
    static View from(glm::dvec3 eye, glm::dvec3 target, double fov = 60) {
        return viewOfCamera({eye, target, fov}, 80, 60);
    }
};

TEST_F(Shadow, window_patch_agrees_with_rays_from_above_and_inside) {
    RoomBuilder b;
    b.box({-0.5, 0, -0.5}, {1, 0.6, 1}, 6, southWall);
    const std::vector<View> views{from({0.2, 1.6, 1.0}, {0, 0.2, 0}, 40),
                                  from({0.3, 0.4, 0.4}, {-0.3, 0.1, -0.4}, 80),
                                  from({0, 1.8, 0}, {0, 0, 0}, 40)};
    expectAgreement(b.mesh, views,
                    {{0, 0.5, 1}, {0.3, 0.8, 1}, {-0.5, 0.3, 0.8}, {0.1, 0.03, 1}, {0.2, 2, 0.5}}, 800);
}

TEST_F(Shadow, what_stands_outside_agrees_with_rays) {
    RoomBuilder b;
    b.box({-0.5, 0, -0.5}, {1, 0.6, 1}, 6, southWall);
    b.mesh.outside.vertices = {{0, 0, 0.55}, {0.4, 0, 0.55}, {0.4, 0.7, 0.55}, {0, 0.7, 0.55}};
    b.mesh.outside.triangles = {0, 2, 1, 0, 3, 2};
    expectAgreement(b.mesh, {from({0.2, 1.6, 1.0}, {0, 0.2, 0}, 40), from({0, 1.8, 0}, {0, 0, 0}, 40)},
                    {{0, 0.5, 1}, {0.3, 0.8, 1}, {-0.5, 0.3, 0.8}}, 200);
}

TEST_F(Shadow, rooms_in_the_way_of_one_another_agree_with_rays) {
    const std::vector<View> views{from({0.4, 2.2, 1.6}, {0, 0.1, -0.1}, 50),
                                  from({-0.9, 0.5, -0.05}, {0.3, 0, -0.9}, 85)};
    expectAgreement(manyRooms(), views, {{0.1, 0.35, 1}, {-0.6, 0.5, 0.7}, {0.05, 0.08, 1}, {0.7, 0.7, 0.7}},
                    300);
}

TEST_F(Shadow, random_suns_agree_even_grazing_or_along_a_wall) {
    const PatchMesh mesh = manyRooms();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<glm::dvec3> suns{{0, 0.5, 1}, {1e-4, 0.3, 1}, {0, 1, 0}, {1e-9, 1e-3, 1}, {1, 0.2, 0}};
    while (suns.size() < 14)
        suns.emplace_back(unit(random), std::abs(unit(random)) + 0.01, unit(random) + 0.8);
    expectAgreement(mesh, {from({-0.3, 1.9, 1.3}, {-0.2, 0.1, -0.3}, 45)}, suns, 300);
}

TEST_F(Shadow, eye_inside_the_volumes_sees_the_same_shadows) {
    RoomBuilder b;
    b.box({-0.5, 0, -0.5}, {1, 0.6, 1}, 6, southWall);
    // In the shadow of the wall beside the window, of the roof, and one within the beam.
    const std::vector<View> views{from({0.45, 0.05, 0.45}, {-0.2, 0, -0.3}, 90),
                                  from({-0.4, 0.55, 0.1}, {0.1, 0, -0.1}, 90),
                                  from({0, 0.28, 0.42}, {0, 0, -0.3}, 90)};
    expectAgreement(b.mesh, views, {{0, 0.5, 1}, {0.4, 0.9, 1}, {-0.3, 0.15, 1}}, 500);
}

TEST(Pane, interior_glass_counts_once_and_exterior_glass_each_time) {
    RoomBuilder b;
    const auto window = [](int i, int j) { return i == 1 && j == 1 ? test::kGlass : test::kWhite; };
    b.box({-0.5, 0, 0}, {1, 1, 1}, 3, window, 0);
    // North room whose south wall is the first room's north wall: an interior window, both sides known.
    b.box({-0.5, 0, -1}, {1, 1, 1}, 3, window, 1);
    PatchMesh& mesh = b.mesh;
    for (uint32_t p = 0; p < mesh.patchCount(); ++p) { // open the first room's north wall in the same place
        const glm::dvec3 c = geometry::patchCentroid(mesh, p);
        if (std::abs(c.z) < 1e-9 && std::abs(c.x) < 0.16 && std::abs(c.y - 0.5) < 0.16) {
            mesh.material[p] = test::kGlass;
            mesh.surface[p] = mesh.room[p] == 0 ? 900 : 901;
            mesh.twin[p] = 0; // any twin: only its presence counts
        }
    }
    mesh.role.assign(mesh.patchCount(), geometry::Role::projection);
    const glm::dvec3 sun = glm::normalize(glm::dvec3(0, 0.05, 1));
    FrameRenderer renderer(test::device(), mesh, {}, nullptr);
    const View view = viewOfCamera({{0, 0.5, -0.1}, {0, 0.45, -1}, 20}, 32, 32);
    compute::Lighting light;
    light.exitance.assign(mesh.patchCount(), glm::vec3(0));
    light.sunDirection = sun;
    light.sunNormalIlluminance = glm::vec3(1000);
    const ImageF picture = renderer.exitance(light, view);
    const double one = daylight::glazingOf(mesh.materials[test::kGlass]).transmittance(sun.z).x;
    EXPECT_NEAR(picture.pixel(16, 16)[0], 700 * sun.z * one * one, 1.5);
}

// Outlines of projectors cut triangles that go over several patches.
TEST(Glow, a_triangle_over_two_patches_has_what_their_grids_say_at_its_corners) {
    PatchMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 0, -1}, {1, 0, -1}};
    mesh.materials = {{}};
    mesh.addPatch(std::array{0u, 1u, 2u}, 0, geometry::Role::projection, 0, 0);
    mesh.addPatch(std::array{3u, 2u, 1u}, 0, geometry::Role::projection, 0, 0);
    const auto there = [](glm::dvec3 p) { return glm::vec3(glm::dvec3(p.x + 2, 3 - p.z, p.x - p.z)); };
    std::vector<compute::PatchGlow> grids{{0, {}}, {1, {}}};
    for (compute::PatchGlow& grid : grids) {
        const std::vector<glm::dvec3> corner = geometry::patchCorners(mesh, grid.patch);
        std::ranges::transform(grid.places(corner[0], corner[1], corner[2]), grid.lux.begin(), there);
        EXPECT_LT(glm::length(grid.at({0.31f, 0.62f}) - there(corner[0] + 0.31 * (corner[1] - corner[0]) +
                                                              0.62 * (corner[2] - corner[0]))),
                  1e-5);
    }
    const VertexLight vertexLight(mesh);
    const std::vector<glm::vec3> twice(2, glm::vec3(2));
    const GlowGrids glow(mesh, vertexLight, grids, twice);
    DrawMesh drawn;
    const std::array<glm::dvec3, 3> at{{{1, 0, 0}, {0.9, 0, -0.8}, {0.1, 0, -0.3}}};
    for (const glm::dvec3 p : at) {
        drawn.corners.push_back({glm::vec3(p), {}, {}, {}});
        drawn.light.push_back({{vertexLight.pairOf(1, 0), 0, 0}, {1, 0, 0}});
    }
    drawn.patch = {0};
    drawn.cornerPatch = {geometry::ProjectorMesh::kCorner, 1, 0};
    const auto on = glow.on(drawn, 0);
    ASSERT_TRUE(on);
    const size_t last[]{0, compute::PatchGlow::kCells, io::kGlowPlaces - 1};
    for (size_t k = 0; k < 3; ++k)
        EXPECT_LT(glm::length(on->light[last[k]] - 2.0f * there(at[k])), 1e-4) << k;
    EXPECT_EQ(on->at[1], glm::vec2(1, 0));
    drawn.corners[1].position = {0.2f, 0, -0.2f}; // now on its own patch
    const auto own = glow.on(drawn, 0);
    ASSERT_TRUE(own);
    EXPECT_EQ(own->light[3], 2.0f * grids[0].lux[3]);
    EXPECT_LT(glm::length(own->at[1] - glm::vec2(0.2f, 0.2f)), 1e-6);
}

// A glow that bends within triangles: each pixel shows what it is there, not what their corners have.
TEST(Glow, is_drawn_as_it_is_within_a_triangle) {
    RoomBuilder room;
    room.box({-0.5, 0, -0.5}, {1, 1, 1}, 1, [](int, int) { return test::kWhite; });
    const PatchMesh& mesh = room.mesh;
    const auto there = [](glm::dvec3 p) { return 1000 * (p.x * p.x + std::abs(p.z) + 0.1); };
    compute::Lighting light;
    light.exitance.assign(mesh.patchCount(), glm::vec3(100));
    light.detail.mean.assign(mesh.patchCount(), glm::vec3(0));
    for (uint32_t p = 0; p < mesh.patchCount(); ++p) {
        if (geometry::patchNormal(mesh, p).y < 0.9) continue;
        compute::PatchGlow glow{p, {}};
        const std::vector<glm::dvec3> corner = geometry::patchCorners(mesh, p);
        std::ranges::transform(glow.places(corner[0], corner[1], corner[2]), glow.lux.begin(),
                               [&](glm::dvec3 at) { return glm::vec3(static_cast<float>(there(at))); });
        light.detail.mean[p] = glow.mean();
        light.exitance[p] += 0.7f * glow.mean();
        light.detail.grids.push_back(glow);
    }
    ASSERT_EQ(light.detail.grids.size(), 2u);
    FrameRenderer renderer(test::device(), mesh, {}, nullptr);
    const ImageF picture = renderer.exitance(light, viewOfCamera({{0, 5, 0}, {0, 0, 0}, 10}, 64, 64));
    const double metres = 2 * 5 * std::tan(glm::radians(5.0)) / 64; // a pixel
    for (int y = 8; y < 56; ++y)
        for (int x = 8; x < 56; ++x)
            EXPECT_NEAR(picture.pixel(x, y)[1],
                        100 + 0.7 * there({metres * (x - 31.5), 0, metres * (y - 31.5)}), 8)
                << x << ' ' << y;
}

} // namespace
} // namespace heliodon::passes
