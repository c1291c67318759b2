// The operator's window: what the outputs show is steered here, and what the program has to say stands here.
// It knows nothing of skies or cameras: it edits the controls and shows the status that it is given.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/passes/false_colour.h"
#include "engine/present/presenter.h"

namespace heliodon::present {

// What OperatorControls::sky says where the hours of a weather file are shown.
constexpr const char* kWeatherFile = "weather";

enum class Shown { light, grid, white, black, identify };

// What the operator decides. The caller keeps it; what the user does in the window changes it.
struct OperatorControls {
    int year = 2026, dayOfYear = 80; // 1..366
    double hour = 13;                // [0, 24)
    double latitudeDeg = 42.73, longitudeDeg = -73.68;
    std::string sky = "clear"; // as --sky has it, or kWeatherFile
    bool skyColour = false;
    bool autoExposure = true;
    double whiteLux = 1000; // where exposure is not automatic
    bool falseColour = false;
    bool playing = false, playDays = false; // plays hours, or days at the same hour
    double speed = 1;                       // hours or days a second
    Shown shown = Shown::light;
};

struct OperatorOutline {
    std::vector<glm::dvec2> points; // pixels of the camera's picture
    std::string label;
    std::array<float, 3> colour{1, 1, 1}; // sRGB, 0..1
};

struct OperatorOutput {
    std::string title, state;
    const gpu::Image* picture = nullptr; // as for Presenter::present
    bool fullScreen = false, open = true;
};

// What there is to say.
struct OperatorStatus {
    std::string clock, date, sun; // "13:00 solar", "21 March", "sun 46 degrees up, ..."
    std::string weather;          // where the weather file is of; empty: there is none
    std::string camera;           // what it is, or why there is none
    bool cameraFails = false;
    std::string working; // what is being done; empty: nothing
    std::string refused; // why the latest sketch is not shown
    std::vector<std::string> warnings;
    std::vector<std::pair<std::string, std::string>> facts;
    double whiteLux = 0; // in use
    std::optional<passes::FalseScale> scale;
    const gpu::Image* cameraPicture = nullptr;
    std::vector<OperatorOutline> outlines;
    std::vector<OperatorOutput> outputs;
};

struct OperatorActions {
    bool quit = false;
    std::vector<size_t> toggleFullScreen; // outputs
};

class OperatorWindow {
public:
    // Draws for one window of the presenter, which outlives it, and listens to it. One at a time.
    OperatorWindow(gpu::Device& device, Presenter& presenter, size_t window);
    ~OperatorWindow();
    OperatorWindow(const OperatorWindow&) = delete;
    OperatorWindow& operator=(const OperatorWindow&) = delete;

    // Handles what the user did since the last call and draws the window anew. The picture is submitted, in
    // TRANSFER_SRC_OPTIMAL, and holds until the next call; null while the window has no area.
    const gpu::Image* draw(OperatorControls& controls, const OperatorStatus& status,
                           OperatorActions& actions);
    // The user is typing into a field: keys are not for the program.
    bool takesKeys() const;
    // A list is open, which the wheel scrolls.
    bool takesWheel() const;
    // The user's hand is in the window: it is to be drawn again soon.
    bool isBusy() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

// What keys and wheel do, a pair a line: for the window and for --help.
const std::vector<std::pair<std::string, std::string>>& operatorKeys();

} // namespace heliodon::present
