// The desktop's displays by what GLFW knows of them. Internal to engine/present. Nothing here throws; all but
// monitors() ask the display server.
#pragma once

#include <string>
#include <vector>

#include "engine/present/presenter.h"

struct GLFWmonitor;
struct GLFWwindow;

namespace heliodon::present {

std::vector<GLFWmonitor*> monitors();
GLFWmonitor* monitorNamed(const std::string& name); // none: it is not connected

const Display* findNamed(const std::vector<Display>& displays, const std::string& name);
// The one that shows most of `part`; none where no pixel of it is shown.
const Display* findUnder(const std::vector<Display>& displays, const Display& part);

// Named after the display that it fills.
Display partCoveredBy(GLFWwindow* window);

} // namespace heliodon::present
