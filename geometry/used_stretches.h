// Stretches of a wall, and which of them bound a room.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

namespace heliodon::geometry {

// Inches along a straight wall, or the middle of a curved one.
struct Stretch {
    double from = 0, to = 0;
    double length() const { return to - from; }
};

// Disjoint stretches along the wall's centre line.
class Used {
public:
    void add(Stretch added) {
        std::vector<Stretch> kept;
        for (const Stretch& i : stretches_) {
            if (i.to < added.from || i.from > added.to)
                kept.push_back(i);
            else
                added = {std::min(i.from, added.from), std::max(i.to, added.to)};
        }
        kept.push_back(added);
        stretches_ = std::move(kept);
    }
    double unused(Stretch asked) const {
        double rest = asked.length();
        for (const Stretch& i : stretches_)
            rest -= std::max(0.0, std::min(i.to, asked.to) - std::max(i.from, asked.from));
        return std::max(0.0, rest);
    }
    std::vector<std::pair<double, double>> stretches() const {
        std::vector<std::pair<double, double>> out;
        for (const Stretch& i : stretches_) out.emplace_back(i.from, i.to);
        return out;
    }

private:
    std::vector<Stretch> stretches_;
};

} // namespace heliodon::geometry
