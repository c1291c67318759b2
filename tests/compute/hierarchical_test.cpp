#include "compute/hierarchical.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <random>

#include <glm/packing.hpp>
#include <gtest/gtest.h>

#include "compute/exact_form_factors.h"
#include "compute/link_claims.h"
#include "compute/link_maker.h"
#include "compute/radiosity.h"
#include "compute/reference/hierarchical.h"
#include "compute/reference/radiosity.h"
#include "tests/compute/cases.h"
#include "tests/compute/form_factor_cases.h"
#include "tests/compute/rooms.h"
#include "tests/gpu/test_device.h"
#include "tests/sanitized.h"

namespace heliodon::compute {
namespace {

const std::string kData = std::string(HELIODON_TEST_DATA) + "/compute/formfactor/";

std::vector<float> dense(const HierarchicalFormFactors& F) {
    std::vector<float> values(size_t{F.patchCount()} * F.patchCount());
    F.rows(0, F.patchCount(), values);
    return values;
}

TEST(PatchTree, clusters_hold_their_triangles_and_every_triangle_is_a_leaf) {
    const geometry::PatchMesh mesh = geometry::readPatches(kData + "room3_672.obj");
    const PatchTree tree = buildPatchTree(mesh, blockingRegions(mesh, 8));
    ASSERT_EQ(tree.leaves.size(), mesh.patchCount());
    double area = 0;
    for (size_t k = 0; k < tree.nodes.size(); ++k) {
        const PatchTree::Node& node = tree.nodes[k];
        if (node.parent == PatchTree::kNone) area += node.area;
        for (uint32_t l = node.firstLeaf; l < node.firstLeaf + node.leafCount; ++l)
            for (const glm::dvec3& p : tree.leaves[l].corner) {
                EXPECT_LE(glm::length(p - node.centre), node.radius * (1 + 1e-12));
                EXPECT_NEAR(glm::dot(p - node.centre, node.normal), 0, 1e-6); // float positions of the file
            }
        if (node.child != 0) {
            EXPECT_EQ(tree.nodes[node.child].leafCount + tree.nodes[node.child + 1].leafCount,
                      node.leafCount);
        }
    }
    double total = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) total += geometry::patchArea(mesh, i);
    EXPECT_NEAR(area, total, 1e-9 * total);
}

// What patches cover of one another across gaps is cut out of both. Edges that cuts had left as short as
// rounding had any direction: where piles lean, patches were taken apart into 0.7 to 2 times their area, and
// rows summed to 0.69 without a word.
TEST(PatchTree, triangles_of_piles_that_lean_make_up_their_patches) {
    for (const double gap : {1e-6, 1e-7})
        for (int k = 0; k < 40; ++k) {
            const geometry::PatchMesh mesh =
                test::pileOfSlabs(gap, 0.01 + 0.0137 * k, {0.37 + 0.1 * k, 0.5, 0.21 - 0.3 * k});
            const PatchTree tree = buildPatchTree(mesh, {});
            std::vector<double> area(mesh.patchCount());
            double covered = 0;
            for (const PatchTree::Leaf& leaf : tree.leaves) {
                area[leaf.patch] += leaf.area;
                if (leaf.across == PatchTree::kNone) continue;
                covered += leaf.area;
                EXPECT_NEAR(tree.leaves[leaf.across].area, leaf.area, 1e-6 * leaf.area);
            }
            EXPECT_GT(covered, 2 * 0.8) << gap << " " << k; // both sides of two gaps, partly beside the slab
            for (size_t i = 0; i < mesh.patchCount(); ++i) {
                const double whole = geometry::patchArea(mesh, i);
                EXPECT_NEAR(area[i], whole, 1e-6 * whole)
                    << "gap " << gap << ", pile " << k << ", patch " << i;
            }
        }
}

// What stands on a floor parts its clusters, however few triangles lie behind.
TEST(PatchTree, clusters_end_where_a_blocker_stands) {
    std::vector<std::vector<glm::dvec3>> squares;
    for (int i = 0; i < 8; ++i)
        for (int k = 0; k < 8; ++k) {
            const double x = i, z = k;
            squares.push_back({{x, 0, z}, {x, 0, z + 1}, {x + 1, 0, z + 1}, {x + 1, 0, z}});
        }
    const geometry::PatchMesh mesh = test::polygons(squares);
    const ConvexRegion wall{{{1, 0, 0}, {1, 3, 0}, {1, 3, 8}, {1, 0, 8}}, 0, 0};
    const ConvexRegion beside{
        {{5, 0.1, 0}, {5, 3, 0}, {5, 3, 8}, {5, 0.1, 8}}, 0, 0}; // does not reach the floor
    const PatchTree tree = buildPatchTree(mesh, std::vector{wall, beside});
    size_t across = 0, halves = 0;
    for (size_t k = 1; k < tree.nodes.size(); ++k) {
        const PatchTree::Node& node = tree.nodes[k];
        bool left = false, right = false;
        for (uint32_t l = node.firstLeaf; l < node.firstLeaf + node.leafCount; ++l) {
            const auto& c = tree.leaves[l].corner;
            ((c[0].x + c[1].x + c[2].x) / 3 < 1 ? left : right) = true;
        }
        across += left && right;
        if (node.parent == 0) halves += node.leafCount;
    }
    EXPECT_EQ(across, 0u);
    EXPECT_EQ(halves, 128u);
}

// Claims of rows as their definition has them, and links of the worst rows taken apart until these hold.
TEST(LinkClaims, few_links_of_the_worst_rows_are_taken_apart) {
    const geometry::PatchMesh mesh = geometry::readPatches(kData + "cube_quads_4x4.obj");
    const PatchTree tree = buildPatchTree(mesh, {});
    std::vector<double> areas;
    for (size_t i = 0; i < mesh.patchCount(); ++i) areas.push_back(geometry::patchArea(mesh, i));
    const auto roots = tree.levelFirst[1];
    std::vector<io::HierarchicalLink> links;
    for (uint32_t a = 0; a < roots; ++a)
        for (uint32_t b = a + 1; b < roots; ++b)
            links.push_back({a, b, 0.5f, 0, 0, a == 0 ? 0.1f : 0.01f, 0.5f, 0});
    LinkClaims claims(tree, areas, links);
    const std::vector<double> sums = claims.rowSums(), squares = claims.rowSquares();
    for (const PatchTree::Leaf& leaf : tree.leaves) {
        uint32_t root = leaf.node;
        while (tree.nodes[root].parent != PatchTree::kNone) root = tree.nodes[root].parent;
        const double face = 16 * areas[0], others = root == 0 ? 5 * 0.1 : 0.1 + 4 * 0.01;
        EXPECT_NEAR(sums[leaf.patch], others * face, 1e-6 * face);
        const double variance = root == 0 ? 5 * 0.01 : 0.01 + 4 * 0.0001;
        EXPECT_NEAR(squares[leaf.patch], variance * face * areas[0], 1e-6 * face * areas[0]);
    }
    const double bound = 0.2 * 16 * areas[0];
    const std::vector<glm::uvec2> pairs = claims.split(links, bound);
    EXPECT_LT(links.size(), 15u);
    EXPECT_GE(links.size(), 10u); // those of other faces are good enough
    EXPECT_EQ(pairs.size(), 2 * (15 - links.size()));
    const LinkClaims rest(tree, areas, links);
    for (size_t i = 0; i < areas.size(); ++i) EXPECT_NEAR(claims.rowSums()[i], rest.rowSums()[i], 1e-9);
    EXPECT_TRUE(claims.split(links, 16 * areas[0]).empty());
}

// The same clusters linked, with the same densities and slopes, as in double precision. Where a value is as
// good as the tolerance, rounding decides: few pairs.
TEST(LinkMaker, links_in_the_open_are_those_of_the_reference) {
    test::BoxRoom box;
    box.cells = {4, 3, 5};
    geometry::PatchMesh mesh = test::boxRoom(box);
    test::BoxRoom inner;
    inner.low = {1, 1, 1}, inner.high = {3, 2, 3};
    test::addBox(mesh, inner, 1); // lies inside the other, yet in a room of its own
    const ClusterScene scene(test::device(), mesh);
    ASSERT_EQ(scene.blockers.nodeCount, 0u);
    for (double tolerance : {1e-2, 3e-3}) {
        if (test::kSanitized && tolerance < 1e-2) continue;
        LinkMaker maker(test::device(), scene, {tolerance, tolerance});
        for (uint32_t a = 0; a < scene.tree.levelFirst[1]; ++a)
            for (uint32_t b = a + 1; b < scene.tree.levelFirst[1]; ++b) maker.add(a, b);
        std::map<std::pair<uint32_t, uint32_t>, io::HierarchicalLink> links;
        for (const io::HierarchicalLink& link : maker.finish()) links[{link.first, link.second}] = link;
        const std::vector<reference::Link> truth = reference::openLinks(scene.tree, tolerance);
        size_t missing = 0, clusters = 0;
        for (const reference::Link& expected : truth) {
            const auto found = links.find({expected.first, expected.second});
            missing += found == links.end();
            if (found == links.end()) continue;
            const io::HierarchicalLink& link = found->second;
            const PatchTree::Node &p = scene.tree.nodes[link.first], &q = scene.tree.nodes[link.second];
            if (p.child == 0 && q.child == 0) { // a rule of few points, or integrals round borders
                const double allowed = double{io::kHierarchicalKept} * tolerance / std::max(p.area, q.area);
                EXPECT_NEAR(link.density, expected.density, allowed + 1e-5 * expected.density);
                continue;
            }
            ++clusters;
            EXPECT_NEAR(link.density, expected.density, 1e-5 * expected.density);
            EXPECT_NEAR(link.error, expected.error, 1e-5 * expected.density);
            const glm::vec2 first = glm::unpackHalf2x16(link.firstSlope),
                            second = glm::unpackHalf2x16(link.secondSlope);
            const std::array<float, 4> slopes{first.x, first.y, second.x, second.y};
            for (size_t k = 0; k < 4; ++k) // ten bits
                EXPECT_NEAR(slopes[k], expected.slopes[k], 1e-5 + std::abs(expected.slopes[k]) / 1024);
        }
        EXPECT_GT(clusters, 100u);
        EXPECT_LE(missing, truth.size() / 200);
        EXPECT_NEAR(static_cast<double>(links.size()), static_cast<double>(truth.size()),
                    0.01 * static_cast<double>(truth.size()));
    }
}

uint32_t rootOf(const PatchTree& tree, glm::dvec3 normal) {
    uint32_t root = 0;
    while (glm::dot(tree.nodes[root].normal, normal) < 0.999) ++root;
    return root;
}

// Loops longer than devices let them be (shaders/lib/loop_limit.glsl). A room about the origin, so that
// blockers that end alike on all sides may be put into it.
TEST(LinkMaker, rays_past_thousands_of_boxes_are_followed_to_their_ends) {
    test::BoxRoom box{.low = {-2, -1.5, -2.5}, .high = {2, 1.5, 2.5}};
    const auto links = [&](uint32_t cells, std::vector<BvhTriangle> blockers,
                           const LinkTolerance& tolerance) {
        box.cells = {cells, 1, cells};
        ClusterScene scene(test::device(), test::boxRoom(box));
        scene.blockers = buildBvh(test::device(), std::move(blockers));
        EXPECT_NEAR(glm::length(scene.blockers.centre), 0, 1e-9);
        LinkMaker maker(test::device(), scene, tolerance);
        maker.add(rootOf(scene.tree, {0, 1, 0}), rootOf(scene.tree, {0, -1, 0}));
        return maker.finish();
    };
    const auto needles = [&](uint32_t count, double width) {
        std::vector<BvhTriangle> triangles;
        for (const auto& [a, b, c] : test::needlesAcross(box, count / 2, width))
            triangles.insert(triangles.end(), {{{a, b, c}, 0, 0}, {{-a, -c, -b}, 0, 0}});
        return triangles;
    };

    // Clusters behind a sheet at the ends of all ways.
    std::vector<BvhTriangle> hidden = needles(6000, 1e-6);
    const glm::dvec3 sheet(9, 1.499, 9), u(18, 0, 0), v(0, 0, 18), speck(1e-6, 0, 0);
    hidden.insert(hidden.end(), {{{sheet, sheet - u, sheet - v}, 0, 0},
                                 {{sheet - u - v, sheet - u, sheet - v}, 0, 0},
                                 {{-sheet, -sheet + speck, u + v - sheet}, 0, 0}});
    for (const io::HierarchicalLink& link : links(8, hidden, {0.02, 1})) EXPECT_EQ(link.density, 0);

    // Triangles, 10 m2 each, that need hundreds of rays.
    const double tolerance = 1e-2;
    for (const io::HierarchicalLink& link : links(1, needles(1500, 5e-3), {1, tolerance}))
        EXPECT_LE(10 * double{link.error}, 2 * double{io::kHierarchicalKept} * tolerance);
}

TEST(Hierarchical, rooms_without_blockers_reach_the_error_asked) {
    for (const char* name :
         {"cube_quads_4x4", "cylinder24", "cube_quads_1x1", "tetra_regular", "thin_slab_1_1_0.001"}) {
        const geometry::PatchMesh mesh = geometry::readPatches(kData + name + ".obj");
        const std::vector<float> exact = test::readFloats(kData + name + ".f32");
        for (double asked : {1e-2, 1e-3, 2e-4}) {
            const HierarchicalFormFactors F(test::device(), mesh, {asked});
            EXPECT_EQ(F.statistics().blockers, 0u);
            // A gap of a thousandth leaves 2e-4: integrals round borders cancel there.
            EXPECT_LT(test::rowError(dense(F), exact), std::max(asked, 3e-4)) << name;
            EXPECT_LT(test::rowError(dense(F), exact), F.report().claimedRowError) << name;
        }
    }
}

TEST(Hierarchical, a_room_with_partitions_keeps_the_error_asked_and_the_error_claimed) {
    const geometry::PatchMesh mesh = geometry::readPatches(kData + "room3_672.obj");
    const std::vector<float> exact = test::readFloats(kData + "room3_672.f32");
    const size_t n = mesh.patchCount();
    for (double asked : {1e-2, 5e-3, 1e-3}) {
        const HierarchicalFormFactors F(test::device(), mesh, {asked});
        const std::vector<float> values = dense(F);
        const double error = test::rowError(values, exact);
        const HierarchicalFormFactors twice(test::device(), mesh, {asked});
        EXPECT_EQ(values, dense(twice)) << asked; // whatever order links and rays in doubt came in
        EXPECT_LT(error, asked);
        EXPECT_LT(F.report().claimedRowError, 1.25 * asked);
        EXPECT_LT(error, F.report().claimedRowError);
        EXPECT_GT(error, 0.4 * F.report().claimedRowError); // an estimate, not a bound picked from far above
        size_t held = 0, sumsHeld = 0;
        double worstSum = 0;
        for (size_t i = 0; i < n; ++i) {
            double squares = 0, sum = 0;
            for (size_t j = 0; j < n; ++j) {
                const double d = double{values[i * n + j]} - double{exact[i * n + j]};
                squares += d * d;
                sum += d;
            }
            held += std::sqrt(squares) <= double{F.rowError()[i]};
            sumsHeld += std::abs(sum) <= double{F.rowSumError()[i]};
            worstSum = std::max(worstSum, std::abs(sum));
        }
        EXPECT_GE(static_cast<double>(held), 0.99 * static_cast<double>(n)) << asked;
        EXPECT_GE(static_cast<double>(sumsHeld), 0.99 * static_cast<double>(n)) << asked;
        EXPECT_LE(worstSum, F.report().claimedRowSumError) << asked;
        EXPECT_LE(F.report().claimedRowSumError, 10 * asked); // what sums are held to
    }
}

// Posts and screens in the open about coarse patches, that stand on the floor across the borders of its
// patches, a hair over it, and in one another.
geometry::PatchMesh openScene(uint32_t seed) {
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    std::vector<std::vector<glm::dvec3>> faces;
    const auto sheet = [&](glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, int times) {
        test::addSheet(faces, corner, u, v, times);
    };
    sheet({-3, 0, -3}, {0, 0, 6}, {6, 0, 0}, 4);
    sheet({-3, 2, -3}, {6, 0, 0}, {0, 0, 6}, 2);
    for (int k = 0; k < 6; ++k) {
        const double turn = between(0, 3), over = k % 3 == 0 ? 0.01 : 0, size = k % 2 == 0 ? 0.1 : 0.5;
        const glm::dvec3 u = size * glm::dvec3(std::cos(turn), 0, std::sin(turn)), v(0, between(0.5, 1.8), 0),
                         w = size * glm::dvec3(-std::sin(turn), 0, std::cos(turn)),
                         at(between(-2, 2), over, between(-2, 2));
        sheet(at, v, u, 1), sheet(at, w, v, 1), sheet(at, u, w, 1);
        sheet(at + u, v, w, 1), sheet(at + w, u, v, 1), sheet(at + v, w, u, 1);
    }
    sheet({-1.5, 0, -1}, {0, 1.2, 0}, {2.2, 0, 0.3}, 2);
    sheet({-1.5, 0, -1}, {2.2, 0, 0.3}, {0, 1.2, 0}, 2);
    return test::polygons(faces);
}

TEST(Hierarchical, few_large_patches_in_the_open_keep_the_error_claimed) {
    // A reference five times finer takes five times as long and moves the errors by 3 % at most.
    constexpr double kReference = 1e-3, kRowSlack = 2e-4;
    size_t rows = 0, held = 0;
    for (uint32_t seed : {1u, 2u}) {
        const geometry::PatchMesh mesh = openScene(seed);
        const size_t n = mesh.patchCount();
        const auto exact = exactFormFactors(test::device(), mesh, {.maxError = kReference})
                               .factors.values.download<float>(n * n);
        for (double asked : {1e-2, 5e-3}) {
            const HierarchicalFormFactors F(test::device(), mesh, {asked});
            const std::vector<float> values = dense(F);
            EXPECT_LT(test::rowError(values, exact), F.report().claimedRowError) << seed << ", " << asked;
            for (size_t i = 0; i < n; ++i) {
                double squares = 0;
                for (size_t j = 0; j < n; ++j)
                    squares += std::pow(double{values[i * n + j]} - double{exact[i * n + j]}, 2);
                ++rows, held += std::sqrt(squares) <= double{F.rowError()[i]} + kRowSlack;
            }
        }
    }
    EXPECT_GE(static_cast<double>(held), 0.97 * static_cast<double>(rows));
}

// Float32 sums of a few hundred terms against the same links in double precision.
// Heights over a needle are rounded far more than its area tells: its own rays must not find it in their way.
TEST(Hierarchical, needles_do_not_stand_in_their_own_light) {
    std::vector<std::vector<glm::dvec3>> faces;
    const geometry::PatchMesh room = test::boxRoom({.cells = {1, 1, 1}});
    for (size_t i = 0; i < room.patchCount(); ++i) {
        faces.emplace_back();
        for (uint32_t corner : room.patch(i)) faces.back().push_back(room.vertices[corner]);
    }
    faces.push_back({{1.1, 0.4, 1.3}, {1.7, 1.1, 1.7}, {1.34, 0.69, 1.455}}); // 1 m by 1 cm
    faces.emplace_back(faces.back().rbegin(), faces.back().rend());
    const HierarchicalFormFactors F(test::device(), test::polygons(faces), {.maxError = 2e-3});
    const size_t n = faces.size();
    const std::vector<float> values = dense(F);
    for (size_t i = 0; i < n; ++i) {
        double sum = 0;
        for (size_t j = 0; j < n; ++j) sum += double{values[i * n + j]};
        EXPECT_NEAR(sum, 1, kSumOverRow * 2e-3) << "row " << i;
    }
}

// Among loose triangles most pairs have a little hidden, which four rays miss; rays go on only where they met
// some. Rows of the closed room sum to one; on average they were 1.2e-3 above it, and 95 % of them within
// their claim.
TEST(Hierarchical, what_rays_that_agree_have_missed_is_told_by_those_that_go_on) {
    const double asked = 1e-3;
    std::mt19937 random(7);
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    const geometry::PatchMesh room = test::boxRoom({.low = {0, 0, 0}, .high = {4, 3, 4}, .cells = {3, 3, 3}});
    std::vector<std::vector<glm::dvec3>> faces;
    for (size_t i = 0; i < room.patchCount(); ++i) {
        faces.emplace_back();
        for (uint32_t corner : room.patch(i)) faces.back().push_back(room.vertices[corner]);
    }
    for (int k = 0; k < 70; ++k) {
        const glm::dvec3 at(between(0.4, 3.6), between(0.3, 2.7), between(0.4, 3.6));
        const auto edge = [&] {
            return glm::dvec3(between(-0.2, 0.2), between(-0.2, 0.2), between(-0.2, 0.2));
        };
        faces.push_back({at, at + edge(), at + edge()});
        faces.emplace_back(faces.back().rbegin(), faces.back().rend());
    }
    const geometry::PatchMesh mesh = test::polygons(faces);
    const size_t n = faces.size();
    double area = 0, mean = 0;
    for (size_t i = 0; i < n; ++i) area += geometry::patchArea(mesh, i);
    const HierarchicalFormFactors F(test::device(), mesh, {asked});
    const std::vector<float> values = dense(F);
    size_t held = 0;
    for (size_t i = 0; i < n; ++i) {
        double off = -1;
        for (size_t j = 0; j < n; ++j) off += double{values[i * n + j]};
        held += std::abs(off) <= double{F.rowSumError()[i]};
        mean += off * geometry::patchArea(mesh, i) / area;
    }
    EXPECT_LT(std::abs(mean), 0.3 * asked);
    EXPECT_GE(static_cast<double>(held), 0.98 * static_cast<double>(n));
}

// Rays that come from walls 7 m away end on a die of 1 cm to within half a micrometre, far more than the die
// alone, the only blocker, would have rounded: they must not find it in their way.
TEST(Hierarchical, small_blockers_in_a_hall_do_not_stand_in_their_own_light) {
    geometry::PatchMesh mesh = test::boxRoom({.low = {0, 0, 0}, .high = {10, 4, 10}, .cells = {1, 1, 1}});
    const size_t room = mesh.vertices.size(), patches = mesh.patchCount();
    test::addBox(mesh, {.low = {4.3, 0.6, 5.1}, .high = {4.311, 0.609, 5.112}, .cells = {1, 1, 1}});
    for (size_t k = room; k < mesh.vertices.size(); ++k) { // so that its faces lie across the axes
        const glm::dvec3 p = mesh.vertices[k] - glm::dvec3(4.3, 0.6, 5.1);
        mesh.vertices[k] =
            glm::dvec3(4.3, 0.6, 5.1) +
            (p.x * glm::dvec3(2, 3, 6) + p.y * glm::dvec3(3, -6, 2) + p.z * glm::dvec3(6, 2, -3)) / 7.0;
    }
    for (size_t i = patches; i < mesh.patchCount(); ++i) {
        const auto corners = mesh.corners.begin() + static_cast<long>(mesh.firstCorner[i]);
        std::swap(corners[1], corners[2]); // faces outwards
    }
    const size_t n = mesh.patchCount();
    const HierarchicalFormFactors F(test::device(), mesh, {1e-3});
    const std::vector<float> values = dense(F);
    for (size_t i = 0; i < n; ++i) {
        double sum = 0;
        for (size_t j = 0; j < n; ++j) sum += double{values[i * n + j]};
        EXPECT_NEAR(sum, 1, kSumOverRow * 1e-3) << "row " << i;
    }
}

// The ends of three slabs, a millimetre apart, against a box 0.1 mm beside them: of rays between points of
// two such triangles hardly any is as short as those along which they exchange what they do. Such rays alone
// were off by 10 % of a pair's light and claimed ten times as much.
TEST(Hierarchical, triangles_that_nearly_touch_keep_the_error_claimed_and_that_is_little) {
    geometry::PatchMesh mesh = test::boxRoom({.low = {0, 0, 0}, .high = {4, 3, 4}, .cells = {1, 1, 1}});
    const size_t room = mesh.corners.size();
    const double gap = 1e-4;
    for (int k = 0; k < 3; ++k)
        test::addBox(
            mesh, {.low = {1, 0.5 + 0.101 * k, 1}, .high = {2.5, 0.6 + 0.101 * k, 2.5}, .cells = {1, 1, 2}});
    test::addBox(mesh, {.low = {2.5 + gap, 0.5, 1}, .high = {3.2, 1.1, 2.5}, .cells = {1, 1, 1}});
    std::reverse(mesh.corners.begin() + static_cast<long>(room),
                 mesh.corners.end()); // solid: they face outwards
    const size_t n = mesh.patchCount();
    const auto exact =
        exactFormFactors(test::device(), mesh, {.maxError = 1e-4}).factors.values.download<float>(n * n);
    const HierarchicalFormFactors F(test::device(), mesh, {1e-3});
    EXPECT_LT(test::rowError(dense(F), exact), F.report().claimedRowError);
    EXPECT_LT(F.report().claimedRowError, 3e-3);
}

void expectRowsWithinClaims(const geometry::PatchMesh& mesh, double rowError) {
    constexpr double kReference = 1e-4; // claimed by the reference
    const size_t n = mesh.patchCount();
    const auto exact = exactFormFactors(test::device(), mesh, {.maxError = kReference})
                           .factors.values.download<float>(n * n);
    const HierarchicalFormFactors F(test::device(), mesh, {1e-3});
    const std::vector<float> values = dense(F);
    EXPECT_LT(test::rowError(values, exact), rowError);
    for (size_t i = 0; i < n; ++i) {
        double squares = 0;
        for (size_t j = 0; j < n; ++j)
            squares += std::pow(double{values[i * n + j]} - double{exact[i * n + j]}, 2);
        EXPECT_LE(std::sqrt(squares), double{F.rowError()[i]} + 2 * kReference) << "row " << i << " of " << n;
    }
}

// In float32 both planes are one. Two slabs cover parts of one another, and a box stands off a wall.
TEST(Hierarchical, faces_a_micrometre_apart_exchange_what_they_cover) {
    geometry::PatchMesh mesh = test::boxRoom({.low = {0, 0, 0}, .high = {4, 3, 4}, .cells = {1, 1, 1}});
    const size_t room = mesh.corners.size();
    constexpr double kGap = 1e-6;
    for (int k = 0; k < 2; ++k)
        test::addBox(mesh, {.low = {1 + 0.1 * k, 0.5 + (0.1 + kGap) * k, 1},
                            .high = {2.5 + 0.1 * k, 0.6 + (0.1 + kGap) * k, 2.5},
                            .cells = {1, 1, 2}});
    test::addBox(mesh, {.low = {4 - 0.2 - kGap, 0.5, 1}, .high = {4 - kGap, 1.1, 2.5}, .cells = {1, 1, 1}});
    std::reverse(mesh.corners.begin() + static_cast<long>(room),
                 mesh.corners.end()); // solid: they face outwards
    const HierarchicalFormFactors F(test::device(), mesh, {1e-3});
    const std::vector<float> values = dense(F);
    const size_t n = mesh.patchCount();
    for (size_t i = 0; i < n; ++i) {
        double sum = 0;
        for (size_t j = 0; j < n; ++j) sum += double{values[i * n + j]};
        EXPECT_NEAR(sum, 1, double{F.rowSumError()[i]}) << i;
    }
    EXPECT_LT(F.report().claimedRowSumError, 2e-2);
}

// Three slabs in a pile, the third askew: the planes of the second, which rays from the first and the third
// take for those that they begin and end on, hide the one from the other. Rows summed to 1.99.
TEST(Hierarchical, slabs_a_micrometre_apart_hide_one_another) {
    const geometry::PatchMesh mesh = test::pileOfSlabs(1e-6, 0.1, {0, 0, 0});
    const HierarchicalFormFactors F(test::device(), mesh, {5e-3});
    const std::vector<float> values = dense(F);
    const size_t n = mesh.patchCount();
    for (size_t i = 0; i < n; ++i) {
        double sum = 0;
        for (size_t j = 0; j < n; ++j) sum += double{values[i * n + j]};
        EXPECT_NEAR(sum, 1, 0.03) << i; // what sums are held to is 0.05
    }
    EXPECT_LT(F.report().claimedRowError, 7.5e-3);
}

// What cuts leave of patches may be thin as the gap, and then little is known of it; of the patch all the
// same.
TEST(Hierarchical, slabs_a_little_askew_are_not_said_to_be_far_off) {
    const HierarchicalFormFactors F(test::device(), test::pileOfSlabs(1e-6, 0.001, {0, 0.3, 0}, 2), {5e-3});
    EXPECT_LT(F.report().claimedRowError, 7.5e-3);
}

// The inside of a slat: long edges of opposite planes cross in plan, far apart, and the little that an end
// exchanges with cells metres away is what is left of much larger sums. It was off by 7e-3 of the end's
// light.
TEST(Hierarchical, inside_thin_bodies_every_row_keeps_its_claim) {
    const glm::dvec3 u = glm::normalize(glm::dvec3(3, 1, -2)),
                     v = glm::normalize(glm::cross(u, glm::dvec3(0.3, 1, 0.2)));
    for (const glm::dvec3 size : {glm::dvec3(3.2, 0.1, 0.004), glm::dvec3(5, 0.5, 0.005)}) {
        geometry::PatchMesh mesh = test::boxRoom({.low = {0, 0, 0}, .high = size, .cells = {4, 1, 1}});
        for (glm::dvec3& p : mesh.vertices)
            p = glm::dvec3(0.4, 0.5, 0.6) + glm::dmat3(u, v, glm::cross(u, v)) * p;
        expectRowsWithinClaims(mesh, 3e-4);
    }
}

// Wires 0.2 mm wide over borders of a floor: seven points, as stand for triangles small every way, missed
// where a wire passes from one patch over the next by a tenth of its light.
TEST(Hierarchical, slivers_over_borders_keep_their_claims) {
    std::vector<std::vector<glm::dvec3>> faces;
    test::addSheet(faces, {0, 0, 0}, {2, 0, 0}, {0, 2, 0}, 2);
    const auto wire = [&](glm::dvec3 from, glm::dvec3 along) {
        const glm::dvec3 across = 2e-4 * glm::normalize(glm::cross(along, glm::dvec3(0, 0, 1)));
        faces.push_back({from, from + along, from + along + across}); // look down
        faces.push_back({from, from + along + across, from + across});
    };
    wire({0.7, 0.3, 0.002}, {0.5, 0.9, 0});
    wire({0.2, 1.3, 0.005}, {1.1, -0.2, 0});
    wire({1.3, 0.6, 0.02}, {0.1, 0.7, 0});
    expectRowsWithinClaims(test::polygons(faces), 2e-3);
}

// A strip of 2 mm, 15 mm before a wall: along 1.9 m what its sides exchange with the wall's patches changes
// within centimetres where these end (few points there left 8e-2 of a side's light), and its own sides, grown
// by millionths of their length, stood before its ends (6e-3 of theirs).
TEST(Hierarchical, strips_before_a_wall_lose_nothing_at_its_borders_or_at_their_ends) {
    geometry::PatchMesh mesh = test::boxRoom({.low = {0, 0, 0}, .high = {4, 2.8, 3.6}, .cells = {3, 2, 2}});
    const size_t room = mesh.corners.size(), strip = mesh.patchCount();
    test::addBox(mesh, {.low = {0.1, 0.02, 0.015}, .high = {3.9, 0.12, 0.017}, .cells = {2, 1, 1}});
    std::reverse(mesh.corners.begin() + static_cast<long>(room), mesh.corners.end()); // it faces outwards
    const HierarchicalFormFactors F(test::device(), mesh, {1e-3});
    EXPECT_LT(F.report().claimedRowError, 1.5e-3);
    EXPECT_LT(F.report().claimedRowSumError, 2e-2);
    const size_t n = mesh.patchCount();
    const std::vector<float> values = dense(F);
    for (size_t i = 0; i < n; ++i) {
        double sum = 0;
        for (size_t j = 0; j < n; ++j) sum += double{values[i * n + j]};
        EXPECT_NEAR(sum, 1, i < strip ? kSumOverRow * 1e-3 : 2e-3) << "row " << i;
    }
}

TEST(Hierarchical, a_gather_is_the_product_with_its_rows) {
    for (bool triangles : {true, false}) {
        test::BoxRoom box;
        box.triangles = triangles;
        geometry::PatchMesh mesh = test::boxRoom(box);
        test::BoxRoom inner;
        inner.low = {1, 1, 1}, inner.high = {3, 2, 3};
        test::addBox(mesh, inner, 1); // lies inside the other, yet in a room of its own
        HierarchicalFormFactors F(test::device(), mesh, {5e-3});
        const std::vector<float> values = dense(F);
        const size_t n = mesh.patchCount();
        std::mt19937 random(3);
        std::uniform_real_distribution<float> at(0, 1000);
        const uint32_t columns = 7;
        std::vector<float> in(n * columns), out(n * columns), again(n * columns);
        for (float& x : in) x = at(random);
        F.gather(in, out, columns);
        for (size_t c = 0; c < columns; ++c)
            for (size_t i = 0; i < n; ++i) {
                double sum = 0;
                for (size_t j = 0; j < n; ++j) sum += double{values[i * n + j]} * in[c * n + j];
                EXPECT_NEAR(out[c * n + i], sum, 2e-6 * sum);
            }
        F.gather(in, again, columns);
        EXPECT_EQ(std::memcmp(out.data(), again.data(), out.size() * sizeof(float)), 0);
        const HierarchicalFormFactors twice(test::device(), mesh, {5e-3});
        EXPECT_EQ(values, dense(twice)); // whatever order the device found links in
    }
}

TEST(Hierarchical, pairs_are_reciprocal) {
    const geometry::PatchMesh mesh = geometry::readPatches(kData + "room3_672.obj");
    const std::vector<float> values = dense(HierarchicalFormFactors(test::device(), mesh, {1e-2}));
    const size_t n = mesh.patchCount();
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < i; ++j) {
            const double a = geometry::patchArea(mesh, i) * values[i * n + j],
                         b = geometry::patchArea(mesh, j) * values[j * n + i];
            ASSERT_NEAR(a, b, 1e-6 * std::max(a, b) + 1e-12);
            ASSERT_GE(a, 0);
        }
}

// Pairs of polygons, some behind blockers: the pair integral in float32, and as many rays as the error asked
// needs (5e-4 at least where something is hidden).
TEST(Hierarchical, pairs_have_their_exact_factors) {
    for (const char* category : {"unoccluded", "occluded"})
        for (const test::FormFactorCase& c : test::formFactorCases(category)) {
            const geometry::PatchMesh mesh = test::meshOf(c.polygons);
            const HierarchicalFormFactors F(test::device(), mesh, {1e-4});
            const std::vector<float> values = dense(F);
            const bool hidden = category == std::string("occluded");
            for (const auto& entry : c.entries)
                EXPECT_NEAR(values[entry.i * mesh.patchCount() + entry.j], entry.value, hidden ? 2e-3 : 2e-4)
                    << c.name;
        }
}

TEST(Hierarchical, radiosity_solves_with_links_as_with_a_matrix) {
    const geometry::PatchMesh mesh = test::boxRoom({});
    const auto n = static_cast<uint32_t>(mesh.patchCount());
    HierarchicalFormFactors F(test::device(), mesh, {1e-3});
    RadiositySolver solver(F, F.rowSums());
    solver.setMatter({n,
                      {std::vector<float>(n, 0.9f)},
                      {std::vector<float>(n, 0)},
                      std::vector<int32_t>(n, geometry::kNoTwin)});
    std::vector<float> exitance, gathered;
    const uint32_t channel[]{0};
    EXPECT_TRUE(solver.solve(std::vector<float>(n, 10.0f), channel, exitance, gathered).converged);
    for (float b : exitance) EXPECT_NEAR(b, 100, 1.5); // closure within 1e-3, ten-fold in a furnace
}

// Rows of links sum to as much as 1.03 here; against the same rows in double precision.
TEST(Hierarchical, the_bound_of_radiosity_holds_where_rows_sum_to_more_than_reflectances_leave) {
    const geometry::PatchMesh mesh = geometry::readPatches(kData + "room3_672.obj");
    const auto n = static_cast<uint32_t>(mesh.patchCount());
    HierarchicalFormFactors F(test::device(), mesh, {5e-3});
    const std::vector<float> sums = F.rowSums(), rho(n, 0.99f);
    ASSERT_GT(0.99f * *std::max_element(sums.begin(), sums.end()), 1.0f);
    RadiositySolver solver(F, sums);
    solver.setMatter({n, {rho}, {std::vector<float>(n, 0)}, std::vector<int32_t>(n, geometry::kNoTwin)});
    std::vector<float> emitted(n, 1), B, gathered;
    emitted[n / 2] = 1000;
    const uint32_t channel[]{0};
    const RadiosityReport report = solver.solve(emitted, channel, B, gathered);
    EXPECT_TRUE(report.converged);
    EXPECT_LT(report.bound, 2e-4);
    const std::vector<double> exact = reference::radiosity(dense(F), rho, emitted);
    double worst = 0, most = 0;
    for (uint32_t i = 0; i < n; ++i) {
        worst = std::max(worst, std::abs(B[i] - exact[i]));
        most = std::max(most, double{B[i]});
    }
    EXPECT_LE(worst / most, report.bound);
    RecordProperty("error", std::to_string(worst / most));
}

TEST(Hierarchical, empty_meshes_and_degenerate_patches_are_no_special_case) {
    HierarchicalFormFactors none(test::device(), test::polygons({}));
    none.gather({}, {}, 1);
    HierarchicalFormFactors flat(test::device(),
                                 test::polygons({{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}},
                                                 {{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}},
                                                 {{0, 0.5, 0}, {1, 0.5, 0}, {2, 0.5, 0}}}),
                                 {1e-4});
    const std::vector<float> values = dense(flat);
    EXPECT_NEAR(values[1], 0.199825, 1e-4); // opposed unit squares, Howell C-11
    for (size_t k : {0u, 2u, 4u, 5u, 6u, 7u, 8u}) EXPECT_EQ(values[k], 0.0f);
}

} // namespace
} // namespace heliodon::compute
