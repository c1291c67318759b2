// The faces of a model's file as loose polygons that are flat.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "geometry/face_soup.h"
#include "geometry/raw_model.h"

namespace heliodon::geometry {

// Of the model's extent: corners nearer are one, as files hold 6 or 7 digits; corners farther off a face's
// plane bend it.
constexpr double kWeldOfExtent = 2e-6, kPlanarOfExtent = 1e-5;

struct ModelFaces {
    std::vector<SoupFace> soup;        // SoupFace::surface: the face's number in the file
    std::vector<SoupFace> outside;     // of kOutsideGroup, flat too
    size_t dropped = 0;                // faces without area
    size_t turnedOver = 0;             // against the others of their body (geometry/turned_faces)
    std::string repair;                // of faces bent by little; empty where there are none
    std::vector<std::string> warnings; // of those bent by more, and what else was guessed
    // By the face's number in the file, world metres: bent so far that this may be what keeps rooms from
    // closing.
    std::map<uint32_t, double> folded;
    // By the face's number in the file: sheets that were made boards, which are closed. What of them hangs
    // open lies where they touch, inside.
    std::set<uint32_t> boards;
    bool exact = false; // corners stand where they are meant to: no gaps are to be closed
    double coarser = 1; // how many times tolerances are wider, of files with few decimals
};

// Bent faces in triangles, both sides of a wall alike. `extent`: of the model, world metres, times `coarser`
// where the file's decimals ask for wider tolerances. Sentences state metres of building, of
// `worldPerBuilding` world metres each.
ModelFaces flatFaces(const RawModel& model, double extent, double worldPerBuilding, double coarser = 1);

} // namespace heliodon::geometry
