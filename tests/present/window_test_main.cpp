// For tests that open windows, whose device is made for those.
#include <gtest/gtest.h>

#include "tests/gpu/drivers.h"

int main(int argc, char** argv) {
    heliodon::test::keepDriversLoaded();
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
