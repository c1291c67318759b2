// Words in pictures: every letter of a name, however its file is coded.
#include "engine/passes/lettering.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

namespace heliodon::passes {
namespace {

Image8 drawn(const std::string& words, double x = 4, double y = 36) {
    Image8 picture{200, 48, {}};
    picture.rgb.assign(3 * 200 * 48, 0);
    Lettering{24, {255, 255, 255}}.draw(picture, x, y, words);
    return picture;
}

// Rows and columns that are inked at least half, from top left to bottom right.
struct Ink {
    int left = 200, top = 48, right = -1, bottom = -1;
    size_t count = 0;
};

Ink inkOf(const Image8& picture) {
    Ink ink;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            if (picture.pixel(x, y)[0] > 127) {
                ink.left = std::min(ink.left, x), ink.right = std::max(ink.right, x);
                ink.top = std::min(ink.top, y), ink.bottom = std::max(ink.bottom, y);
                ++ink.count;
            }
    return ink;
}

TEST(Lettering, letters_with_accents_are_themselves) {
    const Ink plain = inkOf(drawn("a")), accented = inkOf(drawn("\u00E3"));
    EXPECT_EQ(plain.bottom, accented.bottom);
    EXPECT_LT(accented.top, plain.top - 2); // the tilde
    EXPECT_GT(accented.count, plain.count);
    for (const char* letter : {"\u00FC", "\u010D", "\u0142", "\u0416", "\u03A9", "\u00B0"})
        EXPECT_NE(drawn(letter).rgb, drawn("\u4E00").rgb) << letter; // the box of what the font lacks
}

TEST(Lettering, old_files_are_in_windows_1252) {
    EXPECT_EQ(drawn("S\xE3o Paulo").rgb, drawn("S\u00E3o Paulo").rgb);
    EXPECT_EQ(drawn("Z\xFCrich").rgb, drawn("Z\u00FCrich").rgb);
    EXPECT_EQ(drawn("cut \xE2\x82").rgb, drawn("cut \u00E2\u201A").rgb); // half of a character
}

TEST(Lettering, capitals_are_as_tall_and_words_as_wide_as_said) {
    const Ink ink = inkOf(drawn("H"));
    EXPECT_NEAR(ink.bottom - ink.top + 1, 24, 1);
    EXPECT_EQ(ink.bottom, 35); // on the baseline
    const Lettering letters{24};
    EXPECT_EQ(letters.width(""), 0);
    EXPECT_NEAR(letters.width("HHHH"), 4 * letters.width("H"), 1e-9);
    const Ink wide = inkOf(drawn("HHHH", 0));
    EXPECT_NEAR(wide.right, letters.width("HHHH"), 5); // a side bearing of 3.2, and a pixel
}

TEST(Lettering, what_lies_outside_is_left_out) {
    const Image8 whole = drawn("Heliodon", 20);
    for (const auto& [x, y] : {std::pair{-30, 36}, {180, 36}, {20, 0}, {20, 60}, {900, 900}, {-900, -900}}) {
        const Image8 part = drawn("Heliodon", x, y);
        for (int py = 0; py < 48; ++py) // the same letters, moved
            for (int px = 0; px < 200; ++px) {
                const int fromX = px - x + 20, fromY = py - y + 36;
                const bool known = fromX >= 0 && fromX < 200 && fromY >= 0 && fromY < 48;
                ASSERT_EQ(part.pixel(px, py)[0], known ? whole.pixel(fromX, fromY)[0] : 0);
            }
    }
}

} // namespace
} // namespace heliodon::passes
