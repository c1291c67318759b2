#include "engine/present/desktop.h"

#include <algorithm>

#include "engine/present/display_server.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace heliodon::present {

std::vector<GLFWmonitor*> monitors() {
    int count = 0;
    GLFWmonitor** list = glfwGetMonitors(&count);
    return {list, list + count};
}

GLFWmonitor* monitorNamed(const std::string& name) {
    const std::vector<GLFWmonitor*> all = monitors();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](GLFWmonitor* m) { return name == glfwGetMonitorName(m); });
    return found == all.end() ? nullptr : *found;
}

std::vector<Display> displays() {
    openWindowSystem();
    std::vector<Display> list;
    for (GLFWmonitor* monitor : monitors()) {
        Display display{glfwGetMonitorName(monitor)};
        glfwGetMonitorPos(monitor, &display.x, &display.y);
        if (const GLFWvidmode* mode = glfwGetVideoMode(monitor))
            display.width = mode->width, display.height = mode->height;
        list.push_back(display);
    }
    return list;
}

long sharedPixels(const Display& a, const Display& b) {
    const long across = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x),
               down = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
    return across > 0 && down > 0 ? across * down : 0;
}

const Display* findNamed(const std::vector<Display>& displays, const std::string& name) {
    const auto found = std::ranges::find(displays, name, &Display::name);
    return found == displays.end() ? nullptr : &*found;
}

const Display* findUnder(const std::vector<Display>& displays, const Display& part) {
    const auto shows = [&](const Display& display) { return sharedPixels(display, part); };
    const auto best = std::ranges::max_element(displays, {}, shows);
    return best == displays.end() || shows(*best) == 0 ? nullptr : &*best;
}

Display partCoveredBy(GLFWwindow* window) {
    Display part;
    if (GLFWmonitor* monitor = glfwGetWindowMonitor(window)) part.name = glfwGetMonitorName(monitor);
    glfwGetWindowPos(window, &part.x, &part.y);
    glfwGetWindowSize(window, &part.width, &part.height);
    return part;
}

} // namespace heliodon::present
