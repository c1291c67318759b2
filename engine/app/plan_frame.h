// Where plans of a model's storeys lie on a chart: side by side, to one scale, north and a measure at the
// foot.
#pragma once

#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/app/chart.h"

namespace heliodon::app {

// Seen from above: x right, z down, world metres.
inline glm::dvec2 flat(glm::dvec3 p) {
    return {p.x, p.z};
}

inline constexpr Ink kOpeningInk{60, 150, 255};

// One storey at its place among the others: each as large as all of the model is.
class PlanFrame {
public:
    // `low` and `high` bound the model; `beside`: pixels to the right of all plans, as for a scale of
    // colours.
    PlanFrame(glm::dvec2 low, glm::dvec2 high, size_t storey, size_t storeys, double beside);

    Chart chart() const; // large enough for all storeys
    // Two lines of subtitle at most; what is longer is cut off.
    void title(Chart& chart, const std::string& title, const std::string& subtitle) const;
    void caption(Chart& chart, const std::string& words) const; // above the storey
    // `northDeg`: counter-clockwise from +x; a measure of whole building metres.
    void foot(Chart& chart, double worldPerBuilding, double northDeg) const;
    // A line's meaning at the foot, beside the measure; `at` pixels from where the first one is.
    void key(Chart& chart, glm::dvec2 at, Ink ink, double thickness, const std::string& words) const;
    struct Key {
        Ink ink;
        double thickness;
        std::string words;
    };
    // One beside the other; three have room.
    void keys(Chart& chart, const std::vector<Key>& all) const;

    glm::dvec2 pixel(glm::dvec2 p) const { return origin_ + pixels_ * (p - low_); }
    double pixelsPerWorld() const { return pixels_; }
    glm::dvec2 size() const { return size_; } // pixels, of a storey
    glm::dvec2 scaleAt() const;               // where what stands beside the plans begins
    double scaleHeight() const;
    glm::dvec2 keysAt() const;

private:
    glm::dvec2 low_, size_, origin_, all_; // all_: pixels of all storeys together
    double pixels_, caption_, beside_;
};

} // namespace heliodon::app
