#include "geometry/picture_file.h"

#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>

#include <dlfcn.h>
#include <fmt/format.h>
#include <link.h>

#include "geometry/whole_file.h"

namespace heliodon::geometry {

namespace {

// By its place: a search path of the program's own is not followed under the address sanitizer.
std::filesystem::path moduleFile() {
    const auto folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    const auto built = folder / HELIODON_PICTURE_CODECS;
    if (std::filesystem::exists(built)) return built;
    const auto installed = folder / HELIODON_INSTALLED_FOLDER / HELIODON_PICTURE_CODECS;
    if (!std::filesystem::exists(installed))
        throw std::runtime_error(fmt::format(
            "{}, which reads and writes pictures, is missing: expected beside the program in {}, or in {}",
            HELIODON_PICTURE_CODECS, folder.string(), installed.parent_path().lexically_normal().string()));
    return installed;
}

// One that is cut short is mapped all the same, and would end the program where its bytes end.
void refuseCut(const std::filesystem::path& module) {
    ElfW(Ehdr) header{}; // what it says to be last is the table of sections
    std::ifstream(module, std::ios::binary).read(reinterpret_cast<char*>(&header), sizeof header);
    const uintmax_t end = header.e_shoff + uintmax_t{header.e_shnum} * header.e_shentsize;
    if (end == 0 || end > std::filesystem::file_size(module))
        throw std::runtime_error(module.string() +
                                 ", which reads and writes pictures, is cut short: expected a whole file");
}

const PictureCodecs& load() {
    const std::filesystem::path file = moduleFile();
    refuseCut(file);
    void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL); // never closed: the libraries stay in use
    const auto* codecs =
        module ? static_cast<const PictureCodecs*>(dlsym(module, "heliodonPictureCodecs")) : nullptr;
    if (!codecs)
        throw std::runtime_error(std::string("the part that reads and writes pictures: ") + dlerror());
    if (codecs->version != kPictureCodecsVersion)
        throw std::runtime_error(file.string() + " belongs to another build of this program");
    return *codecs;
}

const PictureCodecs& codecs() {
    static const PictureCodecs& loaded = load();
    return loaded;
}

} // namespace

std::vector<uint8_t> bytesOf(const std::filesystem::path& file) {
    std::error_code gone;
    const uintmax_t size = std::filesystem::file_size(file, gone);
    std::vector<uint8_t> bytes(gone ? 0 : size); // at once: a photograph waits for it
    std::ifstream(file, std::ios::binary)
        .read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return bytes;
}

std::optional<PicturePixels> pictureIn(const std::vector<uint8_t>& bytes) {
    return codecs().picture(bytes);
}

std::optional<GreyPixels> greyPictureIn(const std::vector<uint8_t>& bytes) {
    return codecs().greyPicture(bytes);
}

std::optional<std::string> jpegDamageIn(const std::vector<uint8_t>& bytes) {
    return codecs().jpegDamage(bytes);
}

void writePngFile(const std::filesystem::path& file, int width, int height, const uint8_t* rgb) {
    writeWhole(file, [&](const std::filesystem::path& aside) {
        if (!codecs().writePng(aside, width, height, rgb))
            throw std::runtime_error(file.string() + ": the PNG could not be written (disk full?)");
    });
}

std::unique_ptr<FilmEncoder> openFilmFile(const std::filesystem::path& file, int width, int height,
                                          double framesPerSecond) {
    return codecs().openFilm(file, width, height, framesPerSecond);
}

} // namespace heliodon::geometry
