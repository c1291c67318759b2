// A folder that a command writes into, alone: two runs would leave a mixture of both.
#pragma once

#include <filesystem>
#include <vector>

namespace heliodon::app {

class OutputFolder {
public:
    // Makes the folder when it is missing; throws InputError when it is a file, is named like one, or cannot
    // be made or written to, or when another run holds it. The system forgets that hold when a run ends,
    // however it ends.
    explicit OutputFolder(const std::filesystem::path& folder);
    // Removes what was made and is still empty: of a run that failed.
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

private:
    std::vector<std::filesystem::path> made_; // innermost first
    int handle_ = -1;                         // holds the lock, where the file system has such
};

} // namespace heliodon::app
