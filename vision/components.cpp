#include "vision/components.h"

#include <algorithm>

#include "geometry/disjoint_sets.h"

namespace heliodon::vision {
namespace {

struct LabelledRun {
    Run run;
    Paint group;
    int minority;
};

std::vector<LabelledRun> findRuns(const ClassImage& image) {
    std::vector<LabelledRun> runs;
    for (int j = 0; j < image.height; ++j) {
        const Paint* row = image.paint.data() + static_cast<size_t>(j) * static_cast<size_t>(image.width);
        for (int i = 0; i < image.width;) {
            if (row[i] == Paint::none) {
                ++i;
                continue;
            }
            const Paint group = groupOf(row[i]);
            const int begin = i;
            int minority = 0;
            for (; i < image.width && row[i] != Paint::none && groupOf(row[i]) == group; ++i)
                minority += row[i] != group;
            runs.push_back({{j + image.y0, begin + image.x0, i + image.x0}, group, minority});
        }
    }
    return runs;
}

} // namespace

std::vector<Component> findComponents(const ClassImage& image, int minArea) {
    const auto runs = findRuns(image);
    geometry::DisjointSets sets(runs.size());
    size_t above = 0; // first run of the row above that may still touch
    for (size_t i = 0; i < runs.size(); ++i) {
        const Run& run = runs[i].run;
        while (above < i && (runs[above].run.y < run.y - 1 ||
                             (runs[above].run.y == run.y - 1 && runs[above].run.x1 <= run.x0)))
            ++above;
        for (size_t k = above; k < i && runs[k].run.y == run.y - 1 && runs[k].run.x0 < run.x1; ++k)
            if (runs[k].group == runs[i].group) {
                // The earlier run stays the root, so that the order of components is that of their first
                // runs.
                const uint32_t a = sets.root(static_cast<uint32_t>(k)),
                               b = sets.root(static_cast<uint32_t>(i));
                sets.join(std::max(a, b), std::min(a, b));
            }
    }
    std::vector<int> area(runs.size(), 0);
    for (size_t i = 0; i < runs.size(); ++i)
        area[sets.root(static_cast<uint32_t>(i))] += runs[i].run.x1 - runs[i].run.x0;
    std::vector<Component> out;
    std::vector<size_t> place(runs.size());
    for (size_t i = 0; i < runs.size(); ++i) {
        const size_t root = sets.root(static_cast<uint32_t>(i));
        if (area[root] < minArea) continue;
        if (root == i) {
            place[i] = out.size();
            out.push_back({});
            out.back().group = runs[i].group;
        }
        Component& component = out[place[root]];
        const Run& run = runs[i].run;
        const int n = run.x1 - run.x0;
        component.runs.push_back(run);
        component.area += n;
        component.minorityArea += runs[i].minority;
        component.centre += static_cast<double>(n) * glm::dvec2(0.5 * (run.x0 + run.x1 - 1), run.y);
    }
    for (Component& component : out) component.centre /= component.area;
    return out;
}

} // namespace heliodon::vision
