#include "vision/steady_sketch.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

namespace heliodon::vision {

namespace {

using namespace geometry;

double turn(double a, double b, double period = 360) {
    return std::abs(std::remainder(a - b, period));
}

class Comparison {
public:
    explicit Comparison(const SteadyOptions& options) : o_(options) {}

    bool near(glm::dvec2 a, glm::dvec2 b) const { return glm::distance(a, b) <= o_.inches; }
    bool near(double a, double b) const { return std::abs(a - b) <= o_.inches; }

    bool alike(const Wall& a, const Wall& b) const {
        return a.heightClass == b.heightClass && near(a.a, b.a) && near(a.b, b.b) &&
               near(a.thickness, b.thickness);
    }
    bool alike(const Arc& a, const Arc& b) const {
        const double inchesPerDegree = a.radius * 0.0174533;
        return a.heightClass == b.heightClass && near(a.center, b.center) && near(a.radius, b.radius) &&
               turn(a.a0Deg, b.a0Deg) * inchesPerDegree <= o_.inches &&
               turn(a.a1Deg, b.a1Deg) * inchesPerDegree <= o_.inches;
    }
    bool alike(const WindowMarker& a, const WindowMarker& b) const {
        const auto wall = wallBefore.find(b.wall);
        return a.kind == b.kind && wall != wallBefore.end() && wall->second == a.wall && near(a.pos, b.pos) &&
               near(a.width, b.width);
    }
    bool alike(const Skylight& a, const Skylight& b) const {
        return near(a.center, b.center) && near(a.size, b.size) && turn(a.angleDeg, b.angleDeg) <= o_.degrees;
    }
    bool alike(const Token& a, const Token& b) const {
        for (size_t c = 0; c < 3; ++c)
            if (std::abs(a.rgb[c] - b.rgb[c]) > o_.colourSteps) return false;
        return a.kind == b.kind && glm::distance(a.pos, b.pos) <= o_.tokenInches;
    }

    // Values of the sketch before where one is alike, with the names and outlines of now. True when the two
    // lists hold the same things.
    template<class T, class Found>
    bool takeOver(const std::vector<T>& before, std::vector<T>& fresh, Found found) const {
        std::vector<bool> used(before.size());
        size_t taken = 0;
        for (T& item : fresh)
            for (size_t i = 0; i < before.size(); ++i) {
                if (used[i] || !alike(before[i], item)) continue;
                used[i] = true;
                ++taken;
                T old = before[i];
                found(old, item);
                old.id = item.id;
                old.detection = item.detection;
                item = std::move(old);
                break;
            }
        return taken == before.size() && taken == fresh.size();
    }

    std::map<std::string, std::string> wallBefore; // by the name that it has now

private:
    const SteadyOptions& o_;
};

} // namespace

SteadySketch steadied(const Sketch& before, const Sketch& fresh, const SteadyOptions& options) {
    Comparison comparison(options);
    SteadySketch out{fresh};
    Sketch& now = out.sketch;
    const auto nothing = [](const auto&, const auto&) {};
    const bool walls = comparison.takeOver(before.walls, now.walls, [&](const Wall& old, const Wall& item) {
        comparison.wallBefore[item.id] = old.id;
    });
    const bool arcs = comparison.takeOver(before.arcs, now.arcs, nothing);
    const bool windows =
        comparison.takeOver(before.windows, now.windows,
                            [](WindowMarker& old, const WindowMarker& item) { old.wall = item.wall; });
    const bool skylights = comparison.takeOver(before.skylights, now.skylights, nothing);
    out.sameGeometry = walls && arcs && windows && skylights;
    out.sameMaterials = comparison.takeOver(before.tokens, now.tokens, nothing);
    out.sameNorth = before.north.has_value() == now.north.has_value() &&
                    (!now.north || turn(before.north->dirDeg, now.north->dirDeg) <= options.degrees);
    if (out.sameNorth && now.north) now.north->dirDeg = before.north->dirDeg;
    if (out.sameGeometry) { // in the old order too: what is made of them must not change
        now.walls = before.walls, now.arcs = before.arcs;
        now.windows = before.windows, now.skylights = before.skylights;
        if (out.sameMaterials) now.tokens = before.tokens;
    }
    return out;
}

} // namespace heliodon::vision
