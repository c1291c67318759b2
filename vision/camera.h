// Where pictures of the table come from: a GenICam camera, a folder that is played back, a file.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "vision/photograph.h"

namespace heliodon::vision {

struct CameraPicture {
    std::shared_ptr<const Photograph> photo; // the same object as before: the same picture
    std::chrono::steady_clock::time_point taken;
};

// It does not answer, or there is none; it may come back: open it again.
class CameraLost : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

class Camera {
public:
    virtual ~Camera() = default;
    Camera() = default;
    Camera(const Camera&) = delete;
    Camera& operator=(const Camera&) = delete;

    // The newest picture that was not handed out yet; waits for one, at most so long. None: there was none.
    // Throws CameraLost, and InputError for a file that is no picture.
    virtual std::optional<CameraPicture> next(std::chrono::milliseconds longest) = 0;
    // Pictures come all the time, with hands over the table in some of them. Otherwise each picture is meant.
    virtual bool isContinuous() const = 0;
    // Every picture from now on is the last one again.
    virtual bool hasEnded() const { return false; }
    virtual std::string description() const = 0;
};

struct CameraOptions {
    int width = 0, height = 0;   // pixels, of the calibrated camera: what is read out of a larger sensor
    double intervalSeconds = 1;  // from one picture of a folder to the next
    bool loop = false;           // a folder starts again after its last picture
    double refreshSeconds = 0.1; // from one look at a file, or at a picture of a folder, to the next
};

// `aravis:ID` (vendor-serial, address, or nothing for the first camera found), `replay:FOLDER` (its pictures
// by name) or `file:PHOTO` (read again when it changes). Throws InputError where the words can never lead to
// a picture, CameraLost where there is no such camera at present.
std::unique_ptr<Camera> openCamera(const std::string& source, const CameraOptions& options);

// Throws what openCamera throws of words that name no kind of camera; looks at no file and no device.
void refuseNoCamera(const std::string& source);

} // namespace heliodon::vision
