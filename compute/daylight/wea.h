// Weather as Radiance's gendaymtx and Daysim read it (.wea): a head of six lines, then a line a record with
// month, day, hour, direct normal and diffuse horizontal irradiance. Only epw.cpp and tests need this.
#pragma once

#include <string>
#include <string_view>

#include "compute/daylight/epw.h"

namespace heliodon::daylight {

// By its first word.
bool isWea(std::string_view text);

// Longitude and time zone count west of Greenwich in such files, in degrees. Hours are the middles of equal
// parts of an hour, 0.5 of a whole one, or (with a warning) where these begin, or end if one is 24: the sun
// is taken there, as gendaymtx does. Hours, days or months may be left out;
// they may go on into the next year. The year is 2001, 2004 where
// there is a 29 February. 9999 is missing; dew points and global irradiance are not in the format. Throws
// InputError with the line: units other than 1 (W/m2, direct normal), a wrong number, a record out of order.
EpwFile readWea(const std::string& file, std::string_view text);

} // namespace heliodon::daylight
