#include "engine/app/live_table.h"

#include "compute/stopwatch.h"
#include "engine/app/scene_input.h"
#include "geometry/input_error.h"
#include "vision/detect.h"
#include "vision/steady_sketch.h"
#include "vision/table_watch.h"

namespace heliodon::app {

namespace {

constexpr std::chrono::milliseconds kLook(100);   // longest wait for a picture: how soon the thread can end
constexpr std::chrono::milliseconds kRetry(1000); // from one search for a lost camera to the next
constexpr double kBetweenDetections = 0.5;        // seconds, while the projectors' light keeps changing

} // namespace

// What is known of the table between pictures.
class LiveTable::Eye {
public:
    explicit Eye(LiveTable& table) : table_(table) {}

    void look(const vision::CameraPicture& picture, const vision::Camera& camera) {
        const bool continuous = camera.isContinuous();
        const bool again = picture.photo == photo_;
        photo_ = picture.photo;
        if (!again || !continuous)
            table_.board_.update([&](LiveStatus& status) {
                status.photo = picture.photo;
                ++status.pictures;
            });
        if (!continuous) {
            detect(picture);
            return;
        }
        watch_.lightChanged(LiveClock::time_point(LiveClock::duration(table_.lightChanged_)));
        using State = vision::TableWatch::State;
        const State state = watch_.look(*picture.photo, picture.taken);
        const bool flicker = watch_.lightIsChanging(picture.taken);
        const bool ended = camera.hasEnded() && state == State::same && !flicker;
        table_.board_.update([&](LiveStatus& status) {
            status.tableMoves = state == State::moving && !flicker;
            status.cameraEnded = ended;
        });
        if (state == State::changed) {
            watch_.worked();
            detect(picture);
        } else if (flicker && secondsSince(detected_) > kBetweenDetections) {
            // Pictures never hold still while the light plays; two detections that agree do.
            detectTwice(picture);
        }
    }

private:
    // `counts`: of a table that had changed, not of one that is looked at again under other light.
    std::optional<geometry::Sketch> sketchOf(const vision::CameraPicture& picture, bool counts) {
        const compute::Stopwatch watch;
        vision::DetectionResult found;
        try {
            refuseGrey(*picture.photo);
            found = vision::detectSketch(*picture.photo, table_.rig_);
        } catch (const geometry::InputError& error) {
            table_.board_.update([&](LiveStatus& status) {
                status.refuse(&LiveStatus::pictureRefused, error.what());
                status.looks += counts;
            });
            return std::nullopt;
        }
        detected_ = LiveClock::now();
        table_.board_.update([&](LiveStatus& status) {
            status.pictureRefused.clear();
            status.seen = found.sketch;
            status.detectWarnings = found.warnings;
            status.detectSeconds = watch.seconds();
            ++status.detections;
            status.looks += counts;
        });
        return std::move(found.sketch);
    }

    void detect(const vision::CameraPicture& picture) {
        table_.board_.begin(); // counted as looked at before what was seen is handed on
        if (const auto sketch = sketchOf(picture, true)) accept(*sketch, picture);
        table_.board_.end();
    }

    void detectTwice(const vision::CameraPicture& picture) {
        table_.board_.begin();
        if (const auto sketch = sketchOf(picture, false)) {
            const bool agrees = candidate_ && vision::steadied(*candidate_, *sketch).same();
            candidate_ = *sketch;
            if (agrees) accept(*sketch, picture);
        }
        table_.board_.end();
    }

    void accept(const geometry::Sketch& sketch, const vision::CameraPicture& picture) {
        candidate_.reset();
        vision::SteadySketch steady{sketch};
        if (before_) steady = vision::steadied(*before_, sketch);
        if (before_ && steady.same()) return;
        before_ = steady.sketch;
        table_.board_.begin();
        if (!table_.out_.put({steady.sketch, picture.photo->name, picture.taken}))
            table_.board_.end(); // one takes the other's place
    }

    LiveTable& table_;
    vision::TableWatch watch_;
    std::shared_ptr<const vision::Photograph> photo_;
    std::optional<geometry::Sketch> before_, candidate_; // handed on last; waiting for one that agrees
    LiveClock::time_point detected_{};
};

LiveTable::LiveTable(const geometry::Rig& rig, const std::string& source,
                     const vision::CameraOptions& options, LiveBoard& board, Latest<SeenTable>& out)
    : rig_(rig), source_(source), options_(options), board_(board), out_(out) {
    try {
        camera_ = vision::openCamera(source_, options_);
    } catch (const vision::CameraLost& lost) {
        board_.update([&](LiveStatus& status) {
            status.describeCamera(std::string(lost.what()) + "; trying again", true);
        });
    }
    board_.begin(); // the first picture
    thread_ = std::thread([this] { run(); });
}

LiveTable::~LiveTable() {
    stop_ = true;
    thread_.join();
}

// One that was there at the start will be so again.
void LiveTable::openAgain() {
    try {
        camera_ = vision::openCamera(source_, options_);
    } catch (const geometry::InputError& error) {
        throw vision::CameraLost(error.what());
    }
}

void LiveTable::run() {
    Eye eye(*this);
    bool first = true;
    const auto arrived = [&] {
        if (first) board_.end();
        first = false;
    };
    while (!stop_) {
        try {
            if (!camera_) openAgain();
            const auto picture = camera_->next(kLook);
            board_.update([&](LiveStatus& status) { status.describeCamera(camera_->description(), false); });
            if (picture) {
                eye.look(*picture, *camera_);
                if (first && (!camera_->isContinuous() || board_.looks() > 0)) arrived();
            }
        } catch (const vision::CameraLost& lost) {
            camera_.reset();
            board_.update([&](LiveStatus& status) {
                status.cameraLosses += !status.cameraFails;
                status.describeCamera(std::string(lost.what()) + "; trying again", true);
            });
            arrived();
            for (auto waited = kRetry * 0; waited < kRetry && !stop_; waited += kLook)
                std::this_thread::sleep_for(kLook);
        } catch (const geometry::InputError& error) { // a picture that cannot be read; the next one may be
            board_.update([&](LiveStatus& status) {
                status.refuse(&LiveStatus::pictureRefused, error.what());
                ++status.looks;
                status.cameraEnded = camera_ && camera_->hasEnded();
            });
            arrived();
            std::this_thread::sleep_for(kLook);
        } catch (...) {
            board_.fail(std::current_exception());
            arrived();
            return;
        }
    }
}

} // namespace heliodon::app
