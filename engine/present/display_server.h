// The connection to the display server. Internal to engine/present.
#pragma once

namespace heliodon::present {

// GLFW is one per process; opened at the first call. Throws std::runtime_error with its own words, and as
// checkDisplayServer().
void openWindowSystem();

// Throws std::runtime_error once the connection has broken. Nothing of GLFW that asks the server may be
// called then, as Xlib goes on without a buffer: to be called after what waits for an answer, before anything
// else.
void checkDisplayServer();
bool displayServerLost();

// How often the server did not say how large a window is, as another program had destroyed it: what GLFW then
// answers is no size.
unsigned sizesRefused();

} // namespace heliodon::present
