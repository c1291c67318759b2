#include "engine/app/frame_job.h"

#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "geometry/text_file.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

using nlohmann::ordered_json;

namespace {

constexpr const char* kFormat = "heliodon-frames/1";
constexpr const char* kHash = "fnv1a:";

// Fowler, Noll, Vo: FNV-1a, 64 bits. Against mix-ups, not against forgery.
class Hash {
public:
    void add(const void* data, size_t bytes) {
        const auto* at = static_cast<const unsigned char*>(data);
        for (size_t i = 0; i < bytes; ++i) value_ = (value_ ^ at[i]) * 0x100000001b3u;
    }
    template<class T> void add(const std::vector<T>& values) {
        const size_t count = values.size();
        add(&count, sizeof count);
        add(values.data(), count * sizeof(T));
    }
    std::string text() const { return fmt::format("{}{:016x}", kHash, value_); }

private:
    uint64_t value_ = 0xcbf29ce484222325u;
};

std::string hashOfFile(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
    Hash hash;
    hash.add(bytes);
    return hash.text();
}

std::string hashIfFile(const std::string& text) {
    std::error_code none;
    return std::filesystem::is_regular_file(text, none) ? hashOfFile(text) : text;
}

// Files that the input names (.mtl, .bin) and what was made of all of them.
std::string hashOfScene(const Scene& scene) {
    Hash hash;
    const geometry::PatchMesh& mesh = scene.mesh;
    hash.add(mesh.vertices), hash.add(mesh.corners), hash.add(mesh.firstCorner), hash.add(mesh.material);
    hash.add(mesh.role), hash.add(mesh.surface), hash.add(mesh.room), hash.add(mesh.twin);
    for (const geometry::Material& material : mesh.materials) {
        for (const glm::vec3* colour : {&material.reflectance, &material.transmittance, &material.exitance})
            hash.add(colour, sizeof *colour);
        hash.add(&material.refractiveIndex, sizeof material.refractiveIndex);
        const geometry::Blind& blind = material.blind;
        hash.add(&blind.kind, sizeof blind.kind);
        for (const float& value :
             {blind.transmittance, blind.reflectance, blind.slatAngleDeg, blind.slatSpacing})
            hash.add(&value, sizeof value);
    }
    if (!mesh.outside.triangles.empty())
        hash.add(mesh.outside.vertices), hash.add(mesh.outside.triangles), hash.add(mesh.outside.material);
    hash.add(scene.occluders.vertices), hash.add(scene.occluders.triangles);
    hash.add(&scene.northDeg, sizeof scene.northDeg);
    return hash.text();
}

template<class T> ordered_json orDefault(const std::optional<T>& value) {
    return value ? ordered_json(*value) : ordered_json("default");
}

std::string orDefault(const std::string& value) {
    return value.empty() ? "default" : value;
}

std::string readable(const ordered_json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

} // namespace

FrameJob frameJobOf(Run& run, const TimelapseArguments& arguments, const Scene& scene,
                    std::vector<std::string> views, size_t frames) {
    const SceneArguments& input = arguments.scene;
    const PictureArguments& picture = arguments.picture;
    FrameJob job{{}, std::move(views), frames};
    job.options = {
        {"INPUT", hashOfFile(input.input)},
        {"--rig", input.rig.empty() ? "none" : hashOfFile(input.rig)},
        {"--triangles", orDefault(input.triangles)},
        {"--chord-error", orDefault(input.chordError)},
        {"--up", input.up},
        {"--model-scale", orDefault(input.modelScale)},
        {"--north", input.northDeg},
        {"--glass", input.glass.empty() ? "none" : fmt::format("{}", fmt::join(input.glass, " "))},
        {"--reflectance", orDefault(input.reflectance)},
        {"--leave-out", input.leftOut.empty() ? "none" : fmt::format("{}", fmt::join(input.leftOut, " "))},
        {"--blinds", input.blinds.empty() ? "open" : fmt::format("{}", fmt::join(input.blinds, " "))},
        {"the model made of INPUT", hashOfScene(scene)},
        {"--site", orDefault(arguments.moment.site)},
        {"--sky", hashIfFile(orDefault(arguments.moment.sky))},
        {"--ground", orDefault(arguments.moment.groundAlbedo)},
        {"--weather", arguments.moment.weather.empty() ? "none" : hashOfFile(arguments.moment.weather)},
        {"--from", arguments.from},
        {"--to", arguments.to},
        {"--step", arguments.step},
        {"--view", job.views.empty() ? "none" : fmt::format("{}", fmt::join(job.views, " "))},
        {"--size", orDefault(picture.size)},
        {"--exposure", orDefault(picture.exposure)},
        {"--false-color", picture.falseColor},
        {"--sky-color", picture.skyColour},
        {"--compensate-scatter", picture.compensateScatter},
        {"--exr", picture.exr},
        {"--no-stamp", !arguments.stamp},
        {"--device", run.device().info().name},
        {"the program's version", HELIODON_VERSION}};
    return job;
}

std::optional<std::string> difference(const FrameJob& there, const FrameJob& here) {
    for (const auto& [name, value] : here.options.items()) {
        const ordered_json old = there.options.value(name, ordered_json("unknown"));
        if (old == value) continue;
        const std::string a = readable(old), b = readable(value);
        if (a.starts_with(kHash) && b.starts_with(kHash))
            return fmt::format("{} is not what it was",
                               name.starts_with("--") ? "the file of " + name : name);
        const auto shown = [](const std::string& text) { return text.starts_with(kHash) ? "a file" : text; };
        return fmt::format("{} is {} there and {} here", name, shown(a), shown(b));
    }
    if (there.views != here.views || there.frames != here.frames) return "the number of pictures";
    return std::nullopt;
}

std::optional<FrameJob> readFrameJob(const std::filesystem::path& file) {
    std::ifstream in(file);
    const ordered_json all = ordered_json::parse(in, nullptr, false);
    try {
        if (!all.is_object() || all.at("format") != kFormat || !all.at("job").is_object())
            return std::nullopt;
        return FrameJob{all.at("job"), all.at("views").get<std::vector<std::string>>(),
                        all.at("frames").get<size_t>()};
    } catch (const ordered_json::exception&) {
        return std::nullopt;
    }
}

void writeFrameJob(const FrameJob& job, const std::filesystem::path& file) {
    const ordered_json all{
        {"format", kFormat}, {"frames", job.frames}, {"views", job.views}, {"job", job.options}};
    geometry::writeWholeText(file, geometry::jsonText(all));
}

} // namespace heliodon::app
