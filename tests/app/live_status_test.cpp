// What `live` says in words.
#include "engine/app/live_status.h"

#include <gtest/gtest.h>

#include "engine/app/live_board.h"
#include "engine/app/run.h"

namespace heliodon::test {
namespace {

TEST(LiveStatus, counts_one_of_a_kind_as_one) {
    app::LiveStatus status;
    status.detections = 1;
    status.seen.walls.resize(1), status.seen.arcs.resize(1), status.seen.windows.resize(2);
    status.seen.skylights.resize(1);
    const auto facts = app::factsOf(status, nullptr, {});
    ASSERT_FALSE(facts.empty());
    EXPECT_EQ(facts[0].second, "1 wall, 1 arc, 2 windows, 1 skylight, 0 tokens, no north arrow");
}

TEST(LiveStatus, an_error_that_no_kernel_claims_is_unknown) {
    const auto scene = std::make_shared<app::LiveScene>();
    app::LitScene lit;
    lit.scene = scene;
    lit.moment = std::make_shared<compute::Moment>();
    const auto errorWith = [&](const nlohmann::json& claim) {
        scene->report["form_factors"] = {{"claimed_row_error", claim}, {"closure_rms", 0.01}};
        for (const auto& [name, value] : app::factsOf({}, &lit, {}))
            if (name == "error") return value;
        return std::string();
    };
    EXPECT_EQ(errorWith(nullptr), "rows unknown, closure 1.0e-02, solution 0.0e+00");
    EXPECT_EQ(errorWith(0), "rows 0.0e+00, closure 1.0e-02, solution 0.0e+00");
}

TEST(LiveStatus, every_reason_of_a_refusal_is_handed_on_once) {
    app::LiveBoard board;
    board.update([](app::LiveStatus& status) {
        status.refuse(&app::LiveStatus::pictureRefused, "grey");
        status.refuse(&app::LiveStatus::refused, "open");
    });
    EXPECT_EQ(board.read().refusals, 2u);
    EXPECT_EQ(board.read().refused, "open");
    const auto said = board.takeUnsaid();
    ASSERT_EQ(said.size(), 2u);
    EXPECT_EQ(said[0].text, "not shown: grey");
    EXPECT_EQ(said[1].text, "not shown: open");
    EXPECT_TRUE(said[0].warning && said[1].warning);
    EXPECT_TRUE(board.takeUnsaid().empty());
    // Of a camera its loss and its return, not every attempt.
    for (const char* why : {"none; trying again", "gone; trying again"})
        board.update([&](app::LiveStatus& status) { status.describeCamera(why, true); });
    for (int k = 0; k < 3; ++k)
        board.update([&](app::LiveStatus& status) { status.describeCamera("file a.png", false); });
    const auto cameras = board.takeUnsaid();
    ASSERT_EQ(cameras.size(), 2u);
    EXPECT_EQ(cameras[0].text, "none; trying again");
    EXPECT_TRUE(cameras[0].warning);
    EXPECT_EQ(cameras[1].text, "camera: file a.png");
    EXPECT_FALSE(cameras[1].warning);
}

// A display that runs for days meets one picture after another that it cannot show.
TEST(LiveStatus, warnings_of_days_are_the_latest) {
    app::Arguments arguments;
    arguments.common.quiet = true;
    app::Run run(arguments);
    const size_t left = 500;
    for (size_t k = 0; k < app::Run::kMostWarnings + left; ++k) run.warn(std::to_string(k));
    run.warn(std::to_string(app::Run::kMostWarnings)); // said before
    const nlohmann::json& warnings = run.report()["warnings"];
    ASSERT_EQ(warnings.size(), app::Run::kMostWarnings);
    EXPECT_EQ(warnings.front(), std::to_string(left));
    EXPECT_EQ(warnings.back(), std::to_string(app::Run::kMostWarnings + left - 1));
    EXPECT_EQ(run.report()["warnings_left_out"], left);
}

} // namespace
} // namespace heliodon::test
