#include "vision/calibration_target.h"

#include <cmath>
#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "geometry/input_error.h"
#include "geometry/sketch.h"
#include "geometry/whole_file.h"

namespace heliodon::vision {
namespace {

constexpr int kGrid = 15;
constexpr double kUsualEdge = 1.016, kDiskOffset = 0.452;

bool isGap(int column, int row) {
    const int fromSide = std::min(column, kGrid - 1 - column), fromTop = std::min(row, kGrid - 1 - row);
    return fromSide + fromTop <= 1 || (column == kGrid / 2 && row == kGrid / 2);
}

std::string svg(const CalibrationTarget& target) {
    const double half = 500 * target.board, square = 1000 * target.square;
    std::string out =
        fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.4f}mm\" height=\"{0:.4f}mm\" "
                    "viewBox=\"{1:.4f} "
                    "{1:.4f} {0:.4f} {0:.4f}\">\n<title>Heliodon calibration target, millimetres</title>\n"
                    "<rect x=\"{1:.4f}\" y=\"{1:.4f}\" width=\"{0:.4f}\" height=\"{0:.4f}\" "
                    "fill=\"#fff\"/>\n<g fill=\"#000\">\n",
                    2 * half, -half);
    for (const glm::dvec2& mark : target.marks)
        out += fmt::format(
            "<path d=\"M{0:.4f} {1:.4f}h{2:.4f}v{2:.4f}h-{2:.4f}zm0 0h-{2:.4f}v-{2:.4f}h{2:.4f}z\"/>\n",
            1000 * mark.x, 1000 * mark.y, square);
    out += "</g>\n";
    for (const auto& disk : target.disks)
        out += fmt::format(
            "<circle cx=\"{:.4f}\" cy=\"{:.4f}\" r=\"{:.4f}\" fill=\"rgb({:.0f},{:.0f},{:.0f})\"/>\n",
            1000 * disk.at.x, 1000 * disk.at.y, 1000 * target.diskRadius, 255 * disk.srgb.x,
            255 * disk.srgb.y, 255 * disk.srgb.z);
    return out + "</svg>\n";
}

// One page, drawn in millimetres with y down like the board's frame.
std::string pageContent(const CalibrationTarget& target) {
    const double edge = 1000 * target.board, pointsPerMm = 72 / 25.4, square = 1000 * target.square;
    std::string out = fmt::format("{0:.6f} 0 0 {1:.6f} {2:.4f} {2:.4f} cm\n0 g\n", pointsPerMm, -pointsPerMm,
                                  pointsPerMm * edge / 2);
    for (const glm::dvec2& mark : target.marks)
        for (const double side : {square, -square})
            out += fmt::format("{:.4f} {:.4f} {:.4f} {:.4f} re\n", 1000 * mark.x, 1000 * mark.y, side, side);
    out += "f\n";
    const double r = 1000 * target.diskRadius,
                 k = r * 4 / 3 * (std::sqrt(2.0) - 1); // four cubic arcs: round to 3e-4 of the radius
    for (const auto& disk : target.disks) {
        const double x = 1000 * disk.at.x, y = 1000 * disk.at.y;
        out += fmt::format("{:.4f} {:.4f} {:.4f} rg\n{:.4f} {:.4f} m\n", disk.srgb.x, disk.srgb.y,
                           disk.srgb.z, x + r, y);
        double dx = 1, dy = 0; // from the centre to the arc's start; the next one is a quarter turn on
        for (int arc = 0; arc < 4; ++arc) {
            const double ex = -dy, ey = dx;
            out += fmt::format("{:.4f} {:.4f} {:.4f} {:.4f} {:.4f} {:.4f} c\n", x + r * dx + k * ex,
                               y + r * dy + k * ey, x + r * ex + k * dx, y + r * ey + k * dy, x + r * ex,
                               y + r * ey);
            dx = ex, dy = ey;
        }
        out += "f\n";
    }
    return out;
}

std::string pdf(const CalibrationTarget& target) {
    const double edge = target.board / geometry::kMetresPerInch * 72;
    const std::string content = pageContent(target);
    const std::string objects[] = {
        "<< /Type /Catalog /Pages 2 0 R /ViewerPreferences << /PrintScaling /None >> >>",
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {0:.4f} {0:.4f}] /Contents 4 0 R /Resources "
                    "<< >> >>",
                    edge),
        fmt::format("<< /Length {} >>\nstream\n{}endstream", content.size(), content)};
    std::string out = "%PDF-1.4\n", table = "0000000000 65535 f \n";
    int number = 0;
    for (const std::string& object : objects) {
        table += fmt::format("{:010} 00000 n \n", out.size());
        out += fmt::format("{} 0 obj\n{}\nendobj\n", ++number, object);
    }
    return out + fmt::format("xref\n0 {0}\n{1}trailer\n<< /Size {0} /Root 1 0 R >>\nstartxref\n{2}\n%%EOF\n",
                             number + 1, table, out.size());
}

} // namespace

CalibrationTarget makeTarget(double boardEdge) {
    const double scale = boardEdge / kUsualEdge;
    CalibrationTarget target;
    for (double* length : {&target.board, &target.square, &target.pitch, &target.diskRadius})
        *length *= scale;
    for (int row = 0; row < kGrid; ++row)
        for (int column = 0; column < kGrid; ++column)
            (isGap(column, row) ? target.gaps : target.marks)
                .emplace_back(target.pitch * (column - kGrid / 2), target.pitch * (row - kGrid / 2));
    const double d = scale * kDiskOffset;
    target.disks = {CalibrationTarget::Disk{{-d, -d}, 0, {0.85, 0.10, 0.12}},
                    CalibrationTarget::Disk{{d, -d}, 133, {0.10, 0.62, 0.24}},
                    CalibrationTarget::Disk{{d, d}, 230, {0.12, 0.25, 0.72}},
                    CalibrationTarget::Disk{{-d, d}, 46, {0.95, 0.82, 0.10}}};
    return target;
}

void writeTarget(const CalibrationTarget& target, const std::filesystem::path& file) {
    const std::string extension = file.extension().string();
    if (extension != ".svg" && extension != ".pdf")
        throw geometry::InputError(file.string(), "", "expected a name that ends in .pdf or .svg");
    geometry::writeWholeText(file, extension == ".svg" ? svg(target) : pdf(target));
}

} // namespace heliodon::vision
