// A folder that a command writes into, alone: two runs would leave a mixture of both.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace heliodon::app {

class Run;

class OutputFolder {
public:
    // Makes the folder when it is missing; throws InputError when it is a file, is named like one, or cannot
    // be made or written to, or when another run holds it. The system forgets that hold when a run ends,
    // however it ends.
    explicit OutputFolder(const std::filesystem::path& folder);
    // Removes what was made and is still empty, and a record of files none of which is there: of a run that
    // failed.
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

    // Before the first file of `command` is written: removes what an earlier run of it wrote into the folder,
    // by that run's record COMMAND.files.json, and is not in `files` (names in the folder, without this one);
    // then records those. Files without a record are never removed; warns of those that will be written over.
    void startFiles(Run& run, const std::string& command, const std::vector<std::string>& files);

private:
    std::filesystem::path folder_;
    std::filesystem::path record_;            // empty before startFiles
    std::vector<std::string> files_;          // what it lists
    std::vector<std::filesystem::path> made_; // innermost first
    int handle_ = -1;                         // holds the lock, where the file system has such
};

// Names `files`, in the folder, that will be written over though no earlier run is known to have made them.
void warnOfStrangers(Run& run, const std::filesystem::path& folder, std::span<const std::string> files);

} // namespace heliodon::app
