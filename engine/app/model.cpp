#include <optional>

#include <fmt/format.h>

#include "engine/app/commands.h"
#include "engine/app/in_words.h"
#include "engine/app/refused_plan.h"
#include "engine/app/room_plan.h"
#include "engine/app/scene_input.h"
#include "geometry/input_error.h"
#include "geometry/model_file.h"

namespace heliodon::app {

namespace {

void drawPlan(Run& run, const ModelArguments& arguments, const Scene& scene) {
    roomPlan(scene, run.report(), arguments.scene.input.filename().string()).write(arguments.plan);
}

// The file stands in the title, and not before `why` once more.
void drawRefused(const ModelArguments& arguments, const geometry::RefusedModel& model, std::string why) {
    const std::filesystem::path& file = arguments.scene.input;
    if (why.starts_with(file.string() + ":")) why.erase(0, file.string().size() + 1);
    refusedPlan(model, model.northDeg - arguments.scene.northDeg, file.filename().string(), why)
        .write(arguments.plan);
}

// What is refused is drawn, too: a plan says more of it than a sentence.
Scene loadOrDraw(Run& run, const ModelArguments& arguments) {
    SceneSource source = readSource(run, arguments.scene);
    Scene drawn;
    if (!arguments.plan.empty()) drawn.sketch = source.sketch;
    if (drawn.sketch && drawn.sketch->north) drawn.northDeg = drawn.sketch->north->dirDeg;
    drawn.northDeg -= arguments.scene.northDeg;
    std::optional<geometry::RefusedModel> model;
    OnRefusal keep;
    if (!arguments.plan.empty()) keep = [&](const geometry::RefusedModel& refused) { model = refused; };
    try {
        return makeScene(run, arguments.scene, std::move(source.rig), std::move(source.sketch), keep);
    } catch (const geometry::InputError& error) {
        if (drawn.sketch)
            drawPlan(run, arguments, drawn);
        else if (model)
            drawRefused(arguments, *model, error.what());
        if (drawn.sketch || model) run.note("the plan shows what was refused: " + arguments.plan.string());
        throw;
    }
}

} // namespace

void execute(Run& run, const ModelArguments& arguments) {
    const std::string extension = arguments.output.extension().string();
    if (extension != ".obj" && extension != ".glb")
        throw geometry::InputError(arguments.output.string(), "", "a model is written as .obj or .glb");
    refuseNoDrawing(arguments.plan);
    const Scene scene = loadOrDraw(run, arguments);
    const StageTimer timer(run, "write");
    geometry::writeModel(scene.mesh, arguments.output, scene.northDeg);
    if (!arguments.plan.empty()) drawPlan(run, arguments, scene);
    const nlohmann::json& report = run.report();
    double floor = 0;
    for (const nlohmann::json& room : report["rooms"]) floor += room["floor_area"].get<double>();
    run.note(fmt::format("{}, {:.0f} ft2 of floor, {}, {}, {}", counted(report["n_rooms"], "room"), floor,
                         counted(report["n_windows"], "window"),
                         counted(report["n_skylight_panes"], "skylight pane"),
                         counted(scene.mesh.patchCount(), "triangle")));
}

} // namespace heliodon::app
