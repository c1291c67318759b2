// Checklist 8 and 32: four sRGB swapchains in one process, by pixels read back from them. Needs a display
// server: the one of $DISPLAY, else an Xvfb of its own.
#include <dlfcn.h>
#include <unistd.h>

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "compute/gpu/commands.h"
#include "compute/gpu/image.h"
#include "engine/present/presenter.h"
#include "tests/present/own_display.h"

namespace heliodon::present {
namespace {

passes::Image8 pattern(int width, int height, int seed) {
    passes::Image8 picture{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                picture.rgb.push_back(
                    static_cast<uint8_t>((x * (c + 1) + y * 3 + seed * 67 + (x * y) / 16) & 255));
    return picture;
}

class Windows : public testing::Test {
protected:
    static void SetUpTestSuite() {
        display = std::make_unique<test::OwnDisplay>();
        gpu::DeviceOptions options;
        options.validation = true;
        options.onMessage = [](std::string_view message) { ADD_FAILURE() << message; };
        device = std::make_unique<gpu::Device>(withWindows(options)); // throws where there is no display
    }
    static void TearDownTestSuite() {
        device.reset();
        display.reset();
    }
    // From host memory; an empty picture leaves a window as it is.
    static size_t present(Presenter& presenter, const std::vector<passes::Image8>& pictures) {
        std::vector<gpu::Image> images(pictures.size());
        std::vector<const gpu::Image*> shown(pictures.size(), nullptr);
        for (size_t i = 0; i < pictures.size(); ++i) {
            if (pictures[i].rgb.empty()) continue;
            images[i] = uploaded(*device, pictures[i], "picture");
            shown[i] = &images[i];
        }
        return presenter.present(shown);
    }
    // Presents until a window shows the wanted size: resizing takes the server some time.
    static void presentUntil(Presenter& presenter, const std::vector<passes::Image8>& pictures, size_t window,
                             int width) {
        for (int i = 0; i < 2000; ++i) {
            presenter.pollEvents();
            present(presenter, pictures);
            const auto shown = presenter.lastShown(window);
            if (shown && shown->width == width) return;
            usleep(10000);
        }
    }
    static inline std::unique_ptr<test::OwnDisplay> display;
    static inline std::unique_ptr<gpu::Device> device;
};

TEST_F(Windows, four_swapchains_show_their_four_pictures_to_the_last_bit) {
    Presenter presenter(*device, {{"a", 320, 240}, {"b", 320, 240}, {"c", 200, 150}, {"d", 64, 48}});
    presenter.keepCopies(true);
    for (int frame = 0; frame < 20; ++frame) { // more frames than a swapchain has images
        const std::vector<passes::Image8> pictures{pattern(320, 240, frame), pattern(320, 240, frame + 1),
                                                   pattern(200, 150, frame + 2), pattern(64, 48, frame + 3)};
        presenter.pollEvents();
        ASSERT_EQ(present(presenter, pictures), 4u);
        for (size_t i = 0; i < 4; ++i) {
            const auto shown = presenter.lastShown(i);
            ASSERT_TRUE(shown);
            // Blitting decodes and encodes sRGB: that must come back to the same byte.
            ASSERT_EQ(shown->rgb, pictures[i].rgb) << "window " << i << ", frame " << frame;
        }
    }
}

TEST_F(Windows, a_closed_window_leaves_the_others_at_work) {
    Presenter presenter(*device, {{"a", 100, 80}, {"b", 100, 80}, {"c", 100, 80}});
    const std::vector<passes::Image8> pictures(3, pattern(100, 80, 5));
    EXPECT_EQ(present(presenter, pictures), 3u);
    presenter.close(1);
    EXPECT_EQ(presenter.state(1), WindowState::closed);
    EXPECT_FALSE(presenter.reason(1).empty());
    presenter.pollEvents();
    EXPECT_EQ(present(presenter, pictures), 2u);
    presenter.close(0);
    presenter.close(2);
    for (size_t i = 0; i < 3; ++i) EXPECT_EQ(presenter.state(i), WindowState::closed);
    EXPECT_EQ(present(presenter, pictures), 0u);
}

// A function of the Xlib that GLFW has loaded.
template<class F> F* xlib(const char* name) {
    return reinterpret_cast<F*>(dlsym(RTLD_DEFAULT, name));
}

// Another client of the display server destroys the window of that title, asking nobody.
void destroyFromOutside(const std::string& title) {
    using Id = unsigned long;
    void* const client = xlib<void*(const char*)>("XOpenDisplay")(nullptr);
    const Id root = xlib<Id(void*)>("XDefaultRootWindow")(client);
    Id ignored = 0, *children = nullptr;
    unsigned count = 0;
    xlib<int(void*, Id, Id*, Id*, Id**, unsigned*)>("XQueryTree")(client, root, &ignored, &ignored, &children,
                                                                  &count);
    for (unsigned i = 0; i < count; ++i) {
        char* name = nullptr;
        xlib<int(void*, Id, char**)>("XFetchName")(client, children[i], &name);
        if (name && name == title) xlib<int(void*, Id)>("XDestroyWindow")(client, children[i]);
        if (name) xlib<int(void*)>("XFree")(name);
    }
    xlib<int(void*)>("XFree")(children);
    xlib<int(void*)>("XCloseDisplay")(client); // when the server has done it
}

// Xlib would end the program.
TEST_F(Windows, a_window_that_another_program_destroys_is_closed) {
    Presenter presenter(*device, {{"doomed", 100, 80}, {"b", 100, 80}});
    const std::vector<passes::Image8> pictures(2, pattern(100, 80, 5));
    EXPECT_EQ(present(presenter, pictures), 2u);
    destroyFromOutside("doomed");
    presenter.pollEvents();
    EXPECT_EQ(presenter.state(0), WindowState::closed);
    EXPECT_EQ(presenter.reason(0), "closed by another program");
    EXPECT_EQ(presenter.state(1), WindowState::open);
    EXPECT_EQ(present(presenter, pictures), 1u);
}

TEST_F(Windows, a_resized_window_gets_images_of_its_new_size) {
    Presenter presenter(*device, {{"a", 100, 80}, {"b", 120, 90}});
    presenter.keepCopies(true);
    passes::Image8 grey{100, 80, std::vector<uint8_t>(3 * 100 * 80, 188)};
    const std::vector<passes::Image8> pictures(2, grey);
    present(presenter, pictures);
    presenter.resize(0, 260, 200);
    presentUntil(presenter, pictures, 0, 260);
    const auto shown = presenter.lastShown(0);
    ASSERT_TRUE(shown);
    EXPECT_EQ(shown->width, 260);
    EXPECT_EQ(shown->height, 200);
    EXPECT_EQ(shown->pixel(130, 100)[1], 188); // stretched, and still the same grey
    EXPECT_EQ(presenter.lastShown(1)->width, 120);
}

TEST_F(Windows, a_window_without_a_picture_keeps_its_own) {
    Presenter presenter(*device, {{"a", 100, 80}, {"b", 100, 80}});
    presenter.keepCopies(true);
    presentUntil(presenter, {pattern(100, 80, 1), pattern(100, 80, 2)}, 1, 100);
    EXPECT_EQ(present(presenter, {pattern(100, 80, 3), {}}), 1u);
    EXPECT_EQ(presenter.lastShown(0)->rgb, pattern(100, 80, 3).rgb);
    EXPECT_EQ(presenter.lastShown(1)->rgb, pattern(100, 80, 2).rgb);
    EXPECT_FALSE(presenter.damaged(1));
}

TEST_F(Windows, a_missing_display_gives_a_window_and_is_named_together_with_the_known_ones) {
    Presenter presenter(*device, {{"a", 100, 80, "NO-SUCH-OUTPUT"}, {"b", 100, 80}});
    EXPECT_EQ(present(presenter, std::vector<passes::Image8>(2, pattern(100, 80, 4))), 2u);
    EXPECT_FALSE(presenter.fullScreen(0));
    EXPECT_NE(presenter.notice(0).find("NO-SUCH-OUTPUT"), std::string::npos);
    for (const Display& known : displays())
        EXPECT_NE(presenter.notice(0).find(known.name), std::string::npos) << presenter.notice(0);
    EXPECT_EQ(presenter.notice(1), "");
}

TEST_F(Windows, a_display_without_srgb_gets_the_same_bytes) {
    WindowOptions plain{"a", 160, 120};
    plain.codeBefore = true;
    Presenter presenter(*device, {plain, {"b", 160, 120}});
    presenter.keepCopies(true);
    const std::vector<passes::Image8> pictures(2, pattern(160, 120, 9));
    ASSERT_EQ(present(presenter, pictures), 2u);
    EXPECT_EQ(presenter.lastShown(0)->rgb, pictures[0].rgb);
    EXPECT_EQ(presenter.lastShown(1)->rgb, pictures[1].rgb);
}

TEST_F(Windows, a_named_display_is_filled) {
    const std::vector<Display> connected = displays();
    ASSERT_FALSE(connected.empty());
    Presenter presenter(*device, {{"full", 64, 48, connected.front().name}});
    presenter.keepCopies(true);
    presenter.pollEvents();
    ASSERT_EQ(present(presenter, {pattern(64, 48, 2)}), 1u);
    EXPECT_GE(presenter.lastShown(0)->width, 640);
    EXPECT_TRUE(presenter.fullScreen(0));
    presenter.setFullScreen(0, false); // and back to a window of the picture's size
    presentUntil(presenter, {pattern(64, 48, 2)}, 0, 64);
    EXPECT_EQ(presenter.lastShown(0)->width, 64);
}

} // namespace
} // namespace heliodon::present
