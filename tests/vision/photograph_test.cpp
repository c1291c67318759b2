// Photographs as files: what is read, and what is refused before it is decoded.
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "geometry/input_error.h"
#include "vision/detect.h"
#include "vision/photograph.h"

namespace heliodon::vision {
namespace {

// A PNG may say that its values are light itself.
TEST(Photograph, of_a_stated_gamma) {
    const std::string file = ::testing::TempDir() + "linear.png";
    std::ifstream in(HELIODON_SOURCE "/examples/i01_mixed.png", std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(in), {}};
    std::string chunk("gAMA\x00\x01\x86\xA0", 8); // 100000
    uint32_t check = 0xFFFFFFFF;                  // of PNG's chunks: CRC-32
    for (const char c : chunk) {
        check ^= static_cast<uint8_t>(c);
        for (int bit = 0; bit < 8; ++bit) check = check >> 1 ^ (check & 1 ? 0xEDB88320 : 0);
    }
    for (int shift = 24; shift >= 0; shift -= 8) chunk += static_cast<char>(~check >> shift);
    constexpr size_t kAfterHeader = 33;
    bytes.insert(kAfterHeader, std::string("\x00\x00\x00\x04", 4) + chunk);
    std::ofstream(file, std::ios::binary) << bytes;
    const Photograph usual = readPhotograph(HELIODON_SOURCE "/examples/i01_mixed.png"),
                     linear = readPhotograph(file);
    for (size_t i = 0; i < usual.rgb.size(); i += 10007)
        EXPECT_NEAR(linear.rgb[i], 255 * std::pow(usual.rgb[i] / 255.0, 1 / 2.2), 0.51);
    std::filesystem::remove(file);
}

TEST(Photograph, too_many_pixels_are_refused_before_they_are_decoded) {
    const std::string file = testing::TempDir() + "heliodon_too_large";
    const auto refusal = [&](const std::string& bytes) {
        std::ofstream(file, std::ios::binary) << bytes;
        try {
            readPhotograph(file);
        } catch (const geometry::InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    using namespace std::string_literals;
    const std::string said = "20000 x 30000 pixels";
    EXPECT_NE(refusal("\x89PNG\r\n\x1A\n\0\0\0\x0DIHDR\0\0\x4E\x20\0\0\x75\x30"s).find(said),
              std::string::npos);
    EXPECT_NE(refusal("\xFF\xD8\xFF\xC2\0\x11\x08\x75\x30\x4E\x20\3"s).find(said), std::string::npos);
    EXPECT_NE(
        refusal("II*\0\x08\0\0\0\2\0\0\1\3\0\1\0\0\0\x20\x4E\0\0\1\1\4\0\1\0\0\0\x30\x75\0\0"s).find(said),
        std::string::npos);
    EXPECT_NE(refusal("MM\0*\xFF\xFF\xFF\xFF"s), ""); // a directory beyond the file's end
}

// Decoders paint grey what data does not reach. A JPEG has no checksum: what still makes as many pixels
// passes.
TEST(Photograph, with_less_or_more_data_than_pixels_is_refused_by_name) {
    std::ifstream in(HELIODON_TEST_DATA "/vision/i01_mixed_harsh.jpg", std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    const std::string file = testing::TempDir() + "heliodon_damaged.jpg";
    for (const size_t bytes : {1u, 400u}) {
        std::string damaged = whole;
        const size_t at = whole.size() * (bytes == 1 ? 3 : 7) / 10;
        damaged.replace(at, bytes, bytes, bytes == 1 ? static_cast<char>(whole[at] ^ 0x10) : '\x11');
        std::ofstream(file, std::ios::binary) << damaged;
        try {
            readPhotograph(file);
            ADD_FAILURE() << bytes;
        } catch (const geometry::InputError& error) {
            EXPECT_EQ(std::string(error.what()).rfind(file + ": the picture is damaged: ", 0), 0u)
                << error.what();
        }
    }
}

TEST(Photograph, a_tiff_cut_short_is_told_before_it_is_decoded) {
    std::string whole("II*\0\x08\0\0\0\x09\0", 10);
    constexpr int kSide = 40, kPixels = 8 + 2 + 9 * 12 + 4 + 6; // pixels; bytes before them
    const auto entry = [&](int tag, int type, int count, int value) {
        for (const auto& [number, size] : {std::pair{tag, 2}, {type, 2}, {count, 4}, {value, 4}})
            for (int i = 0; i < size; ++i) whole += static_cast<char>(number >> 8 * i & 0xFF);
    };
    entry(256, 3, 1, kSide), entry(257, 3, 1, kSide), entry(258, 3, 3, kPixels - 6), entry(259, 3, 1, 1);
    entry(262, 3, 1, 2), entry(273, 4, 1, kPixels), entry(277, 3, 1, 3), entry(278, 3, 1, kSide);
    entry(279, 4, 1, 3 * kSide * kSide);
    whole += std::string("\0\0\0\0\x08\0\x08\0\x08\0", 10) + std::string(3 * kSide * kSide, 'x');
    const std::string file = testing::TempDir() + "heliodon_cut_short.tif";
    std::ofstream(file, std::ios::binary) << whole;
    EXPECT_EQ(readPhotograph(file).width, kSide);
    for (const size_t length : {whole.size() - 1, whole.size() / 2, size_t{60}}) {
        std::ofstream(file, std::ios::binary) << whole.substr(0, length);
        try {
            readPhotograph(file);
            ADD_FAILURE() << length;
        } catch (const geometry::InputError& error) {
            EXPECT_NE(std::string(error.what()).find("is cut short"), std::string::npos) << error.what();
        }
    }
}

TEST(Photograph, cut_short_or_grey_is_no_photograph) {
    std::ifstream in(HELIODON_TEST_DATA "/vision/i01_mixed_harsh.jpg", std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    const std::string file = testing::TempDir() + "heliodon_cut_short.jpg";
    std::ofstream(file, std::ios::binary) << whole;
    EXPECT_TRUE(hasColor(readPhotograph(file)));
    EXPECT_NEAR(readPhotograph(file).jpegQuality, 90, 10);
    EXPECT_NEAR(readPhotograph(file).chromaStep, 0.4, 0.3);
    EXPECT_EQ(readPhotograph(HELIODON_SOURCE "/examples/i01_mixed.png").chromaStep, 0);
    for (const double share : {0.3, 0.7, 0.99}) {
        std::ofstream(file, std::ios::binary)
            << whole.substr(0, static_cast<size_t>(share * static_cast<double>(whole.size())));
        EXPECT_THROW(readPhotograph(file), geometry::InputError) << share;
    }
    // What a camera adds behind the picture does not make it less whole.
    std::ofstream(file, std::ios::binary) << whole << std::string(100, 'x');
    EXPECT_NO_THROW(readPhotograph(file));
    // Nor what it pads the data with.
    for (const std::string& padding : {std::string("pad"), std::string(512, '\0')}) {
        std::ofstream(file, std::ios::binary) << whole.substr(0, whole.size() - 2) << padding << "\xFF\xD9";
        EXPECT_NO_THROW(readPhotograph(file));
    }
    EXPECT_FALSE(hasColor({2, 1, {9, 9, 9, 200, 200, 200}}));
}

} // namespace
} // namespace heliodon::vision
