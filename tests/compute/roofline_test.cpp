#include "compute/roofline.h"

#include <gtest/gtest.h>

#include "tests/gpu/test_device.h"

namespace heliodon::compute {
namespace {

// The kernel's sums are checked where they are made; here: rates that a machine can have, from a phone to a
// rack.
TEST(Roofline, rates_are_those_of_a_machine_and_bound_work_by_the_slower) {
    const Roofline measured = measureRoofline(test::device());
    EXPECT_GT(measured.flopsPerSecond, 1e8);
    EXPECT_LT(measured.flopsPerSecond, 1e15);
    EXPECT_GT(measured.bytesPerSecond, 1e8);
    EXPECT_LT(measured.bytesPerSecond, 1e14);
    const Roofline roof{100, 10};
    EXPECT_EQ(roof.seconds(200, 10), 2);
    EXPECT_EQ(roof.seconds(10, 30), 3);
}

} // namespace
} // namespace heliodon::compute
