#include "engine/present/display_server.h"

#include <dlfcn.h>

#include <atomic>
#include <stdexcept>
#include <string>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace heliodon::present {

namespace {

std::atomic<bool> lost = false; // set by whichever thread meets the broken connection

std::atomic<unsigned> refused = 0;

// XErrorEvent, of <X11/Xlib.h>.
struct Refusal {
    int type;
    void* connection;
    unsigned long resource, serial;
    unsigned char code, request, minor;
};
using OnRefusal = int (*)(void*, Refusal*);
OnRefusal usual = nullptr;

// A window that has been destroyed is no reason to end the program; for others Xlib does.
int noteRefusal(void* connection, Refusal* refusal) {
    constexpr unsigned char kBadWindow = 3, kBadDrawable = 9; // codes
    constexpr unsigned char kGetWindowAttributes = 3;         // a request whose caller waits for the answer
    if (refusal->code != kBadWindow && refusal->code != kBadDrawable) return usual(connection, refusal);
    if (refusal->request == kGetWindowAttributes) ++refused;
    return 0;
}

// Xlib would end the program on the spot. Its functions are looked up: GLFW may have been built for another
// window system, and Xlib before 1.7 has no such handler.
void surviveBrokenConnection() {
    using Connection = void*;
    const auto find = [](const char* name) { return dlsym(RTLD_DEFAULT, name); };
    const auto connection = reinterpret_cast<Connection (*)()>(find("glfwGetX11Display"));
    const auto onError = reinterpret_cast<void* (*)(int (*)(Connection))>(find("XSetIOErrorHandler"));
    const auto onExit = reinterpret_cast<void (*)(Connection, void (*)(Connection, void*), void*)>(
        find("XSetIOErrorExitHandler"));
    if (const auto onRefusal = reinterpret_cast<OnRefusal (*)(OnRefusal)>(find("XSetErrorHandler")))
        usual = onRefusal(noteRefusal);
    if (!connection || !onError || !onExit) return;
    onError([](Connection) { return 0; }); // says nothing: checkDisplayServer() does
    onExit(
        connection(), [](Connection, void*) { lost = true; }, nullptr);
}

} // namespace

void openWindowSystem() {
    static const bool open = [] {
        if (glfwInit() != GLFW_TRUE) return false;
        surviveBrokenConnection();
        return true;
    }();
    checkDisplayServer();
    if (open) return;
    const char* why = nullptr;
    glfwGetError(&why);
    throw std::runtime_error(std::string("no display can be opened for windows: ") +
                             (why ? why : "no reason given"));
}

void checkDisplayServer() {
    if (lost) throw std::runtime_error("the connection to the display server has broken");
}

unsigned sizesRefused() {
    return refused;
}

bool displayServerLost() {
    return lost;
}

} // namespace heliodon::present
