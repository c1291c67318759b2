#include <fmt/format.h>

#include "engine/app/commands.h"
#include "engine/app/light_report.h"
#include "engine/app/moment.h"
#include "engine/app/pictures.h"
#include "engine/app/projector_reach.h"
#include "engine/app/scene_input.h"
#include "engine/passes/image_file.h"

namespace heliodon::app {

namespace {

void renderPreviews(Run& run, passes::FrameRenderer& renderer, const compute::Lighting& light,
                    const RenderArguments& arguments) {
    passes::PreviewOptions options;
    options.tone = toned(options.tone, arguments.picture, false);
    const StageTimer timer(run, "render");
    passes::writePng(renderer.preview(light, options), arguments.output / "preview.png");
    if (arguments.picture.exr)
        passes::writeExr(renderer.previewHdr(light, options), arguments.output / "preview.exr");
    if (!arguments.picture.falseColor) return;
    options.tone = toned(options.tone, arguments.picture, true);
    passes::writePng(renderer.preview(light, options), arguments.output / "false-color.png");
}

void renderProjectors(Run& run, passes::FrameRenderer& renderer, const compute::Lighting& light,
                      const RenderArguments& arguments) {
    passes::ProjectorOptions options;
    options.tone = toned(options.tone, arguments.picture, false);
    const StageTimer timer(run, "render");
    const std::vector<passes::Image8> pictures = renderer.projectors(light, options);
    for (size_t p = 0; p < pictures.size(); ++p)
        passes::writePng(pictures[p], arguments.output / fmt::format("projector-{}.png", p));
    if (!arguments.picture.exr) return;
    const std::vector<passes::ImageF> linear = renderer.projectorsHdr(light, options);
    for (size_t p = 0; p < linear.size(); ++p)
        passes::writeExr(linear[p], arguments.output / fmt::format("projector-{}.exr", p));
}

} // namespace

void execute(Run& run, const RenderArguments& arguments) {
    const Scene scene = loadScene(run, arguments.scene);
    const SkySource source(run, arguments.moment, scene);
    const daylight::Sky sky = source.skyAt(source.moment());
    prepareFolder(arguments.output);
    const auto transport = makeTransport(run, scene.mesh);
    const compute::Moment moment = std::move(solveLight(run, *transport, std::span(&sky, 1))[0]);
    passes::FrameRenderer renderer = makeRenderer(run, scene);
    const LightFigures figures = lightFigures(scene.mesh, moment);
    run.report()["light"] = {
        {"mean_lux", figures.meanLux},
        {"max_lux", figures.maxLux},
        {"glare_ratio", figures.glareRatio},
        {"white_lux", arguments.picture.exposure.value_or(renderer.autoWhite(moment.lighting))}};
    renderPreviews(run, renderer, moment.lighting, arguments);
    if (scene.rig) {
        renderProjectors(run, renderer, moment.lighting, arguments);
        reportReach(run, scene);
        if (isPhotograph(arguments.scene.input))
            drawReachOverlay(scene, arguments.scene.input, arguments.output / "overlay.png");
    } else
        run.skipped("projector pictures: no rig was given");
}

} // namespace heliodon::app
