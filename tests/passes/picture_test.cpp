#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "engine/passes/false_colour.h"
#include "engine/passes/image_file.h"
#include "geometry/input_error.h"
#include "geometry/luminance.h"
#include "shaders/io/display.io.h"

namespace heliodon::passes {
namespace {

std::filesystem::path scratch(const std::string& name) {
    return std::filesystem::path(testing::TempDir()) / name;
}

TEST(ImageFile, png_comes_back_to_the_last_bit) {
    Image8 picture{5, 3, {}};
    for (int i = 0; i < 45; ++i) picture.rgb.push_back(static_cast<uint8_t>(i * 5));
    writePng(picture, scratch("picture.png"));
    const cv::Mat back = cv::imread(scratch("picture.png").string(), cv::IMREAD_COLOR);
    ASSERT_EQ(back.cols, 5);
    ASSERT_EQ(back.rows, 3);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 5; ++x)
            for (int c = 0; c < 3; ++c) EXPECT_EQ(back.at<cv::Vec3b>(y, x)[2 - c], picture.pixel(x, y)[c]);
}

TEST(ImageFile, exr_is_read_by_another_implementation_with_every_bit) {
    setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);
    ImageF picture{7, 4, {}};
    for (int i = 0; i < 84; ++i) picture.rgb.push_back(static_cast<float>(i) * 1234.567f);
    writeExr(picture, scratch("picture.exr"));
    const cv::Mat back = cv::imread(scratch("picture.exr").string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(back.cols, 7);
    ASSERT_EQ(back.rows, 4);
    ASSERT_EQ(back.type(), CV_32FC3);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 7; ++x)
            for (int c = 0; c < 3; ++c) EXPECT_EQ(back.at<cv::Vec3f>(y, x)[2 - c], picture.pixel(x, y)[c]);
}

// Several blocks of lines: smooth ones, and noise that compression would make longer.
TEST(ImageFile, exr_is_compressed_and_every_cut_is_seen) {
    setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);
    ImageF picture{61, 41, {}};
    uint32_t noise = 1;
    for (int i = 0; i < 3 * 61 * 41; ++i) {
        noise = noise * 1664525u + 1013904223u;
        const bool smooth = i < 3 * 61 * 20;
        picture.rgb.push_back(smooth ? 1000.0f : std::bit_cast<float>(noise >> 2));
    }
    const std::filesystem::path file = scratch("blocks.exr"), cut = scratch("cut.exr");
    writeExr(picture, file,
             {{{"heliodon:unit", "lux"}, {"comments", "\u00B0 of an angle"}}, {{"whiteLuminance", 0.3183f}}});
    std::ifstream in(file, std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(in), {});
    for (const char* name : {"chromaticities", "heliodon:unit", "comments", "whiteLuminance"})
        EXPECT_NE(bytes.find(name), std::string::npos) << name;
    const cv::Mat back = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(back.rows, 41);
    for (int y = 0; y < 41; ++y)
        for (int x = 0; x < 61; ++x)
            for (int c = 0; c < 3; ++c) ASSERT_EQ(back.at<cv::Vec3f>(y, x)[2 - c], picture.pixel(x, y)[c]);
    const uintmax_t size = std::filesystem::file_size(file);
    EXPECT_LT(size, 12u * 61 * 41 * 3 / 4);
    EXPECT_TRUE(isWholeExr(file));
    for (uintmax_t left = 0; left < size; left += left < 1000 ? 1 : 500) {
        std::filesystem::copy_file(file, cut, std::filesystem::copy_options::overwrite_existing);
        std::filesystem::resize_file(cut, left);
        EXPECT_FALSE(isWholeExr(cut)) << left;
    }
    EXPECT_FALSE(isWholeExr(scratch("none.exr")));
    const std::filesystem::path png = scratch("whole.png");
    writePng({2, 1, {1, 2, 3, 4, 5, 6}}, png);
    EXPECT_TRUE(isWholePng(png));
    EXPECT_FALSE(isWholePng(scratch("none.png")));
    for (uintmax_t left = std::filesystem::file_size(png); left-- > 0;) {
        std::filesystem::resize_file(png, left);
        EXPECT_FALSE(isWholePng(png)) << left;
    }
}

TEST(ImageFile, a_missing_folder_is_named_and_nothing_is_left) {
    const Image8 picture{1, 1, {1, 2, 3}};
    EXPECT_THROW(writePng(picture, scratch("no/such/folder/a.png")), geometry::InputError);
    EXPECT_FALSE(std::filesystem::exists(scratch("no")));
}

TEST(FalseColour, shaders_weigh_channels_as_the_host_does) {
    EXPECT_EQ(io::kLuminance, glm::vec3(geometry::kLuminance));
}

TEST(FalseColour, the_scale_grows_lighter_all_along) {
    double before = -1;
    for (int i = 0; i <= 100; ++i) {
        const glm::vec3 c = viridis(i / 100.0);
        const double luma =
            0.2126 * std::pow(c.r, 2.2) + 0.7152 * std::pow(c.g, 2.2) + 0.0722 * std::pow(c.b, 2.2);
        EXPECT_GT(luma, before) << i;
        before = luma;
    }
}

TEST(FalseColour, open_ends_take_steps_of_1_2_5_and_stated_ends_are_kept) {
    const std::vector<float> lux{0, 30, 200, 4000};
    const FalseScale scale = falseScale({}, lux);
    EXPECT_NEAR(scale.lowLux, 20, 1e-9);
    EXPECT_NEAR(scale.highLux, 5000, 1e-6);
    Tone tone;
    tone.highLux = 500;
    EXPECT_NEAR(falseScale(tone, lux).lowLux, 20, 1e-9);
    EXPECT_DOUBLE_EQ(falseScale(tone, lux).highLux, 500);
    EXPECT_GT(falseScale({}, {}).highLux, falseScale({}, {}).lowLux); // night: still a scale
    const std::vector<double> wide = legendTicks({5, 20000});
    EXPECT_EQ(wide.front(), 5); // both ends are told, however far apart
    EXPECT_NEAR(wide.back(), 20000, 1e-6);
    EXPECT_EQ(wide.size(), 6u);
}

TEST(FalseColour, the_legend_shows_both_ends_of_the_scale) {
    Image8 picture{400, 300, std::vector<uint8_t>(3 * 400 * 300, 128)};
    drawLegend(picture, {10, 10000});
    const auto has = [&](glm::vec3 colour) {
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x)
                if (std::abs(picture.pixel(x, y)[0] - 255 * colour.r) < 2 &&
                    std::abs(picture.pixel(x, y)[1] - 255 * colour.g) < 2 &&
                    std::abs(picture.pixel(x, y)[2] - 255 * colour.b) < 2)
                    return true;
        return false;
    };
    EXPECT_TRUE(has(viridis(0)));
    EXPECT_TRUE(has(viridis(1)));
    EXPECT_TRUE(has(glm::vec3(0)));            // below the scale
    EXPECT_EQ(picture.pixel(10, 150)[0], 128); // the rest of the picture is left alone
    // Each number beside its tick.
    const auto isInked = [&](int x0, int x1, int y) {
        for (int x = x0; x < x1; ++x)
            if (picture.pixel(x, y)[0] > 120) return true;
        return false;
    };
    const int left = picture.width - legendWidth(picture.height), bar = picture.width - 22;
    int ticks = 0;
    for (int y = 20; y < 280; ++y) { // below "lux", above what is below the scale
        if (!isInked(bar - 2, bar, y)) continue;
        int top = y, bottom = y;
        while (isInked(left, bar - 4, top - 1)) --top;
        while (isInked(left, bar - 4, bottom + 1)) ++bottom;
        EXPECT_NEAR(0.5 * (top + bottom), y, 1) << y;
        ++ticks;
    }
    EXPECT_EQ(ticks, 10);
    Image8 tiny{3, 3, std::vector<uint8_t>(27, 9)};
    drawLegend(tiny, {}); // no room: nothing happens
    EXPECT_EQ(tiny.rgb, std::vector<uint8_t>(27, 9));
    // A strip is kept free for it just where it is drawn.
    for (int height = 16; height < 100; ++height) {
        Image8 low{400, height, std::vector<uint8_t>(3 * 400 * static_cast<size_t>(height), 128)};
        drawLegend(low, {});
        int columns = 0;
        while (columns < 400 && low.pixel(399 - columns, 0)[0] != 128) ++columns;
        EXPECT_EQ(columns, legendWidth(height)) << height;
    }
}

} // namespace
} // namespace heliodon::passes
