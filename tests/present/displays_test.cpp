// Pictures on displays of their own, by what the display server shows where, while displays go, come back,
// change and are moved. Needs Xorg's dummy driver; skipped where that cannot be started. With a window
// manager.
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compute/gpu/image.h"
#include "engine/present/presenter.h"
#include "tests/present/dummy_displays.h"

namespace heliodon::present {
namespace {

using Sizes = std::vector<std::array<int, 2>>;
const Sizes kSizes{{640, 480}, {800, 600}, {640, 400}, {640, 360}};
constexpr std::array<int, 3> kColours[]{{200, 30, 30}, {30, 200, 30}, {30, 30, 200}, {200, 200, 30}};

// A frame one pixel wide tells whether every pixel has its place.
passes::Image8 pattern(size_t i) {
    const auto [width, height] = kSizes[i];
    passes::Image8 picture{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const bool frame = x == 0 || y == 0 || x == width - 1 || y == height - 1;
            for (const int value : kColours[i])
                picture.rgb.push_back(static_cast<uint8_t>(frame ? 255 - value : value + (x + y) % 40));
        }
    return picture;
}

// A function of the Xlib that GLFW has loaded.
template<class F> F* xlib(const char* name) {
    return reinterpret_cast<F*>(dlsym(RTLD_DEFAULT, name));
}

// What a display shows, asked for by another client of the server.
passes::Image8 seenOn(const Display& display) {
    void* const client = xlib<void*(const char*)>("XOpenDisplay")(nullptr);
    const auto root = xlib<unsigned long(void*)>("XDefaultRootWindow")(client);
    constexpr int kZPixmap = 2;
    void* const image = xlib<void*(void*, unsigned long, int, int, unsigned, unsigned, unsigned long, int)>(
        "XGetImage")(client, root, display.x, display.y, static_cast<unsigned>(display.width),
                     static_cast<unsigned>(display.height), ~0ul, kZPixmap);
    const auto pixel = xlib<unsigned long(void*, int, int)>("XGetPixel");
    passes::Image8 seen{display.width, display.height, {}};
    for (int y = 0; y < display.height; ++y)
        for (int x = 0; x < display.width; ++x) {
            const unsigned long value = pixel(image, x, y);
            for (const int shift : {16, 8, 0}) seen.rgb.push_back(static_cast<uint8_t>(value >> shift & 255));
        }
    xlib<int(void*)>("XDestroyImage")(image);
    xlib<int(void*)>("XCloseDisplay")(client);
    return seen;
}

class Displays : public testing::Test {
protected:
    static void SetUpTestSuite() {
        server = std::make_unique<test::DummyDisplays>();
        if (!server->running()) return;
        for (const char* output : {"DUMMY1", "DUMMY2", "DUMMY3", "DUMMY4"})
            for (const auto& [width, height] : kSizes)
                server->addMode(output, fmt::format("{}x{}", width, height));
        server->arrange(kRow);
        // Before GLFW asks for one. Managers fill the display that a window lies on, so pictures could get
        // mixed up; where openbox cannot be started the tests hold as well.
        server->startWindowManager();
        gpu::DeviceOptions options;
        options.validation = true;
        options.onMessage = [](std::string_view message) { ADD_FAILURE() << message; };
        device = std::make_unique<gpu::Device>(withWindows(options));
    }
    static void TearDownTestSuite() {
        device.reset();
        server.reset();
    }
    void SetUp() override {
        if (!server->running()) GTEST_SKIP() << server->whyNot();
        ASSERT_TRUE(server->arrange(kRow));
        images.clear();
        for (size_t i = 0; i < 4; ++i) images.push_back(uploaded(*device, pattern(i), "picture"));
    }
    // Four that fill a display each, in no order, and one more, on the first display.
    static std::vector<WindowOptions> windows() {
        std::vector<WindowOptions> list;
        for (const size_t i : {2u, 0u, 3u, 1u})
            list.push_back(
                {fmt::format("picture {}", i), kSizes[i][0], kSizes[i][1], fmt::format("DUMMY{}", i + 1)});
        list.push_back({"operator", 300, 200});
        list.back().position = {20, 20};
        return list;
    }
    // Shows them until that is so, for a while.
    bool becomes(Presenter& presenter, const std::function<bool()>& so) {
        for (int i = 0; i < 100; ++i) {
            presenter.pollEvents(0.05);
            presenter.present({&images[2], &images[0], &images[3], &images[1], &images[0]});
            for (size_t window = 0; window < 4; ++window) {
                const auto covered = presenter.covers(window);
                if (!covered || covered->name.empty()) continue;
                EXPECT_TRUE(std::ranges::count(kSizes, std::array{covered->width, covered->height}))
                    << covered->width << " pixels: on its way to " << covered->name;
            }
            if (so()) return true;
        }
        return false;
    }
    static bool shows(size_t output, size_t picture) {
        for (const Display& display : displays())
            if (display.name == fmt::format("DUMMY{}", output))
                return seenOn(display).rgb == pattern(picture).rgb;
        return false;
    }
    static bool eachShowsItsOwn() { return shows(1, 0) && shows(2, 1) && shows(3, 2) && shows(4, 3); }

    static inline const std::string kRow =
        "--output DUMMY0 --mode 800x600 --pos 0x0 --primary --output DUMMY1 --mode 640x480 --pos 800x0 "
        "--output DUMMY2 --mode 800x600 --pos 1440x0 --output DUMMY3 --mode 640x400 --pos 2240x0 "
        "--output DUMMY4 --mode 640x360 --pos 2880x0";
    static inline std::unique_ptr<test::DummyDisplays> server;
    static inline std::unique_ptr<gpu::Device> device;
    std::vector<gpu::Image> images;
};

TEST_F(Displays, each_shows_its_picture_wherever_it_is_moved) {
    Presenter presenter(*device, windows());
    EXPECT_TRUE(becomes(presenter, eachShowsItsOwn));
    ASSERT_TRUE(server->arrange("--output DUMMY1 --pos 2240x0 --output DUMMY3 --pos 800x0 --output DUMMY4 "
                                "--pos 1440x600"));
    EXPECT_TRUE(becomes(presenter, eachShowsItsOwn));
    // Another mode is filled, and left again.
    ASSERT_TRUE(server->arrange("--output DUMMY2 --mode 640x480"));
    EXPECT_TRUE(becomes(presenter, [&] {
        const auto covered = presenter.covers(3);
        return covered && covered->width == 640 && covered->height == 480 && covered->name == "DUMMY2";
    }));
    ASSERT_TRUE(server->arrange("--output DUMMY2 --mode 800x600"));
    EXPECT_TRUE(becomes(presenter, eachShowsItsOwn));
}

TEST_F(Displays, one_that_goes_leaves_the_others_and_is_filled_again) {
    Presenter presenter(*device, windows());
    EXPECT_TRUE(becomes(presenter, eachShowsItsOwn));
    ASSERT_TRUE(server->arrange("--output DUMMY3 --off --output DUMMY4 --pos 2240x0"));
    EXPECT_TRUE(becomes(presenter, [&] { return presenter.displayMissing(0); }));
    EXPECT_NE(presenter.notice(0).find("shown in a window on 'DUMMY0'"), std::string::npos)
        << presenter.notice(0);
    EXPECT_TRUE(becomes(presenter, [] { return shows(1, 0) && shows(2, 1) && shows(4, 3); }));
    // Without a display that no picture is for, nothing lies over the others'.
    ASSERT_TRUE(server->arrange("--output DUMMY0 --off"));
    EXPECT_TRUE(becomes(presenter, [&] { return presenter.state(0) == WindowState::hidden; }));
    EXPECT_EQ(presenter.state(4), WindowState::hidden);
    EXPECT_TRUE(becomes(presenter, [] { return shows(1, 0) && shows(2, 1) && shows(4, 3); }));
    ASSERT_TRUE(server->arrange(kRow));
    EXPECT_TRUE(becomes(presenter, eachShowsItsOwn));
    EXPECT_FALSE(presenter.displayMissing(0));
    EXPECT_EQ(presenter.notice(0), "");
    EXPECT_EQ(presenter.state(4), WindowState::open);
}

TEST_F(Displays, a_window_that_is_asked_for_outside_of_all_is_seen) {
    std::vector<WindowOptions> one{{"outside", 300, 200}};
    one[0].position = {50, 700}; // DUMMY0 ends above
    Presenter presenter(*device, one);
    EXPECT_EQ(presenter.state(0), WindowState::open);
    EXPECT_EQ(presenter.notice(0), "");
    EXPECT_FALSE(presenter.displayMissing(0));
    const auto covered = presenter.covers(0);
    ASSERT_TRUE(covered);
    EXPECT_GT(sharedPixels(*covered, {"DUMMY0", 0, 0, 800, 600}), 50'000);
}

TEST_F(Displays, all_may_go_and_come_back_in_another_order) {
    Presenter presenter(*device, windows());
    EXPECT_TRUE(becomes(presenter, eachShowsItsOwn));
    ASSERT_TRUE(server->arrange("--output DUMMY1 --off --output DUMMY2 --off --output DUMMY3 --off --output "
                                "DUMMY4 --off --output DUMMY0 --off"));
    EXPECT_TRUE(becomes(presenter, [&] { return presenter.displayMissing(3); }));
    for (size_t i = 0; i < 5; ++i) EXPECT_EQ(presenter.state(i), WindowState::hidden);
    ASSERT_TRUE(
        server->arrange("--output DUMMY4 --mode 640x360 --pos 0x0 --output DUMMY3 --mode 640x400 --pos "
                        "640x0 --output DUMMY2 --mode 800x600 --pos 1280x0 --output DUMMY1 --mode "
                        "640x480 --pos 2080x0 --output DUMMY0 --mode 800x600 --pos 2720x0"));
    EXPECT_TRUE(becomes(presenter, eachShowsItsOwn));
}

} // namespace
} // namespace heliodon::present
