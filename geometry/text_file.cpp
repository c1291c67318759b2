#include "geometry/text_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "geometry/input_error.h"

namespace heliodon::geometry {

namespace {

// Bytes of the character that starts here; 0 where it is no UTF-8.
size_t characterLength(std::string_view text) {
    const auto byte = [&](size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char first = byte(0);
    const size_t length = first < 0x80 ? 1 : first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    if (length == 0 || first > 0xF4 || text.size() < length) return 0;
    for (size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xC0) != 0x80) return 0;
    // Longer than need be, half of a pair of UTF-16, or beyond what there is.
    const bool wrong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xED && byte(1) >= 0xA0) ||
                       (first == 0xF0 && byte(1) < 0x90) || (first == 0xF4 && byte(1) >= 0x90);
    return wrong ? 0 : length;
}

// Windows-1252: ISO 8859-1 with quotation marks, dashes and a few letters from 0x80 to 0x9F.
std::string fromWindows(const std::string& text) {
    constexpr std::array<uint16_t, 32> kMarks{0x20AC, 0x81,   0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                              0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0x8D,   0x017D, 0x8F,
                                              0x90,   0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                              0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0x9D,   0x017E, 0x0178};
    std::string out;
    for (const char letter : text) {
        const auto byte = static_cast<unsigned char>(letter);
        const unsigned code = byte >= 0x80 && byte < 0xA0 ? kMarks[byte - 0x80] : byte;
        if (code >= 0x800) {
            out += static_cast<char>(0xE0 | (code >> 12));
            out += static_cast<char>(0x80 | (code >> 6 & 0x3F));
        } else if (code >= 0x80) {
            out += static_cast<char>(0xC0 | (code >> 6));
        }
        out += static_cast<char>(code < 0x80 ? code : 0x80 | (code & 0x3F));
    }
    return out;
}

// Of the character there, from 1 on.
std::string lineAt(std::string_view text, size_t at) {
    return std::to_string(1 + std::ranges::count(text.substr(0, at), '\n'));
}

// What nlohmann's parser calls with what it comes upon.
class RepeatedFields : public nlohmann::json_sax<nlohmann::json> {
public:
    explicit RepeatedFields(const std::filesystem::path& file) : file_(file) {}
    bool null() override { return value(); }
    bool boolean(bool) override { return value(); }
    bool number_integer(number_integer_t) override { return value(); }
    bool number_unsigned(number_unsigned_t) override { return value(); }
    bool number_float(number_float_t, const string_t&) override { return value(); }
    bool string(string_t&) override { return value(); }
    bool binary(binary_t&) override { return value(); }
    bool start_object(size_t) override { return begin(false); }
    bool start_array(size_t) override { return begin(true); }
    bool end_object() override { return end(); }
    bool end_array() override { return end(); }
    bool parse_error(size_t, const std::string&, const nlohmann::json::exception&) override { return false; }
    bool key(string_t& name) override {
        open_.back().field = name;
        if (!open_.back().fields.insert(name).second)
            throw InputError(file_.string(), place(), "is there twice, expected it once");
        return true;
    }

private:
    struct Open {
        bool list = false;
        size_t count = 0;             // of a list: what was read of it
        std::string field;            // of an object: the last one,
        std::set<std::string> fields; // and all
    };

    bool begin(bool list) {
        open_.push_back({list, 0, {}, {}});
        return true;
    }
    bool end() {
        open_.pop_back();
        return value();
    }
    bool value() {
        if (!open_.empty()) ++open_.back().count;
        return true;
    }
    std::string place() const {
        std::string out;
        for (const Open& in : open_)
            out += in.list ? fmt::format("[{}]", in.count) : (out.empty() ? "" : ".") + in.field;
        return out;
    }

    const std::filesystem::path& file_;
    std::vector<Open> open_;
};

} // namespace

void refuseUnreadable(const std::filesystem::path& file, const std::string& expected) {
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(file, ignored);
    const char* what = nullptr;
    if (!std::filesystem::exists(status))
        what = "does not exist";
    else if (std::filesystem::is_directory(status))
        what = "is a folder";
    else if (::access(file.c_str(), R_OK) != 0) // a pipe cannot be opened twice
        what = "cannot be read";
    if (what) throw InputError(file.string(), "", std::string(what) + ", expected " + expected);
}

int openToRead(const std::filesystem::path& file) {
    // open() itself would wait for a writer, and go on waiting after a signal; poll() does not.
    const int in = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (in < 0) return in;
    pollfd ready{in, POLLIN, 0};
    if (::poll(&ready, 1, -1) < 0 && errno == EINTR) {
        ::close(in);
        throw std::runtime_error(file.string() + ": interrupted, nobody writes into this pipe");
    }
    ::fcntl(in, F_SETFL, 0); // reading waits
    return in;
}

std::string readText(const std::filesystem::path& file, const std::string& expected, size_t largest) {
    refuseUnreadable(file, expected);
    const auto fail = [&] { throw InputError(file.string(), "", "cannot be read, expected " + expected); };
    const int descriptor = openToRead(file);
    if (descriptor < 0) fail();
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(::fdopen(descriptor, "rb"), std::fclose);
    std::string read;
    std::vector<char> chunk(1 << 20);
    while (const size_t count = std::fread(chunk.data(), 1, chunk.size(), in.get())) {
        read.append(chunk.data(), count);
        if (read.size() > largest)
            throw InputError(file.string(), "",
                             fmt::format("is larger than {} MiB, expected {}", largest >> 20, expected));
    }
    if (std::ferror(in.get())) fail();
    refuseUtf16(file, read);
    return read;
}

void refuseUtf16(const std::filesystem::path& file, const std::string& text) {
    for (const char* const mark : {"\xFF\xFE", "\xFE\xFF"})
        if (text.starts_with(mark))
            throw InputError(file.string(), "", "is UTF-16, expected UTF-8: save it in that encoding");
}

void refuseOtherKinds(const std::filesystem::path& file, std::string_view text, const std::string& expected) {
    using namespace std::string_view_literals;
    struct Kind {
        std::string_view begin;
        const char* name;
    };
    constexpr Kind kKinds[] = {{"\x89PNG"sv, "a picture (PNG)"},
                               {"\xFF\xD8\xFF"sv, "a picture (JPEG)"},
                               {"II*\0"sv, "a picture (TIFF)"},
                               {"MM\0*"sv, "a picture (TIFF)"},
                               {"%PDF"sv, "a document (PDF)"},
                               {"PK\3\4"sv, "an archive (zip)"},
                               {"\x1F\x8B"sv, "compressed (gzip)"},
                               {"glTF"sv, "a model (.glb)"},
                               {"BLENDER"sv, "a scene of Blender (.blend)"},
                               {"Kaydara FBX"sv, "a model (.fbx)"}};
    for (const Kind& kind : kKinds)
        if (text.starts_with(kind.begin))
            throw InputError(file.string(), "", fmt::format("is {}, expected {}", kind.name, expected));
    if (text.substr(0, text.find('\n')).find('\0') != text.npos) // further on, readers name the line
        throw InputError(file.string(), "", "is no text, expected " + expected);
}

void refuseNotJson(const std::filesystem::path& file, const std::string& text, size_t byte,
                   const std::string& expected) {
    refuseOtherKinds(file, text, expected);
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text.find_first_not_of(" \t\r\n", text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0) ==
        text.npos)
        throw InputError(file.string(), "", "is empty, expected " + expected);
    const size_t end = std::min(byte, text.size()), newline = text.substr(0, end).rfind('\n');
    const size_t character = end - (newline == std::string::npos ? 0 : newline + 1);
    throw InputError(file.string(), lineAt(text, end),
                     fmt::format("is not JSON here (character {} of the line), expected {}",
                                 std::max<size_t>(character, 1), expected));
}

void refuseLargeNumber(const std::filesystem::path& file, const std::string& text,
                       const nlohmann::json::out_of_range& error) {
    // "[json.exception.out_of_range.406] number overflow parsing '1e999'"
    const std::string_view said = error.what();
    const size_t end = said.rfind('\''), begin = said.rfind('\'', end - 1) + 1;
    const std::string_view number = said.substr(begin, end - begin);
    const auto isPart = [&](size_t at) { // of a longer word or a text
        return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) ||
                                    std::string_view(".+-\"").find(text[at]) != std::string_view::npos);
    };
    size_t at = text.find(number);
    while (at != std::string::npos && ((at > 0 && isPart(at - 1)) || isPart(at + number.size())))
        at = text.find(number, at + 1);
    throw InputError(file.string(), lineAt(text, at),
                     fmt::format("{} is too large a number to represent", number));
}

void refuseRepeatedFields(const std::filesystem::path& file, const std::string& text) {
    RepeatedFields repeated(file);
    nlohmann::json::sax_parse(text, &repeated);
}

std::string asUtf8(const std::string& text) {
    for (size_t at = 0; at < text.size();) {
        const size_t length = characterLength(std::string_view(text).substr(at));
        if (length == 0) return fromWindows(text);
        at += length;
    }
    return text;
}

} // namespace heliodon::geometry
