// `--blinds`: the states of windows as a user writes them, and a mesh with its windows so.
#pragma once

#include <string>
#include <vector>

#include "engine/app/run.h"
#include "geometry/patch_mesh.h"

namespace heliodon::app {

// One value of `--blinds`: [MATERIAL=]STATE with STATE open, fabric:T[,R] or slats:ANGLE[,R[,SPACING]].
struct WindowState {
    std::string material; // of the openings meant; empty: all
    geometry::Blind blind;
};
// Throws InputError on what is no state, naming the option.
WindowState parseWindowState(const std::string& text);

// Draws blinds before the openings that lead outside: those of the materials, which `file` gave, then
// `states`, later ones over earlier ones. Fills `blinds` of the report. Throws InputError on materials that
// no such opening has, and on interior windows that the file gives blinds.
void drawBlinds(Run& run, const std::vector<std::string>& states, const std::string& file,
                geometry::PatchMesh& mesh);

} // namespace heliodon::app
