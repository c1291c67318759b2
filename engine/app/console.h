// What is said to people, on the standard error.
#pragma once

#include <string_view>

namespace heliodon::app {

// A descriptor of the three that whoever started the program has closed would be the next file's that is
// opened: what is said would go into it. Call it first.
void keepStandardStreams();

// Messages that cannot be said, as where the log's disk is full, are no reason to end the work. Never throws.
void say(std::string_view text);

// Throws where something that was printed on the standard output has not arrived. Call it last.
void refuseLostOutput();

} // namespace heliodon::app
