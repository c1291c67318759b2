// What a photograph leaves in doubt: things that may be something else, or more than was seen of them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>

#include "geometry/sketch.h"
#include "vision/detect.h"
#include "vision/plan_view.h"
#include "vision/wall_evidence.h"

namespace heliodon::vision {

// What is said of places in the picture.
class Doubts {
public:
    void add(glm::dvec2 pixel, std::string_view what);

    // One for each matter, as they were met: its first places, and how many more there are.
    std::vector<std::string> lines() const;

private:
    struct Matter {
        std::string what;
        std::vector<glm::dvec2> at; // pixels
    };
    std::vector<Matter> matters_;
};

// The middle of the outline, in pixels; the origin where there is none.
glm::dvec2 centreOf(const geometry::Detection& detection);

// `sketch`: its windows name their walls by index.
void addDoubts(const geometry::Sketch& sketch, const WallEvidence& evidence, const PlanView& view,
               const DetectOptions& options, Doubts& doubts);

} // namespace heliodon::vision
