#include "geometry/film_codec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

namespace heliodon::geometry {

namespace {

constexpr const char* kQuality = "18";    // of x264, where eyes no longer find a difference
// Half of x264's own, beyond which memory grows by 4 MB a frame of 1280 x 960, and 52 dB by 0.3 in all.
constexpr const char* kLookahead = "20"; // frames
// As many on all machines: films have the same bits, and on large ones x264's own would take twice the memory.
constexpr int kThreads = 4;
constexpr int kLargestRateTerm = 1001000; // 30000/1001 frames a second and its like are exact

// 23.976, 29.97 and 59.94 mean 24000/1001 and so on.
AVRational rateOf(double framesPerSecond) {
    const double whole = std::round(framesPerSecond / 0.999);
    if (std::abs(framesPerSecond - 0.999 * whole) < 1e-6) return {static_cast<int>(whole) * 1000, 1001};
    return av_d2q(framesPerSecond, kLargestRateTerm);
}

struct Release {
    void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
    void operator()(AVFrame* frame) const { av_frame_free(&frame); }
    void operator()(AVPacket* packet) const { av_packet_free(&packet); }
    void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
    void operator()(AVFormatContext* format) const {
        avio_closep(&format->pb);
        avformat_free_context(format);
    }
};
template<class T> using Owned = std::unique_ptr<T, Release>;

class Encoder : public FilmEncoder {
public:
    Encoder(int width, int height)
        : width_(width), height_(height), evenWidth_(width + width % 2), // 4:2:0 needs even sizes
          evenHeight_(height + height % 2),
          padded_(static_cast<size_t>(evenWidth_) * static_cast<size_t>(evenHeight_) * 3, uint8_t{0}) {}

    bool open(const std::filesystem::path& file, double framesPerSecond) {
        return openCodec(framesPerSecond) && openScaler() && openFile(file);
    }

    bool add(const uint8_t* rgb) override {
        const size_t row = static_cast<size_t>(width_) * 3, evenRow = static_cast<size_t>(evenWidth_) * 3;
        for (size_t y = 0; y < static_cast<size_t>(height_); ++y)
            std::copy_n(rgb + y * row, row, padded_.data() + y * evenRow);
        if (!done(av_frame_make_writable(frame_.get()))) return false;
        const uint8_t* from[] = {padded_.data()};
        const int stride[] = {static_cast<int>(evenRow)};
        sws_scale(scaler_.get(), from, stride, 0, evenHeight_, frame_->data, frame_->linesize);
        frame_->pts = count_++;
        return encode(frame_.get());
    }

    bool finish() override {
        const bool whole = encode(nullptr) && done(av_write_trailer(format_.get()));
        return done(avio_closep(&format_->pb)) && whole;
    }

    std::string why() const override {
        std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
        return error_ < 0 && av_strerror(error_, text.data(), text.size()) == 0 ? text.data() : "";
    }

private:
    // Whether what a call returned is no error; the first that is one is kept.
    bool done(int returned) {
        if (returned < 0 && error_ == 0) error_ = returned;
        return returned >= 0;
    }

    bool openCodec(double framesPerSecond) {
        const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
        if (!codec) codec = avcodec_find_encoder(AV_CODEC_ID_H264);
        codec_.reset(codec ? avcodec_alloc_context3(codec) : nullptr);
        if (!codec_) return false;
        codec_->width = evenWidth_, codec_->height = evenHeight_;
        codec_->pix_fmt = AV_PIX_FMT_YUV420P;
        codec_->framerate = rateOf(framesPerSecond);
        codec_->time_base = av_inv_q(codec_->framerate);
        codec_->colorspace = AVCOL_SPC_BT709;
        codec_->color_primaries = AVCOL_PRI_BT709;
        codec_->color_trc = AVCOL_TRC_IEC61966_2_1;
        codec_->color_range = AVCOL_RANGE_MPEG;
        codec_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER; // as .mp4 wants it
        codec_->thread_count = kThreads;
        av_opt_set(codec_->priv_data, "crf", kQuality, 0);
        av_opt_set(codec_->priv_data, "rc-lookahead", kLookahead, 0);
        return avcodec_open2(codec_.get(), codec, nullptr) == 0;
    }

    bool openScaler() {
        scaler_.reset(sws_getContext(evenWidth_, evenHeight_, AV_PIX_FMT_RGB24, evenWidth_, evenHeight_,
                                     AV_PIX_FMT_YUV420P, SWS_BICUBIC | SWS_ACCURATE_RND, nullptr, nullptr,
                                     nullptr));
        const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
        constexpr int kFull = 1, kLimited = 0, kOne = 1 << 16;
        if (!scaler_ ||
            sws_setColorspaceDetails(scaler_.get(), bt709, kFull, bt709, kLimited, 0, kOne, kOne) < 0)
            return false;
        frame_.reset(av_frame_alloc());
        packet_.reset(av_packet_alloc());
        if (!frame_ || !packet_) return false;
        frame_->format = codec_->pix_fmt;
        frame_->width = evenWidth_, frame_->height = evenHeight_;
        return av_frame_get_buffer(frame_.get(), 0) == 0;
    }

    bool openFile(const std::filesystem::path& file) {
        AVFormatContext* format = nullptr;
        if (avformat_alloc_output_context2(&format, nullptr, "mp4", file.c_str()) < 0) return false;
        format_.reset(format);
        stream_ = avformat_new_stream(format, nullptr);
        if (!stream_ || avcodec_parameters_from_context(stream_->codecpar, codec_.get()) < 0) return false;
        stream_->time_base = codec_->time_base;
        stream_->avg_frame_rate = codec_->framerate;
        return avio_open(&format->pb, file.c_str(), AVIO_FLAG_WRITE) == 0 &&
               avformat_write_header(format, nullptr) >= 0;
    }

    // A frame, or null for the last ones that still wait in the encoder.
    bool encode(const AVFrame* frame) {
        bool sent = done(avcodec_send_frame(codec_.get(), frame));
        while (sent) {
            const int received = avcodec_receive_packet(codec_.get(), packet_.get());
            if (received == AVERROR(EAGAIN) || received == AVERROR_EOF) return true;
            if (!done(received)) return false;
            packet_->duration = 1;
            av_packet_rescale_ts(packet_.get(), codec_->time_base, stream_->time_base);
            packet_->stream_index = stream_->index;
            sent = done(av_interleaved_write_frame(format_.get(), packet_.get()));
        }
        return false;
    }

    int width_, height_, evenWidth_, evenHeight_, error_ = 0;
    int64_t count_ = 0;
    std::vector<uint8_t> padded_;
    Owned<AVCodecContext> codec_;
    Owned<SwsContext> scaler_;
    Owned<AVFrame> frame_;
    Owned<AVPacket> packet_;
    Owned<AVFormatContext> format_;
    AVStream* stream_ = nullptr; // format_'s
};

} // namespace

std::unique_ptr<FilmEncoder> openFilm(const std::filesystem::path& file, int width, int height,
                                      double framesPerSecond) {
    av_log_set_level(AV_LOG_ERROR);
    auto encoder = std::make_unique<Encoder>(width, height);
    if (!encoder->open(file, framesPerSecond)) return nullptr;
    return encoder;
}

} // namespace heliodon::geometry
