// What X11 window managers have to be told beside what GLFW tells them. Internal to engine/present.
#pragma once

#include "engine/present/presenter.h"

struct GLFWwindow;

namespace heliodon::present {

// That a window that is full-screen fills this display. Some managers go by the display's number among those
// connected, for which GLFW sends the one of the time when it was connected. Nothing where there is no X11.
void askToFill(GLFWwindow* window, const Display& display);

} // namespace heliodon::present
