// The command line as plain values: one struct a command. What the options mean stands in arguments.cpp,
// where --help is made of it; numbers have been checked against the ranges said there, texts and files
// have not: whoever uses them does, and names the option or the file. An empty text or path is an option
// not given.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace heliodon::app {

struct CommonArguments {
    std::string device; // name or index; empty: the default choice
    std::filesystem::path report;
    std::vector<std::filesystem::path> resultFiles;   // that are no folders
    std::vector<std::filesystem::path> outputFolders; // made where they are missing
    std::vector<std::filesystem::path> readFiles;     // what the other words name, where it is there
    bool quiet = false;
};

// What to work on: a photograph, a sketch or a model; stages start where the input starts.
struct SceneArguments {
    std::filesystem::path input, rig;
    std::optional<size_t> triangles;
    std::optional<double> chordError; // inches on the table
    std::string up = "y";
    double northDeg = 0;               // turns north clockwise seen from above
    std::optional<double> modelScale;  // how many times larger than a model from a file its building is
    std::vector<std::string> glass;    // MATERIAL=T[,T,T] of a model from a file
    std::optional<double> reflectance; // of materials that a model from a file does not define
    std::vector<std::string> leftOut;  // objects and materials of a model from a file
    std::vector<std::string> blinds;   // [MATERIAL=]STATE, see blinds.h
};

// Where, when and under which sky; empty: the default, which is printed.
struct MomentArguments {
    std::string site, time, sky;
    std::filesystem::path weather; // in place of `sky`
    std::optional<double> groundAlbedo;
};

struct PictureArguments {
    std::optional<double> exposure;
    bool falseColor = false, exr = false, skyColour = false, compensateScatter = false;
    std::string size; // of previews, "1280x960"; empty: the default
};

struct DetectArguments {
    std::filesystem::path photo, rig, output, overlay;
};
struct ModelArguments {
    SceneArguments scene;
    std::filesystem::path plan, output;
};
struct FormFactorArguments {
    SceneArguments scene;
    std::string kernel = "auto";
    std::optional<unsigned> resolution, points; // 64 and 1
    double maxError = 0, maxRadiosityError = 0;
    std::filesystem::path reference, output;
};
struct IlluminanceArguments {
    SceneArguments scene;
    MomentArguments moment;
    std::filesystem::path sensors, plan, output;
    double maxError = 0; // of each sensor's lux, relative; 0: no bound asked for
    bool sunDisc = false;
};
struct RenderArguments {
    SceneArguments scene;
    MomentArguments moment;
    PictureArguments picture;
    bool contactSheet = false;
    std::string days, hours; // of the contact sheet; empty: the paper's
    bool stamp = true; // date, time, sun, sky and white on previews, the sun's height on the sheet's cells
    double maxRadiosityError = 0;
    std::filesystem::path output;
};
struct TimelapseArguments {
    SceneArguments scene;
    MomentArguments moment;
    PictureArguments picture;
    std::string from, to, step;
    std::string view; // "preview", "projectors", "none"; empty: projectors with a rig, else preview
    double framesPerSecond = 24;
    bool resume = false, stamp = true; // date, time and sun on previews
    std::filesystem::path output;
};
struct AnnualArguments {
    SceneArguments scene;
    std::filesystem::path weather, sensors;
    std::string occupied = "8-18";
    double groundAlbedo = 0.2;
    std::string temporal; // rows of sensors that get a map of their own, or "all"
    bool ill = false, svg = false, sunDisc = false;
    std::filesystem::path output;
};
struct CalibrateTargetArguments {
    double boardEdge = 1.016; // metres
    std::filesystem::path output;
};
struct CalibrateCameraArguments {
    std::vector<std::filesystem::path> images;
    std::string flat; // name of the picture whose board lies on the table; empty: see calibrate_camera.cpp
    double tableDiameter = 0;                     // metres; 0: the rig's, else the paper's
    double boardEdge = 1.016, boardThickness = 0; // metres
    std::filesystem::path rig, output, overlay;
};
struct LiveArguments {
    SceneArguments scene; // its input is the camera
    MomentArguments moment;
    PictureArguments picture;
    std::string camera;
    std::vector<std::string> displays; // "P1=HDMI-2"
    double interval = 1;               // seconds, of a replay
    bool loop = false, windowed = false;
    double windowScale = 1, duration = 0; // seconds; 0: until it is closed
    std::filesystem::path script, snapshots;
};
struct CalibratePatternsArguments {
    std::string size = "1024x768";
    int cell = 16;
    std::filesystem::path output;
};
struct CalibrateProjectorArguments {
    std::vector<std::filesystem::path> folders;
    std::vector<std::string> ids; // one a folder; empty: see calibrate_projector.cpp
    std::string size;             // "1024x768"; empty: see calibrate_projector.cpp
    std::optional<int> cell;
    std::vector<double> heights; // metres, of the planes in the order of their numbers
    double spacing = 0.0246;     // metres between planes, where no heights are given
    std::filesystem::path rig, output, overlay;
};
struct BenchArguments {
    std::vector<std::string> kernels{"all"}, scenes{"partitions"};
    std::vector<size_t> sizes;                    // empty: 500 and 2000
    std::vector<double> errors{1e-2, 1e-3, 1e-4}; // RMS of rows', of kernels that are asked for one
    std::optional<int> runs;                      // counted; without: 3, of long ones 1
    size_t referenceRows = 12;
    bool peers = true;
    std::string clock = "wall"; // or "CPU": the time that is compared
    std::filesystem::path output;
};
struct DevicesArguments {};

using Command = std::variant<DetectArguments, ModelArguments, FormFactorArguments, IlluminanceArguments,
                             RenderArguments, TimelapseArguments, AnnualArguments, LiveArguments,
                             CalibrateTargetArguments, CalibrateCameraArguments, CalibratePatternsArguments,
                             CalibrateProjectorArguments, BenchArguments, DevicesArguments>;

struct Arguments {
    std::string commandName;
    CommonArguments common;
    Command command;
};

// None when --help or --version was asked for and has been printed. Throws geometry::InputError on bad usage.
std::optional<Arguments> parseArguments(int argc, const char* const* argv);

} // namespace heliodon::app
