// What stands where in the operator's window. Internal to engine/present.
#pragma once

#include <optional>
#include <vector>

#include "engine/passes/label_places.h"
#include "engine/present/operator_window.h"

namespace heliodon::present {

// A picture to be put under the drawing, pixels of the window.
struct PlacedPicture {
    const gpu::Image* picture = nullptr;
    float left = 0, top = 0, right = 0, bottom = 0;
};

// Where labels were placed, to be kept until they or the picture change.
struct LabelsKept {
    std::vector<passes::Label> labels;
    std::vector<passes::Line> lines;
    passes::Box within;
    std::vector<std::optional<passes::Box>> boxes; // none: left out
};

// Sets the style and loads the fonts; once, before the first frame.
void styleOperatorWindow();

// Between ImGui::NewFrame and ImGui::Render.
std::vector<PlacedPicture> layOutOperatorWindow(OperatorControls& controls, const OperatorStatus& status,
                                                OperatorActions& actions, LabelsKept& kept);

// The ground behind everything, sRGB.
constexpr float kOperatorGround[3] = {0.085f, 0.09f, 0.105f};

} // namespace heliodon::present
