#include <optional>
#include <set>

#include <fmt/format.h>

#include "engine/app/calibration_folder.h"
#include "engine/app/calibration_report.h"
#include "engine/app/commands.h"
#include "engine/app/output_folder.h"
#include "engine/app/pixel_size.h"
#include "engine/app/progress.h"
#include "engine/app/scene_input.h"
#include "geometry/input_error.h"
#include "geometry/picture_file.h"
#include "geometry/rig_edit.h"
#include "geometry/text_file.h"
#include "geometry/whole_file.h"
#include "vision/calibration_overlay.h"
#include "vision/projector_calibration.h"

namespace heliodon::app {

using nlohmann::json;

namespace {

constexpr const char* kDescription = "patterns.json";

vision::ProjectorPlane decodePlane(Run& run, const CalibrationFolder& folder, size_t index,
                                   const geometry::OpticalDevice& camera, json& report) {
    const auto& plane = folder.planes[index];
    const vision::DecodedPatterns decoded =
        vision::decodePatterns(folder.patterns, [&](const std::string& pattern) {
            const std::filesystem::path file = pictureOf(plane.folder, pattern);
            vision::GreyPicture picture = vision::readGrey(file);
            if (picture.width != camera.width || picture.height != camera.height)
                throw geometry::InputError(file.string(), "",
                                           fmt::format("is {} x {} pixels, the rig's camera has {} x {}",
                                                       picture.width, picture.height, camera.width,
                                                       camera.height));
            return picture;
        });
    report = {{"folder", plane.folder.string()},  {"height_m", plane.height},
              {"lit_share", decoded.litShare},    {"decoded_share", decoded.decodedShare},
              {"contrast", decoded.contrast},     {"cell", decoded.cell},
              {"corners", decoded.corners.size()}};
    if (decoded.cell != folder.patterns.cell)
        run.warn(
            fmt::format("{}: the camera does not resolve cells of {} projector pixels; read as cells of {}",
                        plane.folder.string(), folder.patterns.cell, decoded.cell));
    for (const std::string& doubt : decoded.doubts)
        run.warn(fmt::format("{}: {}", plane.folder.string(), doubt));
    constexpr double kFaint = 16.0 / 255;
    if (decoded.contrast < kFaint)
        run.warn(fmt::format("{}: the projector's white is only {:.1f} of 255 steps over its black: corners "
                             "are less exact; a longer exposure or less other light helps",
                             plane.folder.string(), 255 * decoded.contrast));
    return {plane.height, decoded.corners};
}

std::vector<vision::ProjectorPlane> decodePlanes(Run& run, const CalibrationFolder& folder,
                                                 const geometry::OpticalDevice& camera, json& report) {
    const StageTimer timer(run, "decode");
    std::vector<vision::ProjectorPlane> planes;
    Progress progress(folder.id, folder.planes.size(), run.showsProgress());
    for (size_t i = 0; i < folder.planes.size(); ++i) {
        planes.push_back(decodePlane(run, folder, i, camera, report["planes"].emplace_back()));
        progress.advance(i + 1);
    }
    return planes;
}

void report(Run& run, json& out, const vision::ProjectorCalibration& result) {
    out["projector"] = lensReport(result.projector.lens);
    out["projector_sigma"] = lensReport(result.sigma);
    const glm::dvec3 centre = result.projector.centre(), sigma = result.centreSigma;
    out["centre_m"] = {centre.x, centre.y, centre.z};
    out["centre_sigma_m"] = {sigma.x, sigma.y, sigma.z};
    out["rms_px"] = result.rms;
    out["held_out_rms_px"] = orNull(result.heldOutRms);
    out["mean_mm"] = result.meanMm;
    out["deviation_mm"] = result.deviationMm;
    out["coverage"] = result.coverage;
    size_t corners = 0;
    for (size_t i = 0; i < result.planes.size(); ++i) {
        const vision::CalibratedPlane& plane = result.planes[i];
        corners += plane.corners;
        out["planes"][i].update({{"corners_used", plane.corners},
                                 {"corners_rejected", plane.rejected.size()},
                                 {"rms_px", plane.rms},
                                 {"held_out_rms_px", orNull(plane.heldOutRms)},
                                 {"mean_off_px", plane.meanOff}});
        if (plane.corners == 0)
            run.warn(fmt::format("{}: left out: no plane of corners found in it",
                                 out["planes"][i]["folder"].get<std::string>()));
    }
    const std::string id = out["id"];
    for (const std::string& warning : result.warnings) run.warn(id + ": " + warning);
    const geometry::Lens& lens = result.projector.lens;
    run.note(fmt::format(
        "{}: {} corners, RMS {:.3f} px, {}, {:.2f} +- {:.2f} mm on the planes\n"
        "focal length {:.2f} +- {:.2f}, {:.2f} +- {:.2f} px; principal point {:.2f} +- {:.2f}, {:.2f} +- "
        "{:.2f} px",
        id, corners, result.rms,
        result.heldOutRms ? fmt::format("{:.3f} px on planes held out", *result.heldOutRms)
                          : "too few planes to hold one out",
        result.meanMm, result.deviationMm, lens.fx, result.sigma.fx, lens.fy, result.sigma.fy, lens.cx,
        result.sigma.cx, lens.cy, result.sigma.cy));
}

std::string overlayOf(const CalibrationFolder& folder, size_t plane) {
    return fmt::format("{}-{}.png", folder.id, folder.planes[plane].folder.filename().string());
}

void drawOverlays(const std::filesystem::path& target, const CalibrationFolder& folder,
                  const std::vector<vision::ProjectorPlane>& planes,
                  const vision::ProjectorCalibration& result) {
    for (size_t p = 0; p < planes.size(); ++p) {
        std::vector<glm::dvec2> found, rejected;
        const std::set<size_t> off(result.planes[p].rejected.begin(), result.planes[p].rejected.end());
        for (size_t i = 0; i < planes[p].corners.size(); ++i)
            (result.planes[p].corners == 0 || off.contains(i) ? rejected : found)
                .push_back(planes[p].corners[i].camera);
        vision::drawCalibrationOverlay(vision::readPhotograph(pictureOf(folder.planes[p].folder, "white")),
                                       {found, rejected, {}}, target / overlayOf(folder, p));
    }
}

// Of folders with pictures of one projector, or that are named after one another.
void warnOfPlaces(Run& run, const geometry::Rig& rig, const std::vector<geometry::OpticalDevice>& found) {
    constexpr double kOnePlace = 0.02; // metres: no two lenses are as close
    for (size_t i = 0; i < found.size(); ++i) {
        const auto here = [&](const geometry::OpticalDevice& other) {
            return glm::distance(found[i].centre(), other.centre()) < kOnePlace;
        };
        for (size_t j = 0; j < i; ++j)
            if (here(found[j]))
                run.warn(
                    fmt::format("{} and {} come out at the same place: are both pictures of one projector?",
                                found[j].id, found[i].id));
        for (const geometry::Projector& before : rig.projectors)
            if (before.id != found[i].id && here(before))
                run.warn(fmt::format("{} comes out where the rig has {}: are the folders' names right?",
                                     found[i].id, before.id));
    }
}

} // namespace

void execute(Run& run, const CalibratePatternsArguments& arguments) {
    vision::PatternSet set;
    const PixelSize size = parseSize("--size", arguments.size, kMostPixels);
    set.width = size.width, set.height = size.height;
    set.cell = arguments.cell;
    if (set.columns() < 4 || set.rows() < 4)
        throw geometry::InputError("--cell", std::to_string(set.cell),
                                   "fewer than four cells fit into the picture");
    const OutputFolder folder(arguments.output);
    const auto names = set.names();
    std::vector<std::string> files{kDescription};
    for (const std::string& name : names) files.push_back(name + ".png");
    run.willWrite(arguments.output, files);
    Progress progress("pictures", names.size(), run.showsProgress());
    for (size_t i = 0; i < names.size(); ++i) {
        const vision::Photograph picture = vision::drawPattern(set, names[i]);
        geometry::writePngFile(arguments.output / (names[i] + ".png"), picture.width, picture.height,
                               picture.rgb.data());
        progress.advance(i + 1);
    }
    const json description = {{"format", "vh-patterns/1"},
                              {"width", set.width},
                              {"height", set.height},
                              {"cell", set.cell},
                              {"names", names}};
    geometry::writeWholeText(arguments.output / kDescription, geometry::jsonText(description, 1));
    run.note(fmt::format("{} pictures of {} x {} pixels in {}", names.size(), set.width, set.height,
                         arguments.output.string()));
}

void execute(Run& run, const CalibrateProjectorArguments& arguments) {
    if (!arguments.ids.empty() && arguments.ids.size() != arguments.folders.size())
        throw geometry::InputError(
            "--id", "",
            fmt::format("{} names for {} folders", arguments.ids.size(), arguments.folders.size()));
    const geometry::RigFile file(arguments.rig);
    const geometry::Rig rig = file.rig();
    std::vector<CalibrationFolder> folders;
    std::set<std::string> ids;
    for (size_t i = 0; i < arguments.folders.size(); ++i) {
        folders.push_back(openCalibrationFolder(arguments, i));
        if (!ids.insert(folders.back().id).second)
            throw geometry::InputError(
                arguments.folders[i].string(), "",
                fmt::format("is the second folder of projector \"{}\"; --id names them", folders.back().id));
        for (const auto& [description, fields] : folders.back().misspelt)
            warnOfUnknown(run, description, fields, "projector's description");
        if (!folders.back().assumed.empty()) run.assume(folders.back().assumed);
    }
    if (arguments.heights.empty())
        run.assume(fmt::format("planes {} m apart, plane_0 on the table", arguments.spacing));
    std::optional<OutputFolder> overlays;
    if (!arguments.overlay.empty()) {
        std::vector<std::string> names;
        for (const CalibrationFolder& folder : folders)
            for (size_t plane = 0; plane < folder.planes.size(); ++plane)
                names.push_back(overlayOf(folder, plane));
        run.willWrite(arguments.overlay, names);
        overlays.emplace(arguments.overlay);
    }

    geometry::RigEdit edit;
    for (size_t i = 0; i < folders.size(); ++i) {
        const CalibrationFolder& folder = folders[i];
        json& out = run.report()["projectors"].emplace_back();
        out = {{"id", folder.id}, {"planes", json::array()}};
        const auto planes = decodePlanes(run, folder, rig.camera, out);
        vision::ProjectorCalibration result;
        try {
            const StageTimer timer(run, "calibrate");
            result =
                vision::calibrateProjector(rig.camera, folder.patterns.width, folder.patterns.height, planes);
        } catch (const vision::CalibrationError& error) {
            throw geometry::InputError(arguments.folders[i].string(), "", error.what());
        }
        report(run, out, result);
        if (overlays) drawOverlays(arguments.overlay, folder, planes, result);
        edit.projectors.push_back(result.projector);
        edit.projectors.back().id = folder.id;
    }
    warnOfPlaces(run, rig, edit.projectors);
    file.write(arguments.output, edit);
}

} // namespace heliodon::app
