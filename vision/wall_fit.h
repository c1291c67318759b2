// Straight walls with the window markers on them, and curved walls, from connected regions of paint.
#pragma once

#include <optional>
#include <vector>

#include "geometry/sketch.h"
#include "vision/color_classes.h"
#include "vision/components.h"
#include "vision/plan_view.h"

namespace heliodon::vision {

// One straight wall: the pieces of its paint that are seen, and the markers that cover the rest.
struct Chain {
    Paint paint = Paint::none;            // red, blue or green
    std::vector<const Component*> pieces; // of the wall's own paint; not empty
    std::vector<const Component*> markers;
};

struct Chains {
    std::vector<Chain> chains;
    std::vector<const Component*> orphans; // markers that touch no wall
};

// Groups wall paint and markers that continue one another along one line.
Chains formChains(const std::vector<const Component*>& wallPieces,
                  const std::vector<const Component*>& markers, const PlanView& view,
                  const DetectOptions& options);

struct StraightWall {
    geometry::Wall wall;
    std::vector<geometry::WindowMarker> windows; // `wall` is left empty
};

// None when the chain is not a straight strip of a wall's thickness at its height.
std::optional<StraightWall> fitStraight(const Chain& chain, const PlanView& view,
                                        const DetectOptions& options);

// A wall for each piece where the face below a marker shows a joint; the whole wall where none does. Where
// one of the others stands against the face it is that which is seen.
std::vector<StraightWall> splitAtJoints(const StraightWall& whole, const std::vector<geometry::Wall>& others,
                                        const PlanView& view, const DetectOptions& options);

// The wall's top in the picture, white ends included.
std::vector<glm::dvec2> wallOutline(const geometry::Wall& wall, const PlanView& view);

// The marker's coloured top.
std::vector<glm::dvec2> windowOutline(const geometry::Wall& wall, const geometry::WindowMarker& window,
                                      const PlanView& view, const DetectOptions& options);

// None when the paint does not follow a circle's arc.
std::optional<geometry::Arc> fitArc(const Chain& chain, const PlanView& view, const DetectOptions& options);

// That a region is one straight strip or one arc as it is.
bool isStripOrArc(const Component& region, const PlanView& view, const DetectOptions& options);

// The width of a straight or a curved strip of wall paint, whatever it is, up to a quarter of an inch more or
// less than the options' thickness. None where either side is not seen along most of it.
std::optional<double> straightWidth(const Chain& chain, const PlanView& view, const DetectOptions& options);
std::optional<double> arcWidth(const Chain& chain, const PlanView& view, const DetectOptions& options);

// The region without what is wider than any joint of walls, in connected parts. All of it where nothing is.
std::vector<Component> thinParts(const Component& component, const PlanView& view,
                                 const DetectOptions& options);

// Walls that touch make one region that is neither: the straight strips within it, largest first.
std::vector<Component> splitStrips(const Component& component, const PlanView& view,
                                   const DetectOptions& options);

// Standard deviation across a wall's paint, in inches: the lens and the mosaic widen it by a pixel.
double stripSpread(const PlanView& view, glm::dvec2 plan, double height, const DetectOptions& options);

// That a strip of paint between two measured sides is as wide as a wall's.
bool isWallThickness(double measured, const PlanView& view, glm::dvec2 plan, double height,
                     const DetectOptions& options);

geometry::HeightClass heightClassOf(Paint wallPaint);

} // namespace heliodon::vision
