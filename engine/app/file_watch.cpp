#include "engine/app/file_watch.h"

#include <system_error>
#include <utility>

#include "geometry/input_error.h"
#include "geometry/text_file.h"

namespace heliodon::app {

FileWatch::FileWatch(std::filesystem::path file)
    : file_(std::move(file)), state_(geometry::fileState(file_)) {
    if (isThere()) text_ = geometry::readText(file_, "a file");
}

bool FileWatch::changes() {
    const auto now = std::chrono::steady_clock::now();
    if (now - looked_ < std::chrono::seconds(1)) return false;
    looked_ = now;
    const auto state = geometry::fileState(file_);
    if (state == state_ || !isThere()) return false;
    state_ = state;
    try {
        std::string text = geometry::readText(file_, "a file");
        std::swap(text, text_);
        return text != text_;
    } catch (const geometry::InputError&) { // whoever reads it says what is amiss
        text_.clear();
        return true;
    }
}

bool FileWatch::isThere() const {
    std::error_code missing;
    return std::filesystem::is_regular_file(file_, missing);
}

} // namespace heliodon::app
