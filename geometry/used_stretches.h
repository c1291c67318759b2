// Which stretches of a wall bound a room.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

namespace heliodon::geometry {

struct Interval {
    double from, to;
};

// Disjoint intervals along the wall's centre line.
class Used {
public:
    void add(Interval added) {
        std::vector<Interval> kept;
        for (const Interval& i : intervals_) {
            if (i.to < added.from || i.from > added.to)
                kept.push_back(i);
            else
                added = {std::min(i.from, added.from), std::max(i.to, added.to)};
        }
        kept.push_back(added);
        intervals_ = std::move(kept);
    }
    double unused(Interval asked) const {
        double rest = asked.to - asked.from;
        for (const Interval& i : intervals_)
            rest -= std::max(0.0, std::min(i.to, asked.to) - std::max(i.from, asked.from));
        return std::max(0.0, rest);
    }
    std::vector<std::pair<double, double>> stretches() const {
        std::vector<std::pair<double, double>> out;
        for (const Interval& i : intervals_) out.emplace_back(i.from, i.to);
        return out;
    }

private:
    std::vector<Interval> intervals_;
};

} // namespace heliodon::geometry
