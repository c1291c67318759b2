#include "geometry/jpeg_damage.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>

#include <jpeglib.h>
// Needs the former.
#include <jerror.h>

namespace heliodon::geometry {

namespace {

constexpr std::array<int, 5> kLosses{JWRN_HUFF_BAD_CODE, JWRN_ARITH_BAD_CODE, JWRN_HIT_MARKER,
                                     JWRN_MUST_RESYNC, JWRN_JPEG_EOF};
constexpr int kMostPadding = 16; // bytes that say nothing, of cameras that fill up to a whole word

struct Listener {
    jpeg_error_mgr callbacks{}; // first: libjpeg knows the address of this alone
    std::jmp_buf giveUp;
    bool hasLoss = false, isSurplus = false;
    std::array<char, JMSG_LENGTH_MAX> loss{};
};

Listener& listenerOf(j_common_ptr codec) {
    return *reinterpret_cast<Listener*>(codec->err);
}

void keepFirst(j_common_ptr codec, bool isSurplus) {
    Listener& listener = listenerOf(codec);
    if (listener.hasLoss) return;
    codec->err->format_message(codec, listener.loss.data());
    listener.hasLoss = true, listener.isSurplus = isSurplus;
}

void onMessage(j_common_ptr codec, int level) {
    const jpeg_error_mgr& said = *codec->err;
    const bool isSurplus = said.msg_code == JWRN_EXTRANEOUS_DATA && said.msg_parm.i[0] > kMostPadding;
    if (level < 0 && (isSurplus || std::ranges::find(kLosses, said.msg_code) != kLosses.end()))
        keepFirst(codec, isSurplus);
}

// Of cameras that fill up a whole block, with one value.
bool endsInPadding(const std::vector<uint8_t>& bytes) {
    constexpr std::array<uint8_t, 2> kEnd{0xFF, 0xD9};
    const auto end = std::ranges::find_end(bytes, kEnd).begin();
    return end - bytes.begin() > kMostPadding &&
           std::all_of(end - kMostPadding, end, [&](uint8_t byte) { return byte == *(end - 1); });
}

// Through C's frames, and over no object that has a destructor.
[[noreturn]] void onError(j_common_ptr codec) {
    std::longjmp(listenerOf(codec).giveUp, 1);
}

// All of the data at an eighth of the size: the coefficients are read, few pixels are made of them.
void decode(jpeg_decompress_struct& codec, Listener& listener, const std::vector<uint8_t>& bytes,
            std::vector<JSAMPLE>& line) {
    if (setjmp(listener.giveUp) != 0) return;
    jpeg_mem_src(&codec, bytes.data(), bytes.size());
    jpeg_read_header(&codec, TRUE);
    codec.scale_num = 1, codec.scale_denom = 8;
    jpeg_start_decompress(&codec);
    line.resize(size_t{codec.output_width} * static_cast<size_t>(codec.output_components));
    JSAMPROW row = line.data();
    while (codec.output_scanline < codec.output_height && !listener.hasLoss)
        jpeg_read_scanlines(&codec, &row, 1);
    if (!listener.hasLoss) jpeg_finish_decompress(&codec); // looks at what stands before the end
}

} // namespace

std::optional<std::string> jpegDamage(const std::vector<uint8_t>& bytes) {
    if (bytes.size() < 2 || bytes[0] != 0xFF || bytes[1] != 0xD8) return std::nullopt;
    Listener listener;
    jpeg_decompress_struct codec{};
    codec.err = jpeg_std_error(&listener.callbacks);
    listener.callbacks.emit_message = onMessage;
    listener.callbacks.error_exit = onError;
    jpeg_create_decompress(&codec);
    std::vector<JSAMPLE> line;
    decode(codec, listener, bytes, line);
    jpeg_destroy_decompress(&codec);
    if (!listener.hasLoss || (listener.isSurplus && endsInPadding(bytes))) return std::nullopt;
    return std::string(listener.loss.data());
}

} // namespace heliodon::geometry
