// Cameras as `live` uses them: a file, a folder, and a GigE Vision camera that Aravis imitates, on the
// loopback network, with our own pictures in its sensor.
#include "vision/camera.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include "geometry/input_error.h"
#include "tests/vision/imitated_camera.h"

namespace heliodon::vision {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

const fs::path kBright = HELIODON_SOURCE "/examples/i01_mixed.png";
const fs::path kGood = HELIODON_TEST_DATA "/vision/p10_window_over_joint_good.jpg";

class Cameras : public testing::Test {
protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        folder = fs::temp_directory_path() / ("heliodon-" + std::to_string(getpid()) + info->name());
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }
    std::string source(const std::string& kind, const fs::path& path) const {
        return kind + ":" + path.string();
    }
    fs::path folder;
    CameraOptions options{1392, 1032, 1, false, 0.02};
};

TEST_F(Cameras, a_file_is_one_picture_until_it_changes) {
    const fs::path file = folder / "table.png";
    fs::copy_file(kBright, file);
    const auto camera = openCamera(source("file", file), options);
    EXPECT_FALSE(camera->isContinuous());
    const auto first = camera->next(20s);
    ASSERT_TRUE(first);
    EXPECT_EQ(first->photo->rgb, readPhotograph(kBright).rgb);
    EXPECT_FALSE(camera->next(150ms));
    fs::remove(file);
    fs::copy_file(kGood, file);
    const auto second = camera->next(20s);
    ASSERT_TRUE(second);
    EXPECT_EQ(second->photo->rgb, readPhotograph(kGood).rgb);
    EXPECT_FALSE(camera->next(150ms));
}

TEST_F(Cameras, a_file_that_is_being_written_is_waited_for) {
    const fs::path file = folder / "table.jpg";
    fs::copy_file(kGood, file);
    const auto camera = openCamera(source("file", file), options);
    ASSERT_TRUE(camera->next(20s));
    std::ifstream in(kGood, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    std::thread writer([&] { // slowly, but never so slowly that it rests for a look
        std::ofstream out(file, std::ios::binary);
        constexpr size_t kPieces = 40;
        for (size_t i = 0; i < kPieces; ++i) {
            const size_t from = bytes.size() * i / kPieces, to = bytes.size() * (i + 1) / kPieces;
            out.write(bytes.data() + from, static_cast<std::streamsize>(to - from));
            out.flush();
            std::this_thread::sleep_for(10ms);
        }
    });
    options.refreshSeconds = 0.1;
    const auto slow = openCamera(source("file", file), options);
    slow->next(50ms); // whatever it holds now
    const auto whole = slow->next(20s);
    writer.join();
    ASSERT_TRUE(whole);
    EXPECT_EQ(whole->photo->rgb, readPhotograph(kGood).rgb);
}

TEST_F(Cameras, a_file_that_stays_away_is_a_camera_that_is_lost) {
    const fs::path file = folder / "table.jpg";
    fs::copy_file(kGood, file);
    const auto camera = openCamera(source("file", file), options);
    ASSERT_TRUE(camera->next(20s));
    fs::remove(file);
    EXPECT_THROW(camera->next(20s), CameraLost);
}

TEST_F(Cameras, a_folder_is_played_by_name_and_ends_with_its_last_picture) {
    fs::copy_file(kGood, folder / "2.jpg");
    fs::copy_file(kBright, folder / "1.png");
    std::ofstream(folder / "notes.txt") << "no picture";
    options.intervalSeconds = 0.6;
    const auto camera = openCamera(source("replay", folder), options);
    EXPECT_TRUE(camera->isContinuous());
    std::vector<std::shared_ptr<const Photograph>> seen;
    // A further one would come within an interval of the last.
    auto end = std::chrono::steady_clock::now() + 20s;
    while (std::chrono::steady_clock::now() < end)
        if (const auto picture = camera->next(100ms);
            picture && (seen.empty() || seen.back() != picture->photo)) {
            seen.push_back(picture->photo);
            if (seen.size() == 2) end = std::chrono::steady_clock::now() + 1s;
        }
    ASSERT_EQ(seen.size(), 2u);
    EXPECT_EQ(fs::path(seen[0]->name).filename(), "1.png");
    EXPECT_EQ(fs::path(seen[1]->name).filename(), "2.jpg");
}

TEST_F(Cameras, what_can_never_be_a_camera_is_refused) {
    for (const std::string& bad :
         {std::string("webcam:0"), std::string("table.png"), source("file", folder / "none.png"),
          source("replay", folder), source("replay", folder / "none")})
        EXPECT_THROW(openCamera(bad, options), geometry::InputError) << bad;
}

// ---- Aravis ----

TEST_F(Cameras, a_network_camera_delivers_its_pictures_to_the_last_bit) {
    const Photograph photo = readPhotograph(kBright);
    const ImitatedCamera imitated(photo);
    ASSERT_TRUE(imitated.runs());
    const auto camera = openCamera("aravis:127.0.0.1", options);
    EXPECT_TRUE(camera->isContinuous());
    std::optional<CameraPicture> picture;
    for (int i = 0; i < 50 && !picture; ++i) picture = camera->next(200ms); // a packet may be lost
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->photo->width, 1392);
    EXPECT_EQ(picture->photo->height, 1032);
    EXPECT_EQ(picture->photo->rgb, photo.rgb);
}

TEST_F(Cameras, a_network_camera_that_goes_away_is_lost_and_found_again) {
    const Photograph photo = readPhotograph(kBright);
    auto imitated = std::make_unique<ImitatedCamera>(photo);
    auto camera = openCamera("aravis:127.0.0.1", options);
    ASSERT_TRUE(camera->next(20s));
    imitated.reset();
    const auto untilLost = [&] {
        for (int i = 0; i < 100; ++i) camera->next(100ms);
    };
    EXPECT_THROW(untilLost(), CameraLost);
    camera.reset();
    EXPECT_THROW(openCamera("aravis:127.0.0.1", options), CameraLost);
    imitated = std::make_unique<ImitatedCamera>(photo);
    camera = openCamera("aravis:127.0.0.1", options);
    std::optional<CameraPicture> picture;
    for (int i = 0; i < 50 && !picture; ++i) picture = camera->next(200ms);
    EXPECT_TRUE(picture);
}

} // namespace
} // namespace heliodon::vision
