// What is paint in a region of which much is only tinted.
#pragma once

#include <optional>

#include "vision/color_classes.h"
#include "vision/components.h"
#include "vision/plan_view.h"

namespace heliodon::vision {

// The part of a region of `image` whose P' is high, where it falls into one that is vivid and one that is
// pale: shade that another light tints, or colour that a file or a lens smeared. None where it is of one
// kind.
std::optional<ClassImage> vividPart(const Component& region, const ClassImage& image, const PlanView& view);

// The pixels of that paint in a region of `image`.
ClassImage partOf(const Component& region, const ClassImage& image, Paint paint);

// The part with blue paint of a region of which a good part is light blue, as where a wall stands before a
// skylight. None where either is next to nothing.
std::optional<ClassImage> bluePart(const Component& region, const ClassImage& image);

} // namespace heliodon::vision
