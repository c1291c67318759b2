#include "vision/detect.h"
#include "engine/app/commands.h"
#include "engine/app/in_words.h"
#include "engine/app/overlay_tags.h"
#include "engine/app/scene_input.h"
#include "geometry/input_error.h"
#include "geometry/rig.h"
#include "geometry/sketch.h"

namespace heliodon::app {

void execute(Run& run, const DetectArguments& arguments) {
    SceneArguments scene;
    scene.input = arguments.photo;
    if (scene.input.extension() == ".json")
        throw geometry::InputError(scene.input.string(), "",
                                   "is a sketch already, expected a photograph (.png .jpg .tif)");
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
