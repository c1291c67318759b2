// _NET_WM_FULLSCREEN_MONITORS of the Extended Window Manager Hints, 1.5 (freedesktop.org, 2011).
#include "engine/present/window_manager.h"

#include <dlfcn.h>

#include <algorithm>

namespace heliodon::present {

namespace {

using Connection = void*;
using Id = unsigned long;

// XineramaScreenInfo, of <X11/extensions/Xinerama.h>.
struct Screen {
    int number;
    short x, y, width, height;
};

// XClientMessageEvent, of <X11/Xlib.h>, and the rest of an XEvent.
struct Message {
    int type;
    unsigned long serial;
    int sentByProgram;
    Connection connection;
    Id window, kind;
    int format;
    long data[5];
    long rest[12];
};

// Functions are looked up, see display_server.cpp.
template<class F> F* find(const char* name, void* library = RTLD_DEFAULT) {
    return reinterpret_cast<F*>(dlsym(library, name));
}

// Its number among the screens; -1 where it is none of them.
long numberOf(const Display& display, Connection connection) {
    static void* const library = dlopen("libXinerama.so.1", RTLD_LAZY | RTLD_LOCAL);
    const auto query = library ? find<Screen*(Connection, int*)>("XineramaQueryScreens", library) : nullptr;
    if (!query) return -1;
    int count = 0;
    Screen* const screens = query(connection, &count);
    const Screen* const end = screens + count;
    const Screen* const at = std::find_if(static_cast<const Screen*>(screens), end, [&](const Screen& s) {
        return s.x == display.x && s.y == display.y && s.width == display.width && s.height == display.height;
    });
    const long number = at == end ? -1 : at - screens;
    if (screens) find<int(void*)>("XFree")(screens);
    return number;
}

} // namespace

void askToFill(GLFWwindow* window, const Display& display) {
    const auto connectionOf = find<Connection()>("glfwGetX11Display");
    const auto windowOf = find<Id(GLFWwindow*)>("glfwGetX11Window");
    const auto atom = find<Id(Connection, const char*, int)>("XInternAtom");
    const auto root = find<Id(Connection)>("XDefaultRootWindow");
    const auto send = find<int(Connection, Id, int, long, void*)>("XSendEvent");
    const Connection connection = connectionOf ? connectionOf() : nullptr;
    if (!connection || !windowOf || !atom || !root || !send) return;
    const long number = numberOf(display, connection);
    if (number < 0) return;
    constexpr int kClientMessage = 33;
    constexpr long kToManagers = (1L << 19) | (1L << 20); // SubstructureNotifyMask, SubstructureRedirectMask
    Message message{kClientMessage,
                    0,
                    1,
                    connection,
                    windowOf(window),
                    atom(connection, "_NET_WM_FULLSCREEN_MONITORS", 0),
                    32,
                    {number, number, number, number, 1 /* an application asks */},
                    {}};
    send(connection, root(connection), 0, kToManagers, &message);
}

} // namespace heliodon::present
