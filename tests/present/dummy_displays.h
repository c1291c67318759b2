// A display server with four displays and more, for tests: Xorg on its dummy driver.
#pragma once

#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace heliodon::test {

// Sets $DISPLAY while it runs. It takes the rights to open a console, as root has.
class DummyDisplays {
public:
    DummyDisplays() {
        std::filesystem::create_directories(folder_);
        std::ofstream(folder_ / "config") << R"(
Section "ServerFlags"
  Option "AutoAddDevices" "false"
  Option "AutoAddGPU" "false"
EndSection
Section "Device"
  Identifier "dummy"
  Driver "dummy"
  VideoRam 65536
EndSection
Section "Monitor"
  Identifier "monitor"
  HorizSync 5-1000
  VertRefresh 5-200
EndSection
Section "Screen"
  Identifier "screen"
  Device "dummy"
  Monitor "monitor"
  DefaultDepth 24
  SubSection "Display"
    Virtual 4096 2048
  EndSubSection
EndSection
)";
        int ends[2];
        if (pipe(ends) != 0) return;
        server_ = fork();
        if (server_ == 0) {
            close(ends[0]);
            const std::string number = std::to_string(ends[1]), config = folder_ / "config",
                              log = folder_ / "log";
            if (!std::freopen((folder_ / "said").c_str(), "w", stderr)) _exit(127);
            execlp("Xorg", "Xorg", "-displayfd", number.c_str(), "-config", config.c_str(), "-logfile",
                   log.c_str(), "-noreset", "-novtswitch", "-sharevts", "-nolisten", "tcp",
                   static_cast<char*>(nullptr));
            _exit(127);
        }
        close(ends[1]);
        std::string answer;
        char letter = 0;
        pollfd wait{ends[0], POLLIN, 0};
        while (poll(&wait, 1, 20000) > 0 && read(ends[0], &letter, 1) == 1 && letter != '\n')
            answer += letter;
        close(ends[0]);
        if (answer.empty()) return;
        if (const char* display = std::getenv("DISPLAY")) before_ = display;
        setenv("DISPLAY", (":" + answer).c_str(), 1);
        running_ = true;
    }
    ~DummyDisplays() {
        end(manager_);
        end(server_);
        if (running_ && before_.empty()) unsetenv("DISPLAY");
        if (running_ && !before_.empty()) setenv("DISPLAY", before_.c_str(), 1);
        std::filesystem::remove_all(folder_);
    }
    bool running() const { return running_; }
    // Empty where it runs.
    std::string whyNot() const {
        if (running_) return "";
        std::string last, line;
        for (std::ifstream said(folder_ / "said"); std::getline(said, line);)
            if (line.find_first_not_of(" \t") != std::string::npos) last += line + "; ";
        return "Xorg with the driver dummy cannot be started here: " + last;
    }

    // What `xrandr` is told; asked again, it notices what is connected. Of outputs other than the first,
    // modes are to be added once.
    bool arrange(const std::string& options) { return run("xrandr " + options + "; xrandr > /dev/null"); }
    bool addMode(const std::string& output, const std::string& mode) {
        return run("xrandr --addmode " + output + " " + mode);
    }
    // Openbox; false where it cannot be started.
    bool startWindowManager() {
        manager_ = fork();
        if (manager_ == 0) {
            if (!std::freopen("/dev/null", "w", stderr)) _exit(127);
            execlp("openbox", "openbox", "--sm-disable", static_cast<char*>(nullptr));
            _exit(127);
        }
        for (int i = 0; i < 200; ++i) {
            if (run("xprop -root -notype _NET_SUPPORTING_WM_CHECK | grep -q 0x")) return true;
            if (waitpid(manager_, nullptr, WNOHANG) == manager_) break;
            usleep(20000);
        }
        manager_ = 0;
        return false;
    }
    void kill() { end(server_, SIGKILL); }

private:
    static bool run(const std::string& command) { return std::system(command.c_str()) == 0; }
    static void end(pid_t& child, int signal = SIGTERM) {
        if (child <= 0) return;
        ::kill(child, signal);
        waitpid(child, nullptr, 0);
        child = 0;
    }
    std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("heliodon-displays-" + std::to_string(getpid()));
    std::string before_;
    pid_t server_ = 0, manager_ = 0;
    bool running_ = false;
};

} // namespace heliodon::test
