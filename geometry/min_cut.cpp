#include "geometry/min_cut.h"

#include <algorithm>
#include <limits>

namespace heliodon::geometry {

namespace {

struct Arc {
    uint32_t to;
    int64_t left;
};

class Flow {
public:
    explicit Flow(uint32_t nodes) : out_(nodes), level_(nodes), cursor_(nodes) {}

    void add(uint32_t a, uint32_t b, int64_t forward, int64_t backward) {
        out_[a].push_back(static_cast<uint32_t>(arcs_.size()));
        arcs_.push_back({b, forward});
        out_[b].push_back(static_cast<uint32_t>(arcs_.size()));
        arcs_.push_back({a, backward});
    }

    void run(uint32_t source, uint32_t sink) {
        while (levels(source)[sink] >= 0) {
            std::ranges::fill(cursor_, 0u);
            while (push(source, sink, std::numeric_limits<int64_t>::max()) > 0) {
            }
        }
    }

    const std::vector<int>& levels(uint32_t source) {
        std::ranges::fill(level_, -1);
        level_[source] = 0;
        std::vector<uint32_t> queue{source};
        for (size_t i = 0; i < queue.size(); ++i)
            for (const uint32_t arc : out_[queue[i]])
                if (arcs_[arc].left > 0 && level_[arcs_[arc].to] < 0) {
                    level_[arcs_[arc].to] = level_[queue[i]] + 1;
                    queue.push_back(arcs_[arc].to);
                }
        return level_;
    }

private:
    int64_t push(uint32_t node, uint32_t sink, int64_t limit) {
        if (node == sink) return limit;
        for (; cursor_[node] < out_[node].size(); ++cursor_[node]) {
            const uint32_t arc = out_[node][cursor_[node]];
            const uint32_t to = arcs_[arc].to;
            if (arcs_[arc].left <= 0 || level_[to] != level_[node] + 1) continue;
            const int64_t pushed = push(to, sink, std::min(limit, arcs_[arc].left));
            if (pushed == 0) continue;
            arcs_[arc].left -= pushed;
            arcs_[arc ^ 1u].left += pushed;
            return pushed;
        }
        return 0;
    }

    std::vector<Arc> arcs_;
    std::vector<std::vector<uint32_t>> out_;
    std::vector<int> level_;
    std::vector<uint32_t> cursor_;
};

} // namespace

std::vector<bool> MinCut::sourceSide() const {
    const uint32_t source = nodes_, sink = nodes_ + 1;
    Flow flow(nodes_ + 2);
    for (uint32_t i = 0; i < nodes_; ++i) {
        if (toSource_[i] > 0) flow.add(source, i, toSource_[i], 0);
        if (toSink_[i] > 0) flow.add(i, sink, toSink_[i], 0);
    }
    for (const Link& link : links_) flow.add(link.a, link.b, link.capacity, link.capacity);
    flow.run(source, sink);
    const std::vector<int>& reached = flow.levels(source);
    std::vector<bool> side(nodes_);
    for (uint32_t i = 0; i < nodes_; ++i) side[i] = reached[i] >= 0;
    return side;
}

} // namespace heliodon::geometry
