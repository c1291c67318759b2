#include "engine/passes/lettering.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#define STBTT_STATIC
#define STB_TRUETYPE_IMPLEMENTATION
#include <stb/stb_truetype.h>

#include "geometry/text_file.h"

// The font's file as it is, so that pictures need nothing that is installed.
__asm__(".pushsection .rodata\n"
        ".balign 16\n"
        ".globl heliodonFont, heliodonFontEnd\n"
        "heliodonFont: .incbin \"" HELIODON_FONT "\"\n"
        "heliodonFontEnd: .byte 0\n"
        ".popsection\n");
extern "C" const unsigned char heliodonFont[], heliodonFontEnd[];

namespace heliodon::passes {

namespace {

struct Font {
    stbtt_fontinfo info{};
    double capital = 1; // height of an H in the font's units

    Font() {
        stbtt_InitFont(&info, heliodonFont, 0);
        int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
        stbtt_GetCodepointBox(&info, 'H', &x0, &y0, &x1, &y1);
        capital = y1;
    }
};

const Font& font() {
    static const Font it;
    return it;
}

struct Glyph {
    int index;
    double x; // pixels along the line
};

// Glyphs of UTF-8 and where they stand; the line's end is the last one's place, and has no glyph.
std::vector<Glyph> laidOut(std::string_view words, double scale) {
    const stbtt_fontinfo& info = font().info;
    const std::string text = geometry::asUtf8(std::string(words));
    std::vector<Glyph> line;
    double x = 0;
    int before = -1;
    for (size_t at = 0; at < text.size();) {
        const auto first = static_cast<unsigned char>(text[at++]);
        const int more = first < 0x80 ? 0 : first < 0xE0 ? 1 : first < 0xF0 ? 2 : 3;
        int code = more == 0 ? first : first & (0x3F >> more);
        for (int i = 0; i < more; ++i) code = code << 6 | (static_cast<unsigned char>(text[at++]) & 0x3F);
        const int index = stbtt_FindGlyphIndex(&info, code);
        if (before >= 0) x += scale * stbtt_GetGlyphKernAdvance(&info, before, index);
        line.push_back({index, x});
        int advance = 0, bearing = 0;
        stbtt_GetGlyphHMetrics(&info, index, &advance, &bearing);
        x += scale * advance;
        before = index;
    }
    line.push_back({-1, x});
    return line;
}

void drawLine(Image8& picture, double x, double y, const std::vector<Glyph>& line, double scale,
              const std::array<uint8_t, 3>& ink) {
    const stbtt_fontinfo& info = font().info;
    const auto size = static_cast<float>(scale);
    std::vector<unsigned char> cover;
    for (const Glyph& glyph : line) {
        if (glyph.index < 0) break;
        const double left = std::floor(x + glyph.x), top = std::floor(y);
        const auto right = static_cast<float>(x + glyph.x - left), down = static_cast<float>(y - top);
        int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
        stbtt_GetGlyphBitmapBoxSubpixel(&info, glyph.index, size, size, right, down, &x0, &y0, &x1, &y1);
        const int width = x1 - x0, height = y1 - y0;
        if (width <= 0 || height <= 0) continue;
        cover.assign(static_cast<size_t>(width) * static_cast<size_t>(height), 0);
        stbtt_MakeGlyphBitmapSubpixel(&info, cover.data(), width, height, width, size, size, right, down,
                                      glyph.index);
        for (int j = 0; j < height; ++j)
            for (int i = 0; i < width; ++i) {
                const int px = static_cast<int>(left) + x0 + i, py = static_cast<int>(top) + y0 + j;
                if (px < 0 || py < 0 || px >= picture.width || py >= picture.height) continue;
                const int share =
                    cover[static_cast<size_t>(j) * static_cast<size_t>(width) + static_cast<size_t>(i)];
                uint8_t* to = picture.pixel(px, py);
                for (size_t c = 0; c < 3; ++c)
                    to[c] = static_cast<uint8_t>((to[c] * (255 - share) + ink[c] * share + 127) / 255);
            }
    }
}

} // namespace

std::span<const uint8_t> fontFile() {
    return {heliodonFont, heliodonFontEnd};
}

double Lettering::width(std::string_view words) const {
    return laidOut(words, capital / font().capital).back().x;
}

void Lettering::shrinkTo(double room, std::string_view words) {
    capital *= std::min(1.0, room / width(words));
}

void Lettering::draw(Image8& picture, double x, double y, std::string_view words) const {
    const double scale = capital / font().capital;
    const std::vector<Glyph> line = laidOut(words, scale);
    constexpr int kDirections = 16;
    for (int k = 0; halo > 0 && k < kDirections; ++k) {
        const double angle = 2 * std::numbers::pi * k / kDirections;
        drawLine(picture, x + halo * std::cos(angle), y + halo * std::sin(angle), line, scale,
                 {255, 255, 255});
    }
    drawLine(picture, x, y, line, scale, ink);
}

void Lettering::drawCentred(Image8& picture, double x, double y, std::string_view words) const {
    draw(picture, x - 0.5 * width(words), y + 0.5 * capital, words);
}

} // namespace heliodon::passes
