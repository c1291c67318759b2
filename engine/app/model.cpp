#include "engine/app/commands.h"
#include "engine/app/scene_input.h"
#include "geometry/input_error.h"
#include "geometry/model_file.h"

namespace heliodon::app {

void execute(Run& run, const ModelArguments& arguments) {
    const std::string extension = arguments.output.extension().string();
    if (extension != ".obj" && extension != ".glb")
        throw geometry::InputError(arguments.output.string(), "", "a model is written as .obj or .glb");
    const Scene scene = loadScene(run, arguments.scene);
    const StageTimer timer(run, "write");
    geometry::writeModel(scene.mesh, arguments.output, scene.northDeg);
}

} // namespace heliodon::app
