#include "geometry/wall_face.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace heliodon::geometry {

namespace {

enum Heading : int { east, north, west, south };
constexpr std::array<std::array<int, 2>, 4> kStep{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

class GridTracer {
public:
    GridTracer(uint32_t columns, uint32_t rows, const std::vector<int>& labels, const std::vector<bool>& keep)
        : columns_(static_cast<int>(columns)), rows_(static_cast<int>(rows)), labels_(labels), keep_(keep),
          seen_(labels.size() * 4, false) {
        findPinches();
        findComponents();
    }

    std::vector<GridFace> faces() {
        for (int row = 0; row < rows_; ++row)
            for (int column = 0; column < columns_; ++column)
                for (int heading = 0; heading < 4; ++heading) {
                    const size_t cell = index(column, row);
                    if (labels_[cell] < 0 || seen_[cell * 4 + static_cast<size_t>(heading)] ||
                        !isBoundary(column, row, heading))
                        continue;
                    const auto [place, isNew] = faceOf_.try_emplace(component_[cell], faces_.size());
                    if (isNew) faces_.push_back({labels_[cell], {}});
                    faces_[place->second].loops.push_back(trace(column, row, heading));
                }
        for (GridFace& face : faces_)
            std::ranges::stable_sort(face.loops, std::greater(), [](const auto& loop) { return area(loop); });
        return std::move(faces_);
    }

private:
    size_t index(int column, int row) const { return static_cast<size_t>(row * columns_ + column); }

    int at(int column, int row) const {
        const bool in = column >= 0 && row >= 0 && column < columns_ && row < rows_;
        return in ? static_cast<int>(component_[index(column, row)]) : -1;
    }

    // Where a face would touch itself in a point it is cut in two, from top to bottom.
    void findPinches() {
        for (int row = 1; row < rows_; ++row)
            for (int column = 1; column < columns_; ++column) {
                const int low = labels_[index(column - 1, row - 1)],
                          lowRight = labels_[index(column, row - 1)], high = labels_[index(column - 1, row)],
                          highRight = labels_[index(column, row)];
                if (low == highRight && low != high && low != lowRight) cut_.insert({column, low});
                if (high == lowRight && high != low && high != highRight) cut_.insert({column, high});
            }
    }

    void findComponents() {
        component_.resize(labels_.size());
        std::iota(component_.begin(), component_.end(), size_t{0});
        const auto find = [&](size_t c) {
            while (component_[c] != c) c = component_[c] = component_[component_[c]];
            return c;
        };
        for (int row = 0; row < rows_; ++row)
            for (int column = 0; column < columns_; ++column) {
                const size_t c = index(column, row);
                if (column > 0 && labels_[c] == labels_[c - 1] && !cut_.contains({column, labels_[c]}))
                    component_[find(c)] = find(c - 1);
                if (row > 0 && labels_[c] == labels_[index(column, row - 1)])
                    component_[find(c)] = find(index(column, row - 1));
            }
        for (size_t c = 0; c < component_.size(); ++c) component_[c] = find(c);
    }

    // The edge of the cell that runs with `heading`, the cell on its left: east below, north on the right,
    // ...
    bool isBoundary(int column, int row, int heading) const {
        const auto step = kStep[static_cast<size_t>((heading + 3) % 4)]; // to the right of the heading
        return at(column + step[0], row + step[1]) != at(column, row);
    }

    static GridPoint start(int column, int row, int heading) {
        return {static_cast<uint32_t>(column + (heading == north || heading == west)),
                static_cast<uint32_t>(row + (heading == west || heading == south))};
    }

    std::vector<GridPoint> trace(int column, int row, int heading) {
        std::vector<GridPoint> loop;
        int lastHeading = -1;
        const int firstColumn = column, firstRow = row, firstHeading = heading;
        do {
            seen_[index(column, row) * 4 + static_cast<size_t>(heading)] = true;
            const GridPoint point = start(column, row, heading);
            const size_t vertex = point.row * static_cast<size_t>(columns_ + 1) + point.column;
            if (heading != lastHeading || (!keep_.empty() && keep_[vertex])) loop.push_back(point);
            lastHeading = heading;
            // Left turn inside the same cell, straight on into the next one, or right turn.
            if (isBoundary(column, row, (heading + 1) % 4)) {
                heading = (heading + 1) % 4;
                continue;
            }
            const auto ahead = kStep[static_cast<size_t>(heading)];
            column += ahead[0];
            row += ahead[1];
            if (isBoundary(column, row, heading)) continue;
            const auto right = kStep[static_cast<size_t>((heading + 3) % 4)];
            column += right[0];
            row += right[1];
            heading = (heading + 3) % 4;
        } while (column != firstColumn || row != firstRow || heading != firstHeading);
        // The walk may have begun in the middle of a straight edge.
        const size_t first = loop[0].row * static_cast<size_t>(columns_ + 1) + loop[0].column;
        if (heading == lastHeading && (keep_.empty() || !keep_[first])) loop.erase(loop.begin());
        return loop;
    }

    static double area(const std::vector<GridPoint>& loop) {
        double sum = 0;
        for (size_t i = 0; i < loop.size(); ++i) {
            const GridPoint &p = loop[i], &q = loop[(i + 1) % loop.size()];
            sum += static_cast<double>(p.column) * q.row - static_cast<double>(q.column) * p.row;
        }
        return sum;
    }

    int columns_, rows_;
    const std::vector<int>& labels_;
    const std::vector<bool>& keep_;
    std::vector<bool> seen_;
    std::set<std::pair<int, int>> cut_; // column and label of faces that are parted there
    std::vector<size_t> component_;
    std::map<size_t, size_t> faceOf_;
    std::vector<GridFace> faces_;
};

} // namespace

std::vector<GridFace> gridFaces(uint32_t columns, uint32_t rows, const std::vector<int>& labels,
                                const std::vector<bool>& keep) {
    return GridTracer(columns, rows, labels, keep).faces();
}

} // namespace heliodon::geometry
