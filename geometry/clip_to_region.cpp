#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "geometry/perpendicular.h"
#include "geometry/ray_crossing.h"
#include "geometry/region_mesh.h"
#include "geometry/segment_distance.h"

namespace heliodon::geometry {

namespace {

// The border of a region by rows as high as its edges are long.
class BorderRows {
public:
    explicit BorderRows(std::span<const Segment> border) : border_(border) {
        double length = 0, high = -1e300;
        for (const auto& [a, b] : border) {
            low_ = std::min({low_, a.y, b.y});
            high = std::max({high, a.y, b.y});
            length += glm::length(b - a);
        }
        height_ = std::max(length / static_cast<double>(border.size()), 1e-3 * (high - low_));
        count_ = static_cast<int>((high - low_) / height_) + 1;
        first_.assign(static_cast<size_t>(count_) + 1, 0);
        for (const auto& [a, b] : border) eachRow(a.y, b.y, [&](size_t r) { ++first_[r + 1]; });
        for (size_t r = 1; r < first_.size(); ++r) first_[r] += first_[r - 1];
        edges_.resize(first_.back());
        std::vector<uint32_t> at(first_.begin(), first_.end() - 1);
        for (uint32_t e = 0; e < border.size(); ++e)
            eachRow(border[e][0].y, border[e][1].y, [&](size_t r) { edges_[at[r]++] = e; });
    }

    // Inside, and not on the border.
    bool wellInside(glm::dvec2 p) const {
        bool in = false, on = false;
        eachEdge(p.y, p.y, [&](uint32_t e) {
            const auto& [a, b] = border_[e];
            if (rayCrosses(p, a, b)) in = !in;
            if (std::min(a.y, b.y) > p.y + kSameInRegion || std::max(a.y, b.y) < p.y - kSameInRegion) return;
            on = on || distanceToSegment(p, a, b) <= kSameInRegion;
        });
        return in && !on;
    }

    // Edges that come within kSameInRegion of the heights between; from several rows, some more than once.
    template<class Visit> void eachEdge(double from, double to, Visit visit) const {
        for (int r = row(std::min(from, to)); r <= row(std::max(from, to)); ++r)
            for (uint32_t k = first_[static_cast<size_t>(r)]; k < first_[static_cast<size_t>(r) + 1]; ++k)
                visit(edges_[k]);
    }

    const Segment& edge(uint32_t e) const { return border_[e]; }

private:
    int row(double y) const { return std::clamp(static_cast<int>((y - low_) / height_), 0, count_ - 1); }
    template<class Visit> void eachRow(double from, double to, Visit visit) const {
        const int last = row(std::max(from, to) + kSameInRegion);
        for (int r = row(std::min(from, to) - kSameInRegion); r <= last; ++r) visit(static_cast<size_t>(r));
    }

    std::span<const Segment> border_;
    double low_ = 1e300, height_ = 1;
    int count_ = 1;
    std::vector<uint32_t> first_, edges_;
};

// Cuts one segment where it meets the border.
class SegmentClipper {
public:
    SegmentClipper(std::span<const Segment> border, std::vector<Cut>& out) : border_(border), out_(out) {}

    void clip(const Segment& segment) {
        a_ = segment[0];
        length_ = glm::length(segment[1] - segment[0]);
        if (!(length_ > kSameInRegion)) return;
        along_ = (segment[1] - segment[0]) / length_;
        low_ = glm::min(segment[0], segment[1]) - kSameInRegion;
        high_ = glm::max(segment[0], segment[1]) + kSameInRegion;
        stops_.clear();
        border_.eachEdge(low_.y, high_.y, [&](uint32_t e) { meet(static_cast<int>(e)); });
        join();
        for (size_t k = 0; k + 1 < stops_.size(); ++k) {
            const double from = stops_[k].at, to = stops_[k + 1].at;
            if (to - from > kSameInRegion && border_.wellInside(place(0.5 * (from + to))))
                out_.push_back({endAt(stops_[k]), endAt(stops_[k + 1])});
        }
    }

private:
    struct Stop {
        double at = 0; // metres along the segment
        int edge = -1;
        double t = 0;
        bool corner() const { return edge >= 0 && (t == 0 || t == 1); }
    };

    glm::dvec2 place(double at) const { return a_ + at * along_; }

    CutEnd endAt(const Stop& stop) const {
        if (stop.edge < 0) return {place(stop.at), -1, 0};
        const auto& [p, q] = border_.edge(static_cast<uint32_t>(stop.edge));
        return {p + stop.t * (q - p), stop.edge, stop.t};
    }

    void stop(double at, int edge, double t, double edgeLength) {
        if (at < -kSameInRegion || at > length_ + kSameInRegion) return;
        if (t * edgeLength <= kSameInRegion) t = 0;
        if ((1 - t) * edgeLength <= kSameInRegion) t = 1;
        stops_.push_back({std::clamp(at, 0.0, length_), edge, t});
    }

    void meet(int i) {
        const auto& [p, q] = border_.edge(static_cast<uint32_t>(i));
        if (std::max(p.x, q.x) < low_.x || std::max(p.y, q.y) < low_.y || std::min(p.x, q.x) > high_.x ||
            std::min(p.y, q.y) > high_.y)
            return;
        const glm::dvec2 e = q - p;
        const double size = glm::length(e), sp = cross(along_, p - a_), sq = cross(along_, q - a_);
        if (std::abs(sp) <= kSameInRegion) stop(glm::dot(p - a_, along_), i, 0, size);
        if (std::abs(sq) <= kSameInRegion) stop(glm::dot(q - a_, along_), i, 1, size);
        if (sp * sq < 0) {
            const double t = sp / (sp - sq);
            stop(glm::dot(p + t * e - a_, along_), i, t, size);
        }
        for (const double at : {0.0, length_}) { // ends that touch at a small angle
            const double t = std::clamp(glm::dot(place(at) - p, e) / (size * size), 0.0, 1.0);
            if (glm::length(place(at) - p - t * e) <= kSameInRegion) stop(at, i, t, size);
        }
    }

    // Stops at one place become one, at a corner if any is; the segment's own ends are stops too.
    void join() {
        std::ranges::sort(stops_, [](const Stop& s, const Stop& o) {
            return std::pair(s.at, s.edge) < std::pair(o.at, o.edge);
        });
        joined_.clear();
        if (stops_.empty() || stops_[0].at > kSameInRegion) joined_.push_back({0, -1, 0});
        for (const Stop& s : stops_)
            if (!joined_.empty() && joined_.back().edge >= 0 && s.at - joined_.back().at <= kSameInRegion) {
                if (s.corner() && !joined_.back().corner()) joined_.back() = s;
            } else {
                joined_.push_back(s);
            }
        if (joined_.back().at < length_ - kSameInRegion) joined_.push_back({length_, -1, 0});
        stops_.swap(joined_);
    }

    BorderRows border_;
    std::vector<Cut>& out_;
    glm::dvec2 a_{}, along_{}, low_{}, high_{};
    double length_ = 0;
    std::vector<Stop> stops_, joined_;
};

} // namespace

std::vector<Cut> clipToRegion(std::span<const Segment> segments, std::span<const Segment> borderEdges) {
    std::vector<Cut> cuts;
    if (borderEdges.empty()) return cuts;
    SegmentClipper clipper(borderEdges, cuts);
    for (const Segment& segment : segments) clipper.clip(segment);
    return cuts;
}

} // namespace heliodon::geometry
