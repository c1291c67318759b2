#include "engine/app/calibration_report.h"

namespace heliodon::app {

nlohmann::json lensReport(const geometry::Lens& lens) {
    return {{"fx", lens.fx}, {"fy", lens.fy}, {"cx", lens.cx}, {"cy", lens.cy}, {"dist", lens.dist}};
}

nlohmann::json orNull(std::optional<double> figure) {
    return figure ? nlohmann::json(*figure) : nlohmann::json();
}

} // namespace heliodon::app
