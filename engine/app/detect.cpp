#include "vision/detect.h"

#include <fmt/format.h>

#include "engine/app/commands.h"
#include "engine/app/in_words.h"
#include "engine/app/overlay_tags.h"
#include "engine/app/scene_input.h"
#include "geometry/input_error.h"
#include "geometry/rig.h"
#include "geometry/sketch.h"
#include "geometry/text_file.h"

namespace heliodon::app {
namespace {

// Says which of the formats it is, where it says so itself: sketches and rigs are mistaken for one another.
[[noreturn]] void refuseJson(const std::filesystem::path& file) {
    constexpr const char* kExpected = "a photograph (.png .jpg .tif)";
    const auto json = geometry::readJson(file, kExpected);
    const auto format = json.is_object() ? json.find("format") : json.end();
    const std::string is = format != json.end() && format->is_string() ? format->get<std::string>() : "JSON";
    throw geometry::InputError(file.string(), "", fmt::format("is {}, expected {}", is, kExpected));
}

} // namespace

void execute(Run& run, const DetectArguments& arguments) {
    SceneArguments scene;
    scene.input = arguments.photo;
    if (scene.input.extension() == ".json") refuseJson(scene.input);
    if (!arguments.overlay.empty() && arguments.overlay.extension() != ".png")
        throw geometry::InputError("--overlay", arguments.overlay.string(), "is written as .png");
    const geometry::Rig rig = loadRig(run, arguments.rig);
    const geometry::Sketch sketch = loadSketch(run, scene, rig);
    if (!sketch.north) run.assume(kAssumedNorth);
    if (!arguments.overlay.empty())
        writeOverlay(vision::readPhotograph(arguments.photo), rig, sketch, arguments.overlay);
    geometry::writeSketch(sketch, arguments.output);
    run.note("found " + inWords(sketch));
}

} // namespace heliodon::app
