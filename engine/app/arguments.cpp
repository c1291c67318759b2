#include "engine/app/arguments.h"

#include <functional>
#include <memory>
#include <set>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compute/form_factors.h"
#include "engine/app/command_line.h"
#include "engine/app/option_checks.h"
#include "engine/app/option_groups.h"
#include "engine/present/operator_window.h"
#include "geometry/input_error.h"

namespace heliodon::app {

namespace {

class Parser {
public:
    Parser() : app_("A virtual heliodon: from a sketch on a table to daylight on the model.", "heliodon") {
        app_.set_version_flag("--version", HELIODON_VERSION);
        app_.require_subcommand(1);
        app_.formatter(std::make_shared<HelpLayout>());
        app_.footer("heliodon COMMAND --help says more, with an example.");
        addDetect();
        addModel();
        addFormFactors();
        addIlluminance();
        addRender();
        addTimelapse();
        addAnnual();
        addCalibrate();
        addLive();
        addBench();
        addDevices();
    }

    std::optional<Arguments> parse(int argc, const char* const* argv) {
        const CLI::App& named = commandNamed(app_, argc, argv);
        if (&named != &app_) refuseWords(named, argc, argv);
        try {
            app_.parse(argc, argv);
        } catch (const CLI::Success& success) { // --help, --version
            app_.exit(success);
            return std::nullopt;
        } catch (const CLI::ParseError& error) {
            throw geometry::InputError("command line", "", inOurWords(error));
        }
        for (auto& [sub, command] : commands_) {
            if (!*sub) continue;
            refuseValues(*sub);
            noteFiles(*sub);
            std::string name = sub->get_name();
            if (sub->get_parent() != &app_) name = fmt::format("{} {}", sub->get_parent()->get_name(), name);
            return Arguments{name, common_, command()};
        }
        return std::nullopt;
    }

private:
    // A file that a command writes.
    CLI::Option* written(CLI::Option* option) {
        writtenFiles_.insert(option);
        return option;
    }

    void noteFiles(const CLI::App& sub) {
        const std::set<std::string> folders{"--output", "--overlay", "--snapshots"}; // unless a file
        std::error_code none;
        for (const CLI::Option* option : sub.get_options())
            for (std::string text : option->results()) {
                if (writtenFiles_.contains(option)) {
                    if (option->get_name() != "--report") common_.resultFiles.emplace_back(text);
                } else if (folders.contains(option->get_name())) {
                    if (std::filesystem::path(text).extension() == ".mp4") continue; // a film
                    common_.outputFolders.emplace_back(text);
                } else {
                    if (option->get_name() == "--camera" && text.starts_with("file:")) text.erase(0, 5);
                    if (std::filesystem::is_regular_file(text, none)) common_.readFiles.emplace_back(text);
                }
            }
    }

    // `group`: the command that this one is a part of, if any.
    template<class T>
    CLI::App* add(const std::string& name, const std::string& what, T& values, const std::string& example,
                  CLI::App* group = nullptr) {
        CLI::App* sub = (group ? group : &app_)->add_subcommand(name, what);
        std::string before;
        if (group) before = fmt::format("{} ", group->get_name());
        sub->footer(
            fmt::format("Example:\n  heliodon {}{}{}{}", before, name, example.empty() ? "" : " ", example));
        sub->option_defaults()->always_capture_default(false);
        sub->add_option("--device", common_.device,
                        "Vulkan device: part of its name, or its index (heliodon devices)");
        written(sub->add_option("--report", common_.report,
                                "write everything worth knowing about the run to this JSON file"))
            ->transform(CLI::Validator(fileOrStdout, ""));
        sub->add_flag("--quiet", common_.quiet, "no progress and no notes");
        commands_.emplace_back(sub, [&values] { return Command(values); });
        return sub;
    }

    // What the words in a command's results mean.
    static void explain(CLI::App* sub, const std::vector<std::pair<std::string, std::string>>& words) {
        std::string text = sub->get_footer() + "\n\nIn the results:\n";
        for (const auto& [word, meaning] : words) text += fmt::format("  {:<22} {}\n", word, meaning);
        sub->footer(text);
    }

    void addDetect() {
        CLI::App* sub = add("detect", "find walls, windows, tokens and arrow in a photograph", detect_,
                            "photo.png --rig rig.json -o sketch.json --overlay found.png");
        sub->add_option("PHOTO", detect_.photo, "overhead photograph (.png .jpg .tif)")->required();
        sub->add_option("--rig", detect_.rig, "calibrated camera (.json)")->required();
        written(sub->add_option("-o,--output", detect_.output, "the sketch (.json)"))
            ->transform(resultNamed(".json"))
            ->required();
        written(sub->add_option("--overlay", detect_.overlay,
                                "the photograph with everything that was found drawn on it (.png)"));
    }

    void addModel() {
        CLI::App* sub = add("model", "infer the closed rooms and mesh them", model_,
                            "sketch.json --triangles 2000 -o room.obj");
        addScene(sub, model_.scene);
        written(
            sub->add_option("--plan", model_.plan,
                            "draw walls as they lie on the table and rooms as they were understood (.png or "
                            ".svg); of what is refused, too"));
        written(sub->add_option("-o,--output", model_.output, "the model (.obj with .mtl, or .glb)"))
            ->required();
    }

    void addFormFactors() {
        CLI::App* sub = add("formfactors", "the matrix of form factors", formFactors_,
                            "room.obj --kernel hemicube --resolution 64 -o F.npy");
        addScene(sub, formFactors_.scene);
        sub->add_option(
            "--kernel", formFactors_.kernel,
            fmt::format("auto, {} (default auto)", fmt::join(compute::formFactorKernels(), ", ")));
        auto* resolution =
            sub->add_option(
                   "--resolution", formFactors_.resolution,
                   "hemicube: pixels along its top, even; montecarlo: R x R rays a patch (default 64)")
                ->check(within(4, 1024));
        sub->add_option("--points", formFactors_.points, "hemicube: viewpoints a patch (default 1)")
            ->check(within(1, 1024));
        auto* maxError = sub->add_option("--max-error", formFactors_.maxError,
                                         "wanted RMS of the rows' errors; auto picks the kernel by it")
                             ->check(within(1e-7, 1.0))
                             ->excludes(resolution);
        addRadiosityError(sub, formFactors_.maxRadiosityError)->excludes(resolution)->excludes(maxError);
        sub->add_option("--reference", formFactors_.reference,
                        "compare with this matrix (.npy, or raw little-endian .f32) in the report");
        written(sub->add_option("-o,--output", formFactors_.output, "n x n float32 (.npy)"))
            ->transform(resultNamed(".npy"))
            ->required();
    }

    void addIlluminance() {
        CLI::App* sub = add("illuminance", "lux at sensors or patches", illuminance_,
                            "room.obj --up z --sky sky.json --sensors desk.csv -o lux.csv");
        explain(sub, {{"lux", "illuminance of a point's plane, or the mean over a patch: the sum of"},
                      {"lux_sun", "straight from the sun"},
                      {"lux_sky, lux_ground", "straight from the sky and the ground outside"},
                      {"lux_interreflected", "by way of surfaces of the room, and what they emit"},
                      {"lux_error", "the true lux is expected within this of lux, at 99 of 100 places"}});
        addScene(sub, illuminance_.scene);
        addBlinds(sub, illuminance_.scene);
        addMoment(sub, illuminance_.moment, true);
        addGround(sub, illuminance_.moment);
        sub->add_option("--sensors", illuminance_.sensors,
                        "points (.csv with x,y,z,nx,ny,nz); without: one row per patch");
        written(sub->add_option(
            "--plan", illuminance_.plan,
            "draw a plan with iso-lux lines (.png or .svg) of the sensors, or without of a work plane "
            "0.76 m above the floor"));
        sub->add_option("--max-error", illuminance_.maxError,
                        "wanted lux_error over lux, on 95 of 100 places; picks mesh, kernel and solution")
            ->check(within(1e-4, 1.0));
        addSunDisc(sub, illuminance_.sunDisc);
        written(sub->add_option("-o,--output", illuminance_.output, "the table (.csv)"))
            ->transform(resultNamed(".csv"))
            ->required();
    }

    void addRender() {
        CLI::App* sub = add("render", "pictures for the projectors, and a preview", render_,
                            "photo.png --rig rig.json --time 2026-03-21T13:00solar --false-color -o out");
        addScene(sub, render_.scene);
        addBlinds(sub, render_.scene);
        addMoment(sub, render_.moment, true);
        addGround(sub, render_.moment);
        addPicture(sub, render_.picture,
                   "pixels of the preview, and of each on a contact sheet (default 1280x960 and 400x300)");
        auto* sheet = sub->add_flag("--contact-sheet", render_.contactSheet,
                                    "one picture with previews of several days and hours too");
        sub->add_option("--days", render_.days,
                        "of the contact sheet, as 06-21,03-21,12-21 (the default) in the year of --time")
            ->needs(sheet);
        sub->add_option("--hours", render_.hours,
                        "of the contact sheet, apparent solar time, as 7,9,11,13,15,17 (the default)")
            ->needs(sheet);
        sub->add_flag(
            "!--no-stamp", render_.stamp,
            "leave date, time, sun, sky and white out of the corner of previews, and the sun's height and "
            "'no sun' out of the contact sheet's");
        addRadiosityError(sub, render_.maxRadiosityError);
        sub->add_option("-o,--output", render_.output, "folder for the pictures; made when missing")
            ->required();
    }

    void addTimelapse() {
        CLI::App* sub = add("timelapse", "a day, or a year, as a film or as pictures", timelapse_,
                            "sketch.json --from 2026-06-21T07:00solar --to 2026-06-21T17:00solar \\\n      "
                            "--step PT10M -o day.mp4");
        addScene(sub, timelapse_.scene);
        addBlinds(sub, timelapse_.scene);
        addMoment(sub, timelapse_.moment, false);
        addGround(sub, timelapse_.moment);
        addPicture(sub, timelapse_.picture, "pixels of previews (default 1280x960)");
        sub->add_option("--from", timelapse_.from, "time of the first frame")->required();
        sub->add_option("--to", timelapse_.to,
                        "time of the last frame; where no step ends there, frames end before it")
            ->required();
        sub->add_option("--step", timelapse_.step, "time between frames: PT10M, P1D")->required();
        sub->add_option("--view", timelapse_.view,
                        "preview, projectors, or none for frames.csv alone (default: projectors with a rig, "
                        "else preview)")
            ->check(CLI::IsMember({"preview", "projectors", "none"}));
        addWeather(sub, timelapse_.moment);
        sub->add_flag(
            "!--no-stamp", timelapse_.stamp,
            "leave date, time, sun, sky and white out of the corner of previews (projectors' pictures and "
            "linear ones never have them)");
        sub->add_option("--fps", timelapse_.framesPerSecond, "frames a second of the film (default 24)")
            ->check(within(1.0, 240.0));
        sub->add_flag(
            "--resume", timelapse_.resume,
            "go on where an interrupted run of the same options stopped, or do nothing where it has made "
            "everything; a film's frames are kept in OUT.frames until it is whole, if it had --resume too");
        sub->add_option(
               "-o,--output", timelapse_.output,
               "film (.mp4; OUT-projector-0.mp4 ... of several projectors), with OUT.frames.csv beside it, "
               "or folder for numbered pictures and frames.csv")
            ->required();
    }

    void addAnnual() {
        CLI::App* sub = add("annual", "a year of weather: hourly lux and what it says about the room",
                            annual_, "room.obj --up z --weather chicago.epw --sensors desk.csv -o year");
        explain(sub, {{"DA300_pct", "percent of occupied hours with at least 300 lux"},
                      {"cDA300_pct", "the same, darker hours counted by their share of 300 lux"},
                      {"UDI_..._pct", "percent with so many lux: below 100, 100 to 300, to 3000, above"},
                      {"direct_gt1000lx_hours", "occupied hours with over 1000 lux straight from the sun"},
                      {"annual_lux_hours", "lux times hours over the whole year"},
                      {"..._low, ..._high", "what the error of lux leaves open"},
                      {"sDA", "percent of sensors with 300 lux in half of the occupied hours"},
                      {"ASE", "percent of sensors with over 250 hours of such direct sun"}});
        addScene(sub, annual_.scene);
        addBlinds(sub, annual_.scene);
        sub->add_option("--weather", annual_.weather,
                        "hourly weather (.epw, .wea, also .gz); its site is used")
            ->required();
        sub->add_option(
            "--sensors", annual_.sensors,
            "points (.csv with x,y,z,nx,ny,nz); without: every 2 ft (0.61 m) over the floor, 0.76 m "
            "above it");
        sub->add_option(
            "--occupied", annual_.occupied,
            "o'clock, every day, as 8-18 (the default) or 8:30-17: records whose middle lies in it");
        sub->add_option("--ground", annual_.groundAlbedo, "diffuse reflectance of the ground (default 0.2)")
            ->check(within(0.0, 1.0));
        sub->add_option("--temporal", annual_.temporal,
                        "maps of hour by day for these sensors too: all, or rows counted from 0 (5,17)");
        addSunDisc(sub, annual_.sunDisc);
        sub->add_flag("--ill", annual_.ill, "illuminance.ill too: a line of text a record, as Daysim has it");
        sub->add_flag("--svg", annual_.svg, "drawings as .svg instead of .png");
        sub->add_option(
               "-o,--output", annual_.output,
               "folder for illuminance.npy (sensors x records), metrics.csv and summary.json; made when "
               "missing")
            ->required();
    }

    static void addSunDisc(CLI::App* sub, bool& disc) {
        sub->add_flag("--sun-disc", disc,
                      "shadows of the sun have their penumbra at sensors (0.53 degrees); else it is a point");
    }

    static void addBoardEdge(CLI::App* sub, double& edge) {
        sub->add_option("--board-size", edge,
                        "edge of the board in metres; everything on it scales along (default 1.016, 40 in)")
            ->check(within(0.1, 10));
    }

    void addCalibrate() {
        CLI::App* group =
            app_.add_subcommand("calibrate", "print the target, calibrate camera and projectors");
        group->require_subcommand(1);
        group->footer(
            "heliodon calibrate STEP --help says more, with an example; docs/calibration.md, what to do.");
        addCalibrateTarget(group);
        addCalibrateCamera(group);
        addCalibratePatterns(group);
        addCalibrateProjector(group);
    }

    void addCalibrateTarget(CLI::App* group) {
        CLI::App* sub = add("target", "the board of marks, to print in true size", calibrateTarget_,
                            "-o target.pdf", group);
        addBoardEdge(sub, calibrateTarget_.boardEdge);
        written(sub->add_option("-o,--output", calibrateTarget_.output, "the drawing (.pdf or .svg)"))
            ->required();
    }

    void addCalibrateCamera(CLI::App* group) {
        CLI::App* sub = add("camera", "lens and place of the camera from pictures of the board",
                            calibrateCamera_, "flat.png tilted-*.png -o rig.json --overlay found", group);
        sub->add_option(
               "IMAGE", calibrateCamera_.images,
               "colour photographs of the board, 15 to 30: one flat on the table, the others tilted by 10 "
               "to 45 degrees in all directions, together filling the picture")
            ->required();
        sub->add_option(
            "--flat", calibrateCamera_.flat,
            "picture that shows the board flat on the table, which makes the world's axes (default: "
            "the one with \"flat\" in its name, else the first)");
        addBoardEdge(sub, calibrateCamera_.boardEdge);
        sub->add_option("--board-thickness", calibrateCamera_.boardThickness,
                        "metres from its printed side down to the table in that picture (default 0: the "
                        "printed side is the world's y = 0)")
            ->check(within(0, 0.2));
        sub->add_option("--table", calibrateCamera_.tableDiameter,
                        "diameter of the table in metres (default: the rig's, else 1.0668, 42 in)")
            ->check(within(0.1, 100));
        sub->add_option("--rig", calibrateCamera_.rig,
                        "rig to take projectors and everything else from (.json)");
        sub->add_option("--overlay", calibrateCamera_.overlay,
                        "folder for the pictures with the marks found; made when missing");
        written(sub->add_option("-o,--output", calibrateCamera_.output, "the rig (.json)"))
            ->transform(resultNamed(".json"))
            ->required();
    }

    void addCalibratePatterns(CLI::App* group) {
        CLI::App* sub = add("patterns", "the pictures that a projector shows to be calibrated",
                            calibratePatterns_, "--size 1024x768 -o patterns", group);
        sub->add_option("--size", calibratePatterns_.size, "pixels of the projector (default 1024x768)");
        sub->add_option("--cell", calibratePatterns_.cell, "projector pixels along a cell (default 16)")
            ->check(within(1, 256));
        sub->add_option(
               "-o,--output", calibratePatterns_.output,
               "folder for white.png, black.png, x_bit5.png ... and patterns.json; made when missing")
            ->required();
    }

    void addCalibrateProjector(CLI::App* group) {
        CLI::App* sub =
            add("projector", "lens and place of projectors from pictures of their patterns",
                calibrateProjector_, "left right --rig rig.json -o rig.json --overlay found", group);
        auto* folders =
            sub->add_option("DIR", calibrateProjector_.folders,
                            "one folder a projector; in it plane_0, plane_1 ... with the camera's "
                            "pictures, named as the patterns are (.png .jpg .tif), and patterns/ or "
                            "patterns.json as `calibrate patterns` writes it")
                ->required();
        sub->add_option("--rig", calibrateProjector_.rig, "rig with the calibrated camera (.json)")
            ->required();
        sub->add_option("--id", calibrateProjector_.ids,
                        "the projectors' names in the rig, with commas between (default: \"id\" in "
                        "projector.json, else the folder's name)")
            ->delimiter(',')
            ->needs(folders);
        sub->add_option("--spacing", calibrateProjector_.spacing,
                        "metres from plane to plane, plane_0 on the table (default 0.0246)")
            ->check(positive());
        sub->add_option(
               "--heights", calibrateProjector_.heights,
               "metres over the table of each plane in turn, with commas between, in place of --spacing")
            ->delimiter(',')
            ->check(within(-1, 10));
        sub->add_option("--size", calibrateProjector_.size,
                        "pixels of the projector (default: as the patterns in DIR, else 1024x768)");
        sub->add_option("--cell", calibrateProjector_.cell,
                        "projector pixels along a cell (default: as the patterns in DIR, else 16)")
            ->check(within(1, 256));
        sub->add_option("--overlay", calibrateProjector_.overlay,
                        "folder for pictures with the corners found; made when missing");
        written(sub->add_option("-o,--output", calibrateProjector_.output,
                                "the rig with the projectors put in (.json)"))
            ->transform(resultNamed(".json"))
            ->required();
    }

    void addLive() {
        std::string example = "--rig rig.json --camera aravis:\n\nIn any window:\n";
        for (const auto& [keys, what] : present::operatorKeys())
            example += fmt::format("  {:<26} {}\n", keys, what);
        CLI::App* sub =
            add("live", "light on the table while it is being changed: projectors, camera, operator", live_,
                example);
        sub->add_option("--rig", live_.scene.rig, "calibrated camera and projectors (.json)")->required();
        sub->add_option(
            "--camera", live_.camera,
            "aravis:ID (vendor and serial number, or address; no ID: the first found), replay:FOLDER "
            "(its pictures by name), file:PHOTO (read again when it changes) (default aravis:)");
        sub->add_option(
               "--display", live_.displays,
               "PROJECTOR=OUTPUT, in place of what the rig says; again for each (xrandr lists outputs)")
            ->expected(1)
            ->take_all();
        sub->add_flag("--windowed", live_.windowed,
                      "ordinary windows, in place of the displays that the rig names");
        sub->add_option("--window-scale", live_.windowScale,
                        "of windows against projectors' pixels (default 1)")
            ->check(within(0.1, 4));
        addMesh(sub, live_.scene);
        addBlinds(sub, live_.scene);
        addMoment(sub, live_.moment, true);
        addWeather(sub, live_.moment);
        sub->add_option("--exposure", live_.picture.exposure,
                        "lux of exitance that shows as white (default: chosen from the picture)")
            ->check(positive());
        sub->add_flag("--false-color", live_.picture.falseColor, "lux as colours");
        sub->add_flag("--sky-color", live_.picture.skyColour,
                      "light in the colours of sun and sky, not white");
        addScatter(sub, live_.picture);
        sub->add_option("--interval", live_.interval, "seconds a picture of a replay (default 1)")
            ->check(within(0.01, 86400));
        sub->add_flag("--loop", live_.loop, "start a replay again after its last picture");
        sub->add_option("--duration", live_.duration, "end after so many seconds")->check(positive());
        sub->add_option(
            "--script", live_.script,
            "do what this file says, a line each: wait, look TIMES (until so many pictures of a table that "
            "had changed have been looked at; with file: those that were written), sleep S, time T, sky SKY "
            "(or weather, the file's), wheel N [shift] [ctrl], key K, resize WINDOW WIDTH HEIGHT, close "
            "WINDOW, snapshot NAME, quit. Windows are numbered from 0, in the rig's order of projectors; the "
            "operator's comes last");
        sub->add_option("--snapshots", live_.snapshots,
                        "folder for what the outputs showed at a script's snapshot, and in the end");
    }

    void addBench() {
        CLI::App* sub = add("bench", "error against time of every form-factor kernel, beside other programs",
                            bench_, "--scenes partitions,room.obj --sizes 500,2000 -o bench");
        sub->add_option("--kernels", bench_.kernels,
                        "kernels, with commas between (default all; auto beside them by its name)")
            ->delimiter(',');
        sub->add_option("--scenes", bench_.scenes,
                        "box, ell, partitions, blocks, slot, louvres, all, or models (.obj .gltf .glb), "
                        "whose faces are taken as they are (default partitions)")
            ->delimiter(',');
        sub->add_option("--sizes", bench_.sizes, "triangles of the built-in scenes (default 500,2000)")
            ->delimiter(',')
            ->check(within(12, 200000));
        sub->add_option("--errors", bench_.errors,
                        "row errors asked of the kernels that refine to one (default 1e-2,1e-3,1e-4)")
            ->delimiter(',')
            ->check(within(1e-7, 1.0));
        sub->add_option(
               "--runs", bench_.runs,
               "counted runs of each setting; the median is kept (default 3, and 1 of settings that take "
               "over 2 s)")
            ->check(within(1, 1000));
        sub->add_option("--reference-rows", bench_.referenceRows,
                        "rows of double precision to compare with (default 12)")
            ->check(within(1, 100000));
        sub->add_flag("!--no-peers", bench_.peers, "leave other programs out");
        sub->add_option(
               "--clock", bench_.clock,
               "time to compare by: wall (default), or CPU, of all threads, where the machine has other "
               "work and the device is the processor")
            ->check(CLI::IsMember({"wall", "CPU"}));
        sub->add_option("-o,--output", bench_.output,
                        "folder for bench.csv, .json, .svg and .png; made when missing")
            ->required();
    }

    void addDevices() {
        add("devices", "list the Vulkan devices, with why one cannot be used", devices_, "");
    }

    CLI::App app_;
    CommonArguments common_;
    DetectArguments detect_;
    ModelArguments model_;
    FormFactorArguments formFactors_;
    IlluminanceArguments illuminance_;
    RenderArguments render_;
    TimelapseArguments timelapse_;
    AnnualArguments annual_;
    CalibrateTargetArguments calibrateTarget_;
    CalibrateCameraArguments calibrateCamera_;
    LiveArguments live_;
    CalibratePatternsArguments calibratePatterns_;
    CalibrateProjectorArguments calibrateProjector_;
    BenchArguments bench_;
    DevicesArguments devices_;
    std::vector<std::pair<CLI::App*, std::function<Command()>>> commands_;
    std::set<const CLI::Option*> writtenFiles_;
};

} // namespace

std::optional<Arguments> parseArguments(int argc, const char* const* argv) {
    std::vector<const char*> words(argv, argv + argc);
    if (argc > 1 && words[1] == std::string("help")) { // "help render" for "render --help"
        words.erase(words.begin() + 1);
        words.push_back("--help");
    }
    return Parser().parse(static_cast<int>(words.size()), words.data());
}

} // namespace heliodon::app
