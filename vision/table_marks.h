// What lies flat on the table: skylight markers, material tokens and the north arrow.
#pragma once

#include <optional>
#include <vector>

#include "geometry/sketch.h"
#include "vision/color_classes.h"
#include "vision/components.h"
#include "vision/plan_view.h"

namespace heliodon::vision {

// A rectangle of light-blue card; none when the region is no rectangle.
std::optional<geometry::Skylight> fitSkylight(const Component& component, const PlanView& view,
                                              const DetectOptions& options);

// A faint rim, of pale colour that shadows and blur have too, must be seen all round.
enum class TokenLook { vivid, faint };

// A coloured square rim with a white ring and a paint chip within; none when the region is no such rim.
std::optional<geometry::Token> fitToken(const Component& component, const ClassImage& image,
                                        const PlanView& view, const DetectOptions& options,
                                        TokenLook look = TokenLook::vivid);

// Whether the region lies in one of the tokens: it is a part of its rim or chip, whatever its colour.
bool liesWithin(const std::vector<geometry::Token>& tokens, const Component& region, const PlanView& view,
                const DetectOptions& options);

// An arrow: longer than wide, one end broader than the other. None for every other shape.
std::optional<geometry::NorthArrow> fitArrow(const Component& component, const PlanView& view,
                                             const DetectOptions& options);

} // namespace heliodon::vision
