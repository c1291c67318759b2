// Options that several commands share: said once, so that they mean the same in each.
#pragma once

#include <CLI/CLI.hpp>

#include "engine/app/arguments.h"

namespace heliodon::app {

void addScene(CLI::App* sub, SceneArguments& scene); // the input, with those of addMesh
void addMesh(CLI::App* sub, SceneArguments& scene);
void addBlinds(CLI::App* sub, SceneArguments& scene);
void addMoment(CLI::App* sub, MomentArguments& moment, bool withTime);
void addWeather(CLI::App* sub, MomentArguments& moment); // after addMoment: excludes its --sky
void addGround(CLI::App* sub, MomentArguments& moment);
void addScatter(CLI::App* sub, PictureArguments& picture); // after --rig; part of addPicture
void addPicture(CLI::App* sub, PictureArguments& picture, const std::string& sizeHelp);
CLI::Option* addRadiosityError(CLI::App* sub, double& value);

} // namespace heliodon::app
