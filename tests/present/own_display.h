// A display for tests that open windows.
#pragma once

#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace heliodon::test {

// The display server of $DISPLAY, else an Xvfb that lives as long as this object.
class OwnDisplay {
public:
    OwnDisplay() {
        if (std::getenv("DISPLAY")) return;
        int ends[2];
        if (pipe(ends) != 0) return;
        child_ = fork();
        if (child_ == 0) {
            close(ends[0]);
            const std::string number = std::to_string(ends[1]);
            // A server that begins anew when its last client leaves refuses the next one meanwhile.
            execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", "2100x1600x24", "-noreset",
                   "-nolisten", "tcp", static_cast<char*>(nullptr));
            _exit(127);
        }
        close(ends[1]);
        std::string answer; // the number of the display, once it is ready
        char letter = 0;
        pollfd wait{ends[0], POLLIN, 0};
        while (poll(&wait, 1, 20000) > 0 && read(ends[0], &letter, 1) == 1 && letter != '\n')
            answer += letter;
        close(ends[0]);
        if (!answer.empty()) setenv("DISPLAY", (":" + answer).c_str(), 1);
    }
    ~OwnDisplay() {
        if (child_ <= 0) return;
        kill(child_, SIGTERM);
        waitpid(child_, nullptr, 0);
    }

private:
    pid_t child_ = 0;
};

} // namespace heliodon::test
