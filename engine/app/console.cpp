#include "engine/app/console.h"

#include <cstdio>
#include <stdexcept>

#include <fcntl.h>
#include <unistd.h>

namespace heliodon::app {

void keepStandardStreams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(stream, F_GETFD) < 0)
            // The lowest free number is this one. Results that cannot go to the output are an error.
            (void)::open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);
}

void say(std::string_view text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

void refuseLostOutput() {
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
        throw std::runtime_error("the standard output could not be written to");
}

} // namespace heliodon::app
