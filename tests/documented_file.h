// The examples of docs/files.md, so that they stay right.
#pragma once

#include <fstream>
#include <sstream>
#include <string>

namespace heliodon::test {

// What stands in that page between ```json and ```, of the given "format".
inline std::string documentedFile(const std::string& format) {
    std::ostringstream page;
    page << std::ifstream(HELIODON_SOURCE "/docs/files.md").rdbuf();
    const std::string text = page.str(), begin = "```json\n";
    const size_t named = text.find("\"format\": \"" + format + "\"");
    if (named == text.npos) return "";
    const size_t from = text.rfind(begin, named) + begin.size();
    return text.substr(from, text.find("```", from) - from);
}

} // namespace heliodon::test
