// What `live` says in words.
#include "engine/app/live_status.h"

#include <gtest/gtest.h>

#include "engine/app/live_board.h"

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

TEST(LiveStatus, every_reason_of_a_refusal_is_handed_on_once) {
    app::LiveBoard board;
    board.update([](app::LiveStatus& status) {
        status.refuse(&app::LiveStatus::pictureRefused, "grey");
        status.refuse(&app::LiveStatus::refused, "open");
    });
    EXPECT_EQ(board.read().refusals, 2u);
    EXPECT_EQ(board.read().refused, "open");
    EXPECT_EQ(board.takeUnsaid(), (std::vector<std::string>{"grey", "open"}));
    EXPECT_TRUE(board.takeUnsaid().empty());
}

} // namespace
} // namespace heliodon::test
