#include "geometry/min_cut.h"

#include <algorithm>

namespace heliodon::geometry {

// What is left of all capacities while flow is pushed. Sinks stand at several distances from the source: all
// are served in one phase, after which each is farther away than before.
class MinCut::Flow {
public:
    Flow(const MinCut& graph, std::vector<int64_t> fromSource, std::vector<int64_t> toSink)
        : graph_(graph), left_(graph.capacity_), fromSource_(std::move(fromSource)),
          toSink_(std::move(toSink)), level_(fromSource_.size()), cursor_(fromSource_.size()) {
        queue_.reserve(fromSource_.size());
        for (size_t v = 0; v < fromSource_.size(); ++v) {
            const int64_t through = std::min(fromSource_[v], toSink_[v]);
            fromSource_[v] -= through;
            toSink_[v] -= through;
        }
    }

    std::vector<bool> run() {
        while (reachesSink()) {
            std::copy(graph_.first_.begin(), graph_.first_.end() - 1, cursor_.begin());
            for (uint32_t v = 0; v < fromSource_.size(); ++v)
                while (fromSource_[v] > 0) {
                    const int64_t pushed = push(v, fromSource_[v]);
                    if (pushed == 0) break;
                    fromSource_[v] -= pushed;
                }
        }
        std::vector<bool> side(level_.size());
        for (size_t v = 0; v < side.size(); ++v) side[v] = level_[v] >= 0;
        return side;
    }

private:
    // Distances from the source in what is left.
    bool reachesSink() {
        std::ranges::fill(level_, -1);
        queue_.clear();
        for (uint32_t v = 0; v < fromSource_.size(); ++v)
            if (fromSource_[v] > 0) {
                level_[v] = 0;
                queue_.push_back(v);
            }
        bool any = false;
        for (size_t i = 0; i < queue_.size(); ++i) {
            const uint32_t v = queue_[i];
            any |= toSink_[v] > 0;
            for (uint32_t a = graph_.first_[v]; a < graph_.first_[v + 1]; ++a) {
                const uint32_t to = graph_.arcs_[a].to;
                if (left_[a] <= 0 || level_[to] >= 0) continue;
                level_[to] = level_[v] + 1;
                queue_.push_back(to);
            }
        }
        return any;
    }

    int64_t push(uint32_t v, int64_t limit) {
        if (toSink_[v] > 0) {
            const int64_t pushed = std::min(limit, toSink_[v]);
            toSink_[v] -= pushed;
            return pushed;
        }
        for (uint32_t& a = cursor_[v]; a < graph_.first_[v + 1]; ++a) {
            const auto [to, back] = graph_.arcs_[a];
            if (left_[a] <= 0 || level_[to] != level_[v] + 1) continue;
            const int64_t pushed = push(to, std::min(limit, left_[a]));
            if (pushed == 0) continue;
            left_[a] -= pushed;
            left_[back] += pushed;
            return pushed;
        }
        return 0;
    }

    const MinCut& graph_;
    std::vector<int64_t> left_; // per arc
    std::vector<int64_t> fromSource_, toSink_;
    std::vector<int> level_;
    std::vector<uint32_t> cursor_, queue_;
};

MinCut::MinCut(uint32_t nodes, const std::vector<Link>& links)
    : arcs_(2 * links.size()), first_(nodes + 1, 0), capacity_(2 * links.size()) {
    for (const Link& link : links) {
        ++first_[link.a + 1];
        ++first_[link.b + 1];
    }
    for (uint32_t v = 0; v < nodes; ++v) first_[v + 1] += first_[v];
    std::vector<uint32_t> place(first_.begin(), first_.end() - 1);
    for (const Link& link : links) {
        const uint32_t there = place[link.a]++, back = place[link.b]++;
        arcs_[there] = {link.b, back};
        arcs_[back] = {link.a, there};
        capacity_[there] = capacity_[back] = link.capacity;
    }
}

std::vector<bool> MinCut::sourceSide(std::vector<int64_t> fromSource, std::vector<int64_t> toSink) const {
    return Flow(*this, std::move(fromSource), std::move(toSink)).run();
}

} // namespace heliodon::geometry
