#include "vision/calibration_target.h"

#include <algorithm>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <unistd.h>

#include "geometry/input_error.h"
#include "vision/find_target.h"

namespace heliodon::vision {
namespace {

// What a page draws, millimetres.
struct Page {
    double edge = 0;
    std::vector<cv::Rect2d> squares;
    struct Disk {
        cv::Point2d at;
        double radius;
        cv::Scalar rgb;
    };
    std::vector<Disk> disks;
};

class TargetFile : public testing::Test {
protected:
    void TearDown() override { std::filesystem::remove(file); }
    std::string written(const CalibrationTarget& target, const std::string& extension) {
        file = std::filesystem::temp_directory_path() /
               ("heliodon-target-" + std::to_string(getpid()) + extension);
        writeTarget(target, file);
        std::ostringstream text;
        text << std::ifstream(file).rdbuf();
        return text.str();
    }
    std::filesystem::path file;
};

// All places where the pattern fits, one after the other; # in it stands for a number, which is returned.
std::vector<std::vector<double>> matches(const std::string& text, const std::string& pattern) {
    std::vector<std::vector<double>> out;
    for (size_t start = 0; start < text.size();) {
        std::vector<double> numbers;
        size_t at = start;
        const bool fits = std::ranges::all_of(pattern, [&](char wanted) {
            if (wanted != '#') return at < text.size() && text[at++] == wanted;
            const size_t sign = at < text.size() && text[at] == '-' ? 1 : 0;
            const size_t end = std::min(text.find_first_not_of("0123456789.", at + sign), text.size());
            if (end == at + sign) return false;
            numbers.push_back(std::stod(text.substr(at, end - at)));
            at = end;
            return true;
        });
        if (fits) out.push_back(numbers);
        start = fits ? at : start + 1;
    }
    return out;
}

Page readSvg(const std::string& text) {
    Page page;
    page.edge = matches(text, "width=\"#mm\"").at(0)[0];
    for (const auto& m : matches(text, "M# #h#v")) {
        page.squares.emplace_back(m[0], m[1], m[2], m[2]);
        page.squares.emplace_back(m[0] - m[2], m[1] - m[2], m[2], m[2]);
    }
    for (const auto& m : matches(text, "cx=\"#\" cy=\"#\" r=\"#\" fill=\"rgb(#,#,#)"))
        page.disks.push_back({{m[0], m[1]}, m[2], {m[3], m[4], m[5]}});
    return page;
}

// Points to millimetres and the other way up by the page's own matrix.
Page readPdf(const std::string& text) {
    Page page;
    page.edge = matches(text, "MediaBox [0 0 # ").at(0)[0] * 25.4 / 72;
    const auto matrix = matches(text, "# 0 0 # # # cm").at(0);
    EXPECT_NEAR(matrix[0], 72 / 25.4, 1e-5);
    EXPECT_NEAR(matrix[1], -72 / 25.4, 1e-5);
    EXPECT_NEAR(matrix[2] * 25.4 / 72, page.edge / 2, 1e-3);
    for (const auto& m : matches(text, "# # # # re"))
        page.squares.emplace_back(std::min(m[0], m[0] + m[2]), std::min(m[1], m[1] + m[3]), std::abs(m[2]),
                                  std::abs(m[3]));
    // A disk begins at its right and goes on to its bottom.
    for (const auto& m : matches(text, "# # # rg\n# # m\n# # # # # # c\n"))
        page.disks.push_back({{m[9], m[4]}, m[3] - m[9], {255 * m[0], 255 * m[1], 255 * m[2]}});
    return page;
}

Photograph painted(const Page& page, double pixelsPerMm) {
    const int size = static_cast<int>(page.edge * pixelsPerMm);
    cv::Mat picture(size, size, CV_8UC3, cv::Scalar::all(255));
    const auto pixel = [&](double x, double y) { // 1/16 pixel
        const double scale = 16 * pixelsPerMm, half = page.edge / 2;
        return cv::Point(static_cast<int>(std::lround((x + half) * scale - 8)),
                         static_cast<int>(std::lround((y + half) * scale - 8)));
    };
    for (const auto& s : page.squares)
        cv::fillConvexPoly(picture,
                           std::vector{pixel(s.x, s.y), pixel(s.x + s.width, s.y),
                                       pixel(s.x + s.width, s.y + s.height), pixel(s.x, s.y + s.height)},
                           cv::Scalar::all(0), cv::LINE_AA, 4);
    for (const auto& disk : page.disks)
        cv::circle(picture, pixel(disk.at.x, disk.at.y), static_cast<int>(16 * disk.radius * pixelsPerMm),
                   disk.rgb, cv::FILLED, cv::LINE_AA, 4);
    cv::GaussianBlur(picture, picture, {}, 0.7);
    return {size, size, {picture.data, picture.data + 3 * picture.total()}, "page"};
}

TEST_F(TargetFile, printed_pages_have_true_size_and_are_found_as_they_are_drawn) {
    for (const double edge : {1.016, 0.42}) {
        const CalibrationTarget target = makeTarget(edge);
        for (const bool isPdf : {false, true}) {
            SCOPED_TRACE(isPdf ? "pdf" : "svg");
            const std::string text = written(target, isPdf ? ".pdf" : ".svg");
            const Page page = isPdf ? readPdf(text) : readSvg(text);
            EXPECT_NEAR(page.edge, 1000 * edge, 0.01);
            ASSERT_EQ(page.squares.size(), 424u);
            ASSERT_EQ(page.disks.size(), 4u);
            for (size_t i = 0; i < target.marks.size(); ++i) { // a square begins at the mark, one ends there
                EXPECT_NEAR(page.squares[2 * i].x, 1000 * target.marks[i].x, 1e-3);
                EXPECT_NEAR(page.squares[2 * i].y, 1000 * target.marks[i].y, 1e-3);
                EXPECT_NEAR(page.squares[2 * i + 1].br().x, 1000 * target.marks[i].x, 1e-3);
                EXPECT_NEAR(page.squares[2 * i + 1].br().y, 1000 * target.marks[i].y, 1e-3);
            }
            const double scale = 900 / page.edge;
            const FoundTarget found = findTarget(painted(page, scale), target);
            ASSERT_EQ(found.marks.size(), 212u) << found.problem;
            for (const FoundMark& mark : found.marks) {
                const glm::dvec2 at = (1000.0 * target.marks[mark.id] + page.edge / 2) * scale - 0.5;
                EXPECT_NEAR(mark.pixel.x, at.x, 0.25); // OpenCV's painter is no better
                EXPECT_NEAR(mark.pixel.y, at.y, 0.25);
            }
        }
    }
}

TEST_F(TargetFile, a_mirrored_picture_of_the_board_is_named) {
    const CalibrationTarget target = makeTarget(1.016);
    const Page page = readSvg(written(target, ".svg"));
    Photograph photo = painted(page, 900 / page.edge);
    const auto width = static_cast<size_t>(photo.width);
    for (size_t i = 0; i < photo.rgb.size() / 3; ++i)
        if (const size_t x = i % width; 2 * x < width)
            std::swap_ranges(&photo.rgb[3 * i], &photo.rgb[3 * i] + 3,
                             &photo.rgb[3 * (i - x + width - 1 - x)]);
    const FoundTarget found = findTarget(photo, target);
    EXPECT_TRUE(found.marks.empty());
    EXPECT_NE(found.problem.find("mirrored"), std::string::npos) << found.problem;
}

TEST(CalibrationTarget, is_the_papers) {
    const CalibrationTarget target = makeTarget();
    ASSERT_EQ(target.marks.size(), 212u);
    EXPECT_EQ(target.gaps.size(), 13u);
    EXPECT_NEAR(target.marks[0].x, -0.33, 1e-12);
    EXPECT_NEAR(target.marks[0].y, -0.462, 1e-12);
    EXPECT_NEAR(target.marks[1].x, -0.264, 1e-12);
    EXPECT_NEAR(target.marks[211].x, 0.33, 1e-12);
    EXPECT_NEAR(target.disks[1].at.x, 0.452, 1e-12);
    EXPECT_NEAR(target.disks[1].at.y, -0.452, 1e-12);
}

TEST_F(TargetFile, a_pdf_says_where_its_objects_are) {
    const std::string text = written(makeTarget(), ".pdf");
    const auto table = matches(text, "# 00000 n ");
    ASSERT_EQ(table.size(), 4u);
    for (size_t i = 0; i < table.size(); ++i) {
        EXPECT_EQ(text.compare(static_cast<size_t>(table[i][0]), 7, std::to_string(i + 1) + " 0 obj"), 0);
        EXPECT_NE(text.find(fmt::format("\n{:010.0f} 00000 n ", table[i][0])), std::string::npos);
    }
    const auto start = static_cast<size_t>(matches(text, "startxref\n#").at(0)[0]);
    EXPECT_EQ(text.compare(start, 4, "xref"), 0);
    const auto length = static_cast<size_t>(matches(text, "/Length #").at(0)[0]);
    EXPECT_EQ(text.compare(text.find("stream\n") + 7 + length, 9, "endstream"), 0);
}

TEST_F(TargetFile, another_format_is_refused) {
    EXPECT_THROW(written(makeTarget(), ".png"), geometry::InputError);
}

} // namespace
} // namespace heliodon::vision
