// Wavefront .obj and .mtl. Our own reader because every refusal must name its line; what lights need is a
// small part of the format: v, vn, s, f, usemtl, mtllib, g, o, north, twins; Kd, Tf, Ni, Ke,
// and `blinds`, our own.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "geometry/input_error.h"
#include "geometry/lower_case.h"
#include "geometry/named_files.h"
#include "geometry/number_text.h"
#include "geometry/picture_file.h"
#include "geometry/raw_model.h"
#include "geometry/text_file.h"
#include "geometry/texture_mean.h"

namespace heliodon::geometry {

namespace {

// Walks over the logical lines of a text file (a trailing backslash continues a line) and their words.
class Lines {
public:
    // `expected`: what the file should be.
    Lines(const std::filesystem::path& file, const std::string& expected)
        : file_(file.string()), text_(readText(file, expected, kLargestModel)) {
        refuseOtherKinds(file, text_, expected);
        constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
        if (text_.starts_with(kByteOrderMark)) position_ = kByteOrderMark.size();
        if (text_.find('\n') == std::string::npos) std::ranges::replace(text_, '\r', '\n'); // old Macs' lines
    }

    bool next() {
        line_.clear();
        number_ = nextNumber_;
        if (position_ >= text_.size()) return false;
        bool continued = true;
        while (continued && position_ < text_.size()) {
            size_t end = text_.find('\n', position_);
            if (end == std::string::npos) end = text_.size();
            std::string_view piece(text_.data() + position_, end - position_);
            if (!piece.empty() && piece.back() == '\r') piece.remove_suffix(1);
            continued = !piece.empty() && piece.back() == '\\';
            if (continued) piece.remove_suffix(1);
            line_ += piece;
            if (continued) line_ += ' ';
            position_ = end + 1;
            ++nextNumber_;
        }
        if (const size_t comment = line_.find('#'); comment != std::string::npos) line_.resize(comment);
        rest_ = line_;
        return true;
    }

    // The next word of the line; empty at its end.
    std::string_view word() {
        const size_t begin = rest_.find_first_not_of(" \t");
        if (begin == std::string_view::npos) return rest_ = {};
        const size_t end = std::min(rest_.find_first_of(" \t", begin), rest_.size());
        const std::string_view found = rest_.substr(begin, end - begin);
        rest_.remove_prefix(end);
        return found;
    }

    // The remainder of the line without blanks at either end: names may hold blanks.
    std::string remainder() {
        const size_t begin = rest_.find_first_not_of(" \t");
        if (begin == std::string_view::npos) return {};
        return std::string(rest_.substr(begin, rest_.find_last_not_of(" \t") + 1 - begin));
    }

    double number(const char* expected) {
        const std::string_view text = word();
        const std::optional<double> value = signedNumberFrom(text);
        if (!value)
            fail(text.empty() ? fmt::format("ends early, expected {}", expected)
                              : fmt::format("\"{}\" is not a finite number, expected {}", text, expected));
        return *value;
    }

    [[noreturn]] void fail(const std::string& what) const { throw InputError(file_, place(), what); }
    std::string place() const { return std::to_string(number_); }
    size_t lineNumber() const { return number_; }
    const std::string& file() const { return file_; }

private:
    std::string file_, text_, line_;
    std::string_view rest_;
    size_t position_ = 0, number_ = 0, nextNumber_ = 1;
};

using MaterialIndex = std::map<std::string, uint32_t, std::less<>>;

constexpr MaterialFields kFields{"Kd", "Tf", "Ke", "Ni"};

struct MaterialDraft {
    Material material;
    std::string place, colourPlace;     // its last line; that of its last Kd or Tf
    std::optional<RawModel::Flaw> flaw; // of the first line with one
    std::string texture;                // as its line has it
    bool hasKd = false;
    std::optional<double> opacity; // as stated

    // Programs that have a filter's colour for every material write "Tf 1 1 1" beside the "d 1" of what is
    // opaque.
    bool hasIdleFilter() const {
        return material.transmittance == glm::vec3(1) && material.reflectance != glm::vec3(0) && opacity == 1;
    }
};

// Programs may name one library before each object.
bool isAlike(const Material& a, const Material& b) {
    return a.reflectance == b.reflectance && a.transmittance == b.transmittance &&
           a.refractiveIndex == b.refractiveIndex && a.exitance == b.exitance && a.blind == b.blind;
}

// Of "brick.png", also after options as "-s 2 2 1"; `file`: that names it.
std::optional<glm::vec3> meanOf(const std::string& texture, const std::string& file) {
    const std::filesystem::path folder = std::filesystem::path(file).parent_path();
    for (const std::string& name : {texture, texture.substr(texture.rfind(' ') + 1)})
        for (const auto find : {fileAt, fileBeside})
            if (const auto picture = find(folder, unquoted(name))) return textureMean(bytesOf(*picture));
    return std::nullopt;
}

void finishMaterial(const MaterialDraft& draft, const std::string& file, RawModel& model,
                    MaterialIndex& index) {
    Material material = draft.material;
    const auto number = static_cast<uint32_t>(model.materials.size());
    if (draft.hasIdleFilter()) {
        material.transmittance = glm::vec3(0);
        model.doubts[number] = fmt::format(
            "material \"{}\" has d 1 and Kd, and Tf 1 1 1: it was taken as opaque", material.name);
    }
    const bool active = material.isOpening() || material.exitance != glm::vec3(0);
    const bool isWhite = draft.hasKd && material.reflectance == glm::vec3(1);
    const std::string picture =
        draft.texture.empty() ? "" : fmt::format("map_Kd {} in {}", draft.texture, file);
    // Programs that state another colour beside it mean either both of them or one.
    const auto mean =
        picture.empty() || active || (draft.hasKd && !isWhite) ? std::nullopt : meanOf(draft.texture, file);
    if (mean) {
        material.reflectance = *mean;
        model.assumed[number] = textureTaken(material.name, *mean, picture);
    } else if (!draft.hasKd && !active) {
        material.reflectance = glm::vec3(0.5f);
        model.assumed[number] =
            fmt::format("material \"{}\" has no Kd: a reflectance of 0.5 was assumed", material.name);
    }
    auto flaw = draft.flaw;
    if (!flaw || flaw->kind == RawModel::Flaw::Kind::tooBright) // a Tf may have followed
        flaw = flawOf(material, kFields, file, draft.colourPlace);
    if (flaw) {
        flaw->material = number;
        model.flaws.push_back(*flaw);
    }
    if (material.blind != Blind{} && !material.isOpening())
        throw InputError(
            file, draft.place,
            fmt::format("material \"{}\" has blinds but lets no light through (Tf)", material.name));
    if (draft.opacity.value_or(1) < 1 && !material.isOpening())
        model.doubts[number] = seeThroughButOpaque(material.name, *draft.opacity, "transmittance (Tf)");
    if (!picture.empty() && !mean) model.unread[number] = picture;
    if (const auto before = index.find(material.name);
        before != index.end() && !isAlike(material, model.materials[before->second])) {
        std::string& doubt = model.doubts[number];
        doubt +=
            fmt::format("{}material \"{}\" is defined again in {}:{}: faces that name it from there on are "
                        "of that",
                        doubt.empty() ? "" : "; ", material.name, file, draft.place);
    }
    index[material.name] = number;
    model.materials.push_back(std::move(material));
}

// "d 0.4", "d -halo 0.4"; "Tr 0.6" is what is let through. 1 where it is no number.
double readOpacity(bool through, Lines& lines) {
    std::string_view word = lines.word();
    if (word == "-halo") word = lines.word();
    double value = through ? 0 : 1;
    std::from_chars(word.data(), word.data() + word.size(), value);
    return through ? 1 - value : value;
}

// "r g b", or "r" for a grey.
glm::vec3 readRgb(Lines& lines) {
    const char* const expected = "three numbers r g b";
    glm::vec3 rgb(static_cast<float>(lines.number(expected)));
    if (lines.remainder().empty()) return rgb;
    for (int c = 1; c < 3; ++c) rgb[c] = static_cast<float>(lines.number(expected));
    return rgb;
}

void readMtl(const std::filesystem::path& file, RawModel& model, MaterialIndex& index) {
    Lines lines(file, "materials (.mtl)");
    std::optional<MaterialDraft> draft;
    while (lines.next()) {
        const std::string_view key = lines.word();
        if (key == "newmtl") {
            if (draft) finishMaterial(*draft, lines.file(), model, index);
            draft.emplace();
            draft->material.name = lines.remainder();
            draft->place = lines.place();
            if (draft->material.name.empty()) lines.fail("newmtl without a name");
            continue;
        }
        const bool known = key == "Kd" || key == "Tf" || key == "Ke" || key == "Ni" || key == "blinds";
        if (known && !draft) lines.fail(fmt::format("{} stands before any newmtl", key));
        if (key == "Kd") {
            draft->material.reflectance = readRgb(lines);
            draft->hasKd = true;
        } else if (key == "Tf") {
            draft->material.transmittance = readRgb(lines);
        } else if (key == "Ke") {
            draft->material.exitance = readRgb(lines);
        } else if (key == "Ni") {
            draft->material.refractiveIndex = static_cast<float>(lines.number("a refractive index"));
        } else if ((key == "d" || key == "Tr") && draft) {
            draft->opacity = readOpacity(key == "Tr", lines);
        } else if (key == "map_Kd" && draft) {
            draft->texture = lines.remainder();
        } else if (key == "blinds") {
            try {
                draft->material.blind = parseBlind(lines.remainder());
            } catch (const std::invalid_argument& error) {
                lines.fail(fmt::format("blinds \"{}\": {}", lines.remainder(), error.what()));
            }
        }
        if (!known) continue;
        draft->place = lines.place();
        if (key == "Kd" || key == "Tf") draft->colourPlace = lines.place();
        Material soFar = draft->material;
        if (soFar.transmittance == glm::vec3(1)) soFar.transmittance = glm::vec3(0); // "d 1" may follow
        if (!draft->flaw) draft->flaw = flawOf(soFar, kFields, lines.file(), lines.place());
    }
    if (draft) finishMaterial(*draft, lines.file(), model, index);
}

// "7", "7/1", "7//3", "-1/2/3": the vertex as an index from 0.
uint32_t readIndex(std::string_view text, size_t vertexCount, const Lines& lines) {
    long long value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || (end != text.data() + text.size() && *end != '/'))
        lines.fail(fmt::format("\"{}\" is not a vertex index", text));
    const auto count = static_cast<long long>(vertexCount);
    if (value == 0 || value > count || value < -count)
        lines.fail(fmt::format("vertex {} does not exist, {} are defined so far", value, count));
    return static_cast<uint32_t>(value > 0 ? value - 1 : count + value);
}

// What stands behind "mtllib": one file, whose name may hold blanks, or several. `whole` becomes what was
// written; no files where one of them is missing.
std::vector<std::filesystem::path> librariesOf(Lines& lines, const std::filesystem::path& folder,
                                               std::string& whole) {
    whole = lines.remainder();
    std::vector<std::string> words;
    for (std::string_view word = lines.word(); !word.empty(); word = lines.word()) words.emplace_back(word);
    std::vector<std::filesystem::path> files;
    const auto findAll = [&](const std::vector<std::string>& names, const auto& find) {
        files.clear();
        for (const std::string& name : names)
            if (const auto file = find(folder, unquoted(name))) files.push_back(*file);
        return files.size() == names.size();
    };
    const auto anyhow = [](const std::filesystem::path& in, const std::string& name) {
        const auto there = fileAt(in, name);
        return there ? there : fileBeside(in, name);
    };
    if (!findAll({whole}, fileAt) && !findAll(words, anyhow) && !findAll({whole}, fileBeside)) files.clear();
    return files;
}

class ObjReader {
public:
    explicit ObjReader(const std::filesystem::path& file) : path_(file), lines_(file, "a model (.obj)") {
        model_.file = lines_.file();
    }

    RawModel read() {
        while (lines_.next()) {
            const std::string_view key = lines_.word();
            if (key == "v")
                readVertex();
            else if (key == "vn")
                readNormal();
            else if (key == "f")
                readFace();
            else if (key == "mtllib")
                readLibraries();
            else if (key == "usemtl")
                useMaterial(lines_.remainder());
            else if (key == "g" || key == "o")
                useGroup(lines_.remainder(), key == "o");
            else if (key == "s")
                readSmoothing();
            else if (key == "north")
                model_.northDeg = lines_.number("north DEG");
            else if (key == "twins")
                readTwins();
        }
        if (model_.faceCount() == 0)
            throw InputError(lines_.file(), "", "holds no faces, expected lines such as f 1 2 3");
        return std::move(model_);
    }

private:
    void readLibraries() {
        std::string whole;
        const std::vector<std::filesystem::path> files = librariesOf(lines_, path_.parent_path(), whole);
        if (whole.empty()) lines_.fail("mtllib without a name");
        if (files.empty())
            model_.flaws.push_back(
                {RawModel::Flaw::Kind::missingFile, lines_.file(), lines_.place(),
                 fmt::format(
                     "mtllib \"{}\" does not exist, expected materials (.mtl); --reflectance 0.5 takes "
                     "them as grey, --glass MATERIAL=0.8 one as glass",
                     whole)});
        for (const auto& file : files) readMtl(file, model_, materials_);
    }

    void readVertex() {
        glm::dvec3 p;
        for (int c = 0; c < 3; ++c) p[c] = lines_.number("v x y z");
        model_.vertices.push_back(p);
    }

    // Programs write "nan" for corners of faces without area: such a normal says nothing.
    void readNormal() {
        glm::vec3 n{0};
        bool known = true;
        for (int c = 0; c < 3; ++c) {
            const std::optional<double> value = signedNumberFrom(lines_.word());
            known = known && value;
            n[c] = static_cast<float>(value.value_or(0));
        }
        normals_.push_back(known ? n : glm::vec3(0));
    }

    // Of a corner "7/1/3" or "7//-1"; 0 where it names none.
    glm::vec3 normalOf(std::string_view corner) const {
        const size_t place = corner.find('/');
        const size_t begin = place == std::string_view::npos ? place : corner.find('/', place + 1);
        if (begin == std::string_view::npos) return glm::vec3(0);
        long long value = 0;
        std::from_chars(corner.data() + begin + 1, corner.data() + corner.size(), value);
        const auto count = static_cast<long long>(normals_.size());
        const long long at = value < 0 ? count + value : value - 1;
        return at < 0 || at >= count ? glm::vec3(0) : normals_[static_cast<size_t>(at)];
    }

    void readFace() {
        size_t count = 0;
        for (std::string_view word = lines_.word(); !word.empty(); word = lines_.word(), ++count)
            model_.addCorner(readIndex(word, model_.vertices.size(), lines_), normalOf(word));
        if (count < 3) lines_.fail(fmt::format("a face of {} corners, expected at least 3", count));
        if (!currentMaterial_) useMaterial("default");
        if (model_.groups.empty()) useGroup(kNoGroup, false);
        model_.endFace(*currentMaterial_, lines_.lineNumber(), smoothing_);
    }

    // Our own: of how many faces and what glass, and pairs of them by their order in the file from 1.
    void readTwins() {
        const auto number = [&](std::string_view word) {
            uint32_t value = 0;
            const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
            if (error != std::errc() || end != word.data() + word.size() || value == 0)
                lines_.fail(fmt::format("\"{}\", expected twins of FACES, and twins FACE "
                                        "FACE ..., counted from 1",
                                        word));
            return value;
        };
        std::string_view word = lines_.word();
        if (word == "of") {
            if (!model_.twins) model_.twins.emplace();
            model_.twins->of = number(lines_.word());
            word = lines_.word();
        }
        if (word == "glass" && model_.twins) {
            const std::string form = fmt::format("twins of FACES glass {}", kGlassMarkForm);
            std::vector<double> numbers;
            while (!lines_.remainder().empty()) numbers.push_back(lines_.number(form.c_str()));
            model_.twins->glass = glassMark(numbers);
            if (!model_.twins->glass) lines_.fail("expected " + form);
            return;
        }
        if (!model_.twins) lines_.fail("twins without the number of all faces, expected twins of FACES");
        for (; !word.empty(); word = lines_.word()) {
            const uint32_t face = number(word) - 1;
            const std::string_view other = lines_.word();
            if (other.empty()) lines_.fail("twins of an odd number of faces, expected pairs");
            model_.twins->pairs.emplace_back(face, number(other) - 1);
        }
    }

    // "s 3"; "s off" and "s 0" end it, and so does what is no number.
    void readSmoothing() {
        const std::string_view word = lines_.word();
        smoothing_ = 0;
        std::from_chars(word.data(), word.data() + word.size(), smoothing_);
    }

    // Blender names no material where a face has none.
    void useMaterial(std::string name) {
        if (name.empty()) name = "default";
        auto found = materials_.find(name);
        if (found == materials_.end()) {
            // Without any material in the file the faces are a mid grey; a name that nothing defines is a
            // mistake.
            MaterialDraft grey;
            grey.material.name = name;
            grey.place = lines_.place();
            if (name != "default") {
                grey.hasKd = true;
                grey.flaw = {
                    RawModel::Flaw::Kind::undefined, lines_.file(), lines_.place(),
                    fmt::format("material \"{0}\" is not defined in any mtllib; --reflectance 0.5 takes "
                                "it as grey, --glass \"{0}=0.8\" as glass",
                                name)};
            }
            finishMaterial(grey, lines_.file(), model_, materials_);
            found = materials_.find(name);
        }
        currentMaterial_ = found->second;
    }

    // Programs that know objects name them, and may write groups within; 3ds Max writes groups alone.
    void useGroup(std::string name, bool isObject) {
        if (isObject) object_ = name;
        const std::string& shown = object_.empty() ? name : object_;
        model_.object.push_back({"object", shown == kNoGroup ? "" : shown});
        model_.groups.push_back(std::move(name));
        model_.source.emplace_back();
    }

    static constexpr const char* kNoGroup = "default";

    std::filesystem::path path_;
    Lines lines_;
    RawModel model_;
    std::vector<glm::vec3> normals_; // in the file's own axes
    std::string object_;             // of the last "o"
    MaterialIndex materials_;
    std::optional<uint32_t> currentMaterial_;
    uint32_t smoothing_ = 0;
};

} // namespace

std::vector<std::filesystem::path> materialFiles(const std::filesystem::path& file) {
    std::vector<std::filesystem::path> all;
    if (loweredExtension(file) != ".obj") return all;
    std::string whole;
    for (Lines lines(file, "a model (.obj)"); lines.next();)
        if (lines.word() == "mtllib")
            for (auto& library : librariesOf(lines, file.parent_path(), whole))
                all.push_back(std::move(library));
    return all;
}

RawModel readObj(const std::filesystem::path& file) {
    return ObjReader(file).read();
}

} // namespace heliodon::geometry
