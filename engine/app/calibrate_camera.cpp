#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <system_error>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "engine/app/calibration_report.h"
#include "engine/app/commands.h"
#include "engine/app/output_folder.h"
#include "engine/app/progress.h"
#include "geometry/input_error.h"
#include "geometry/rig_edit.h"
#include "vision/calibration_overlay.h"
#include "vision/camera_calibration.h"
#include "vision/median.h"

namespace heliodon::app {

using nlohmann::json;

namespace {

constexpr size_t kLeastMarks = 40;

struct Picture {
    std::filesystem::path file;
    vision::Photograph photo; // empty unless overlays are wanted
    int width = 0, height = 0;
    vision::FoundTarget target;
};

std::vector<Picture> readPictures(Run& run, const CalibrateCameraArguments& arguments,
                                  const vision::CalibrationTarget& target) {
    const StageTimer timer(run, "detect");
    std::vector<Picture> pictures;
    Progress progress("marks", arguments.images.size(), run.showsProgress());
    for (const auto& file : arguments.images) {
        vision::Photograph photo = vision::readPhotograph(file);
        Picture picture{file, {}, photo.width, photo.height, vision::findTarget(photo, target)};
        if (!picture.target.marks.empty() && picture.target.marks.size() < kLeastMarks)
            picture.target.problem = fmt::format("only {} marks found", picture.target.marks.size());
        if (!arguments.overlay.empty()) picture.photo = std::move(photo);
        pictures.push_back(std::move(picture));
        progress.advance(pictures.size());
    }
    return pictures;
}

// All pictures of one camera have one size; the size of most is meant.
void markOtherSizes(std::vector<Picture>& pictures) {
    std::map<std::pair<int, int>, size_t> sizes;
    for (const Picture& p : pictures) ++sizes[{p.width, p.height}];
    const auto usual = std::max_element(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) {
                           return a.second < b.second;
                       })->first;
    for (Picture& p : pictures)
        if (std::pair(p.width, p.height) != usual)
            p.target.problem = fmt::format("is {} x {} pixels, the others {} x {}", p.width, p.height,
                                           usual.first, usual.second);
}

// Pictures of a board that did not move, or copies of one, count once: they say nothing new, but would make
// the lens look surer than it is.
void markCopies(std::vector<Picture>& pictures, size_t flat) {
    constexpr double kSamePlace = 0.25; // px; marks of one board found twice differ by some hundredths
    const auto samePlace = [](const Picture& a, const Picture& b) {
        std::map<size_t, glm::dvec2> at;
        for (const vision::FoundMark& mark : a.target.marks) at[mark.id] = mark.pixel;
        std::vector<double> moved;
        for (const vision::FoundMark& mark : b.target.marks)
            if (const auto same = at.find(mark.id); same != at.end())
                moved.push_back(glm::distance(same->second, mark.pixel));
        return moved.size() >= kLeastMarks && vision::median(std::move(moved)) < kSamePlace;
    };
    for (size_t i = 0; i < pictures.size(); ++i)
        for (size_t j = 0; j < pictures.size(); ++j) {
            const bool wins = j == flat || (i != flat && j < i);
            if (!wins || i == j || !pictures[j].target.problem.empty() ||
                !pictures[i].target.problem.empty() || !samePlace(pictures[j], pictures[i]))
                continue;
            pictures[i].target.problem =
                fmt::format("shows the board where {} does: move it between pictures",
                            pictures[j].file.filename().string());
        }
}

// Those in which the board was found.
struct Views {
    std::vector<vision::TargetView> found;
    std::vector<size_t> picture; // of each
};

Views usableViews(const std::vector<Picture>& pictures) {
    Views views;
    for (size_t i = 0; i < pictures.size(); ++i)
        if (pictures[i].target.problem.empty()) {
            views.found.push_back({pictures[i].file.filename().string(), pictures[i].target.marks});
            views.picture.push_back(i);
        }
    return views;
}

[[noreturn]] void refuseTooFew(const std::vector<Picture>& pictures, const Views& views, size_t flat) {
    if (views.found.size() >= vision::kLeastViews)
        throw geometry::InputError(
            pictures[flat].file.string(), "",
            "the board was not found in this picture, which should show it flat on the table: " +
                pictures[flat].target.problem + "; --flat names another");
    std::string problems;
    for (const Picture& p : pictures)
        if (!p.target.problem.empty())
            problems += fmt::format("; {}: {}", p.file.filename().string(), p.target.problem);
    throw geometry::InputError(
        "IMAGE", "",
        fmt::format("the board was found in {} of {} pictures, at least {} are needed{}", views.found.size(),
                    pictures.size(), vision::kLeastViews, problems));
}

// Which picture makes the world: the one named, else the only one that its name calls flat, else the first.
// Nothing in a picture tells a board on the table from one held level, so it is never guessed from them.
size_t flatPicture(Run& run, const CalibrateCameraArguments& arguments) {
    const auto& images = arguments.images;
    std::vector<size_t> called;
    for (size_t i = 0; i < images.size(); ++i) {
        const std::string name = images[i].filename().string();
        if (!arguments.flat.empty() ? images[i] == arguments.flat || name == arguments.flat
                                    : name.find("flat") != std::string::npos)
            called.push_back(i);
    }
    if (called.size() == 1) return called.front();
    if (!arguments.flat.empty())
        throw geometry::InputError("--flat", arguments.flat,
                                   called.empty() ? "is none of the pictures given"
                                                  : "names more than one picture");
    run.assume(fmt::format("{} shows the board flat on the table (--flat names another)",
                           images.front().filename().string()));
    return 0;
}

// None: the rig has one.
std::optional<double> tableRadius(Run& run, const CalibrateCameraArguments& arguments,
                                  const geometry::RigFile& rig) {
    if (arguments.tableDiameter > 0) return 0.5 * arguments.tableDiameter;
    if (rig.namesTable()) return std::nullopt;
    const double radius = geometry::Rig{}.tableRadius;
    run.assume(fmt::format("a table {:.4g} m across (--table says another)", 2 * radius));
    return radius;
}

std::string misfit(const vision::CalibratedView& view) {
    return view.turned ? "it is turned by half against the other pictures: take it as the camera gave it"
                       : "its marks do not fit those of the other pictures";
}

void report(Run& run, const std::vector<Picture>& pictures, const std::vector<size_t>& indexOfView,
            const vision::CameraCalibration& result, size_t flat) {
    json& out = run.report();
    out["camera"] = lensReport(result.fit.lens);
    out["camera_sigma"] = lensReport(result.fit.sigma);
    out["flat"] = pictures[flat].file.filename().string();
    out["rms_px"] = result.rms;
    const auto used =
        std::count_if(result.views.begin(), result.views.end(), [](const auto& v) { return v.used; });
    out["held_out_rms_px"] = orNull(result.heldOutRms);
    out["coverage"] = result.coverage;
    json& list = out["views"] = json::array();
    for (const Picture& p : pictures)
        list.push_back({{"file", p.file.string()}, {"marks", p.target.marks.size()}, {"used", false}});
    for (size_t i = 0; i < pictures.size(); ++i)
        if (!pictures[i].target.problem.empty()) list[i]["problem"] = pictures[i].target.problem;
    for (size_t v = 0; v < result.views.size(); ++v) {
        const vision::CalibratedView& view = result.views[v];
        json& entry = list[indexOfView[v]];
        entry["used"] = view.used;
        if (!view.used) {
            entry["problem"] = misfit(view);
            continue;
        }
        entry.update({{"marks_rejected", view.rejected.size()},
                      {"rms_px", view.rms},
                      {"held_out_rms_px", orNull(view.heldOutRms)},
                      {"tilt_deg", view.tiltDegrees}});
    }
    for (const json& entry : list)
        if (entry.contains("problem"))
            run.warn(fmt::format("{}: left out: {}", entry["file"].get<std::string>(),
                                 entry["problem"].get<std::string>()));
    for (const std::string& warning : result.warnings) run.warn(warning);
    const auto& view = pictures[flat];
    const geometry::Lens &lens = result.fit.lens, &sigma = result.fit.sigma;
    const std::string heldOut = result.heldOutRms
                                    ? fmt::format("{:.3f} px in pictures held out", *result.heldOutRms)
                                    : "too few to hold one out";
    run.note(fmt::format(
        "{} of {} pictures, RMS {:.3f} px, {}\n"
        "focal length {:.2f} +- {:.2f}, {:.2f} +- {:.2f} px; principal point {:.2f} +- {:.2f}, {:.2f} +- "
        "{:.2f} px; table as in {}",
        used, pictures.size(), result.rms, heldOut, lens.fx, sigma.fx, lens.fy, sigma.fy, lens.cx, sigma.cx,
        lens.cy, sigma.cy, view.file.filename().string()));
}

std::filesystem::path overlayOf(const std::filesystem::path& folder, const std::filesystem::path& image) {
    return folder / image.filename().replace_extension(".png");
}

// Nothing is written over, and every picture has an overlay of its own.
void refuseOverwriting(Run& run, const CalibrateCameraArguments& arguments) {
    std::set<std::string> names;
    for (const auto& image : arguments.images) {
        const std::string name = overlayOf("", image).string();
        if (!names.insert(name).second)
            throw geometry::InputError("--overlay", arguments.overlay.string(),
                                       "two pictures would both be drawn as " + name);
    }
    run.willWrite(arguments.overlay, {names.begin(), names.end()});
}

void drawOverlays(const std::filesystem::path& folder, const std::vector<Picture>& pictures,
                  const std::vector<size_t>& indexOfView, const vision::CameraCalibration* result) {
    for (size_t i = 0; i < pictures.size(); ++i) {
        const vision::FoundTarget& target = pictures[i].target;
        const auto view = std::find(indexOfView.begin(), indexOfView.end(), i) - indexOfView.begin();
        const vision::CalibratedView* calibrated = result && static_cast<size_t>(view) < indexOfView.size()
                                                       ? &result->views[static_cast<size_t>(view)]
                                                       : nullptr;
        std::vector<glm::dvec2> found, rejected, disks;
        for (const vision::FoundMark& mark : target.marks) {
            const bool isOff =
                calibrated && (!calibrated->used || std::binary_search(calibrated->rejected.begin(),
                                                                       calibrated->rejected.end(), mark.id));
            (isOff ? rejected : found).push_back(mark.pixel);
        }
        for (const auto& disk : target.disks)
            if (disk) disks.push_back(*disk);
        vision::drawCalibrationOverlay(pictures[i].photo, {found, rejected, disks},
                                       overlayOf(folder, pictures[i].file));
    }
}

} // namespace

void execute(Run& run, const CalibrateTargetArguments& arguments) {
    vision::writeTarget(vision::makeTarget(arguments.boardEdge), arguments.output);
    run.note(fmt::format("print {} at 100 % (no fit to page): its page is {:.1f} mm square",
                         arguments.output.string(), 1000 * arguments.boardEdge));
}

void execute(Run& run, const CalibrateCameraArguments& arguments) {
    const vision::CalibrationTarget target = vision::makeTarget(arguments.boardEdge);
    const size_t flat = flatPicture(run, arguments);
    const geometry::RigFile rig(arguments.rig);
    std::optional<OutputFolder> overlays;
    if (!arguments.overlay.empty()) {
        refuseOverwriting(run, arguments);
        overlays.emplace(arguments.overlay);
    }
    std::vector<Picture> pictures = readPictures(run, arguments, target);
    markOtherSizes(pictures);
    markCopies(pictures, flat);

    const Views views = usableViews(pictures);
    const auto flatView = std::find(views.picture.begin(), views.picture.end(), flat);
    if (flatView == views.picture.end() || views.found.size() < vision::kLeastViews) {
        if (overlays) drawOverlays(arguments.overlay, pictures, views.picture, nullptr);
        refuseTooFew(pictures, views, flat);
    }

    vision::CameraCalibration result;
    try {
        const StageTimer timer(run, "calibrate");
        const Picture& first = pictures[views.picture.front()];
        result =
            vision::calibrateCamera(target, first.width, first.height, views.found, arguments.boardThickness);
    } catch (const vision::CalibrationError& error) {
        throw geometry::InputError("IMAGE", "", error.what());
    }
    if (overlays) drawOverlays(arguments.overlay, pictures, views.picture, &result);
    report(run, pictures, views.picture, result, flat);
    const vision::CalibratedView& world = result.views[static_cast<size_t>(flatView - views.picture.begin())];
    if (!world.used)
        throw geometry::InputError(
            pictures[flat].file.string(), "",
            misfit(world) + ", and it should show the board flat on the table; --flat names another");
    if (!arguments.rig.empty())
        run.note("the projectors of the rig, if any, were calibrated with its former camera: calibrate them "
                 "again");
    rig.write(arguments.output, {tableRadius(run, arguments, rig), world.camera, {}});
}

} // namespace heliodon::app
