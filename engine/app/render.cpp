#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "engine/app/commands.h"
#include "engine/app/contact_sheet.h"
#include "engine/app/light_report.h"
#include "engine/app/moment.h"
#include "engine/app/pictures.h"
#include "engine/app/projector_reach.h"
#include "engine/app/scene_input.h"
#include "engine/app/sky_tint.h"
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

std::vector<std::string> listOf(const std::string& text) {
    std::vector<std::string> items;
    std::istringstream in(text);
    for (std::string item; std::getline(in, item, ',');) items.push_back(item);
    return items;
}

// Hours of apparent solar time on a few days of the year, as in figure 11 of the paper; one exposure for all.
void renderSheet(Run& run, passes::FrameRenderer& renderer, compute::DaylightTransport& transport,
                 const SkySource& source, const RenderArguments& arguments) {
    const std::vector<std::string> days =
                                       listOf(arguments.days.empty() ? "06-21,03-21,12-21" : arguments.days),
                                   hours =
                                       listOf(arguments.hours.empty() ? "7,9,11,13,15,17" : arguments.hours);
    std::vector<daylight::Sky> skies;
    std::vector<std::string> columns;
    for (const std::string& day : days)
        for (const std::string& hour : hours) {
            const std::string clock =
                (hour.size() == 1 ? "0" + hour : hour) + (hour.size() <= 2 ? ":00" : "");
            const std::string date =
                day.size() <= 5 ? fmt::format("{:04}-{}", source.moment().date.year, day) : day;
            skies.push_back(
                source.skyAt(daylight::parseTime(date + "T" + clock + "solar", "--days, --hours")));
            if (columns.size() < hours.size()) columns.push_back(clock);
        }
    std::vector<compute::Moment> moments = solveLight(run, transport, skies);
    if (arguments.picture.skyColour) tintLight(transport, skies, moments);
    const StageTimer timer(run, "render");
    passes::PreviewOptions options;
    options.width = 400, options.height = 300;
    options.tone = toned(options.tone, arguments.picture, arguments.picture.falseColor);
    if (!options.tone.whiteLux) {
        double white = 0;
        for (const compute::Moment& moment : moments)
            white = std::max(white, renderer.autoWhite(moment.lighting));
        options.tone.whiteLux = white;
    }
    std::vector<passes::Image8> cells;
    for (const compute::Moment& moment : moments) cells.push_back(renderer.preview(moment.lighting, options));
    passes::writePng(
        contactSheet(cells, days, columns,
                     fmt::format("apparent solar time; white is {:.0f} lux", *options.tone.whiteLux)),
        arguments.output / "contact-sheet.png");
}

} // namespace

void execute(Run& run, const RenderArguments& arguments) {
    const Scene scene = loadScene(run, arguments.scene);
    const SkySource source(run, arguments.moment, scene);
    const daylight::Sky sky = source.skyAt(source.moment());
    prepareFolder(arguments.output);
    const auto transport = makeTransport(run, scene.mesh);
    compute::Moment moment = std::move(solveLight(run, *transport, std::span(&sky, 1))[0]);
    if (arguments.picture.skyColour) tintLight(*transport, std::span(&sky, 1), std::span(&moment, 1));
    passes::FrameRenderer renderer = makeRenderer(run, scene);
    const LightFigures figures = lightFigures(scene.mesh, moment);
    run.report()["light"] = {
        {"mean_lux", figures.meanLux},
        {"max_lux", figures.maxLux},
        {"glare_ratio", figures.glareRatio},
        {"white_lux", arguments.picture.exposure.value_or(renderer.autoWhite(moment.lighting))}};
    renderPreviews(run, renderer, moment.lighting, arguments);
    if (arguments.contactSheet) renderSheet(run, renderer, *transport, source, arguments);
    if (scene.rig) {
        renderProjectors(run, renderer, moment.lighting, arguments);
        reportReach(run, scene);
        if (isPhotograph(arguments.scene.input))
            drawReachOverlay(scene, arguments.scene.input, arguments.output / "overlay.png");
    } else
        run.skipped("projector pictures: no rig was given");
}

} // namespace heliodon::app
