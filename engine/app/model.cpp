#include <fmt/format.h>

#include "engine/app/commands.h"
#include "engine/app/in_words.h"
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
    const nlohmann::json& report = run.report();
    double floor = 0;
    for (const nlohmann::json& room : report["rooms"]) floor += room["floor_area"].get<double>();
    run.note(fmt::format("{}, {:.0f} ft2 of floor, {}, {}, {}", counted(report["n_rooms"], "room"), floor,
                         counted(report["n_windows"], "window"),
                         counted(report["n_skylight_panes"], "skylight pane"),
                         counted(scene.mesh.patchCount(), "triangle")));
}

} // namespace heliodon::app
