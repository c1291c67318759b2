#include "engine/app/frame_sink.h"

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "engine/passes/image_file.h"
#include "geometry/input_error.h"
#include "geometry/whole_file.h"

namespace heliodon::app {

namespace fs = std::filesystem;

namespace {

constexpr const char* kJobFile = "frames.json";
constexpr const char* kPartOfTable = "frames.part.csv";
// Deflating a picture takes longer than drawing it on a graphics device.
constexpr size_t kWriters = 4;

// Whether a job may have written it, by its name.
bool isPictureOf(const FrameJob& job, const fs::path& file) {
    const std::string extension = file.extension().string();
    std::string number = file.stem().string();
    if (extension != ".png" && extension != ".exr") return false;
    if (job.views.size() > 1)
        for (const std::string& view : job.views)
            if (number.starts_with(view + "-")) number.erase(0, view.size() + 1);
    const bool digits = number.find_first_not_of("0123456789") == std::string::npos;
    return digits && number.size() >= 5 && number.size() < 12 && std::stoull(number) < job.frames;
}

std::vector<fs::path> picturesOf(const FrameJob& job, const fs::path& folder) {
    std::vector<fs::path> found;
    if (job.views.empty()) return found;
    std::error_code missing;
    for (const auto& entry : fs::directory_iterator(folder, missing))
        if (isPictureOf(job, entry.path())) found.push_back(entry.path());
    return found;
}

} // namespace

FrameSink::FrameSink(FrameSinkOptions options)
    : options_(std::move(options)), isFilm_(options_.output.extension() == ".mp4"), text_(options_.header) {
    if (isFilm_ && options_.exr)
        throw geometry::InputError("--exr", "", "goes into a folder of pictures, not into a film");
    if (!isFilm_)
        folder_ = options_.output;
    else if (options_.resume)
        folder_ = fs::path(options_.output).replace_extension(".frames");
    for (const fs::path& film : films()) { // now, not after the form factors
        geometry::refuseUnwritable(film);
        held_.emplace_back(film);
    }
    if (isFilm_) geometry::refuseUnwritable(table()); // whose name is longer
    if (options_.resume) refuseOtherJob();
    if (folder_.empty()) return; // Film has a thread of its own
    made_.emplace(folder_);
    if (options_.resume) keepRows();
    for (size_t i = 0; i < kWriters; ++i) writers_.emplace_back([this] { work(); });
}

void FrameSink::refuseOtherJob() const {
    const std::optional<FrameJob> there = readFrameJob(folder_ / kJobFile);
    const auto refuse = [&](const std::string& why) {
        throw geometry::InputError(
            "--resume", "",
            fmt::format("{} holds frames of another job: {}; expected the same options, or another output",
                        folder_.string(), why));
    };
    if (there) {
        if (const auto why = difference(*there, options_.job)) refuse(*why);
    } else if (!picturesOf(options_.job, folder_).empty()) {
        refuse(fmt::format("it has pictures but no {} that says whose", kJobFile));
    }
}

// A line without an end was cut, and says nothing.
void FrameSink::keepRows() {
    std::ifstream in(partOfTable(), std::ios::binary);
    std::string line;
    if (!readFrameJob(folder_ / kJobFile) || !std::getline(in, line) || line + '\n' != options_.header)
        return;
    while (std::getline(in, line) && !in.eof() && kept_ < options_.job.frames && done(kept_)) {
        text_ += line + '\n';
        ++kept_;
    }
}

std::vector<std::string> FrameSink::strangers() const {
    std::vector<std::string> names;
    if (isFilm_ || options_.resume || readFrameJob(folder_ / kJobFile)) return names;
    for (const fs::path& picture : picturesOf(options_.job, folder_))
        names.push_back(picture.filename().string());
    std::ranges::sort(names);
    for (const fs::path& file : {table(), partOfTable()})
        if (fs::exists(file)) names.push_back(file.filename().string());
    return names;
}

// What an earlier job left would pass for frames of this one.
void FrameSink::startFolder() {
    started_ = true;
    const fs::path file = folder_ / kJobFile;
    if (!options_.resume)
        if (const std::optional<FrameJob> before = readFrameJob(file)) {
            for (const fs::path& old : picturesOf(*before, folder_)) fs::remove(old);
            if (!isFilm_) fs::remove(table());
        }
    writeFrameJob(options_.job, file);
    geometry::writeWholeText(partOfTable(), text_);
    part_.open(partOfTable(), std::ios::binary | std::ios::app);
}

FrameSink::~FrameSink() {
    endThreads();
}

fs::path FrameSink::table() const {
    return isFilm_ ? fs::path(options_.output).replace_extension(".frames.csv")
                   : options_.output / "frames.csv";
}

fs::path FrameSink::partOfTable() const {
    return folder_ / kPartOfTable;
}

fs::path FrameSink::picture(size_t view, size_t frame, const char* extension) const {
    return folder_ / (options_.job.views.size() == 1
                          ? fmt::format("{:05}{}", frame, extension)
                          : fmt::format("{}-{:05}{}", options_.job.views[view], frame, extension));
}

fs::path FrameSink::filmOf(size_t view) const {
    if (options_.job.views.size() == 1) return options_.output;
    fs::path file = options_.output;
    return file.replace_filename(fmt::format("{}-{}.mp4", file.stem().string(), options_.job.views[view]));
}

std::vector<fs::path> FrameSink::films() const {
    std::vector<fs::path> files;
    if (isFilm_)
        for (size_t v = 0; v < options_.job.views.size(); ++v) files.push_back(filmOf(v));
    return files;
}

bool FrameSink::writes(const fs::path& place) const {
    std::vector<fs::path> files = films();
    files.push_back(table());
    if (!isFilm_ || options_.resume) files.push_back(isFilm_ ? filmRecord() : folder_ / kJobFile);
    if (!folder_.empty()) files.push_back(partOfTable());
    const auto leadsThere = [&](const fs::path& file) { return geometry::leadsTo(file, place); };
    if (std::ranges::any_of(files, leadsThere)) return true;
    if (isFilm_ || options_.job.views.empty()) return false;
    return (isPictureOf(options_.job, place) && geometry::isSamePlace(folder_, place.parent_path())) ||
           std::ranges::any_of(picturesOf(options_.job, folder_), leadsThere); // links
}

// What a film was made from: its rate is no matter of frames.
FrameJob FrameSink::filmJob() const {
    FrameJob job = options_.job;
    job.options["--fps"] = options_.framesPerSecond;
    return job;
}

fs::path FrameSink::filmRecord() const {
    return fs::path(options_.output).replace_extension(".frames.json");
}

bool FrameSink::complete() const {
    if (!options_.resume || !fs::exists(table()) || fs::exists(partOfTable())) return false;
    const std::optional<FrameJob> there = readFrameJob(isFilm_ ? filmRecord() : folder_ / kJobFile);
    if (!there || difference(*there, isFilm_ ? filmJob() : options_.job)) return false;
    const std::vector<fs::path> made = films();
    if (isFilm_) return std::ranges::all_of(made, [](const fs::path& film) { return fs::exists(film); });
    for (size_t frame = 0; frame < options_.job.frames; ++frame)
        if (!done(frame)) return false;
    return true;
}

bool FrameSink::done(size_t frame) const {
    if (!options_.resume) return false;
    for (size_t v = 0; v < options_.job.views.size(); ++v)
        if (!passes::isWholePng(picture(v, frame, ".png")) ||
            (options_.exr && !passes::isWholeExr(picture(v, frame, ".exr"))))
            return false;
    return true;
}

Film& FrameSink::film(size_t view, int width, int height) {
    while (films_.size() <= view)
        films_.push_back(std::make_unique<Film>(filmOf(films_.size()), static_cast<uint32_t>(width),
                                                static_cast<uint32_t>(height), options_.framesPerSecond));
    return *films_[view];
}

void FrameSink::addToFilms(std::vector<passes::Image8>&& pictures) {
    for (size_t v = 0; v < pictures.size(); ++v)
        film(v, pictures[v].width, pictures[v].height).add(std::move(pictures[v].rgb));
}

void FrameSink::add(size_t frame, std::vector<passes::Image8> pictures, std::vector<passes::ImageF> linear,
                    passes::ExrAttributes attributes) {
    throwFailure();
    if (folder_.empty()) {
        addToFilms(std::move(pictures));
        return;
    }
    if (!started_) startFolder();
    // std::function copies what it holds; the pictures are many megabytes.
    const auto shared = std::make_shared<std::vector<passes::Image8>>(std::move(pictures));
    const auto floats = std::make_shared<std::vector<passes::ImageF>>(std::move(linear));
    writing_.push([this, frame, shared, floats, attributes = std::move(attributes)] {
        for (size_t v = 0; v < floats->size(); ++v)
            passes::writeExr((*floats)[v], picture(v, frame, ".exr"), attributes);
        for (size_t v = 0; v < shared->size(); ++v) passes::writePng((*shared)[v], picture(v, frame, ".png"));
    });
}

void FrameSink::addRow(const std::string& line) {
    throwFailure();
    if (!folder_.empty()) {
        if (!started_) startFolder();
        errno = 0;
        if (!(part_ << line).flush())
            throw std::runtime_error(fmt::format("{}: could not be written: {}", partOfTable().string(),
                                                 std::system_category().message(errno)));
    }
    text_ += line;
}

void FrameSink::work() {
    while (const auto job = writing_.pop()) {
        try {
            (*job)();
        } catch (...) {
            const std::scoped_lock lock(mutex_);
            if (!failure_) failure_ = std::current_exception();
            writing_.close(true);
        }
    }
}

void FrameSink::throwFailure() {
    const std::scoped_lock lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
}

void FrameSink::endThreads() {
    writing_.close();
    for (std::thread& writer : writers_)
        if (writer.joinable()) writer.join();
}

void FrameSink::filmsFromPictures() {
    for (size_t frame = 0; done(frame); ++frame)
        for (size_t v = 0; v < options_.job.views.size(); ++v) {
            passes::Image8 image = readPicture(picture(v, frame, ".png"));
            film(v, image.width, image.height).add(std::move(image.rgb));
        }
}

void FrameSink::close() {
    endThreads();
    throwFailure();
    if (!folder_.empty() && !started_) startFolder(); // all was kept
    if (isFilm_) closeFilms();
    geometry::writeWholeText(table(), text_);
    if (!isFilm_) fs::remove(partOfTable());
    if (isFilm_ && options_.resume) writeFrameJob(filmJob(), filmRecord());
}

void FrameSink::closeFilms() {
    if (options_.resume) filmsFromPictures();
    std::error_code ignored;
    if (readFrameJob(filmRecord())) fs::remove(filmRecord(), ignored); // of the films before
    for (auto& film : films_) film->close();
    if (!options_.resume) return;
    for (const fs::path& frame : picturesOf(options_.job, folder_)) fs::remove(frame, ignored);
    for (const char* own : {kPartOfTable, kJobFile}) fs::remove(folder_ / own, ignored);
    fs::remove(folder_, ignored); // unless others put something there
}

} // namespace heliodon::app
