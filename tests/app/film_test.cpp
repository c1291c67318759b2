// A film whose encoder gives up: named at the next frame or at the end, nothing left behind, nobody kept
// waiting.
#include "engine/app/film.h"

#include "tests/app/program.h"

namespace heliodon::test {
namespace {

// Writes a byte a frame, as far as `frames`.
class GivesUp : public geometry::FilmEncoder {
public:
    GivesUp(const std::filesystem::path& file, int frames) : file_(file), left_(frames) { file_ << "begun"; }
    bool add(const uint8_t* rgb) override { return left_-- > 0 && file_.put(static_cast<char>(*rgb)).good(); }
    bool finish() override {
        file_.close();
        return left_ >= 0;
    }

private:
    std::ofstream file_;
    int left_;
};

class FilmTest : public InFolder {
protected:
    app::Film film(int frames) {
        return app::Film(in("film.mp4"), [frames](const std::filesystem::path& file) {
            return std::make_unique<GivesUp>(file, frames);
        });
    }
    size_t files() const {
        const auto all = std::filesystem::directory_iterator(folder);
        return static_cast<size_t>(std::distance(begin(all), end(all)));
    }
    static std::vector<uint8_t> frame() { return std::vector<uint8_t>(12, 'x'); }
};

TEST_F(FilmTest, appears_whole) {
    {
        app::Film whole = film(3);
        for (int i = 0; i < 3; ++i) whole.add(frame());
        EXPECT_FALSE(std::filesystem::exists(in("film.mp4")));
        whole.close();
    }
    EXPECT_EQ(readText(in("film.mp4")), "begunxxx");
    EXPECT_EQ(files(), 1u);
}

TEST_F(FilmTest, goes_where_its_name_links_to) {
    std::filesystem::create_directory(folder / "disk");
    std::filesystem::create_symlink("disk/real.mp4", folder / "film.mp4");
    for (int run = 0; run < 2; ++run) { // there, or not yet
        app::Film linked = film(1);
        linked.add(frame());
        linked.close();
        EXPECT_TRUE(std::filesystem::is_symlink(folder / "film.mp4"));
        EXPECT_EQ(readText(in("disk/real.mp4")), "begunx");
    }
    EXPECT_EQ(files(), 2u);
}

TEST_F(FilmTest, says_why_its_file_cannot_be_begun) {
    const std::string name = std::string(252, 'x') + ".mp4";
    try {
        app::Film(in(name), [](const std::filesystem::path&) { return nullptr; });
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find(name + ": could not be written: File name too long"),
                  std::string::npos)
            << error.what();
    }
}

TEST_F(FilmTest, that_fails_early_is_said_and_leaves_nothing) {
    for (const int frames : {0, 2}) {
        app::Film early = film(frames);
        EXPECT_EQ(files(), 1u); // aside
        const auto addMany = [&] {
            for (int i = 0; i < 1000; ++i) early.add(frame()); // many more than wait for the encoder
        };
        try {
            addMany();
            FAIL() << "no failure after " << frames;
        } catch (const std::runtime_error& error) {
            EXPECT_NE(std::string(error.what()).find("film.mp4: a frame could not be encoded"),
                      std::string::npos)
                << error.what();
        }
        EXPECT_THROW(early.add(frame()), std::runtime_error); // and again
        EXPECT_THROW(early.close(), std::runtime_error);
        EXPECT_EQ(files(), 0u);
    }
}

TEST_F(FilmTest, that_is_given_up_after_a_failure_leaves_nothing) {
    {
        app::Film dropped = film(0);
        EXPECT_ANY_THROW(for (int i = 0; i < 1000; ++i) dropped.add(frame()));
    }
    EXPECT_EQ(files(), 0u);
}

TEST_F(FilmTest, that_fails_at_its_last_frame_fails_at_the_end) {
    app::Film late = film(3);
    for (int i = 0; i < 4; ++i) late.add(frame()); // fewer than wait for the encoder
    EXPECT_THROW(late.close(), std::runtime_error);
    EXPECT_EQ(files(), 0u);
}

TEST_F(FilmTest, whose_encoder_begins_the_file_and_does_not_open_leaves_nothing) {
    int begun = 0;
    const auto begin = [&](const std::filesystem::path& file) {
        std::ofstream(file) << 'x';
        begun += std::filesystem::file_size(file) == 1;
    };
    const auto none = [&](const std::filesystem::path& file) {
        begin(file);
        return std::unique_ptr<geometry::FilmEncoder>();
    };
    const auto failing = [&](const std::filesystem::path& file) -> std::unique_ptr<geometry::FilmEncoder> {
        begin(file);
        throw std::bad_alloc();
    };
    EXPECT_THROW(app::Film(in("film.mp4"), none), std::runtime_error);
    EXPECT_EQ(files(), 0u);
    EXPECT_THROW(app::Film(in("film.mp4"), failing), std::bad_alloc); // as it was thrown
    EXPECT_EQ(files(), 0u);
    EXPECT_EQ(begun, 2);
}

TEST_F(FilmTest, without_an_encoder_is_refused) {
    EXPECT_THROW(app::Film(in("film.mp4"), [](const auto&) { return nullptr; }), std::runtime_error);
    EXPECT_EQ(files(), 0u);
}

} // namespace
} // namespace heliodon::test
