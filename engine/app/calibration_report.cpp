#include "engine/app/calibration_report.h"

namespace heliodon::app {

nlohmann::json lensReport(const geometry::Lens& lens) {
    return {{"fx", lens.fx}, {"fy", lens.fy}, {"cx", lens.cx}, {"cy", lens.cy}, {"dist", lens.dist}};
}

} // namespace heliodon::app
