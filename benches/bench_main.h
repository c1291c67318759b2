// What the main of every bench does about arguments that lack and input that cannot be read: says so, exit
// code 2.
#pragma once

#include <cstdio>
#include <exception>

namespace heliodon {

// `run(argc, argv)` with at least `least` arguments, of which `usage` tells; lines are written as they end.
template<class Run> int benchMain(int argc, char** argv, int least, const char* usage, Run run) {
    if (argc <= least) {
        std::fprintf(stderr, "usage: %s\n", usage);
        return 2;
    }
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    try {
        run(argc, argv);
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "error: %s\n", e.what());
        return 2;
    }
}

} // namespace heliodon
