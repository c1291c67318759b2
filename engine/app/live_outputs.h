// The windows of `live`: one per projector, drawn by the hybrid renderer, and the operator's. All of it in
// one thread, on a device of its own. Once a member throws gpu::Error only `arrangement` and destruction are
// left.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compute/gpu/image.h"
#include "engine/app/run.h"
#include "engine/passes/frame_renderer.h"
#include "engine/present/operator_window.h"
#include "geometry/rig.h"
#include "vision/photograph.h"

namespace heliodon::app {

class LiveOutputs {
public:
    // Opens the windows. A display that is missing is warned of.
    LiveOutputs(Run& run, const geometry::Rig& rig, const LiveArguments& arguments);
    ~LiveOutputs();

    std::vector<present::Event> pollEvents(double waitSeconds);
    // The operator's window is open, and one of a projector.
    bool wanted() const;
    std::string whyNotWanted() const; // which windows were closed, and by whom
    // Throws where that is not so because a display went away, the last of those needed.
    void refuseLoss() const;
    // Some window wants its picture again.
    bool damaged() const;
    bool operatorBusy() const { return operator_->isBusy(); }

    void toggleFullScreen(size_t window);
    void resize(size_t window, int width, int height);
    void close(size_t window);
    // What users have made of the windows, for others in their place.
    struct Arrangement {
        std::vector<std::string> closed; // why; empty: it is open
        std::vector<bool> fullScreen;
    };
    Arrangement arrangement() const;
    void arrange(const Arrangement& like);

    // Projectors whose windows have been closed give their part of the picture to the others. True if there
    // are new ones: the light is to be drawn before anything else is.
    bool leaveOutClosed();
    // What the projectors that are left can do. There is a scene.
    const passes::PaintedPatches& painted() const { return renderer_->scene().painted; }
    // Another room, to be drawn before anything else is.
    void replaceScene(passes::FrameScene scene);
    // Submitted, not waited for.
    void drawLight(const compute::Lighting& light, const passes::Tone& tone);
    // What was drawn is there to be presented without waiting.
    bool drawn() const;
    // What projectors show from the next presentation on; black where light is wanted and there is none yet.
    void choose(present::Shown shown, bool haveLight);
    const gpu::Image* cameraPicture(const std::shared_ptr<const vision::Photograph>& photo);
    // Fills in `outputs` of the status.
    void drawOperator(present::OperatorControls& controls, present::OperatorStatus status,
                      present::OperatorActions& actions);
    // All at once, windows that have lost their picture included.
    void present(bool projectors, bool operatorToo);
    // NAME-projector-0.png ..., NAME-operator.png.
    static std::vector<std::string> snapshotFiles(const geometry::Rig& rig, const std::string& name);
    // What the windows hold after one more presentation, in these files.
    void snapshot(const std::filesystem::path& folder, const std::string& name);

    // Which projector has which display or window.
    std::string inWords() const;
    nlohmann::json report() const;

private:
    std::vector<bool> closedProjectors() const;
    std::string windowName(size_t window) const;
    void followDisplays();
    size_t operatorIndex() const { return rig_.projectors.size(); }
    const gpu::Image* testPicture(size_t projector, present::Shown shown);

    Run& run_;
    const geometry::Rig& rig_;
    std::unique_ptr<gpu::Device> device_;
    std::optional<present::Presenter> presenter_;
    std::unique_ptr<present::OperatorWindow> operator_;
    std::optional<passes::FrameRenderer> renderer_;
    std::vector<const gpu::Image*> light_, chosen_; // per projector
    std::vector<bool> leftOut_;                     // of the renderer's scene
    std::vector<gpu::Image> tests_;
    present::Shown tested_ = present::Shown::light; // what `tests_` hold; light: nothing
    const gpu::Image* operatorPicture_ = nullptr;
    gpu::Image camera_;
    std::shared_ptr<const vision::Photograph> cameraShown_;
    std::chrono::steady_clock::time_point cameraSent_{};
    std::vector<std::string> notices_;  // per window
    std::vector<char> missing_;         // its display, per window
    std::vector<char> saidLost_;        // per window, too
    bool endedByLoss_ = false;          // the loss noticed last left no window that is needed
    std::vector<size_t> displayLosses_; // per window: how often its display was missing
};

} // namespace heliodon::app
