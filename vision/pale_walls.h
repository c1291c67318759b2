// Walls whose paint is too pale to be told from shadows by itself, as glare, wear or turned-down colours
// leave it.
#pragma once

#include <vector>

#include "geometry/sketch.h"
#include "vision/color_classes.h"
#include "vision/components.h"
#include "vision/doubts.h"
#include "vision/plan_view.h"
#include "vision/wall_fit.h"

namespace heliodon::vision {

// What vivid paint gave.
struct VividReading {
    const std::vector<StraightWall>& straight;
    const geometry::Sketch& sketch;               // its arcs and tokens
    const std::vector<const Component*>& markers; // those on none of its walls
};

struct PaleWalls {
    std::vector<StraightWall> straight;
    std::vector<geometry::Arc> arcs;
    std::vector<const Component*> otherMarkers; // of the vivid reading's, those on none of these walls
};

// Strips that have all else of a wall: both white ends, a face's foot where one is seen, and no wall or token
// that was read beside them. Each, and each window on one, is a doubt. `image`: its paint is that which is
// faint, too. `radius` of the table: inches.
PaleWalls readPaleWalls(const VividReading& read, const ClassImage& image, const PlanView& view,
                        const DetectOptions& options, double radius, Doubts& doubts);

} // namespace heliodon::vision
