// Every pair of segments whose boxes meet is asked: plans have hundreds of segments, not thousands.
// Predicates are filtered: intervals first, rational numbers where those do not decide.
#include "geometry/plan_arrangement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Fraction_traits.h>
#include <CGAL/Interval_nt.h>

namespace heliodon::geometry {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Exact = CGAL::Exact_rational;
using Interval = CGAL::Interval_nt_advanced; // where the rounding mode is protected

bool before(glm::dvec2 a, glm::dvec2 b) {
    return std::pair(a.x, a.y) < std::pair(b.x, b.y);
}

int orientation(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    if (c == a || c == b) return 0; // no filter can tell
    return CGAL::orientation(Kernel::Point_2(a.x, a.y), Kernel::Point_2(b.x, b.y), Kernel::Point_2(c.x, c.y));
}

// A segment from its lexicographically smaller end.
struct Line {
    glm::dvec2 a, b;
    int32_t tag;
    bool forward; // the caller's segment runs from a to b

    auto key() const { return std::tuple(a.x, a.y, b.x, b.y, tag, forward); }
};

template<class Number> struct Coordinates { Number x, y; };

template<class Number> Number crossOf(const Line& s, const Line& t) {
    return (Number(s.b.x) - s.a.x) * (Number(t.b.y) - t.a.y) -
           (Number(s.b.y) - s.a.y) * (Number(t.b.x) - t.a.x);
}

// Where lines that are not parallel cross.
template<class Number> Coordinates<Number> crossingOf(const Line& s, const Line& t) {
    const Number along = ((Number(t.a.x) - s.a.x) * (Number(t.b.y) - t.a.y) -
                          (Number(t.a.y) - s.a.y) * (Number(t.b.x) - t.a.x)) /
                         crossOf<Number>(s, t);
    return {s.a.x + along * (Number(s.b.x) - s.a.x), s.a.y + along * (Number(s.b.y) - s.a.y)};
}

// The same in whole numbers of what all coordinates are multiples of, in lowest terms once and not at each
// step.
Coordinates<Exact> exactCrossingOf(const Line& s, const Line& t) {
    using Fraction = CGAL::Fraction_traits<Exact>;
    using Whole = Fraction::Numerator_type;
    constexpr int kDigits = std::numeric_limits<double>::digits, kFinest = -900;
    int finest = 0;
    for (const double x : {s.a.x, s.a.y, s.b.x, s.b.y, t.a.x, t.a.y, t.b.x, t.b.y})
        if (x != 0) finest = std::min(finest, std::ilogb(x) - kDigits + 1);
    if (finest < kFinest) return crossingOf<Exact>(s, t); // does not fit
    const auto whole = [&](double x) { return Whole(std::ldexp(x, -finest)); };
    const Whole ax = whole(s.a.x), ay = whole(s.a.y), dx = whole(s.b.x) - ax, dy = whole(s.b.y) - ay,
                bx = whole(t.a.x), by = whole(t.a.y), ex = whole(t.b.x) - bx, ey = whole(t.b.y) - by;
    const Whole below = dx * ey - dy * ex, along = (bx - ax) * ey - (by - ay) * ex;
    const Whole denominator = below * whole(1);
    const auto place = [&](const Whole& a, const Whole& d) -> Exact {
        return Fraction::Compose()(Whole(a * below + along * d), denominator);
    };
    return {place(ax, dx), place(ay, dy)};
}

// An end of a segment, or where two cross.
class Place {
public:
    explicit Place(glm::dvec2 end) : near_{end.x, end.y}, end_(end) {}
    Place(const Line& s, const Line& t) : lines_(&s, &t) {
        const CGAL::Protect_FPU_rounding<true> upwards;
        const Interval turn = crossOf<Interval>(s, t);
        sure_ = turn.inf() > 0 || turn.sup() < 0;
        if (sure_) near_ = crossingOf<Interval>(s, t);
    }

    // Lexicographically: less than 0 where this one comes first.
    int compare(const Place& other) const {
        if (sure_ && other.sure_) {
            if (near_.x.sup() < other.near_.x.inf()) return -1;
            if (near_.x.inf() > other.near_.x.sup()) return 1;
        }
        if (lines_.first == nullptr && other.lines_.first == nullptr)
            return before(end_, other.end_) ? -1 : before(other.end_, end_) ? 1 : 0;
        const auto &p = exact(), &q = other.exact();
        if (const auto x = CGAL::compare(p.x, q.x); x != CGAL::EQUAL) return x;
        return CGAL::compare(p.y, q.y);
    }

    glm::dvec2 rounded() const {
        if (lines_.first == nullptr) return end_;
        return {CGAL::to_double(exact().x), CGAL::to_double(exact().y)};
    }

    const Coordinates<Exact>& exact() const {
        if (!exact_)
            exact_ = lines_.first == nullptr ? Coordinates<Exact>{end_.x, end_.y}
                                             : exactCrossingOf(*lines_.first, *lines_.second);
        return *exact_;
    }

private:
    Coordinates<Interval> near_{0, 0};
    bool sure_ = true; // of near_
    glm::dvec2 end_{};
    std::pair<const Line*, const Line*> lines_{nullptr, nullptr};
    mutable std::optional<Coordinates<Exact>> exact_;
};

class Arranger {
public:
    explicit Arranger(std::span<const PlanSegment> segments) {
        for (const PlanSegment& s : segments) {
            const bool forward = before(s.a, s.b);
            lines_.push_back({forward ? s.a : s.b, forward ? s.b : s.a, s.tag, forward});
        }
        // What is found, to the last bit, does not depend on the order in which segments come.
        std::ranges::sort(lines_, {}, &Line::key);
    }

    PlanArrangement arrange() {
        findPlaces();
        numberPlaces();
        makeEdges();
        sortRound();
        linkHalves();
        nameCells();
        return std::move(out_);
    }

private:
    void add(size_t line, uint32_t place) { on_[line].push_back(place); }

    void findPlaces() {
        on_.resize(lines_.size());
        std::map<std::pair<double, double>, uint32_t> known;
        const auto endAt = [&](glm::dvec2 p) {
            const auto [found, isNew] = known.try_emplace({p.x, p.y}, static_cast<uint32_t>(places_.size()));
            if (isNew) places_.emplace_back(p);
            return found->second;
        };
        std::vector<std::pair<uint32_t, uint32_t>> ends;
        for (size_t i = 0; i < lines_.size(); ++i) {
            ends.emplace_back(endAt(lines_[i].a), endAt(lines_[i].b));
            add(i, ends[i].first);
            add(i, ends[i].second);
        }
        // Lines are sorted by where they begin.
        for (size_t i = 0; i < lines_.size(); ++i)
            for (size_t j = i + 1; j < lines_.size() && lines_[j].a.x <= lines_[i].b.x; ++j) meet(i, j, ends);
    }

    static bool over(double a, double b, double c, double d) {
        return std::max(a, b) >= std::min(c, d) && std::max(c, d) >= std::min(a, b);
    }

    // Line j begins where line i does, or further on.
    void meet(size_t i, size_t j, const std::vector<std::pair<uint32_t, uint32_t>>& ends) {
        const Line &s = lines_[i], &t = lines_[j];
        if (!over(s.a.y, s.b.y, t.a.y, t.b.y)) return;
        const int ta = orientation(s.a, s.b, t.a), tb = orientation(s.a, s.b, t.b);
        if (ta * tb > 0) return;
        const int sa = orientation(t.a, t.b, s.a), sb = orientation(t.a, t.b, s.b);
        if (sa * sb > 0) return;
        if (ta * tb < 0 && sa * sb < 0) {
            const auto place = static_cast<uint32_t>(places_.size());
            places_.emplace_back(s, t);
            add(i, place);
            add(j, place);
            return;
        }
        const auto within = [](glm::dvec2 p, const Line& line) {
            return !before(p, line.a) && !before(line.b, p);
        };
        if (ta == 0 && within(t.a, s)) add(i, ends[j].first);
        if (tb == 0 && within(t.b, s)) add(i, ends[j].second);
        if (sa == 0 && within(s.a, t)) add(j, ends[i].first);
        if (sb == 0 && within(s.b, t)) add(j, ends[i].second);
    }

    // Points by their order from left to right, those above one another from below.
    void numberPlaces() {
        std::vector<uint32_t> order(places_.size()), numberOf(places_.size());
        std::iota(order.begin(), order.end(), 0u);
        std::ranges::sort(order, [&](uint32_t a, uint32_t b) {
            const int c = places_[a].compare(places_[b]);
            return c != 0 ? c < 0 : a < b;
        });
        for (size_t k = 0; k < order.size(); ++k) {
            if (k == 0 || places_[order[k - 1]].compare(places_[order[k]]) != 0) {
                first_.push_back(order[k]);
                out_.points.push_back(places_[order[k]].rounded());
            }
            numberOf[order[k]] = static_cast<uint32_t>(first_.size() - 1);
        }
        for (std::vector<uint32_t>& places : on_) {
            for (uint32_t& place : places) place = numberOf[place];
            std::ranges::sort(places);
        }
    }

    // Between places that follow one another on a line; lines that overlap have the same there.
    void makeEdges() {
        struct Piece {
            uint32_t from, to, line;
        };
        std::vector<Piece> pieces;
        for (uint32_t i = 0; i < on_.size(); ++i)
            for (size_t k = 0; k + 1 < on_[i].size(); ++k)
                if (on_[i][k] != on_[i][k + 1]) pieces.push_back({on_[i][k], on_[i][k + 1], i});
        // As a sweep from left to right ends them, from below.
        std::ranges::sort(pieces, [&](const Piece& p, const Piece& q) {
            if (p.to != q.to) return p.to < q.to;
            if (p.from == q.from) return p.line < q.line;
            return turn(lines_[p.line], lines_[q.line]) < 0;
        });
        for (size_t k = 0; k < pieces.size(); ++k) {
            if (k == 0 ||
                std::pair(pieces[k].from, pieces[k].to) != std::pair(pieces[k - 1].from, pieces[k - 1].to)) {
                out_.target.insert(out_.target.end(), {pieces[k].to, pieces[k].from});
                out_.tags.emplace_back();
                lineOf_.push_back(pieces[k].line);
            }
            out_.tags.back().push_back({lines_[pieces[k].line].tag, lines_[pieces[k].line].forward});
        }
        for (auto& tags : out_.tags)
            std::ranges::sort(tags, {},
                              [](const PlanArrangement::Tag& t) { return std::pair(t.tag, t.forward); });
    }

    const Line& line(uint32_t half) const { return lines_[lineOf_[half / 2]]; }

    // Positive where the second line turns left from the first one, both from left to right.
    static int turn(const Line& s, const Line& t) {
        {
            const CGAL::Protect_FPU_rounding<true> upwards;
            const Interval near = crossOf<Interval>(s, t);
            if (near.inf() > 0) return 1;
            if (near.sup() < 0) return -1;
        }
        return CGAL::sign(crossOf<Exact>(s, t));
    }

    // The half-edges that leave each point, counter-clockwise from straight down.
    void sortRound() {
        const auto halves = static_cast<uint32_t>(out_.target.size());
        round_.resize(halves);
        std::iota(round_.begin(), round_.end(), 0u);
        std::ranges::sort(round_, [&](uint32_t h, uint32_t g) {
            if (out_.source(h) != out_.source(g)) return out_.source(h) < out_.source(g);
            if (h % 2 != g % 2) return h % 2 < g % 2; // to the right, to the left
            return h != g && turn(line(h), line(g)) > 0;
        });
        at_.resize(halves);
        for (uint32_t k = 0; k < halves; ++k) at_[round_[k]] = k;
    }

    // Clockwise after what comes back along the half-edge, so that its cell stays on the left.
    void linkHalves() {
        const auto halves = static_cast<uint32_t>(out_.target.size());
        std::vector<uint32_t> last(out_.points.size());
        for (const uint32_t h : round_) last[out_.source(h)] = h;
        out_.next.resize(halves);
        for (uint32_t h = 0; h < halves; ++h) {
            const uint32_t k = at_[h ^ 1u];
            const bool first = k == 0 || out_.source(round_[k - 1]) != out_.target[h];
            out_.next[h] = first ? last[out_.target[h]] : round_[k - 1];
        }
    }

    // A way round a cell. Its least point has nothing of it to the left: where the angle between what leaves
    // there and what arrives is open to the left, it is the outside of all that hangs together.
    void nameCells() {
        const auto halves = static_cast<uint32_t>(out_.target.size());
        constexpr uint32_t kNone = 0xffffffffu;
        out_.cell.assign(halves, kNone);
        out_.cellCount = 1;
        std::vector<std::pair<uint32_t, uint32_t>> outsides; // least point, half-edge
        for (uint32_t start = 0; start < halves; ++start) {
            if (out_.cell[start] != kNone) continue;
            uint32_t least = kNone;
            for (uint32_t h = start; out_.cell[h] == kNone; h = out_.next[h]) {
                out_.cell[h] = out_.cellCount;
                least = std::min(least, out_.target[h]);
            }
            bool outside = false;
            uint32_t h = start;
            do {
                if (out_.target[h] == least) outside = outside || at_[out_.next[h]] >= at_[h ^ 1u];
                h = out_.next[h];
            } while (h != start);
            if (outside)
                outsides.emplace_back(least, start);
            else
                ++out_.cellCount;
            for (h = start; outside && out_.cell[h] == out_.cellCount; h = out_.next[h])
                out_.cell[h] = kNone - 1;
        }
        // What lies below one begins to the left of it, and has its cell already.
        std::ranges::sort(outsides);
        for (const auto& [least, start] : outsides) {
            const uint32_t cell = cellOver(least);
            uint32_t h = start;
            do {
                out_.cell[h] = cell;
                h = out_.next[h];
            } while (h != start);
        }
    }

    // Of the nearest edge straight below an end of a segment to which nothing comes from the left.
    uint32_t cellOver(uint32_t point) const {
        std::optional<uint32_t> best;
        for (uint32_t h = 0; h < out_.target.size(); h += 2) {
            if (out_.source(h) >= point || out_.target[h] <= point) continue;
            if (orientation(line(h).a, line(h).b, out_.points[point]) <= 0) continue;
            if (!best || isAbove(h, *best)) best = h;
        }
        return best ? out_.cell[*best] : 0;
    }

    // Edges that some line from below to above crosses, and that do not cross one another.
    bool isAbove(uint32_t h, uint32_t g) const {
        if (out_.source(h) == out_.source(g)) return turn(line(g), line(h)) > 0;
        const bool later = out_.source(h) > out_.source(g); // h begins over g, or under it
        const Line& under = line(later ? g : h);
        const Coordinates<Exact>& p = places_[first_[out_.source(later ? h : g)]].exact();
        const Exact side = (Exact(under.b.x) - under.a.x) * (p.y - under.a.y) -
                           (Exact(under.b.y) - under.a.y) * (p.x - under.a.x);
        return (CGAL::sign(side) > 0) == later;
    }

    std::vector<Line> lines_;
    std::vector<Place> places_;
    std::vector<std::vector<uint32_t>> on_; // per line: places
    std::vector<uint32_t> first_;           // per point of the arrangement: a place that is there
    std::vector<uint32_t> lineOf_;          // per edge
    std::vector<uint32_t> round_;           // half-edges by source and direction
    std::vector<uint32_t> at_;              // their places in round_
    PlanArrangement out_;
};

} // namespace

PlanArrangement arrange(std::span<const PlanSegment> segments) {
    return Arranger(segments).arrange();
}

} // namespace heliodon::geometry
