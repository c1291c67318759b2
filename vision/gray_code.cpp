#include "vision/gray_code.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <glm/glm.hpp>

#include "vision/homography.h"
#include "vision/lens_solver.h"
#include "vision/median.h"
#include "vision/saddle.h"

namespace heliodon::vision {
namespace {

// Of white less black where the projector shines: 2.5 steps of 8 bits, and 3 % of the brightest, which is
// more than what a dark floor beside the plane returns.
constexpr float kLeastLight = 0.01f, kLeastShare = 0.03f;
constexpr float kSure = 0.2f;          // of white less black: the least difference of a bit from its inverse
constexpr size_t kLeastPixels = 6;     // decided, of a cell
constexpr double kLeastCell = 4;       // camera pixels along a cell
constexpr double kLeastDecided = 0.25; // of the light: what a blur of a pixel leaves of such cells

int bitsFor(int count) {
    int bits = 0;
    while ((1 << bits) < count) ++bits;
    return bits;
}

unsigned grayOf(unsigned index) {
    return index ^ (index >> 1);
}

unsigned indexOf(unsigned gray) {
    for (unsigned shift = 1; shift < 32; shift *= 2) gray ^= gray >> shift;
    return gray;
}

bool bitAt(const PatternSet& set, bool column, int bit, int pixel) {
    const int cells = (column ? set.columns() : set.rows());
    return (column ? set.columnBits() : set.rowBits()) > 0 && pixel / set.cell < cells &&
           (grayOf(static_cast<unsigned>(pixel / set.cell)) >> bit & 1u) != 0;
}

// Of the stripes that the bit makes.
int edgesOf(const PatternSet& set, bool column, int bit) {
    int edges = 0;
    for (int cell = 1; cell < (column ? set.columns() : set.rows()); ++cell)
        edges += bitAt(set, column, bit, cell * set.cell) != bitAt(set, column, bit, (cell - 1) * set.cell);
    return edges;
}

// The cell of every camera pixel that is lit, as finely as it is sure of.
class CellMap {
public:
    CellMap(GreyPicture light, float least)
        : light_(std::move(light)), columns_(light_.values.size(), 0u), rows_(columns_) {
        for (const float value : light_.values) {
            unsureBits_.push_back(value > least ? 0 : kDark);
            lit_ += value > least;
        }
    }

    // A bit of column or row, the lowest being 0.
    void add(bool column, int bit, const GreyPicture& pattern, const GreyPicture& inverse) {
        std::vector<unsigned>& codes = column ? columns_ : rows_;
        BitSeen& seen = seen_.emplace_back(BitSeen{column, bit});
        std::vector<int8_t> sign(codes.size(), 0); // 0: dark or undecided
        for (size_t i = 0; i < codes.size(); ++i) {
            const float difference = pattern.values[i] - inverse.values[i];
            const bool isSure = std::abs(difference) >= kSure * light_.values[i];
            if (!isSure)
                unsureBits_[i] = std::max(unsureBits_[i], bit + 1);
            else if (difference > 0)
                codes[i] |= 1u << bit;
            if (unsureBits_[i] == kDark) continue;
            seen.undecided += !isSure;
            if (isSure) sign[i] = difference > 0 ? 1 : -1;
        }
        const auto width = static_cast<size_t>(light_.width);
        for (size_t i = width; i < sign.size(); ++i)
            seen.changes += (i % width > 0 && sign[i] * sign[i - 1] < 0) || sign[i] * sign[i - width] < 0;
    }

    // What a bit's picture and its inverse cannot be, beside those of the bits before and after it.
    std::vector<std::string> doubts(const PatternSet& set) const {
        constexpr double kMost = 0.3, kFewer = 0.5, kFewerEdges = 0.8; // of the light; of the coarser's
        constexpr int kLeastEdges = 2;                                 // one may lie aslant, or unseen
        const auto lit = static_cast<double>(lit_);
        const auto nameOf = [](const BitSeen& seen) {
            return fmt::format("{}_bit{}", seen.column ? 'x' : 'y', seen.bit);
        };
        std::vector<std::string> out;
        for (size_t i = 0; i + 1 < seen_.size(); ++i)
            for (size_t j = i + 1; j < seen_.size() && seen_[j].column == seen_[i].column; ++j) {
                const BitSeen &coarse = seen_[i], &fine = seen_[j];
                const auto undecided = static_cast<double>(coarse.undecided);
                if (undecided > kMost * lit && static_cast<double>(fine.undecided) < kFewer * undecided) {
                    out.push_back(
                        fmt::format("{} and its inverse leave {:.0f} % of the light undecided, finer "
                                    "patterns less: are they pictures of that pattern?",
                                    nameOf(coarse), 100 * undecided / lit));
                    break;
                }
                const bool decided = std::max(undecided, static_cast<double>(fine.undecided)) < kMost * lit;
                if (decided && edgesOf(set, coarse.column, coarse.bit) >= kLeastEdges &&
                    static_cast<double>(fine.changes) < kFewerEdges * static_cast<double>(coarse.changes)) {
                    out.push_back(fmt::format("{} has more stripes than {}, expected fewer: were their "
                                              "pictures exchanged?",
                                              nameOf(coarse), nameOf(fine)));
                    break;
                }
            }
        return out;
    }

    // How many of the lowest bits are to be left out, so that cells are resolved; 0 where nothing helps.
    int unresolvedBits(const PatternSet& set) const {
        const double cellPixels = std::sqrt(static_cast<double>(lit_) / (set.columns() * set.rows()));
        for (int bits = 0; bits + 2 <= std::min(set.columnBits(), set.rowBits()); ++bits) {
            const auto decided =
                std::ranges::count_if(unsureBits_, [&](int unsure) { return unsure <= bits; });
            if (cellPixels * (1 << bits) >= kLeastCell &&
                static_cast<double>(decided) >= kLeastDecided * static_cast<double>(lit_))
                return bits;
        }
        return 0;
    }

    // Pixels of each cell of `set`, `bits` of whose code have been left out: their middle, by coordinate;
    // none where too few are seen.
    std::vector<std::optional<glm::dvec2>> middles(const PatternSet& set, int bits) {
        std::vector<std::vector<glm::ivec2>> pixels(static_cast<size_t>(set.columns() * set.rows()));
        for (int y = 0; y < light_.height; ++y)
            for (int x = 0; x < light_.width; ++x) {
                const size_t i =
                    static_cast<size_t>(y) * static_cast<size_t>(light_.width) + static_cast<size_t>(x);
                if (unsureBits_[i] > bits) continue;
                const unsigned column = indexOf(columns_[i] >> bits), row = indexOf(rows_[i] >> bits);
                if (column >= static_cast<unsigned>(set.columns()) ||
                    row >= static_cast<unsigned>(set.rows()))
                    continue;
                pixels[row * static_cast<unsigned>(set.columns()) + column].emplace_back(x, y);
                ++decoded_;
            }
        std::vector<std::optional<glm::dvec2>> out;
        for (const auto& cell : pixels) {
            out.emplace_back();
            if (cell.size() < kLeastPixels) continue;
            std::vector<double> x, y;
            for (const glm::ivec2& p : cell) x.push_back(p.x), y.push_back(p.y);
            out.back() = glm::dvec2(median(std::move(x)), median(std::move(y)));
        }
        return out;
    }

    size_t lit() const { return lit_; }
    size_t decoded() const { return decoded_; }
    const GreyPicture& light() const { return light_; }

private:
    static constexpr int kDark = 32; // more than there are bits
    struct BitSeen {
        bool column;
        int bit;
        size_t undecided = 0, changes = 0; // pixels that are lit; with a neighbour of the other value
    };
    GreyPicture light_;
    std::vector<unsigned> columns_, rows_; // Gray codes
    std::vector<int> unsureBits_;          // from the lowest up to the highest that is unsure
    std::vector<BitSeen> seen_;            // columns, then rows, the coarsest first
    size_t lit_ = 0, decoded_ = 0;
};

GreyPicture difference(GreyPicture a, const GreyPicture& b) {
    for (size_t i = 0; i < a.values.size(); ++i) a.values[i] -= b.values[i];
    return a;
}

// The checkerboard as if the surface were lit evenly: from -1 to 1. A gradient of light would draw the saddle
// along.
GreyPicture evenCheckers(const GreyPicture& checkers, const GreyPicture& light, float least) {
    GreyPicture out = checkers;
    for (size_t i = 0; i < out.values.size(); ++i)
        out.values[i] =
            light.values[i] > least ? std::clamp(out.values[i] / light.values[i], -1.5f, 1.5f) : 0.0f;
    return out;
}

// The checkerboard of a bit of columns and rows that is not shown as such: it is lit where one of both is.
GreyPicture checkersOf(const GreyPicture& columns, const GreyPicture& rows) {
    GreyPicture out = columns;
    for (size_t i = 0; i < out.values.size(); ++i) out.values[i] *= -rows.values[i];
    return out;
}

float leastLight(const GreyPicture& light) {
    std::vector<float> sample;
    for (size_t i = 0; i < light.values.size(); i += 37) sample.push_back(light.values[i]);
    if (sample.empty()) return kLeastLight;
    return std::max(kLeastLight, kLeastShare * ranked(sample, sample.size() * 99 / 100));
}

// The corner at the middle of four cells: projector coordinates of the cells' middles, seen there by the
// camera.
std::optional<PatternCorner> cornerOf(const GreyPicture& checkers, const PatternSet& set, int column, int row,
                                      const std::vector<std::optional<glm::dvec2>>& middles) {
    std::array<glm::dvec2, 4> cells, seen;
    for (size_t i = 0; i < 4; ++i) {
        const int dx = i == 1 || i == 2, dy = i >= 2; // round the corner
        const auto& middle = middles[static_cast<size_t>((row + dy) * set.columns() + column + dx)];
        if (!middle) return std::nullopt;
        cells[i] = glm::dvec2(dx - 0.5, dy - 0.5);
        seen[i] = *middle;
    }
    const auto cameraFromCells = homographyThrough(cells, seen);
    if (!cameraFromCells) return std::nullopt;
    const glm::dvec2 expected = (*cameraFromCells)({0, 0});
    // A checkerboard's square is two cells.
    const glm::dmat2 pixelFromSquare((*cameraFromCells)({0.5, 0}) - (*cameraFromCells)({-0.5, 0}),
                                     (*cameraFromCells)({0, 0.5}) - (*cameraFromCells)({0, -0.5}));
    const auto saddle = refineSaddle(checkers, expected, 2.0 * pixelFromSquare);
    const double size = std::sqrt(std::abs(glm::determinant(pixelFromSquare)));
    // Whole contrast bends by 1 or more over the window; a half lit corner by less.
    if (!saddle || saddle->strength < 0.5 ||
        glm::distance(saddle->pixel, expected) > std::max(1.0, 0.35 * size))
        return std::nullopt;
    return PatternCorner{glm::dvec2(column + 1, row + 1) * double(set.cell) - 0.5, saddle->pixel};
}

} // namespace

int PatternSet::columnBits() const {
    return bitsFor(columns());
}

int PatternSet::rowBits() const {
    return bitsFor(rows());
}

std::vector<std::string> PatternSet::names() const {
    std::vector<std::string> out{"white", "black"};
    const auto add = [&](std::string name) {
        out.push_back(name);
        out.push_back(std::move(name) + "_inv");
    };
    for (int bit = columnBits() - 1; bit >= 0; --bit) add(fmt::format("x_bit{}", bit));
    for (int bit = rowBits() - 1; bit >= 0; --bit) add(fmt::format("y_bit{}", bit));
    add("xor_lsb");
    return out;
}

Photograph drawPattern(const PatternSet& set, const std::string& name) {
    const bool inverse = name.ends_with("_inv");
    const std::string plain = inverse ? name.substr(0, name.size() - 4) : name;
    const bool isBit = plain.starts_with("x_bit") || plain.starts_with("y_bit");
    const int bit = isBit ? std::stoi(plain.substr(5)) : 0;
    Photograph out{set.width, set.height, {}, name};
    out.rgb.reserve(static_cast<size_t>(set.width) * static_cast<size_t>(set.height) * 3);
    for (int y = 0; y < set.height; ++y)
        for (int x = 0; x < set.width; ++x) {
            const bool lit = isBit                ? bitAt(set, plain[0] == 'x', bit, plain[0] == 'x' ? x : y)
                             : plain == "xor_lsb" ? bitAt(set, true, 0, x) != bitAt(set, false, 0, y)
                                                  : plain == "white";
            out.rgb.insert(out.rgb.end(), 3, lit != inverse ? 255 : 0);
        }
    return out;
}

DecodedPatterns decodePatterns(const PatternSet& set,
                               const std::function<GreyPicture(const std::string&)>& read) {
    GreyPicture light = difference(read("white"), read("black"));
    const float least = leastLight(light);
    CellMap cells(std::move(light), least);
    const auto nameOf = [](char axis, int bit) { return fmt::format("{}_bit{}", axis, bit); };
    for (const char axis : {'x', 'y'})
        for (int bit = (axis == 'x' ? set.columnBits() : set.rowBits()) - 1; bit >= 0; --bit)
            cells.add(axis == 'x', bit, read(nameOf(axis, bit)), read(nameOf(axis, bit) + "_inv"));
    const int bits = cells.unresolvedBits(set);
    const PatternSet used{set.width, set.height, set.cell << bits};

    DecodedPatterns out;
    out.cell = used.cell;
    out.doubts = cells.doubts(set);
    const auto middles = cells.middles(used, bits);
    const double pixels = static_cast<double>(std::max<size_t>(cells.light().values.size(), 1));
    out.litShare = static_cast<double>(cells.lit()) / pixels;
    out.decodedShare =
        static_cast<double>(cells.decoded()) / static_cast<double>(std::max<size_t>(cells.lit(), 1));
    std::vector<float> lit = cells.light().values;
    std::erase_if(lit, [&](float value) { return value <= least; });
    if (!lit.empty()) out.contrast = static_cast<double>(median(std::move(lit)));
    const double cellPixels = std::sqrt(static_cast<double>(cells.lit()) / (used.columns() * used.rows()));
    const auto even = [&](const std::string& name) {
        return evenCheckers(difference(read(name), read(name + "_inv")), cells.light(), least);
    };
    const GreyPicture checkers =
        blurred(bits == 0 ? even("xor_lsb") : checkersOf(even(nameOf('x', bits)), even(nameOf('y', bits))),
                saddleBlur(2 * cellPixels));
    // The last Gray bit changes between an even cell and the next.
    for (int row = 0; row + 1 < used.rows(); row += 2)
        for (int column = 0; column + 1 < used.columns(); column += 2)
            if (const auto corner = cornerOf(checkers, used, column, row, middles))
                out.corners.push_back(*corner);
    return out;
}

} // namespace heliodon::vision
