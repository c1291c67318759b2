#include "engine/app/pictures.h"

#include <system_error>
#include <unistd.h>

#include "geometry/input_error.h"

namespace heliodon::app {

passes::FrameRenderer makeRenderer(Run& run, const Scene& scene, gpu::Device* other) {
    gpu::Device& device = other ? *other : run.device();
    const StageTimer timer(run, "prepare");
    return passes::FrameRenderer(device, scene.mesh, scene.occluders, scene.rig ? &*scene.rig : nullptr);
}

passes::Tone toned(passes::Tone tone, const PictureArguments& arguments, bool falseColour) {
    if (falseColour) tone.map = passes::ToneMap::falseColour;
    tone.whiteLux = arguments.exposure;
    return tone;
}

void prepareFolder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!std::filesystem::is_directory(folder))
        throw geometry::InputError(folder.string(), "", "is not a folder and cannot be made one");
    if (::access(folder.c_str(), W_OK) != 0)
        throw geometry::InputError(folder.string(), "", "cannot be written to");
}

} // namespace heliodon::app
