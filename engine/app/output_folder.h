// A folder that a command writes into, alone: two runs would leave a mixture of both.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <sys/types.h>

namespace heliodon::app {

class Run;

class OutputFolder {
public:
    // Makes the folder when it is missing; throws InputError when it is a file, is named like one, or cannot
    // be made or written to, or when another run holds it. The system forgets that hold when a run ends,
    // however it ends.
    explicit OutputFolder(const std::filesystem::path& folder);
    // Leaves the record of what this run or an earlier one has written, none where that is nothing: a run
    // that failed has written a part. Removes what was made and is still empty.
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

    // Before the work of `command`: Run::willWrite() of these, and of the record.
    void refuseUsed(Run& run, const std::string& command, std::vector<std::string> files) const;

    // Before the first file of `command` is written: removes what an earlier run of it wrote into the folder,
    // by that run's record COMMAND.files.json, and is not in `files` (names in the folder, without this one);
    // then records those. Files without a record are never removed; warns of those that will be written over,
    // which are recorded when they have been.
    void startFiles(Run& run, const std::string& command, const std::vector<std::string>& files);

private:
    bool wrote(const std::string& name) const;

    std::filesystem::path folder_;
    std::string command_;                     // empty before the record is written
    std::vector<std::string> files_;          // of this run
    std::map<std::string, ino_t> strangers_;  // of these: what stood there, of no earlier run
    std::vector<std::filesystem::path> made_; // innermost first
    int handle_ = -1;                         // holds the lock, where the file system has such
};

// A file that one run at a time makes for long, held by its name before it is there.
class SoleFile {
public:
    // Throws InputError when another run on this machine holds it. The system forgets that hold when a run
    // ends, however it ends.
    explicit SoleFile(const std::filesystem::path& file);
    ~SoleFile();
    SoleFile(const SoleFile&) = delete;
    SoleFile& operator=(const SoleFile&) = delete;

private:
    int socket_ = -1;
};

// Names `files`, in the folder, that will be written over though no earlier run is known to have made them.
void warnOfStrangers(Run& run, const std::filesystem::path& folder, std::span<const std::string> files);

} // namespace heliodon::app
