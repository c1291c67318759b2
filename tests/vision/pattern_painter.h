// What a camera sees of a projector's patterns on a level board.
#pragma once

#include <string>

#include "geometry/rig.h"
#include "vision/gray_code.h"

namespace heliodon::vision {

struct PatternScene {
    geometry::OpticalDevice camera, projector;
    PatternSet patterns;
    double height = 0;      // of the board, metres
    double boardHalf = 0.5; // metres; beside it the patterns fall on the table, y = 0
    double tableWhite = 0;  // its reflectance over the board's
    double ambient = 0.01, blackLevel = 0.004, noise = 0, gamma = 1, exposure = 0.5;
};

// The camera's pictures of a scene's patterns; each is painted when it is asked for.
class PatternPainter {
public:
    explicit PatternPainter(const PatternScene& scene);
    GreyPicture operator()(const std::string& name) const;

private:
    struct Sample {
        int x = -1, y = -1; // projector pixel; -1: none
        float light = 0;
    };
    const PatternScene& scene_;
    std::vector<Sample> samples_;
};

// Looks from `centre` to `at`; `up` is what the picture shows upwards.
geometry::OpticalDevice deviceLooking(glm::dvec3 centre, glm::dvec3 at, glm::dvec3 up,
                                      const geometry::Lens& lens, int width, int height);

} // namespace heliodon::vision
