// Lists in messages: the beginning says enough.
#pragma once

#include <algorithm>
#include <span>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace heliodon::app {

// "a, b, c", with " ..." after it where there are more.
template<class Items> std::string firstFew(const Items& items, size_t few) {
    return fmt::format("{}{}", fmt::join(std::span(items).first(std::min(items.size(), few)), ", "),
                       items.size() > few ? " ..." : "");
}

} // namespace heliodon::app
