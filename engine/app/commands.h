// One function a command; each does the work and fills the report. Throws geometry::InputError (exit 2) or
// anything else (exit 1).
#pragma once

#include "engine/app/arguments.h"
#include "engine/app/run.h"

namespace heliodon::app {

void execute(Run& run, const DetectArguments& arguments);
void execute(Run& run, const ModelArguments& arguments);
void execute(Run& run, const FormFactorArguments& arguments);
void execute(Run& run, const IlluminanceArguments& arguments);
void execute(Run& run, const RenderArguments& arguments);
void execute(Run& run, const TimelapseArguments& arguments);
void execute(Run& run, const AnnualArguments& arguments);
void execute(Run& run, const CalibrateTargetArguments& arguments);
void execute(Run& run, const CalibrateCameraArguments& arguments);
void execute(Run& run, const CalibratePatternsArguments& arguments);
void execute(Run& run, const CalibrateProjectorArguments& arguments);
void execute(Run& run, const LiveArguments& arguments);
void execute(Run& run, const BenchArguments& arguments);
void execute(Run& run, const DevicesArguments& arguments);

} // namespace heliodon::app
