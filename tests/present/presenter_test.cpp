// Checklist 8 and 32: four sRGB swapchains in one process, by pixels read back from them. Needs a display
// server: the one of $DISPLAY, else an Xvfb of its own.
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "compute/gpu/commands.h"
#include "compute/gpu/image.h"
#include "engine/present/presenter.h"
#include "geometry/input_error.h"
#include "tests/gpu/drivers.h"

namespace heliodon::present {
namespace {

// A display server that lives as long as this process.
class OwnDisplay {
public:
    OwnDisplay() {
        if (std::getenv("DISPLAY")) return;
        int ends[2];
        if (pipe(ends) != 0) return;
        child_ = fork();
        if (child_ == 0) {
            close(ends[0]);
            const std::string number = std::to_string(ends[1]);
            execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", "1600x1200x24", "-nolisten",
                   "tcp", static_cast<char*>(nullptr));
            _exit(127);
        }
        close(ends[1]);
        std::string answer; // the number of the display, once it is ready
        char letter = 0;
        pollfd wait{ends[0], POLLIN, 0};
        while (poll(&wait, 1, 20000) > 0 && read(ends[0], &letter, 1) == 1 && letter != '\n')
            answer += letter;
        close(ends[0]);
        if (!answer.empty()) setenv("DISPLAY", (":" + answer).c_str(), 1);
    }
    ~OwnDisplay() {
        if (child_ <= 0) return;
        kill(child_, SIGTERM);
        waitpid(child_, nullptr, 0);
    }

private:
    pid_t child_ = 0;
};

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
        display = std::make_unique<OwnDisplay>();
        gpu::DeviceOptions options;
        options.validation = true;
        options.onMessage = [](std::string_view message) { ADD_FAILURE() << message; };
        device = std::make_unique<gpu::Device>(withWindows(options)); // throws where there is no display
    }
    static void TearDownTestSuite() {
        device.reset();
        display.reset();
    }
    // Presents until a window shows the wanted size: resizing takes the server some time.
    static void presentUntil(Presenter& presenter, const std::vector<passes::Image8>& pictures, size_t window,
                             int width) {
        for (int i = 0; i < 200; ++i) {
            presenter.pollEvents();
            presenter.present(pictures);
            const auto shown = presenter.lastShown(window);
            if (shown && shown->width == width) return;
            usleep(10000);
        }
    }
    static inline std::unique_ptr<OwnDisplay> display;
    static inline std::unique_ptr<gpu::Device> device;
};

TEST_F(Windows, four_swapchains_show_their_four_pictures_to_the_last_bit) {
    Presenter presenter(*device, {{"a", 320, 240}, {"b", 320, 240}, {"c", 200, 150}, {"d", 64, 48}});
    presenter.keepCopies(true);
    for (int frame = 0; frame < 20; ++frame) { // more frames than a swapchain has images
        const std::vector<passes::Image8> pictures{pattern(320, 240, frame), pattern(320, 240, frame + 1),
                                                   pattern(200, 150, frame + 2), pattern(64, 48, frame + 3)};
        presenter.pollEvents();
        ASSERT_EQ(presenter.present(pictures), 4u);
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
    EXPECT_EQ(presenter.present(pictures), 3u);
    presenter.close(1);
    EXPECT_EQ(presenter.state(1), WindowState::closed);
    EXPECT_FALSE(presenter.reason(1).empty());
    presenter.pollEvents();
    EXPECT_EQ(presenter.present(pictures), 2u);
    presenter.close(0);
    presenter.close(2);
    EXPECT_FALSE(presenter.anyOpen());
    EXPECT_EQ(presenter.present(pictures), 0u);
}

TEST_F(Windows, a_resized_window_gets_images_of_its_new_size) {
    Presenter presenter(*device, {{"a", 100, 80}, {"b", 120, 90}});
    presenter.keepCopies(true);
    passes::Image8 grey{100, 80, std::vector<uint8_t>(3 * 100 * 80, 188)};
    const std::vector<passes::Image8> pictures(2, grey);
    presenter.present(pictures);
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
    EXPECT_EQ(presenter.present(std::vector<passes::Image8>{pattern(100, 80, 1), {}}), 1u);
}

TEST_F(Windows, an_unknown_display_is_named_together_with_the_known_ones) {
    try {
        Presenter presenter(*device, {{"a", 100, 80, "NO-SUCH-OUTPUT"}});
        FAIL() << "expected a refusal";
    } catch (const geometry::InputError& error) {
        EXPECT_NE(std::string(error.what()).find("NO-SUCH-OUTPUT"), std::string::npos);
        for (const std::string& name : displayNames())
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
}

TEST_F(Windows, a_named_display_is_filled) {
    const std::vector<std::string> names = displayNames();
    ASSERT_FALSE(names.empty());
    Presenter presenter(*device, {{"full", 64, 48, names.front()}});
    presenter.keepCopies(true);
    presenter.pollEvents();
    ASSERT_EQ(presenter.present(std::vector<passes::Image8>{pattern(64, 48, 2)}), 1u);
    EXPECT_GE(presenter.lastShown(0)->width, 640);
}

} // namespace
} // namespace heliodon::present

int main(int argc, char** argv) {
    heliodon::test::keepDriversLoaded();
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
