// Frames to disk, as numbered pictures or as films, in threads of their own: whoever draws does not wait for
// encoders unless they fall far behind.
#pragma once

#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "engine/app/bounded_queue.h"
#include "engine/app/film.h"
#include "engine/app/frame_job.h"
#include "engine/app/output_folder.h"
#include "engine/passes/image_file.h"
#include "engine/passes/picture.h"

namespace heliodon::app {

struct FrameSinkOptions {
    std::filesystem::path output; // OUT.mp4, or a folder
    double framesPerSecond = 24;
    bool exr = false;    // linear pictures too; folders only
    bool resume = false; // keep what is there; a film's frames stay in OUT.frames/ until the film is whole
    FrameJob job;        // goes into the folder of pictures as frames.json, beside films as OUT.frames.json
    std::string header;  // line of the table
};

class FrameSink {
public:
    // Throws geometry::InputError on outputs that cannot be, and where frames that are to be kept come from
    // another job.
    explicit FrameSink(FrameSinkOptions options);
    ~FrameSink(); // without close(): finishes the pictures at hand; no film appears
    FrameSink(const FrameSink&) = delete;
    FrameSink& operator=(const FrameSink&) = delete;

    // Where `frames.csv` goes: into the folder, or beside the film as OUT.frames.csv.
    std::filesystem::path table() const;
    // With `resume`: everything that the job writes is there, pictures or films and table.
    bool complete() const;
    // With `resume`: how many frames from the first on have their row and pictures already.
    size_t kept() const { return kept_; }
    // Its pictures are there and whole: a disk that filled up or was unplugged leaves empty or cut ones.
    bool done(size_t frame) const;
    // Names of what stands in a folder of pictures like this job's own, where no job is known to have left
    // it.
    std::vector<std::string> strangers() const;
    // Whether the job writes and leaves a file at a geometry::placeOf(): picture or film, table or record.
    bool writes(const std::filesystem::path& place) const;
    // The films, one a view; none where a folder is written.
    std::vector<std::filesystem::path> films() const;

    // In order of frames; one picture a view. Errors of the threads are thrown by the next call.
    void add(size_t frame, std::vector<passes::Image8> pictures, std::vector<passes::ImageF> linear = {},
             passes::ExrAttributes attributes = {});
    // Its line of the table, in order from kept() on. Folders hold those so far as frames.part.csv until all
    // are there.
    void addRow(const std::string& line);
    // After the last frame: finishes pictures, films and table.
    void close();

private:
    FrameJob filmJob() const;
    std::filesystem::path filmRecord() const;
    std::filesystem::path partOfTable() const;
    void refuseOtherJob() const;
    void keepRows();
    void startFolder();
    std::filesystem::path picture(size_t view, size_t frame, const char* extension) const;
    std::filesystem::path filmOf(size_t view) const;
    Film& film(size_t view, int width, int height);
    void addToFilms(std::vector<passes::Image8>&& pictures);
    void filmsFromPictures();
    void closeFilms();
    void throwFailure();
    void work();
    void endThreads();

    FrameSinkOptions options_;
    bool isFilm_;
    std::filesystem::path folder_; // of pictures; empty for a film that does not keep its frames
    std::list<SoleFile> held_;     // the films
    std::optional<OutputFolder> made_;
    bool started_ = false; // the folder says whose frames it holds
    std::string text_;     // of the table so far
    size_t kept_ = 0;
    std::ofstream part_; // its copy on disk
    std::vector<std::unique_ptr<Film>> films_;
    BoundedQueue<std::function<void()>> writing_{8};
    std::mutex mutex_;
    std::exception_ptr failure_;
    std::vector<std::thread> writers_; // last: they use all of the above
};

} // namespace heliodon::app
