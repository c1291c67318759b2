#include "engine/app/scene_input.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "engine/app/blinds.h"
#include "engine/app/interrupt.h"
#include "engine/app/model_hints.h"
#include "engine/app/work_plane.h"
#include "geometry/bounds.h"
#include "geometry/counted.h"
#include "geometry/input_error.h"
#include "geometry/lower_case.h"
#include "geometry/mesher.h"
#include "geometry/number_text.h"
#include "geometry/room_measures.h"
#include "geometry/sketch.h"
#include "vision/detect.h"

namespace heliodon::app {

using geometry::InputError;
using nlohmann::json;

namespace {

enum class InputKind { photograph, sketch, model };

InputKind kindOf(const std::filesystem::path& input) {
    const std::string extension = geometry::loweredExtension(input);
    if (input.empty()) throw InputError("command line", "INPUT", "is empty, expected a file");
    if (!std::filesystem::exists(input)) throw InputError(input.string(), "", "does not exist");
    if (std::filesystem::is_directory(input))
        throw InputError(input.string(), "", "is a folder, expected a photograph, a sketch or a model");
    if (extension == ".json") return InputKind::sketch;
    if (extension == ".obj" || extension == ".gltf" || extension == ".glb") return InputKind::model;
    for (const char* picture : {".png", ".jpg", ".jpeg", ".tif", ".tiff"})
        if (extension == picture) return InputKind::photograph;
    throw InputError(
        input.string(), "",
        fmt::format(
            "'{}' is no known input, expected a photograph (.png .jpg .tif), a sketch (.json) or a model "
            "(.obj .gltf .glb)",
            extension));
}

const char* outcomeName(geometry::Outcome outcome) {
    switch (outcome) {
    case geometry::Outcome::ok:
        return "ok";
    case geometry::Outcome::warn:
        return "warn";
    case geometry::Outcome::refuse:
        break;
    }
    return "refuse";
}

void reportClosure(Run& run, const geometry::ClosureReport& closure) {
    json& report = run.report();
    report["outcome"] = outcomeName(closure.outcome);
    report["code"] = closure.code;
    report["message"] = closure.message;
    report["rooms"] = json::array();
    for (const geometry::RoomReport& room : closure.rooms)
        report["rooms"].push_back({{"floor_area", room.floorAreaFt2},
                                   {"volume", room.volumeFt3},
                                   {"ceiling", room.ceilingFt},
                                   {"euler", room.euler},
                                   {"closed", room.closed},
                                   {"self_intersecting", room.selfIntersecting}});
    report["n_rooms"] = closure.rooms.size();
    report["n_windows"] = closure.windowCount;
    report["n_skylight_panes"] = closure.skylightPaneCount;
    report["walls"] = json::array();
    for (const geometry::WallRole& wall : closure.walls) {
        json entry = {{"id", wall.id}, {"role", wall.role}};
        if (!wall.reason.empty()) entry["reason"] = wall.reason;
        report["walls"].push_back(std::move(entry));
    }
}

// The same fields for a model: importModel has proven its rooms closed, or refused.
void reportImport(Run& run, const geometry::PatchMesh& mesh, const geometry::Building& building,
                  const geometry::PatchMesh& own, double worldPerBuilding, geometry::UpAxis up) {
    const double foot = geometry::kMetresPerFoot * worldPerBuilding;
    const std::vector<geometry::RoomMeasures> rooms = geometry::measureRooms(own, worldPerBuilding);
    json& report = run.report();
    report["outcome"] = "ok";
    report["code"] = "OK";
    std::string message = geometry::counted(rooms.size(), "room");
    for (const std::string& repair : building.repairs) message += "; " + repair;
    report["message"] = message;
    report["repairs"] = building.repairs;
    report["walls"] = json::array(); // of sketches, which have names for theirs
    for (const std::string& warning : building.warnings) run.warn(warning);
    report["n_rooms"] = rooms.size();
    report["rooms"] = json::array();
    std::vector<size_t> thin;
    for (size_t r = 0; r < rooms.size(); ++r)
        if (geometry::isLikeInsideOfWalls(rooms[r], worldPerBuilding)) thin.push_back(r);
    if (!thin.empty())
        run.warn(fmt::format(
            "room {} is {:.2f} m deep on average, as the inside of walls is{}: the faces of a "
            "model must bound the air of its rooms, not their walls",
            thin[0], geometry::meanDepth(rooms[thin[0]]) / worldPerBuilding,
            thin.size() > 1 ? fmt::format(" (so are {} more of {})", thin.size() - 1, rooms.size()) : ""));
    const bool dark = std::ranges::all_of(rooms, [](const auto& room) { return room.openings == 0; });
    for (size_t r = 0; r < rooms.size() && dark; ++r)
        if (geometry::isLikeFloorAndWalls(rooms[r]))
            run.warn(fmt::format(
                "no room has glass, and room {} is {:.2g} m high on average under its highest point at "
                "{:.2g} m, "
                "as the inside of a floor and walls drawn with their thickness is: the faces of a model must "
                "bound the air of its rooms",
                r, rooms[r].volume / rooms[r].floorArea / worldPerBuilding,
                rooms[r].height / worldPerBuilding));
    for (size_t r = 0; r < rooms.size(); ++r)
        for (const size_t i : rooms[r].mayBeFloor) {
            const glm::dvec3 p = modelFromWorld(geometry::patchCentroid(own, i), up);
            run.warn(
                fmt::format("what lies level at ({:.4g}, {:.4g}, {:.4g}) in room {} may be a gallery or a "
                            "stage: no stairs lead there, and it was taken as no floor",
                            p.x, p.y, p.z, r));
        }
    for (const geometry::RoomMeasures& room : rooms)
        report["rooms"].push_back({{"floor_area", room.floorArea / (foot * foot)},
                                   {"volume", room.volume / (foot * foot * foot)},
                                   {"ceiling", room.height / foot},
                                   {"euler", room.euler},
                                   {"closed", true},
                                   {"self_intersecting", false}});
    const geometry::PaneCount panes = geometry::countPanes(mesh);
    report["n_windows"] = panes.windows;
    report["n_skylight_panes"] = panes.skylightPanes;
}

// Triangles are chords of curved walls.
void reportMesh(Run& run, const geometry::PatchMesh& own, const geometry::PatchMesh& mesh) {
    constexpr double kMuch = 0.01; // of a room
    const geometry::MeshQuality quality = geometry::measureMesh(mesh);
    const geometry::VolumeError volume = geometry::worstVolumeError(own, mesh);
    run.report()["triangles"] = quality.triangles;
    run.report()["mesh"] = {{"triangles", quality.triangles},
                            {"min_angle_deg", quality.minAngleDeg},
                            {"min_angle_all_deg", quality.minAngleAllDeg},
                            {"strip_triangles", quality.stripTriangles},
                            {"area_deviation", quality.areaDeviation},
                            {"volume_error", volume.share}};
    if (std::abs(volume.share) > kMuch)
        run.warn(fmt::format(
            "the triangles of room {} enclose {:.1f} % {} than its walls do: more of them (--triangles) are "
            "nearer to curves",
            volume.room, 100 * std::abs(volume.share), volume.share < 0 ? "less" : "more"));
}

geometry::Building importOrRefuse(Run& run, const SceneArguments& arguments, geometry::UpAxis up,
                                  const OnRefusal& onRefusal) {
    const StageTimer timer(run, "model");
    try {
        const std::optional<double>& scale = arguments.modelScale;
        return geometry::importModel(arguments.input, up,
                                     {throwIfInterrupted, scale ? std::optional(1 / *scale) : std::nullopt,
                                      materialsOf(arguments), onRefusal});
    } catch (const InputError& error) {
        run.report()["outcome"] = "refuse";
        run.report()["code"] = "BAD_MODEL";
        run.report()["message"] = error.what();
        throw;
    }
}

constexpr double kCoarseChord = 0.06, kCoarsestChord = 0.3; // inches

// Facets of curved walls as long as the triangles will be.
void fitFacets(Run& run, const SceneArguments& arguments, const geometry::Sketch& sketch, size_t wanted,
               geometry::ClosureOptions& options) {
    const StageTimer timer(run, "model");
    geometry::ClosureOptions coarse = options; // enough to know the rooms' surface by
    coarse.chordError = std::max(coarse.chordError, kCoarseChord);
    const double surface = geometry::surfaceOfRooms(sketch, coarse);
    if (surface > 0) options.facetLength = geometry::fittingFacet(surface, {wanted});
    if (!arguments.chordError) options.coarseChord = kCoarseChord;
}

// Of a photograph that gives no room: a wall may be among it.
std::string whatWasLeftOut(Run& run) {
    const auto count = run.report().value(json::json_pointer("/detected/walls_left_out"), size_t{0});
    if (count == 0) return {};
    return fmt::format("; {} in the photograph {} left out that may be {}: its warnings name {}",
                       geometry::counted(count, "piece"), count == 1 ? "was" : "were",
                       count == 1 ? "a wall" : "walls", count == 1 ? "it" : "them");
}

// Where that closes nothing, facets are left as the chord error alone makes them.
geometry::Building closeOrRefuse(Run& run, const SceneArguments& arguments, const geometry::Sketch& sketch,
                                 geometry::ClosureOptions& options) {
    const StageTimer timer(run, "model");
    geometry::Closure closure = geometry::closeSketch(sketch, options);
    if (!closure.building && options.facetLength > 0) {
        options.facetLength = options.coarseChord = 0;
        closure = geometry::closeSketch(sketch, options);
    }
    reportClosure(run, closure.report);
    if (!closure.building)
        throw InputError(arguments.input.string(), "",
                         closure.report.code + ": " + closure.report.message + whatWasLeftOut(run));
    if (closure.report.outcome == geometry::Outcome::warn)
        run.warn(closure.report.code + ": " + closure.report.message);
    return std::move(*closure.building);
}

// More triangles than were asked for, or so few to an arc that they are slivers.
bool tooManyFacets(const geometry::PatchMesh& mesh, size_t wanted) {
    const geometry::MeshQuality quality = geometry::measureMesh(mesh);
    constexpr double kSliver = 20; // degrees
    return static_cast<double>(quality.triangles) > 1.03 * static_cast<double>(wanted) ||
           quality.minAngleDeg < kSliver;
}

} // namespace

void warnOfUnknown(Run& run, const std::filesystem::path& file, const std::vector<std::string>& fields,
                   const char* of) {
    if (fields.empty()) return;
    constexpr size_t kFew = 5;
    const std::span few(fields.data(), std::min(fields.size(), kFew));
    run.warn(fmt::format("{}: {}{} {} no part of a {} and make{} no difference", file.string(),
                         fmt::join(few, ", "),
                         fields.size() > kFew ? fmt::format(" and {} more", fields.size() - kFew) : "",
                         fields.size() == 1 ? "is" : "are", of, fields.size() == 1 ? "s" : ""));
}

bool isPhotograph(const std::filesystem::path& input) {
    return kindOf(input) == InputKind::photograph;
}

void refuseGrey(const vision::Photograph& photograph) {
    if (!vision::hasColor(photograph))
        throw InputError(photograph.name, "",
                         "is grey, expected a colour photograph: colours state what the pieces are");
}

geometry::UpAxis upAxisOf(const SceneArguments& arguments) {
    return arguments.up == "z" ? geometry::UpAxis::z : geometry::UpAxis::y;
}

geometry::GivenMaterials materialsOf(const SceneArguments& arguments) {
    geometry::GivenMaterials all;
    all.leftOut = arguments.leftOut;
    if (arguments.reflectance) all.reflectance = static_cast<float>(*arguments.reflectance);
    for (const std::string& text : arguments.glass) {
        const size_t equals = std::min(text.rfind('='), text.size());
        std::vector<float> values;
        for (size_t at = equals; at < text.size();) {
            const size_t end = std::min(text.find(',', ++at), text.size());
            const double value = geometry::numberFrom(text.substr(at, end - at)).value_or(0);
            values.push_back(value > 0 && value <= 1 ? static_cast<float>(value) : 0);
            at = end;
        }
        if (values.size() == 1) values.resize(3, values[0]);
        if (equals == 0 || values.size() != 3 || std::ranges::count(values, 0) > 0)
            throw InputError("--glass", "",
                             fmt::format("'{}': expected MATERIAL=T or MATERIAL=R,G,B, transmittances above "
                                         "0 and at most 1",
                                         text));
        all.glazing.push_back({text.substr(0, equals), {values[0], values[1], values[2]}});
    }
    return all;
}

geometry::Sketch loadSketch(Run& run, const SceneArguments& arguments,
                            const std::optional<geometry::Rig>& rig) {
    if (kindOf(arguments.input) == InputKind::sketch) {
        geometry::Sketch sketch = geometry::readSketch(arguments.input);
        warnOfUnknown(run, arguments.input, sketch.unknownFields, "sketch");
        return sketch;
    }
    if (!rig)
        throw InputError(arguments.input.string(), "",
                         "a photograph needs the calibrated camera, expected --rig RIG.json");
    const vision::Photograph photograph = [&] {
        const StageTimer timer(run, "read");
        auto photo = vision::readPhotograph(arguments.input);
        refuseGrey(photo);
        return photo;
    }();
    vision::DetectionResult found = [&] {
        const StageTimer timer(run, "detect");
        return vision::detectSketch(photograph, *rig);
    }();
    // What is said of the whole picture before what is said of its places.
    std::ranges::stable_partition(found.warnings,
                                  [](const auto& text) { return !text.starts_with("pixel "); });
    run.warnOfEach(found.warnings);
    const geometry::Sketch& s = found.sketch;
    run.report()["detected"] = {{"walls", s.walls.size()},
                                {"arcs", s.arcs.size()},
                                {"windows", s.windows.size()},
                                {"skylights", s.skylights.size()},
                                {"tokens", s.tokens.size()},
                                {"north", s.north.has_value()},
                                {"walls_left_out", found.wallsLeftOut}};
    return std::move(found.sketch);
}

namespace {

// That they are far off is said once: devices are in one unit.
void warnOfPlaces(Run& run, const std::filesystem::path& file, const geometry::Rig& rig) {
    constexpr double kFar = 20; // metres: no ceiling is so high
    std::vector<std::pair<std::string, glm::dvec3>> centres{{"camera", rig.camera.centre()}};
    for (size_t p = 0; p < rig.projectors.size(); ++p)
        centres.emplace_back(fmt::format("projectors[{}]", p), rig.projectors[p].centre());
    for (const auto& [device, centre] : centres) {
        if (const double away = glm::length(centre); away > kFar)
            return run.warn(fmt::format("{}: {} stands {:.0f} m from the table, expected t in metres",
                                        file.string(), device, away));
        if (centre.y < 0)
            run.warn(fmt::format("{}: {} stands {:.2f} m below the top of the table: are its R and t right?",
                                 file.string(), device, -centre.y));
    }
}

// By the face's material and where it lies, in metres of building: faces of the file may have been divided.
geometry::PatchMesh meshOrRefuse(const SceneArguments& arguments, const geometry::Building& building,
                                 const geometry::MeshOptions& options, double worldPerBuilding) {
    try {
        return geometry::meshBuilding(building, options);
    } catch (const geometry::MeshError& error) {
        const geometry::Face& face = building.faces[error.face];
        std::vector<glm::dvec3> corners;
        for (const uint32_t v : face.loops[0]) corners.push_back(building.vertices[v] / worldPerBuilding);
        const geometry::Bounds box = geometry::boundsOf(corners);
        const glm::dvec3 at = 0.5 * (box.low + box.high), size = box.high - box.low;
        throw InputError(arguments.input.string(), "",
                         fmt::format("{}: of \"{}\", {:.3g} m wide and {:.3g} m high, round x {:.2f}, "
                                     "y {:.2f}, z {:.2f} m (y up)",
                                     error.what(), building.materials[face.material].name,
                                     std::hypot(size.x, size.z), size.y, at.x, at.y, at.z));
    }
}

} // namespace

geometry::Rig loadRig(Run& run, const std::filesystem::path& file) {
    geometry::Rig rig = geometry::readRig(file);
    warnOfUnknown(run, file, rig.unknownFields, "rig");
    warnOfPlaces(run, file, rig);
    if (rig.tableAssumed)
        run.assume(fmt::format("a table {:.4g} m across (table.radius_m of the rig says another)",
                               2 * rig.tableRadius));
    return rig;
}

void warnOfNoProjectors(Run& run, const std::filesystem::path& rig) {
    run.warn(rig.string() + ": projectors: there is none, only previews are drawn");
}

SceneSource readSource(Run& run, const SceneArguments& arguments) {
    for (const std::string& state : arguments.blinds) parseWindowState(state); // now, not after the meshing
    const InputKind kind = kindOf(arguments.input);
    if (arguments.modelScale && kind != InputKind::model)
        throw InputError("--model-scale", "",
                         "is for models from files, what lies on the table is 12 times smaller");
    if (arguments.chordError && kind == InputKind::model)
        throw InputError("--chord-error", "", "is for curved walls on the table, a model's faces are flat");
    if (arguments.reflectance && kind != InputKind::model)
        throw InputError("--reflectance", "",
                         "is for models from files, tokens on the table say it of the walls there");
    if (!materialsOf(arguments).glazing.empty() && kind != InputKind::model)
        throw InputError("--glass", "", "is for models from files, glass on the table is clear");
    if (!arguments.leftOut.empty() && kind != InputKind::model)
        throw InputError("--leave-out", "",
                         "is for models from files, what is no wall lies beside the table");
    if (arguments.up == "z" && kind != InputKind::model)
        run.warn("--up is not used: it is for models from files, what lies on the table has y up");
    SceneSource source;
    if (!arguments.rig.empty()) source.rig = loadRig(run, arguments.rig);
    if (kind != InputKind::model) source.sketch = loadSketch(run, arguments, source.rig);
    return source;
}

Scene loadScene(Run& run, const SceneArguments& arguments) {
    SceneSource source = readSource(run, arguments);
    return makeScene(run, arguments, std::move(source.rig), std::move(source.sketch));
}

Scene makeScene(Run& run, const SceneArguments& arguments, std::optional<geometry::Rig> rig,
                std::optional<geometry::Sketch> sketch, const OnRefusal& onRefusal) {
    Scene scene;
    scene.up = upAxisOf(arguments);
    scene.rig = std::move(rig);
    scene.sketch = std::move(sketch);
    geometry::Building building;
    const size_t wanted = arguments.triangles.value_or(kDefaultTriangles);
    const bool curved = scene.sketch && !scene.sketch->arcs.empty();
    geometry::ClosureOptions closure;
    closure.chordError = arguments.chordError.value_or(closure.chordError);
    if (!scene.sketch) {
        building = importOrRefuse(run, arguments, scene.up, onRefusal);
        scene.worldPerBuilding = modelScale(run, arguments.modelScale, building);
    } else {
        if (curved) fitFacets(run, arguments, *scene.sketch, wanted, closure);
        building = closeOrRefuse(run, arguments, *scene.sketch, closure);
    }
    {
        const StageTimer timer(run, "model");
        scene.mesh = meshOrRefuse(arguments, building, {wanted, throwIfInterrupted, !scene.sketch},
                                  scene.worldPerBuilding);
        // Curved walls of many facets need many triangles; with few, coarser facets serve better.
        const bool mayCoarsen = curved && !arguments.chordError;
        while (mayCoarsen && closure.chordError < kCoarsestChord && tooManyFacets(scene.mesh, wanted)) {
            const std::vector<int> before = geometry::facetsOfArcs(*scene.sketch, closure);
            closure.chordError *= 4;
            if (geometry::facetsOfArcs(*scene.sketch, closure) == before) break;
            geometry::Closure coarser = geometry::closeSketch(*scene.sketch, closure);
            if (!coarser.building) break;
            building = std::move(*coarser.building);
            reportClosure(run, coarser.report);
            scene.mesh =
                meshOrRefuse(arguments, building, {wanted, throwIfInterrupted}, scene.worldPerBuilding);
        }
    }
    const geometry::PatchMesh own = geometry::ownTriangles(building);
    if (!scene.sketch) {
        reportImport(run, scene.mesh, building, own, scene.worldPerBuilding, scene.up);
        warnOfLying(run, scene.mesh, scene.worldPerBuilding, scene.up);
    }
    reportMesh(run, own, scene.mesh);
    drawBlinds(run, arguments.blinds, arguments.input.string(), scene.mesh);
    scene.occluders = std::move(building.occluders);
    scene.northDeg = building.northDeg - arguments.northDeg; // plan angles grow counter-clockwise
    if (arguments.northDeg == 0 && !building.northIsSaid)
        scene.assumedNorth = scene.sketch                      ? kAssumedNorth
                             : scene.up == geometry::UpAxis::z ? "north along y of the model"
                                                               : "north along -z of the model";
    return scene;
}

} // namespace heliodon::app
