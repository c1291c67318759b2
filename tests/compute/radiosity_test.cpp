#include "compute/radiosity.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "compute/dense_gather.h"
#include "compute/form_factors.h"
#include "compute/gpu/device.h"
#include "compute/radiosity_gather.h"
#include "compute/reference/radiosity.h"
#include "compute/relight_basis.h"
#include "shaders/io/radiosity_gather.io.h"
#include "tests/compute/rooms.h"
#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

// With what is no number behind the last entry, where the last texel reaches.
gpu::Buffer matrixBuffer(const std::vector<float>& values) {
    gpu::Buffer buffer(test::device(), values.size() * sizeof(float), "factors");
    gpu::Commands commands(test::device());
    commands.fill(buffer, 0x7fc00000u, 0, buffer.roundedBytes());
    test::device().submitAndWait(std::move(commands));
    buffer.upload(values);
    return buffer;
}

// Rows of non-negative numbers that sum to `rowSum`, no diagonal.
std::vector<float> randomFactors(size_t n, double rowSum, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> at(0, 1);
    std::vector<float> F(n * n);
    for (size_t i = 0; i < n; ++i) {
        std::vector<double> row(n);
        for (size_t j = 0; j < n; ++j) row[j] = i == j ? 0 : std::pow(at(random), 4);
        const double sum = std::max(std::accumulate(row.begin(), row.end(), 0.0), 1e-30);
        for (size_t j = 0; j < n; ++j) F[i * n + j] = static_cast<float>(row[j] * rowSum / sum);
    }
    return F;
}

TEST(RadiosityGather, agrees_with_the_reference_at_every_alignment_and_column_count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> at(0, 1000);
    for (size_t n : {1u, 2u, 3u, 5u, 16u, 17u, 63u, 130u, 257u}) {
        const std::vector<float> F = randomFactors(n, 1, 5);
        const gpu::Buffer factors = matrixBuffer(F);
        RadiosityGather gather(test::device(), factors, static_cast<uint32_t>(n));
        for (uint32_t columns : {1u, 3u, 4u, 7u}) {
            std::vector<float> in(n * columns), out(n * columns, -1);
            for (float& x : in) x = at(random);
            gather.gather(in, out, columns);
            const std::vector<double> expected = reference::gather(F, n, in, columns);
            // Float sums of n terms of one sign in 32 partial sums: relative error under (n / 32 + 8) * 6e-8.
            for (size_t k = 0; k < out.size(); ++k)
                ASSERT_NEAR(out[k], expected[k], 1e-6 * expected[k] + 1e-6) << n;
            std::vector<float> again(n * columns);
            gather.gather(in, again, columns);
            EXPECT_EQ(std::memcmp(out.data(), again.data(), out.size() * sizeof(float)), 0);
        }
    }
}

TEST(DenseGather, many_columns_are_those_of_the_device_also_of_factors_that_have_changed) {
    constexpr uint32_t n = 257, many = 7;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> at(0, 1000);
    std::vector<float> in(n * many), out(in.size());
    for (float& x : in) x = at(random);
    gpu::Buffer factors = matrixBuffer(randomFactors(n, 1, 5));
    DenseGather gather(test::device(), factors, n);
    for (unsigned seed : {5u, 6u}) {
        const std::vector<float> F = randomFactors(n, 1, seed);
        factors.upload(std::span<const float>(F));
        gather.forgetFactors();
        gather.gather(in, out, many);
        EXPECT_EQ(gather.hostBytes() > 0, factors.mapped() != nullptr);
        const std::vector<double> expected = reference::gather(F, n, in, many);
        // Sums of up to 128 terms of one sign, put together: far below this where rounding is of either sign.
        for (size_t k = 0; k < out.size(); ++k) ASSERT_NEAR(out[k], expected[k], 1e-6 * expected[k]);
    }
}

// Where the light of one column goes: emitted = absorbed + lost, but for residual and rounding.
struct EnergyBalance {
    double emitted = 0, absorbed = 0;
    double lost = 0; // what rows of F that do not sum to one leave over

    double imbalance() const { return std::abs(emitted - absorbed - lost) / emitted; }
};

EnergyBalance balanceOf(const RadiositySolver& solver, const std::vector<double>& area,
                        const std::vector<float>& emitted, const std::vector<float>& exitance,
                        const std::vector<float>& gathered) {
    EnergyBalance sum;
    for (size_t i = 0; i < area.size(); ++i) {
        sum.emitted += area[i] * emitted[i];
        sum.absorbed += area[i] * (1 - double{solver.matter().reflectance[0][i]}) * gathered[i];
        sum.lost += area[i] * (1 - double{solver.rowSums()[i]}) * exitance[i];
    }
    return sum;
}

struct Solved {
    RadiosityReport report;
    std::vector<float> exitance, gathered;
};

Solved solve(const std::vector<float>& F, const std::vector<float>& rho, const std::vector<float>& emitted,
             const RadiosityOptions& options = {}) {
    const size_t n = rho.size();
    const gpu::Buffer factors = matrixBuffer(F);
    RadiosityGather gather(test::device(), factors, static_cast<uint32_t>(n));
    std::vector<float> rowSums(n);
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < n; ++j) rowSums[i] += F[i * n + j];
    RadiositySolver solver(gather, rowSums);
    solver.setMatter({static_cast<uint32_t>(n),
                      {rho},
                      {std::vector<float>(n, 0)},
                      std::vector<int32_t>(n, geometry::kNoTwin)});
    Solved result;
    const uint32_t channel[]{0};
    result.report = solver.solve(emitted, channel, result.exitance, result.gathered, options);
    return result;
}

TEST(Radiosity, a_furnace_glows_with_exitance_over_one_minus_reflectance) {
    const size_t n = 90;
    for (float rho : {0.0f, 0.3f, 0.8f, 0.95f, 0.99f}) {
        const Solved s =
            solve(randomFactors(n, 1, 11), std::vector<float>(n, rho), std::vector<float>(n, 10.0f));
        EXPECT_TRUE(s.report.converged);
        EXPECT_LE(s.report.bound, 1.01e-4 + kGatherRounding / (1 - rho));
        for (float b : s.exitance)
            EXPECT_NEAR(b, 10.0 / (1 - rho), 2e-4 * 10.0 / (1 - rho)); // twice the tolerance
    }
}

TEST(Radiosity, agrees_with_gaussian_elimination_within_its_own_bound) {
    const size_t n = 75;
    std::mt19937 random(9);
    std::uniform_real_distribution<float> at(0, 1);
    const std::vector<float> F = randomFactors(n, 0.97, 21);
    std::vector<float> rho(n), emitted(n);
    for (float& r : rho) r = 0.99f * at(random);
    emitted[7] = 5000; // one small lamp
    for (double tolerance : {1e-2, 1e-4, 1e-6}) {
        RadiosityOptions options;
        options.tolerance = tolerance;
        const Solved s = solve(F, rho, emitted, options);
        const std::vector<double> exact = reference::radiosity(F, rho, emitted);
        double worst = 0;
        for (size_t i = 0; i < n; ++i) worst = std::max(worst, std::abs(s.exitance[i] - exact[i]));
        EXPECT_LE(worst / 5000,
                  s.report.bound + 1e-6); // the bound is of max B, here at least the lamp; float32
        const double most = double{*std::max_element(rho.begin(), rho.end())};
        EXPECT_LE(s.report.bound, tolerance + kGatherRounding / (1 - most));
    }
}

// Rows of which some sum to more than reflectances leave: the largest sum of a row proves nothing there, what
// light does in the room does. Held against elimination in double precision.
TEST(Radiosity, bounds_hold_where_single_rows_sum_to_more_than_one) {
    const size_t n = 200;
    std::mt19937 random(4);
    std::uniform_real_distribution<double> at(-0.03, 0.03);
    std::vector<float> F = randomFactors(n, 1, 8);
    for (size_t i = 0; i < n; ++i) {
        const double row = 1 + at(random) - (i % 4 == 0 ? 0.02 : 0.0);
        for (size_t j = 0; j < n; ++j) F[i * n + j] = static_cast<float>(F[i * n + j] * row);
    }
    std::vector<float> emitted(n, 0.1f);
    emitted[7] = 5000;
    for (float rho : {0.9f, 0.99f, 0.995f})
        for (double tolerance : {1e-2, 1e-4}) {
            const std::vector<float> matter(n, rho);
            RadiosityOptions options;
            options.tolerance = tolerance;
            const Solved s = solve(F, matter, emitted, options);
            EXPECT_TRUE(s.report.converged) << rho;
            EXPECT_LT(s.report.bound, 1.5 * tolerance) << rho;
            const std::vector<double> exact = reference::radiosity(F, matter, emitted);
            double worst = 0, most = 0;
            for (size_t i = 0; i < n; ++i) {
                worst = std::max(worst, std::abs(s.exitance[i] - exact[i]));
                most = std::max(most, double{s.exitance[i]});
            }
            EXPECT_LE(worst / most, s.report.bound) << rho << " " << tolerance;
        }
}

// Reflectance 0.999: float32 sums hide more than the tolerance, and the bound says so.
TEST(Radiosity, bounds_count_what_rounding_hides) {
    const size_t n = 300;
    const std::vector<float> F = randomFactors(n, 1, 2), matter(n, 0.999f);
    std::vector<float> emitted(n);
    for (size_t i = 0; i < n; ++i) emitted[i] = 1 + static_cast<float>(i % 7);
    RadiosityOptions options;
    options.tolerance = 1e-5;
    const Solved s = solve(F, matter, emitted, options);
    const std::vector<double> exact = reference::radiosity(F, matter, emitted);
    double worst = 0;
    for (size_t i = 0; i < n; ++i) worst = std::max(worst, std::abs(s.exitance[i] / exact[i] - 1));
    EXPECT_LE(worst, s.report.bound);
    EXPECT_GE(s.report.bound, 0.99 * kGatherRounding / (1 - 0.999)); // however small the residual came out
    EXPECT_LT(s.report.bound, 1e-3);
    RecordProperty("error", std::to_string(worst / s.report.bound));
}

// Two rooms of random patches and a gap between them: all light is emitted in the first.
TEST(Radiosity, errors_are_found_place_by_place) {
    constexpr size_t n = 120, half = n / 2;
    constexpr float gap = 1e-3f; // of what each patch sees
    std::vector<float> F(n * n, 0), emitted(n, 0), rho(n, 0.6f);
    for (size_t room = 0; room < 2; ++room) {
        const std::vector<float> own = randomFactors(half, 1 - double{gap}, 8 + static_cast<unsigned>(room));
        for (size_t i = 0; i < half; ++i) {
            std::copy_n(&own[i * half], half, &F[(room * half + i) * n + room * half]);
            F[(room * half + i) * n + (1 - room) * half + i] = gap; // of the one across
        }
    }
    for (size_t i = 0; i < half; i += 7) emitted[i] = 20000;
    const gpu::Buffer factors = matrixBuffer(F);
    RadiosityGather gather(test::device(), factors, n);
    RadiositySolver solver(gather, gather.rowSums());
    solver.setMatter({n, {rho}, {std::vector<float>(n, 0)}, std::vector<int32_t>(n, geometry::kNoTwin)});
    const std::vector<double> exact = reference::radiosity(F, rho, emitted),
                              exactF =
                                  reference::gather(F, n, std::vector<float>(exact.begin(), exact.end()), 1);
    for (const double tolerance : {1e-2, 1e-4}) {
        const std::vector<uint32_t> channel{0};
        std::vector<float> b, g, error, ofG;
        const RadiosityReport report = solver.solve(emitted, channel, b, g, {tolerance});
        ASSERT_TRUE(solver.findErrors(channel, b, g, error, ofG));
        const double alike = report.bound * *std::max_element(b.begin(), b.end());
        for (size_t i = 0; i < n; ++i) {
            EXPECT_LE(std::abs(b[i] - exact[i]), error[i]) << i << " " << tolerance;
            // The reference's own input is rounded to float32.
            EXPECT_LE(std::abs(g[i] - exactF[i]), ofG[i] + 1e-7 * exactF[i]) << i << " " << tolerance;
            EXPECT_LT(error[i], (i < half ? 2 : 0.1) * alike) << i << " " << tolerance;
        }
    }
}

TEST(Radiosity, a_bright_closed_box_converges_in_few_passes) {
    const geometry::PatchMesh mesh = test::boxRoom({});
    const size_t n = mesh.patchCount();
    const FormFactors F = computeFormFactors(test::device(), mesh);
    std::vector<float> emitted(n);
    emitted[3] = 1000;
    const Solved s = solve(F.values.download<float>(n * n), std::vector<float>(n, 0.99f), emitted);
    EXPECT_TRUE(s.report.converged);
    EXPECT_LT(s.report.passes, 60u); // plain gathering: ln(1e-4) / ln(0.99) = 916
}

// A closed room that is known to the last digit at any size: patches that all see one another as in a sphere,
// F_ij = A_j / A, but for a part that pairs of patches of equal area turn to either sign. Reciprocal, closed,
// of rank two: B = E + rho (p 1 + q g) with two unknowns.
class SignedSphere {
public:
    explicit SignedSphere(size_t n) : area(n), sign(n) {
        std::mt19937 random(17);
        std::uniform_real_distribution<double> at(0, 1);
        for (size_t i = 0; i < n; i += 2) {
            area[i] = area[i + 1] = std::pow(10.0, 3 * at(random) - 3); // three decades
            sign[i] = at(random), sign[i + 1] = -sign[i];
        }
        total = std::accumulate(area.begin(), area.end(), 0.0);
    }
    double factor(size_t i, size_t j) const { return area[j] / total * (1 + 0.9 * sign[i] * sign[j]); }

    std::vector<double> solution(const std::vector<float>& rho, const std::vector<float>& emitted) const {
        // p = sum A B / total, q = 0.9 sum A g B / total, B put in.
        double e0 = 0, e1 = 0, k00 = 0, k01 = 0, k11 = 0;
        for (size_t i = 0; i < area.size(); ++i) {
            const double a = area[i] / total, g = sign[i];
            e0 += a * emitted[i], e1 += 0.9 * a * g * emitted[i];
            k00 += a * rho[i], k01 += a * rho[i] * g, k11 += a * rho[i] * g * g;
        }
        const double m00 = 1 - k00, m01 = -k01, m10 = -0.9 * k01, m11 = 1 - 0.9 * k11;
        const double determinant = m00 * m11 - m01 * m10;
        const double p = (e0 * m11 - m01 * e1) / determinant, q = (m00 * e1 - m10 * e0) / determinant;
        std::vector<double> B(area.size());
        for (size_t i = 0; i < B.size(); ++i) B[i] = emitted[i] + rho[i] * (p + q * sign[i]);
        return B;
    }

    std::vector<double> area, sign;
    double total = 0;
};

TEST(Radiosity, ten_thousand_patches_stay_within_1e_5_of_double_precision) {
    const size_t n = 10'000;
    const SignedSphere room(n);
    gpu::Buffer factors(test::device(), n * n * sizeof(float), "factors");
    std::vector<float> row(n);
    for (size_t i = 0; i < n; ++i) {
        for (size_t j = 0; j < n; ++j) row[j] = static_cast<float>(room.factor(i, j));
        factors.upload(std::span<const float>(row), i * n * sizeof(float));
    }
    std::mt19937 random(5);
    std::uniform_real_distribution<float> at(0, 1);
    RadiosityGather gather(test::device(), factors, static_cast<uint32_t>(n));
    // One gather: sums of ten thousand terms, and the same bits again.
    std::vector<float> in(3 * n), out(3 * n), again(3 * n);
    for (float& x : in) x = 1000 * at(random);
    gather.gather(in, out, 3);
    gather.gather(in, again, 3);
    EXPECT_EQ(std::memcmp(out.data(), again.data(), out.size() * sizeof(float)), 0);
    for (size_t c = 0; c < 3; ++c) {
        double sum = 0, turned = 0;
        for (size_t j = 0; j < n; ++j) {
            sum += room.area[j] / room.total * double{in[c * n + j]};
            turned += 0.9 * room.sign[j] * room.area[j] / room.total * double{in[c * n + j]};
        }
        for (size_t i = 0; i < n; ++i) {
            const double expected = sum + room.sign[i] * turned;
            ASSERT_NEAR(out[c * n + i], expected, 1e-5 * expected);
        }
    }
    // The solution, of one lamp and walls of any reflectance to 0.99, and where its light ends.
    std::vector<float> rho(n), emitted(n);
    for (float& r : rho) r = 0.99f * std::sqrt(at(random));
    emitted[7] = 1e6;
    RadiositySolver solver(gather, gather.rowSums());
    solver.setMatter({static_cast<uint32_t>(n),
                      {rho},
                      {std::vector<float>(n, 0)},
                      std::vector<int32_t>(n, geometry::kNoTwin)});
    RadiosityOptions options;
    options.tolerance = 3e-5; // of reflected light
    std::vector<float> B, H;
    const uint32_t channel[]{0};
    EXPECT_TRUE(solver.solve(emitted, channel, B, H, options).converged);
    const std::vector<double> exact = room.solution(rho, emitted);
    for (size_t i = 0; i < n; ++i)
        if (i != 7) {
            ASSERT_NEAR(B[i], exact[i], 1e-5 * exact[i]) << i; // each of its own light, not of the lamp's
        }
    const EnergyBalance balance = balanceOf(solver, room.area, emitted, B, H);
    EXPECT_NEAR(balance.emitted, 1e6 * room.area[7], 1e-3 * balance.emitted);
    EXPECT_LT(balance.imbalance(), 1e-5);
    EXPECT_LT(std::abs(balance.lost), 1e-5 * balance.emitted); // the room is closed
}

// A lamp of a millionth of the area and less: its light is all there is, however little of the lamp's
// exitance.
TEST(Radiosity, light_of_tiny_lamps_is_solved_as_well_as_any) {
    const size_t n = 200;
    for (const double share : {1e-2, 1e-6, 1e-9})
        for (const float rho : {0.5f, 0.9f}) {
            SignedSphere room(n);
            room.area[0] = room.area[1] = share * room.total;
            room.total = std::accumulate(room.area.begin(), room.area.end(), 0.0);
            std::vector<float> F(n * n), matter(n, rho), emitted(n), B, H;
            for (size_t k = 0; k < n * n; ++k) F[k] = static_cast<float>(room.factor(k / n, k % n));
            emitted[0] = 1e5;
            const gpu::Buffer factors = matrixBuffer(F);
            RadiosityGather gather(test::device(), factors, n);
            RadiositySolver solver(gather, gather.rowSums());
            solver.setMatter(
                {n, {matter}, {std::vector<float>(n, 0)}, std::vector<int32_t>(n, geometry::kNoTwin)});
            RelightBasis basis(gather, solver, room.area);
            basis.restart();
            const uint32_t channel[]{0};
            const std::vector<double> exact = room.solution(matter, emitted);
            for (int way = 0; way < 3; ++way) { // the second moment of a basis is the first once more
                const RadiosityReport report =
                    way == 0 ? solver.solve(emitted, channel, B, H) : basis.solve(emitted, channel, B, H);
                EXPECT_TRUE(report.converged);
                const double most = *std::max_element(exact.begin() + 2, exact.end());
                for (size_t i = 2; i < n; ++i)
                    ASSERT_NEAR(B[i], exact[i], (report.bound + 1e-6) * most) << share << " " << way;
                EXPECT_LT(balanceOf(solver, room.area, emitted, B, H).imbalance(), 1e-5) << share;
            }
            std::vector<float> error, ofH;
            ASSERT_TRUE(solver.findErrors(channel, B, H, error, ofH));
            for (size_t i = 2; i < n; ++i) EXPECT_LT(ofH[i], 1e-3 * H[i]) << share;
        }
}

// Rows that let a tenth of the light out: absorbed and lost make up what was emitted.
TEST(Radiosity, light_is_emitted_absorbed_and_lost_in_balance) {
    const geometry::PatchMesh mesh = test::boxRoom({});
    const size_t n = mesh.patchCount();
    std::vector<float> F = computeFormFactors(test::device(), mesh).values.download<float>(n * n);
    for (float& f : F) f *= 0.9f;
    const gpu::Buffer factors = matrixBuffer(F);
    RadiosityGather gather(test::device(), factors, static_cast<uint32_t>(n));
    RadiositySolver solver(gather, gather.rowSums());
    solver.setMatter({static_cast<uint32_t>(n),
                      {std::vector<float>(n, 0.5f)},
                      {std::vector<float>(n, 0)},
                      std::vector<int32_t>(n, geometry::kNoTwin)});
    std::vector<float> emitted(n), B, H;
    emitted[11] = 1000;
    std::vector<double> area;
    for (size_t i = 0; i < n; ++i) area.push_back(geometry::patchArea(mesh, i));
    const uint32_t channel[]{0};
    RadiosityOptions options;
    options.tolerance = 1e-5;
    solver.solve(emitted, channel, B, H, options);
    const EnergyBalance balance = balanceOf(solver, area, emitted, B, H);
    EXPECT_LT(balance.imbalance(), 1e-5);
    // Of what leaves patches, a tenth is lost, and half of the rest absorbed: 2 of 11 and 9 of 11.
    EXPECT_NEAR(balance.lost / balance.emitted, 2.0 / 11, 1e-3);
    EXPECT_NEAR(balance.absorbed / balance.emitted, 9.0 / 11, 1e-3);
}

TEST(Radiosity, a_pass_limit_is_reported_not_hidden) {
    RadiosityOptions options;
    options.maxPasses = 2;
    std::vector<float> emitted(40);
    emitted[0] = 1;
    const Solved s = solve(randomFactors(40, 1, 2), std::vector<float>(40, 0.9f), emitted, options);
    EXPECT_FALSE(s.report.converged);
    EXPECT_GT(s.report.bound, options.tolerance);
}

// float32 B leaves a residual of about 1e-7 B: a bound of 1e-6 at reflectance 0.99 asks for 1e-8.
TEST(Radiosity, a_bound_that_rounding_keeps_out_of_reach_is_not_waited_for) {
    RadiosityOptions options;
    options.tolerance = 1e-6;
    std::vector<float> emitted(300);
    emitted[5] = 1;
    const Solved s = solve(randomFactors(300, 1, 2), std::vector<float>(300, 0.99f), emitted, options);
    EXPECT_FALSE(s.report.converged);
    EXPECT_LT(s.report.passes, options.maxPasses / 4);
    EXPECT_LT(s.report.residual, 4e-7);
    // What was reached, of the lamp's own light.
    EXPECT_LT(s.report.bound * *std::max_element(s.gathered.begin(), s.gathered.end()), 4e-5);
}

// Columns end one by one. Patches in a ring see their two neighbours: even light is found at once and then
// held up by rounding, light of one lamp takes many restarts to get round.
TEST(Radiosity, a_column_that_rounding_stops_does_not_stop_others) {
    const size_t n = 300;
    std::vector<float> F(n * n);
    for (size_t i = 0; i < n; ++i) F[i * n + (i + 1) % n] = F[i * n + (i + n - 1) % n] = 0.5f;
    const gpu::Buffer factors = matrixBuffer(F);
    RadiosityGather gather(test::device(), factors, static_cast<uint32_t>(n));
    RadiositySolver solver(gather, gather.rowSums());
    const double rho = double{0.99f};
    solver.setMatter({static_cast<uint32_t>(n),
                      {std::vector<float>(n, 0.99f)},
                      {std::vector<float>(n, 0)},
                      std::vector<int32_t>(n, geometry::kNoTwin)});
    RadiosityOptions options;
    options.tolerance = 1e-6;
    std::vector<float> emitted(2 * n, 1.1f), B, H;
    std::fill_n(&emitted[n], n, 0.0f);
    emitted[n] = 1;
    const uint32_t channel[]{0, 0};
    const RadiosityReport report = solver.solve(emitted, channel, B, H, options);
    EXPECT_FALSE(report.converged);
    EXPECT_LT(report.passes, options.maxPasses);
    EXPECT_LT(report.bound, 4e-5 * B[n] / (B[n] - 1)); // the lamp's is the worse
    // B_i - rho / 2 (B_i-1 + B_i+1) = E_i: from the lamp on light falls as q^i, both ways round.
    const double root = std::sqrt(1 - rho * rho), q = (1 - root) / rho;
    for (size_t i = 0; i < n; ++i) {
        ASSERT_NEAR(B[i], double{1.1f} / (1 - rho), 4e-5 * B[i]);
        const double both = std::pow(q, double(i)) + std::pow(q, double(n - i));
        ASSERT_NEAR(B[n + i], both / (root * (1 - std::pow(q, double(n)))), 4e-5 * B[n]) << i;
    }
}

TEST(Radiosity, interior_glass_hands_on_what_falls_on_its_twin) {
    // Two patches that see only each other's partner: 0 shines on 1, 1 is the twin of 2, 2 shines on 3.
    std::vector<float> F(16);
    F[0 * 4 + 1] = F[1 * 4 + 0] = F[2 * 4 + 3] = F[3 * 4 + 2] = 1;
    const gpu::Buffer factors = matrixBuffer(F);
    RadiosityGather gather(test::device(), factors, 4);
    RadiositySolver solver(gather, {1, 1, 1, 1});
    solver.setMatter(
        {4, {{0.5f, 0, 0, 0}}, {{0, 0.8f, 0.8f, 0}}, {geometry::kNoTwin, 2, 1, geometry::kNoTwin}});
    std::vector<float> exitance, gathered;
    const std::vector<float> emitted{100, 0, 0, 0};
    const uint32_t channel[]{0};
    EXPECT_TRUE(solver.solve(emitted, channel, exitance, gathered).converged);
    EXPECT_NEAR(exitance[2], 80, 0.01);
    EXPECT_NEAR(gathered[3], 80, 0.01);
    EXPECT_NEAR(exitance[1], 0, 0.01);
}

} // namespace
} // namespace heliodon::compute
