// Films, read back by FFmpeg's decoder: every picture, in its colours, and what the file says of them; a disk
// that is full.
#include <sched.h>
#include <sys/resource.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "geometry/picture_file.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace heliodon::geometry {
namespace {

using Rgb = std::array<int, 3>;

class FilmCodecTest : public testing::Test {
protected:
    void SetUp() override {
        std::string name = (std::filesystem::temp_directory_path() / "film-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path film() const { return folder_ / "film.mp4"; }

private:
    std::filesystem::path folder_;
};

std::vector<uint8_t> plain(int width, int height, Rgb colour) {
    std::vector<uint8_t> rgb;
    for (int i = 0; i < width * height; ++i)
        for (const int value : colour) rgb.push_back(static_cast<uint8_t>(value));
    return rgb;
}

struct Decoded {
    AVCodecParameters parameters{}; // without what it points to
    double framesPerSecond = 0;
    std::vector<Rgb> middles; // of the pictures, by BT.709 in limited range
};

Rgb middleOf(const AVFrame& frame) {
    const int x = frame.width / 4, y = frame.height / 4; // in the planes of colour, half as large
    const double luma = (frame.data[0][2 * y * frame.linesize[0] + 2 * x] - 16) / 219.0;
    const double blue = (frame.data[1][y * frame.linesize[1] + x] - 128) / 224.0;
    const double red = (frame.data[2][y * frame.linesize[2] + x] - 128) / 224.0;
    const double r = luma + 1.5748 * red, b = luma + 1.8556 * blue;
    const double g = (luma - 0.2126 * r - 0.0722 * b) / 0.7152;
    const auto step = [](double value) { return static_cast<int>(std::lround(255 * value)); };
    return {step(r), step(g), step(b)};
}

Decoded decode(const std::filesystem::path& file) {
    Decoded result;
    AVFormatContext* format = nullptr;
    if (avformat_open_input(&format, file.c_str(), nullptr, nullptr) < 0) return result;
    avformat_find_stream_info(format, nullptr);
    const AVStream& stream = *format->streams[0];
    result.parameters = *stream.codecpar;
    result.framesPerSecond = av_q2d(stream.avg_frame_rate);
    const AVCodec* codec = avcodec_find_decoder(stream.codecpar->codec_id);
    AVCodecContext* context = avcodec_alloc_context3(codec);
    avcodec_parameters_to_context(context, stream.codecpar);
    avcodec_open2(context, codec, nullptr);
    AVPacket* packet = av_packet_alloc();
    AVFrame* frame = av_frame_alloc();
    const auto receive = [&] {
        while (avcodec_receive_frame(context, frame) == 0) result.middles.push_back(middleOf(*frame));
    };
    while (av_read_frame(format, packet) == 0) {
        avcodec_send_packet(context, packet);
        av_packet_unref(packet);
        receive();
    }
    avcodec_send_packet(context, nullptr);
    receive();
    av_frame_free(&frame);
    av_packet_free(&packet);
    avcodec_free_context(&context);
    avformat_close_input(&format);
    return result;
}

TEST_F(FilmCodecTest, every_picture_is_in_it_in_its_colour) {
    const std::vector<Rgb> colours = {
        {255, 255, 255}, {0, 0, 0}, {200, 30, 40}, {20, 160, 60}, {30, 60, 190}};
    for (const auto& [width, height] : {std::pair(1280, 720), std::pair(65, 49)}) {
        const auto encoder = openFilmFile(film(), width, height, width == 65 ? 29.97 : 30000.0 / 1001);
        ASSERT_TRUE(encoder);
        for (const Rgb& colour : colours) ASSERT_TRUE(encoder->add(plain(width, height, colour).data()));
        ASSERT_TRUE(encoder->finish());
        const Decoded found = decode(film());
        EXPECT_EQ(found.parameters.width, width + width % 2);
        EXPECT_EQ(found.parameters.height, height + height % 2);
        EXPECT_EQ(found.parameters.color_space, AVCOL_SPC_BT709);
        EXPECT_EQ(found.parameters.color_primaries, AVCOL_PRI_BT709);
        EXPECT_EQ(found.parameters.color_trc, AVCOL_TRC_IEC61966_2_1);
        EXPECT_EQ(found.parameters.color_range, AVCOL_RANGE_MPEG);
        EXPECT_NEAR(found.framesPerSecond, 30000.0 / 1001, 1e-9);
        ASSERT_EQ(found.middles.size(), colours.size());
        for (size_t i = 0; i < colours.size(); ++i)
            for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(found.middles[i][c], colours[i][c], 3) << i;
    }
}

TEST_F(FilmCodecTest, one_picture_is_a_film) {
    const auto encoder = openFilmFile(film(), 64, 48, 24);
    ASSERT_TRUE(encoder);
    ASSERT_TRUE(encoder->add(plain(64, 48, {90, 90, 90}).data()));
    ASSERT_TRUE(encoder->finish());
    const Decoded found = decode(film());
    EXPECT_EQ(found.middles.size(), 1u);
    EXPECT_NEAR(found.framesPerSecond, 24, 1e-9);
}

TEST_F(FilmCodecTest, that_has_no_room_is_not_complete) {
    const auto noise = [](int frame) {
        std::vector<uint8_t> rgb(640 * 480 * 3);
        uint32_t state = 1u + static_cast<uint32_t>(frame);
        for (uint8_t& value : rgb)
            value = static_cast<uint8_t>((state = state * 1664525u + 1013904223u) >> 24);
        return rgb;
    };
    const auto old = std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    rlimit small = before;
    small.rlim_cur = 100'000;
    setrlimit(RLIMIT_FSIZE, &small);
    const auto encoder = openFilmFile(film(), 640, 480, 24);
    bool whole = encoder != nullptr;
    for (int i = 0; i < 12 && whole; ++i) whole = encoder->add(noise(i).data());
    whole = whole && encoder->finish();
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, old);
    ASSERT_TRUE(encoder);
    EXPECT_FALSE(whole);
    EXPECT_EQ(encoder->why(), "File too large");
}

// Encoders took as many threads as there were processors, and twice the memory with 24.
TEST_F(FilmCodecTest, has_the_same_bits_whatever_the_number_of_processors) {
    const auto bytes = [&] {
        const auto encoder = openFilmFile(film(), 64, 256, 24);
        EXPECT_TRUE(encoder && encoder->add(plain(64, 256, {200, 30, 40}).data()) && encoder->finish());
        std::ifstream file(film(), std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    };
    const std::string onAll = bytes();
    cpu_set_t before, one;
    ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
    CPU_ZERO(&one);
    for (size_t cpu = 0; CPU_COUNT(&one) == 0; ++cpu)
        if (CPU_ISSET(cpu, &before)) CPU_SET(cpu, &one);
    sched_setaffinity(0, sizeof one, &one);
    const std::string onOne = bytes();
    sched_setaffinity(0, sizeof before, &before);
    EXPECT_TRUE(onOne == onAll);
}

TEST_F(FilmCodecTest, where_no_file_can_be_there_is_none) {
    EXPECT_FALSE(openFilmFile(film() / "none.mp4", 64, 48, 24));
}

} // namespace
} // namespace heliodon::geometry
