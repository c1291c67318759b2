#include "compute/sloped_factors.h"

#include <cmath>
#include <map>
#include <random>
#include <tuple>

#include <gtest/gtest.h>

#include "compute/daylight_transport.h"
#include "tests/compute/rooms.h"
#include "tests/compute/skies.h"
#include "tests/gpu/test_device.h"

using namespace heliodon;
using namespace heliodon::compute;

namespace {

// Light runs on across corners that patches share.
void shareCorners(geometry::PatchMesh& mesh) {
    std::map<std::tuple<int64_t, int64_t, int64_t>, uint32_t> numbers;
    for (uint32_t& v : mesh.corners) {
        const glm::dvec3 at = 1e6 * mesh.vertices[v];
        v = numbers.try_emplace({std::llround(at.x), std::llround(at.y), std::llround(at.z)}, v)
                .first->second;
    }
}

// A well of 1 x 1 m under a skylight, 4 m deep.
geometry::PatchMesh well(uint32_t times) {
    test::BoxRoom box{.low = {0, 0, 0}, .high = {1, 4, 1}, .cells = {2 * times, 6 * times, 2 * times}};
    box.wall.reflectance = glm::vec3(0.6f);
    box.isGlass = [](glm::dvec3 at) { return at.y > 3.999; };
    geometry::PatchMesh mesh = test::boxRoom(box);
    shareCorners(mesh);
    return mesh;
}

double meanOnFloor(const geometry::PatchMesh& mesh, const daylight::Sky& sky, double& direct) {
    DaylightTransport transport(test::device(), mesh);
    const Moment moment = transport.light(sky);
    double sum = 0, area = 0;
    direct = 0;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        if (geometry::patchCentroid(mesh, i).y > 1e-6) continue;
        const double here = geometry::patchArea(mesh, i);
        sum += here * photometric(moment.patches[i].interreflected);
        direct += here * photometric(moment.patches[i].sky + moment.patches[i].sun);
        area += here;
    }
    direct /= area;
    return sum / area;
}

} // namespace

// Were patches even, coarse ones would send too much of what lights them at the top on to the floor.
TEST(SlopedFactors, the_floor_of_a_well_is_as_bright_on_a_coarse_mesh) {
    double few = 0, many = 0;
    const daylight::Sky sky = daylight::cieGeneralSky(16, {0, 1, 0}, 5000);
    const double coarse = meanOnFloor(well(1), sky, few), fine = meanOnFloor(well(4), sky, many);
    EXPECT_NEAR(few, many, 0.01 * many);
    EXPECT_NEAR(coarse, fine, 0.02 * fine);
}

// Patches 15 times as large as the gap between them: light falls off within one of them, and no slope says
// how.
TEST(SlopedFactors, no_light_is_negative_in_a_slot_thinner_than_its_patches) {
    test::BoxRoom box{.low = {0, 0, 0}, .high = {3, 2, 0.02}, .cells = {10, 6, 1}};
    box.wall.reflectance = glm::vec3(0.95f);
    box.isGlass = [](glm::dvec3 at) { return at.y > 1.999; };
    geometry::PatchMesh mesh = test::boxRoom(box);
    shareCorners(mesh);
    DaylightTransport transport(test::device(), mesh);
    const Moment moment = transport.light(daylight::cieGeneralSky(16, {0, 1, 0}, 5000));
    EXPECT_LT(moment.report.energyImbalance, 1e-3);
    EXPECT_GT(moment.laterShare, 0.25); // all of them err the same way, however many there are
    for (const LightParts& parts : moment.patches) {
        EXPECT_GE(parts.interreflected.x, 0);
        EXPECT_GE(parts.error, 0);
    }
    for (const glm::vec3& exitance : moment.lighting.exitance) EXPECT_GE(exitance.x, 0);
}

class OnTheirOwn : public testing::Test {
protected:
    OnTheirOwn() {
        FormFactorOptions options;
        options.kernel = "exact", options.maxError = 1e-3;
        before_ = computeFormFactors(test::device(), mesh_, options).values.download<float>(n_ * n_);
        matrix_ = gpu::Buffer::from(test::device(), before_, "factors");
        pairs_.emplace(mesh_, matrix_);
        std::vector<float> sums(n_, 0);
        for (size_t k = 0; k < n_ * n_; ++k) sums[k / n_] += before_[k];
        sloped_.emplace(scene_, slopes_, *pairs_, sums, matrix_);
        after_ = matrix_.download<float>(n_ * n_);
        for (size_t i = 0; i < n_; ++i) area_.push_back(geometry::patchArea(mesh_, i));
    }

    const geometry::PatchMesh mesh_ = well(1);
    const size_t n_ = mesh_.patchCount();
    const PointScene scene_{mesh_};
    const PatchSlopes slopes_{mesh_};
    gpu::Buffer matrix_;
    std::optional<NearPairs> pairs_;
    std::optional<SlopedFactors> sloped_;
    std::vector<float> before_, after_;
    std::vector<double> area_;
};

TEST_F(OnTheirOwn, no_light_is_made_or_lost_and_even_light_is_left_alone) {
    double most = 0;
    for (size_t i = 0; i < n_; ++i) {
        double received = 0, sent = 0, negative = 0;
        for (size_t j = 0; j < n_; ++j) {
            received += double{after_[i * n_ + j]} - double{before_[i * n_ + j]};
            sent += area_[j] / area_[i] * (double{after_[j * n_ + i]} - double{before_[j * n_ + i]});
            negative += std::max(0.0, -double{after_[i * n_ + j]});
            most = std::max(most, std::abs(double{after_[i * n_ + j]} - double{before_[i * n_ + j]}));
        }
        EXPECT_NEAR(received, 0, 1e-5); // of one, in float sums
        EXPECT_NEAR(sent, 0, 2e-3);     // as reciprocal as F is
        EXPECT_NEAR(sloped_->negative()[i], negative, 1e-6);
    }
    EXPECT_GT(most, 0.01);
}

// F' b less what is taken back is F b, but for what slopes make of slopes; and so from the other end.
TEST_F(OnTheirOwn, what_is_taken_back_is_what_was_added) {
    std::minstd_rand random(7);
    std::uniform_real_distribution<float> value(0, 1);
    std::vector<glm::vec3> light(n_), lux(n_, glm::vec3(0)), sent(n_, glm::vec3(0));
    std::vector<float> importance(n_), gathered(n_, 0);
    for (size_t i = 0; i < n_; ++i) {
        const double height = geometry::patchCentroid(mesh_, i).y;
        light[i] = glm::vec3(static_cast<float>(std::exp(height - 4))), importance[i] = value(random);
    }
    for (size_t i = 0; i < n_; ++i)
        for (size_t j = 0; j < n_; ++j)
            gathered[i] += after_[j * n_ + i] * static_cast<float>(area_[j] / area_[i]) * importance[j];
    const std::vector<float> whole = gathered;
    sloped_->takeBack(light, lux, sent);
    sloped_->takeBackImportance(importance, whole, gathered);
    double added = 0, left = 0, here = 0, there = 0;
    for (size_t i = 0; i < n_; ++i) {
        double with = 0, plain = 0, back = double{lux[i].x};
        for (size_t j = 0; j < n_; ++j) {
            with += double{after_[i * n_ + j]} * double{light[j].x};
            plain += double{before_[i * n_ + j]} * double{light[j].x};
            back += double{after_[i * n_ + j]} * double{sent[j].x};
        }
        added += std::pow(with - plain, 2);
        left += std::pow(with + back - plain, 2);
        here += area_[i] * double{importance[i]} * back;
        there += area_[i] * double{light[i].x} * (double{gathered[i]} - double{whole[i]});
    }
    EXPECT_LT(std::sqrt(left), 0.25 * std::sqrt(added));
    EXPECT_NEAR(here, there, 1e-3 * std::abs(here));
}

// Eleven: a full block of columns and a part of one.
TEST_F(OnTheirOwn, importance_of_many_columns_is_taken_back_as_that_of_each) {
    constexpr size_t kColumns = 11;
    std::minstd_rand random(11);
    std::uniform_real_distribution<float> value(0, 1);
    std::vector<float> importance(kColumns * n_), within(kColumns * n_), together(kColumns * n_, 0);
    for (auto* values : {&importance, &within})
        for (float& v : *values) v = value(random);
    sloped_->takeBackImportance(importance, within, together);
    double most = 0;
    for (size_t c = 0; c < kColumns; ++c) {
        std::vector<float> alone(n_, 0);
        sloped_->takeBackImportance({&importance[c * n_], n_}, {&within[c * n_], n_}, alone);
        for (size_t i = 0; i < n_; ++i) {
            EXPECT_EQ(together[c * n_ + i], alone[i]) << "column " << c << ", patch " << i;
            most = std::max(most, double{std::abs(alone[i])});
        }
    }
    EXPECT_GT(most, 0.01);
}
