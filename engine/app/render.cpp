#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "engine/app/commands.h"
#include "engine/app/contact_sheet.h"
#include "engine/app/light_report.h"
#include "engine/app/moment.h"
#include "engine/app/output_folder.h"
#include "engine/app/pictures.h"
#include "engine/app/projector_reach.h"
#include "engine/app/scene_input.h"
#include "engine/app/sky_tint.h"
#include "engine/app/stamp.h"
#include "engine/passes/false_colour.h"
#include "engine/passes/image_file.h"
#include "geometry/input_error.h"

namespace heliodon::app {

namespace {

// What one moment's pictures have in common.
struct Shown {
    const compute::Lighting& light;
    const SkySource& source;
    double whiteLux;
};

void renderPreviews(Run& run, passes::FrameRenderer& renderer, const Shown& shown,
                    const RenderArguments& arguments) {
    passes::PreviewOptions options = sized({}, arguments.picture);
    options.tone = toned(options.tone, arguments.picture, false);
    const auto write = [&](const char* name, double white) {
        passes::Image8 picture = renderer.preview(shown.light, options);
        if (arguments.stamp) drawStamp(picture, stampOf(shown.source, shown.source.moment(), white));
        passes::writePng(picture, arguments.output / name);
    };
    const StageTimer timer(run, "render");
    write("preview.png", shown.whiteLux);
    if (arguments.picture.exr)
        passes::writeExr(renderer.previewHdr(shown.light, options), arguments.output / "preview.exr",
                         previewAttributes(shown.source, shown.source.moment(), shown.whiteLux));
    if (!arguments.picture.falseColor) return;
    options.tone = toned(options.tone, arguments.picture, true);
    write("false-color.png", 0);
}

void renderProjectors(Run& run, passes::FrameRenderer& renderer, const Shown& shown,
                      const RenderArguments& arguments) {
    passes::ProjectorOptions options;
    options.tone = toned(options.tone, arguments.picture, false);
    const StageTimer timer(run, "render");
    const passes::ProjectorPictures pictures =
        arguments.picture.exr ? renderer.projectorsBoth(shown.light, options)
                              : passes::ProjectorPictures{renderer.projectors(shown.light, options), {}};
    for (size_t p = 0; p < pictures.bytes.size(); ++p)
        passes::writePng(pictures.bytes[p], arguments.output / fmt::format("projector-{}.png", p));
    for (size_t p = 0; p < pictures.floats.size(); ++p)
        passes::writeExr(pictures.floats[p], arguments.output / fmt::format("projector-{}.exr", p),
                         projectorAttributes(shown.source, shown.source.moment(), shown.whiteLux));
}

void compensateScatter(Run& run, const passes::FrameScene& frame, compute::DaylightTransport& transport,
                       double whiteLux, compute::Lighting& light) {
    const StageTimer timer(run, "scatter");
    const passes::ScatterReport scatter =
        passes::leaveOutScatter(frame.mesh, frame.painted, whiteLux, transport.parts().gather, true, light);
    run.report()["scatter"] = scatterEntry(scatter, frame.painted.reflectance);
    run.report()["scatter"]["error_before"] = scatter.errorBefore;
    run.note(
        fmt::format("left out of the projectors' pictures: what the model's surfaces throw at one another, "
                    "{:.0f} % of the light on them (off by {:.0f} % RMS, {:.0f} % without)",
                    100 * scatter.ownShare, 100 * scatter.error, 100 * scatter.errorBefore));
}

std::vector<std::string> listOf(const std::string& text) {
    std::vector<std::string> items;
    std::istringstream in(text);
    for (std::string item; std::getline(in, item, ',');) items.push_back(item);
    if (text.ends_with(',')) items.emplace_back(); // refused as an item, not passed over
    return items;
}

std::vector<std::string> filesOf(const RenderArguments& arguments, const Scene& scene) {
    std::vector<std::string> files{"preview.png"};
    if (arguments.picture.exr) files.emplace_back("preview.exr");
    if (arguments.picture.falseColor) files.emplace_back("false-color.png");
    if (arguments.contactSheet) files.emplace_back("contact-sheet.png");
    if (!scene.rig) return files;
    for (size_t p = 0; p < scene.rig->projectors.size(); ++p) {
        files.push_back(fmt::format("projector-{}.png", p));
        if (arguments.picture.exr) files.push_back(fmt::format("projector-{}.exr", p));
    }
    if (isPhotograph(arguments.scene.input)) files.emplace_back("overlay.png");
    return files;
}

// Hours of apparent solar time on a few days of the year, as in figure 11 of the paper.
struct Sheet {
    std::vector<std::string> days, columns; // "21 June", "09:00"
    std::vector<daylight::Moment> moments;  // row by row
};

std::string clockOf(const std::string& hour) {
    const size_t digits = std::min(hour.find(':'), hour.size());
    return (digits == 1 ? "0" : "") + hour + (digits == hour.size() ? ":00" : "");
}

void refuseUnless(const std::string& option, const std::string& item, const std::string& what,
                  const std::string& time) {
    try {
        daylight::parseTime(time + "solar", option);
    } catch (const geometry::InputError&) {
        throw geometry::InputError(option, "", fmt::format("'{}' is no {}", item, what));
    }
}

// Throws InputError on what is no day or no hour.
Sheet sheetOf(const RenderArguments& arguments) {
    const daylight::Moment moment = arguments.moment.time.empty()
                                        ? daylight::Moment{}
                                        : daylight::parseTime(arguments.moment.time, "--time");
    Sheet sheet;
    const std::vector<std::string> hours =
        listOf(arguments.hours.empty() ? "7,9,11,13,15,17" : arguments.hours);
    for (const std::string& hour : hours) {
        sheet.columns.push_back(clockOf(hour));
        refuseUnless("--hours", hour, "hour, expected such as 9 or 13:30",
                     "2000-01-01T" + sheet.columns.back());
    }
    for (const std::string& day : listOf(arguments.days.empty() ? "06-21,03-21,12-21" : arguments.days)) {
        const std::string date = day.size() <= 5 ? fmt::format("{:04}-{}", moment.date.year, day) : day;
        refuseUnless("--days", day, fmt::format("day of {}, expected such as 06-21", date.substr(0, 4)),
                     date + "T12:00");
        const daylight::Date named = daylight::parseTime(date + "T12:00solar", "--days").date;
        sheet.days.push_back(day.size() <= 5
                                 ? fmt::format("{} {}", named.day, daylight::monthName(named.month))
                                 : fmt::format("{} {} {}", named.day,
                                               daylight::monthName(named.month).substr(0, 3), named.year));
        for (const std::string& clock : sheet.columns)
            sheet.moments.push_back(daylight::parseTime(date + "T" + clock + "solar", "--days, --hours"));
    }
    return sheet;
}

// One exposure, or one false-colour scale, for all.
void renderSheet(Run& run, passes::FrameRenderer& renderer, compute::DaylightTransport& transport,
                 const SkySource& source, const Sheet& sheet, const RenderArguments& arguments) {
    std::vector<daylight::Sky> skies;
    for (const daylight::Moment& moment : sheet.moments) skies.push_back(source.skyAt(moment));
    std::vector<compute::Moment> moments = solveLights(run, transport, skies);
    if (arguments.picture.skyColour) tintLight(transport, skies, moments);
    const StageTimer timer(run, "render");
    passes::PreviewOptions options;
    options.width = 400, options.height = 300;
    options = sized(options, arguments.picture);
    options.tone = toned(options.tone, arguments.picture, arguments.picture.falseColor);
    options.tone.legend = false; // one for the sheet
    settle(options.tone, renderer, moments);
    std::vector<passes::Image8> cells;
    for (size_t k = 0; k < moments.size(); ++k) {
        cells.push_back(renderer.preview(moments[k].lighting, options));
        if (!arguments.stamp || !source.followsTime()) continue;
        const daylight::SunPosition sun = source.sunAt(sheet.moments[k]);
        if (!sun.isUp() && lightFigures(renderer.scene().mesh, moments[k]).maxLux <= 0)
            drawNight(cells.back());
        drawStamp(cells.back(), {sunInWords(sun)});
    }
    const passes::Tone& tone = options.tone;
    std::string title = source.skyInWords() + "; apparent solar time";
    std::optional<passes::FalseScale> legend;
    if (arguments.picture.falseColor)
        legend = passes::falseScale(tone, {});
    else
        title += fmt::format("; white is {:.0f} lux", *tone.whiteLux);
    passes::writePng(contactSheet(cells, sheet.days, sheet.columns, title, legend),
                     arguments.output / "contact-sheet.png");
}

} // namespace

void execute(Run& run, const RenderArguments& arguments) {
    // A typing error in these should not cost the form factors.
    const std::optional<Sheet> sheet =
        arguments.contactSheet ? std::optional(sheetOf(arguments)) : std::nullopt;
    checkSize(run, arguments.picture);
    const Scene scene = loadScene(run, arguments.scene);
    const SkySource source(run, arguments.moment, scene);
    if (sheet && arguments.moment.time.empty()) source.warnOfOneLight(run);
    const daylight::Sky sky = source.reportedSky(run);
    OutputFolder folder(arguments.output);
    folder.refuseUsed(run, "render", filesOf(arguments, scene));
    compute::TransportOptions options{.forPictures = true};
    if (arguments.maxRadiosityError > 0) { // most of it for the form factors, which cost more
        options.formFactors.maxRadiosityError = 0.9 * arguments.maxRadiosityError;
        options.radiosity.tolerance = 0.1 * arguments.maxRadiosityError;
    }
    const auto transport = makeTransport(run, scene.mesh, options);
    compute::Moment moment = solveLight(run, *transport, sky, scene.worldPerBuilding);
    if (arguments.picture.skyColour) tintLight(*transport, std::span(&sky, 1), std::span(&moment, 1));
    passes::FrameRenderer renderer = makeRenderer(run, scene);
    const LightFigures figures = lightFigures(scene.mesh, moment);
    warnOfNight(run, source, figures.maxLux);
    const double white = arguments.picture.exposure.value_or(renderer.autoWhite(moment.lighting));
    if (arguments.picture.compensateScatter)
        compensateScatter(run, renderer.scene(), *transport, white, moment.lighting);
    const Shown shown{moment.lighting, source, white};
    run.report()["light"] = {{"mean_lux", figures.meanLux},
                             {"max_lux", figures.maxLux},
                             {"glare_ratio", figures.glareRatio},
                             {"white_lux", shown.whiteLux}};
    folder.startFiles(run, "render", filesOf(arguments, scene));
    renderPreviews(run, renderer, shown, arguments);
    if (sheet) renderSheet(run, renderer, *transport, source, *sheet, arguments);
    if (scene.rig) {
        if (scene.rig->projectors.empty()) warnOfNoProjectors(run, arguments.scene.rig);
        renderProjectors(run, renderer, shown, arguments);
        reportReach(run, scene);
        if (isPhotograph(arguments.scene.input))
            drawReachOverlay(scene, arguments.scene.input, arguments.output / "overlay.png");
    } else
        run.skipped("projector pictures: no rig was given");
}

} // namespace heliodon::app
