#include "vision/find_target.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <glm/glm.hpp>

#include "vision/grey_picture.h"
#include "vision/homography.h"
#include "vision/saddle.h"

namespace heliodon::vision {
namespace {

constexpr double kAlike = 0.7; // least correlation of a mark with its drawing; clutter stays below 0.5
constexpr size_t kEnough = 40; // marks that make a board: a wrong set of disks gives a handful

// The map from board to picture as far as it is known: the disks' homography, and how far the marks found
// lie off it, which is smooth.
class BoardMap {
public:
    BoardMap(const Homography& homography, const CalibrationTarget& target)
        : homography_(homography), reach_(2 * target.pitch) {}

    void add(glm::dvec2 board, glm::dvec2 pixel) { anchors_.push_back({board, pixel - homography_(board)}); }

    glm::dvec2 pixel(glm::dvec2 board) const { return homography_(board) + correction(board); }

    // d pixel / d board.
    glm::dmat2 slope(glm::dvec2 board, double step) const {
        const glm::dvec2 dx(step, 0), dy(0, step);
        return {(pixel(board + dx) - pixel(board - dx)) / (2 * step),
                (pixel(board + dy) - pixel(board - dy)) / (2 * step)};
    }

    double nearestAnchor(glm::dvec2 board) const {
        double nearest = std::numeric_limits<double>::max();
        for (const Anchor& anchor : anchors_) nearest = std::min(nearest, glm::distance(board, anchor.board));
        return nearest;
    }

private:
    struct Anchor {
        glm::dvec2 board, off;
    };

    // A plane through the anchors nearby, flat where they do not say how it leans.
    glm::dvec2 correction(glm::dvec2 board) const {
        glm::dmat3 matrix(0);
        glm::dmat2x3 right(0);
        double total = 0;
        for (const Anchor& anchor : anchors_) {
            const glm::dvec2 d = (anchor.board - board) / reach_;
            const double weight = std::exp(-0.5 * glm::dot(d, d)) + 1e-9;
            const glm::dvec3 row(d, 1);
            matrix += weight * glm::outerProduct(row, row);
            right[0] += weight * anchor.off.x * row;
            right[1] += weight * anchor.off.y * row;
            total += weight;
        }
        matrix[0][0] += 0.02 * total, matrix[1][1] += 0.02 * total;
        const glm::dmat3 inverse = glm::inverse(matrix);
        return {(inverse * right[0]).z, (inverse * right[1]).z};
    }

    Homography homography_;
    double reach_;
    std::vector<Anchor> anchors_;
};

// What a mark looks like about its point, in squares: -1 dark, 1 bright.
constexpr double kTemplateReach = 1.3;
constexpr int kTemplateSteps = 13;

double templateAt(double u, double v) {
    return u * v > 0 && std::abs(u) < 1 && std::abs(v) < 1 ? -1 : 1;
}

// Correlation coefficient with the drawing, -1..1; 0 out of the picture or on a plain ground.
double likeness(const GreyPicture& picture, glm::dvec2 at, const glm::dmat2& pixelFromSquare) {
    double n = 0, sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
    for (int i = 0; i < kTemplateSteps; ++i)
        for (int j = 0; j < kTemplateSteps; ++j) {
            const glm::dvec2 uv =
                kTemplateReach * (2.0 * glm::dvec2(i + 0.5, j + 0.5) / double(kTemplateSteps) - 1.0);
            const double wanted = templateAt(uv.x, uv.y);
            const double seen = static_cast<double>(picture.at(at + pixelFromSquare * uv));
            n += 1, sx += seen, sy += wanted, sxx += seen * seen, syy += wanted * wanted,
                sxy += seen * wanted;
        }
    const double varianceSeen = sxx / n - sx * sx / (n * n), varianceWanted = syy / n - sy * sy / (n * n);
    if (varianceSeen < 1e-6) return 0; // a quarter of an 8-bit step
    return (sxy / n - sx * sy / (n * n)) / std::sqrt(varianceSeen * varianceWanted);
}

// The best place within `reach` squares, to a quarter of a pixel or so.
std::optional<glm::dvec2> searchMark(const GreyPicture& picture, glm::dvec2 start,
                                     const glm::dmat2& pixelFromSquare, double reach) {
    glm::dvec2 best = start;
    double bestLikeness = 0;
    for (double step = 0.25; step > 0.05; step /= 2, reach = 2 * step) {
        const glm::dvec2 middle = best;
        const int steps = static_cast<int>(std::ceil(reach / step));
        for (int i = -steps; i <= steps; ++i)
            for (int j = -steps; j <= steps; ++j) {
                const glm::dvec2 at = middle + pixelFromSquare * (step * glm::dvec2(i, j));
                const double alike = likeness(picture, at, pixelFromSquare);
                if (alike > bestLikeness) bestLikeness = alike, best = at;
            }
    }
    return bestLikeness > kAlike ? std::optional(best) : std::nullopt;
}

class Grey {
public:
    explicit Grey(GreyPicture picture) : sharp(std::move(picture)) {}

    // As blurred as marks of that size want it for the fit. Made once for all tries of one scale; a wrong set
    // of disks has another, which must not stay for the right one.
    const GreyPicture& softFor(double markPixels) {
        const double wanted = saddleBlur(markPixels);
        if (std::abs(blur_ - wanted) > 0.1 * wanted) soft_ = blurred(sharp, blur_ = wanted);
        return soft_;
    }

    const GreyPicture sharp;

private:
    GreyPicture soft_;
    double blur_ = 0; // pixels
};

// Some of the disks, seen.
using Disks = std::array<const DiskCandidate*, 4>; // null: not seen

// From the disks inwards; a mark that was not found is tried again when more of its neighbours are known.
std::vector<FoundMark> walk(Grey& grey, const CalibrationTarget& target, const Disks& disks,
                            const Homography& homography) {
    BoardMap map(homography, target);
    for (size_t i = 0; i < 4; ++i)
        if (disks[i]) map.add(target.disks[i].at, disks[i]->centre);
    std::vector<int> triesLeft(target.marks.size(), 3);
    std::vector<FoundMark> found;
    const GreyPicture* soft = nullptr; // by the first mark that is seen
    for (bool more = true; more;) {
        more = false;
        std::vector<std::pair<double, size_t>> order; // nearest to what is known first
        for (size_t i = 0; i < target.marks.size(); ++i)
            if (triesLeft[i] > 0) order.emplace_back(map.nearestAnchor(target.marks[i]), i);
        std::sort(order.begin(), order.end());
        for (const auto& [distance, i] : order) {
            if (distance > 2.5 * target.pitch) break; // too far to predict: nearer ones come first
            --triesLeft[i];
            const glm::dvec2 mark = target.marks[i], expected = map.pixel(mark);
            const glm::dmat2 pixelFromSquare = target.square * map.slope(mark, target.square);
            const double size = std::sqrt(std::abs(glm::determinant(pixelFromSquare)));
            if (!grey.sharp.holds(expected, size) || !(size > 2)) continue;
            // Farther is uncertain; a third of the pitch keeps the next mark out.
            const double reach = std::min(0.33 * target.pitch, 0.15 * distance) / target.square;
            const auto start = searchMark(grey.sharp, expected, pixelFromSquare, reach);
            if (!start) continue;
            if (!soft) soft = &grey.softFor(size);
            const auto saddle = refineSaddle(*soft, *start, pixelFromSquare);
            if (!saddle || glm::distance(saddle->pixel, *start) > std::max(1.0, 0.25 * size)) continue;
            map.add(mark, saddle->pixel);
            found.push_back({i, saddle->pixel});
            triesLeft[i] = 0;
            more = true;
            if (found.size() % 8 == 0) break; // order again by what is known now
        }
    }
    std::sort(found.begin(), found.end(), [](const FoundMark& a, const FoundMark& b) { return a.id < b.id; });
    return found;
}

// Whether the marks are where the disks say and the grid's gaps are free: a walk that began beside the grid
// finds marks too, a step off.
bool fits(const Grey& grey, const CalibrationTarget& target, const Disks& disks, const Homography& homography,
          const std::vector<FoundMark>& marks) {
    if (marks.size() < kEnough) return false;
    BoardMap map(homography, target);
    for (const FoundMark& mark : marks) map.add(target.marks[mark.id], mark.pixel);
    for (size_t i = 0; i < 4; ++i) {
        const glm::dvec2 at = target.disks[i].at;
        if (!disks[i]) continue;
        const double pitch =
            target.pitch * std::sqrt(std::abs(glm::determinant(map.slope(at, target.square))));
        if (glm::distance(map.pixel(at), disks[i]->centre) > 0.5 * pitch) return false;
    }
    size_t marksInGaps = 0;
    for (const glm::dvec2& gap : target.gaps)
        marksInGaps +=
            searchMark(grey.sharp, map.pixel(gap), target.square * map.slope(gap, target.square), 0.5)
                .has_value();
    return marksInGaps <= 2;
}

// As printed, the disks go clockwise; a back side or a mirror turns them round.
bool isClockwise(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    const glm::dvec2 u = b - a, v = c - b;
    return u.x * v.y - u.y * v.x > 0;
}

// From four disks, or from three and their sizes.
std::optional<Homography> homographyOf(const CalibrationTarget& target, const Disks& disks) {
    size_t gone = 4;
    std::array<glm::dvec2, 4> board, picture;
    for (size_t i = 0; i < 4; ++i) {
        board[i] = target.disks[i].at;
        if (!disks[i])
            gone = i;
        else
            picture[i] = disks[i]->centre;
    }
    for (size_t i = 0; i < 4; ++i) // the corner between two sides
        if ((gone == 4 || i == (gone + 2) % 4) &&
            !isClockwise(picture[(i + 3) % 4], picture[i], picture[(i + 1) % 4]))
            return std::nullopt;
    if (gone == 4) return homographyThrough(board, picture);
    const size_t a = (gone + 1) % 4, b = (gone + 2) % 4, c = (gone + 3) % 4;
    return homographyFromDisks({board[a], board[b], board[c]}, {picture[a], picture[b], picture[c]},
                               {disks[a]->radius, disks[b]->radius, disks[c]->radius});
}

// Tries the candidates of each disk with one another, that of `without` left out; the first set that fits.
std::optional<FoundTarget> tryDisks(Grey& grey, const CalibrationTarget& target,
                                    const std::array<std::vector<DiskCandidate>, 4>& candidates,
                                    size_t without) {
    std::array<size_t, 4> counts;
    size_t sets = 1;
    for (size_t i = 0; i < 4; ++i) sets *= counts[i] = i == without ? 1 : candidates[i].size();
    for (size_t set = 0; set < sets; ++set) {
        Disks disks{};
        size_t rest = set;
        for (size_t i = 0; i < 4; ++i) {
            if (i != without) disks[i] = &candidates[i][rest % counts[i]];
            rest /= counts[i];
        }
        const auto homography = homographyOf(target, disks);
        if (!homography) continue;
        FoundTarget found{walk(grey, target, disks, *homography), {}, ""};
        if (!fits(grey, target, disks, *homography, found.marks)) continue;
        for (size_t i = 0; i < 4; ++i)
            if (disks[i]) found.disks[i] = disks[i]->centre;
        return found;
    }
    return std::nullopt;
}

// Notes the disks that have candidates.
std::optional<FoundTarget> search(const Photograph& photo, const CalibrationTarget& target,
                                  std::array<bool, 4>& seen) {
    Grey grey(greyOf(photo));
    // Pale print or stray light wants a lower threshold; hands beside a disk a higher one.
    for (const double saturation : {0.5, 0.35, 0.22}) {
        const auto candidates = findDisks(photo, target, saturation);
        for (const size_t without : {4, 0, 1, 2, 3})
            if (auto found = tryDisks(grey, target, candidates, without)) return found;
        for (size_t i = 0; i < 4; ++i) seen[i] = seen[i] || !candidates[i].empty();
    }
    return std::nullopt;
}

Photograph mirrored(const Photograph& photo) {
    Photograph out = photo;
    const auto width = static_cast<size_t>(photo.width), pixels = width * static_cast<size_t>(photo.height);
    for (size_t i = 0; i < pixels; ++i) {
        const size_t from = i - i % width + (width - 1 - i % width);
        for (size_t c = 0; c < 3; ++c) out.rgb[3 * i + c] = photo.rgb[3 * from + c];
    }
    return out;
}

} // namespace

FoundTarget findTarget(const Photograph& photo, const CalibrationTarget& target) {
    constexpr std::array kNames{"red", "green", "blue", "yellow"};
    std::array<bool, 4> seen{};
    if (auto found = search(photo, target, seen)) return *found;
    FoundTarget none;
    for (size_t i = 0; i < 4; ++i)
        if (!seen[i]) none.problem += fmt::format("{}{}", none.problem.empty() ? "no " : ", no ", kNames[i]);
    if (!none.problem.empty()) {
        none.problem += " disk found";
        return none;
    }
    std::array<bool, 4> ignored{};
    none.problem = search(mirrored(photo), target, ignored)
                       ? "the board is seen mirrored: was the picture flipped after it was taken?"
                       : "no marks where its coloured disks should be";
    return none;
}

} // namespace heliodon::vision
