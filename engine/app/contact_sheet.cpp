#include "engine/app/contact_sheet.h"

#include <algorithm>
#include <cassert>

#include <opencv2/core.hpp>

#include "engine/passes/lettering.h"

namespace heliodon::app {

namespace {

constexpr int kGap = 8, kTop = 84, kLeft = 150, kTextHeight = 12;
const cv::Scalar kBackground(24, 24, 26);

// Smaller where it would be wider than `room`.
void label(passes::Image8& sheet, const std::string& text, cv::Point middle, int room) {
    passes::Lettering letters{13, {225, 225, 225}};
    letters.shrinkTo(room, text);
    letters.drawCentred(sheet, middle.x, middle.y, text);
}

} // namespace

passes::Image8 contactSheet(std::span<const passes::Image8> cells, const std::vector<std::string>& rows,
                            const std::vector<std::string>& columns, const std::string& title,
                            const std::optional<passes::FalseScale>& legend) {
    assert(cells.size() == rows.size() * columns.size() && !cells.empty());
    const int width = cells[0].width, height = cells[0].height;
    const auto across = static_cast<int>(columns.size()), down = static_cast<int>(rows.size());
    passes::Image8 image;
    image.height = kTop + down * (height + kGap);
    const int cellsWidth = kLeft + across * (width + kGap);
    image.width = cellsWidth + (legend ? passes::legendWidth(image.height) : 0);
    image.rgb.resize(3 * static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
    cv::Mat sheet(image.height, image.width, CV_8UC3, image.rgb.data());
    sheet = kBackground;
    label(image, title, {cellsWidth / 2, kTop / 3 - 4}, cellsWidth - 2 * kGap);
    for (int c = 0; c < across; ++c)
        label(image, columns[static_cast<size_t>(c)],
              {kLeft + c * (width + kGap) + width / 2, kTop - kTextHeight - kGap}, width);
    for (int r = 0; r < down; ++r) {
        const int top = kTop + r * (height + kGap);
        label(image, rows[static_cast<size_t>(r)], {kLeft / 2, top + height / 2}, kLeft - kGap);
        for (int c = 0; c < across; ++c) {
            const passes::Image8& cell =
                cells[static_cast<size_t>(r) * columns.size() + static_cast<size_t>(c)];
            const cv::Mat from(height, width, CV_8UC3, const_cast<uint8_t*>(cell.rgb.data()));
            from.copyTo(sheet(cv::Rect(kLeft + c * (width + kGap), top, width, height)));
        }
    }
    if (legend) passes::drawLegend(image, *legend);
    return image;
}

} // namespace heliodon::app
