// What threads hand to one another: nothing is lost that should come, nothing waits for ever.
#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "engine/app/bounded_queue.h"
#include "engine/app/latest.h"

namespace heliodon::app {
namespace {

TEST(BoundedQueue, all_items_come_in_order_and_few_wait) {
    BoundedQueue<int> queue(2);
    std::atomic<int> pushed = 0;
    std::thread producer([&] {
        for (int k = 0; k < 1000; ++k) {
            EXPECT_TRUE(queue.push(k));
            ++pushed;
        }
        queue.close();
    });
    int popped = 0;
    while (const auto item = queue.pop()) {
        EXPECT_EQ(*item, popped++);
        EXPECT_LE(pushed, popped + 2);
    }
    producer.join();
    EXPECT_EQ(popped, 1000);
}

TEST(BoundedQueue, a_closed_one_takes_nothing_and_gives_what_it_holds_or_drops_it) {
    BoundedQueue<int> queue(3), dropped(3);
    for (BoundedQueue<int>* q : {&queue, &dropped}) EXPECT_TRUE(q->push(1) && q->push(2));
    queue.close();
    dropped.close(true);
    EXPECT_FALSE(queue.push(3));
    EXPECT_FALSE(dropped.push(3));
    EXPECT_EQ(queue.pop(), 1);
    EXPECT_EQ(queue.pop(), 2);
    EXPECT_EQ(queue.pop(), std::nullopt);
    EXPECT_EQ(dropped.pop(), std::nullopt);
}

TEST(BoundedQueue, closing_frees_those_that_wait) {
    BoundedQueue<int> full(1), empty(1);
    EXPECT_TRUE(full.push(1));
    std::thread producer([&] { EXPECT_FALSE(full.push(2)); });
    std::thread consumer([&] { EXPECT_EQ(empty.pop(), std::nullopt); });
    full.close();
    empty.close();
    producer.join();
    consumer.join();
    EXPECT_EQ(full.pop(), 1);
}

TEST(Latest, what_comes_later_takes_the_place_of_what_waits) {
    Latest<int> place;
    EXPECT_TRUE(place.put(1));
    EXPECT_FALSE(place.put(2));
    EXPECT_EQ(place.take(), 2);
    EXPECT_TRUE(place.put(3));
}

TEST(Latest, again_brings_back_what_was_taken_unless_something_newer_waits) {
    Latest<int> place;
    EXPECT_FALSE(place.again()); // nothing was taken yet
    place.put(1);
    EXPECT_FALSE(place.again());
    EXPECT_EQ(place.take(), 1);
    EXPECT_TRUE(place.again());
    EXPECT_EQ(place.take(), 1);
    place.put(2);
    EXPECT_FALSE(place.again());
    EXPECT_EQ(place.take(), 2);
}

TEST(Latest, closing_frees_whoever_waits) {
    Latest<int> place;
    std::thread waiting([&] { EXPECT_EQ(place.take(), std::nullopt); });
    place.close();
    waiting.join();
    place.put(1);
    EXPECT_EQ(place.take(), std::nullopt);
}

} // namespace
} // namespace heliodon::app
