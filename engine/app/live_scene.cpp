#include "engine/app/live_scene.h"

#include <algorithm>
#include <future>
#include <map>

#include <fmt/format.h>

#include "compute/gpu/error.h"
#include "engine/app/interrupt.h"
#include "engine/app/light_report.h"
#include "engine/app/projector_reach.h"
#include "geometry/input_error.h"

namespace heliodon::app {

namespace {

// A material of its own for each surface, so that a token changes numbers and not what they belong to.
void separateMaterials(geometry::PatchMesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> index;
    std::vector<geometry::Material> materials;
    for (size_t i = 0; i < mesh.patchCount(); ++i) {
        const auto [at, isNew] =
            index.try_emplace({mesh.surface[i], mesh.room[i]}, static_cast<uint32_t>(materials.size()));
        if (isNew) materials.push_back(mesh.materials[mesh.material[i]]);
        const bool same = materials[at->second].name == mesh.materials[mesh.material[i]].name;
        if (!same) return; // surfaces of several materials: as it was
    }
    for (size_t i = 0; i < mesh.patchCount(); ++i)
        mesh.material[i] = index.at({mesh.surface[i], mesh.room[i]});
    mesh.materials = std::move(materials);
}

bool sameGeometry(const Scene& a, const Scene& b) {
    const geometry::PatchMesh &m = a.mesh, &n = b.mesh;
    return m.vertices == n.vertices && m.corners == n.corners && m.firstCorner == n.firstCorner &&
           m.material == n.material && m.role == n.role && m.surface == n.surface && m.room == n.room &&
           m.twin == n.twin && m.materials.size() == n.materials.size() &&
           m.outside.vertices == n.outside.vertices && m.outside.triangles == n.outside.triangles &&
           m.outside.material == n.outside.material && a.occluders.vertices == b.occluders.vertices &&
           a.occluders.triangles == b.occluders.triangles;
}

bool sameMaterials(const Scene& a, const Scene& b) {
    return std::equal(a.mesh.materials.begin(), a.mesh.materials.end(), b.mesh.materials.begin(),
                      [](const geometry::Material& m, const geometry::Material& n) {
                          return m.reflectance == n.reflectance && m.transmittance == n.transmittance &&
                                 m.refractiveIndex == n.refractiveIndex && m.exitance == n.exitance &&
                                 m.blind == n.blind;
                      });
}

} // namespace

std::optional<size_t> DeviceSlots::acquire() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || !taken_[0] || !taken_[1]; });
    if (closed_) return std::nullopt;
    const size_t slot = taken_[0] ? 1 : 0;
    taken_[slot] = true;
    const bool spoilt = std::exchange(spoiltNow_[slot], false);
    lock.unlock();
    try {
        if (spoilt) devices_[slot].reset();
        if (!devices_[slot])
            devices_[slot] = run_.anotherDevice([this](gpu::DeviceOptions options) {
                options.beforeSubmit = [this] {
                    throwIfInterrupted();
                    if (closed_) throw Interrupted(); // what is being worked out is not wanted any more
                };
                return options;
            });
    } catch (...) {
        release(slot);
        throw;
    }
    return slot;
}

void DeviceSlots::release(size_t slot) {
    const std::lock_guard lock(mutex_);
    taken_[slot] = false;
    changed_.notify_all();
}

void DeviceSlots::spoil(size_t slot) {
    const std::lock_guard lock(mutex_);
    spoiltNow_[slot] = true;
    ++spoilt_;
}

void DeviceSlots::close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
}

gpu::Device& DeviceSlots::device(size_t slot) {
    return *devices_[slot];
}

LiveSceneMaker::LiveSceneMaker(const SceneArguments& arguments, const geometry::Rig& rig, DeviceSlots& slots,
                               LiveBoard& board, Latest<SeenTable>& in,
                               std::function<void(SceneChange)> deliver)
    : arguments_(arguments), rig_(rig), slots_(slots), board_(board), in_(in), deliver_(std::move(deliver)),
      thread_([this] { run(); }) {}

LiveSceneMaker::~LiveSceneMaker() {
    in_.close();
    slots_.close();
    thread_.join();
}

void LiveSceneMaker::run() {
    const auto refuse = [this](const std::string& why) {
        board_.update([&](LiveStatus& status) {
            status.refuse(&LiveStatus::refused, why);
            status.working.clear();
        });
    };
    while (const std::optional<SeenTable> seen = in_.take()) {
        try {
            makeOrTryAgain(*seen);
        } catch (const geometry::InputError& error) {
            refuse(error.what());
        } catch (const Interrupted&) {
            return;
        } catch (const std::bad_alloc&) {
            refuse("the sketch needs more memory than there is");
        } catch (const std::exception& error) {
            refuse(error.what());
        }
        board_.end();
    }
}

// A device that is lost is made again: at once, and after a moment, as a driver that has just been reset may
// need it. What it is lost over every time is refused like any other sketch.
void LiveSceneMaker::makeOrTryAgain(const SeenTable& seen) {
    constexpr int kAttempts = 3;
    for (int attempt = 1;; ++attempt) {
        try {
            make(seen);
            return;
        } catch (const gpu::Error& error) {
            const bool full = error.code == VK_ERROR_OUT_OF_DEVICE_MEMORY;
            if (attempt == kAttempts || full) throw;
            board_.update([](LiveStatus& status) { ++status.deviceLosses; });
        }
        if (attempt > 1) std::this_thread::sleep_for(std::chrono::milliseconds(500));
    }
}

void LiveSceneMaker::sayDoing(const std::string& what) {
    board_.update([&](LiveStatus& status) { status.working = what; });
}

std::unique_ptr<SlottedTransport> LiveSceneMaker::transportOf(Run& run, const geometry::PatchMesh& mesh) {
    sayDoing("form factors");
    const std::optional<size_t> slot = slots_.acquire();
    if (!slot) return nullptr;
    auto transport = std::make_unique<SlottedTransport>(slots_, *slot);
    try {
        compute::TransportOptions options{.forPictures = true};
        options.formFactors.longWork = [this](double secondsLeft) {
            sayDoing(fmt::format("form factors, about {:.0f} s more", secondsLeft));
        };
        transport->transport = makeTransport(run, transport->device(), mesh, options);
    } catch (const gpu::Error&) {
        transport->spoil();
        throw;
    }
    return transport;
}

void LiveSceneMaker::make(const SeenTable& seen) {
    Run run(Arguments{"live", {.quiet = true}, {}}); // its report only: warnings and stages of this sketch
    auto made = std::make_shared<LiveScene>();
    made->taken = seen.taken;
    sayDoing("working out the rooms");
    SceneArguments arguments = arguments_;
    arguments.input = seen.picture; // named where the sketch is refused
    made->scene = makeScene(run, arguments, rig_, seen.sketch);
    Scene& scene = made->scene;
    separateMaterials(scene.mesh);
    SceneChange change;
    const size_t spoilt = slots_.spoilt();
    const bool anew = before_ && spoilt != spoiltBefore_; // what was made of it may be gone
    if (anew) before_.reset();
    const bool shape = before_ && sameGeometry(before_->scene, scene),
               paint = shape && sameMaterials(before_->scene, scene);
    made->again = anew;
    made->row = paint ? "north" : shape ? "materials" : "geometry";
    std::future<std::unique_ptr<passes::FrameScene>> frame;
    if (!paint)
        frame = std::async(std::launch::async, [&] {
            return std::make_unique<passes::FrameScene>(scene.mesh, scene.occluders, &rig_);
        });
    if (!shape) {
        change.transport = transportOf(run, scene.mesh);
        if (!change.transport) return;
    }
    if (frame.valid()) {
        sayDoing("what the projectors see");
        const StageTimer timer(run, "prepare"); // what is left of it
        change.frame = frame.get();
        reaching_ = reachingProjectors(change.frame->shown.blend.visible);
    }
    warnOfBlack(run, rig_, reaching_);
    made->report = run.report();
    if (shape) {
        nlohmann::json& formFactors = made->report["form_factors"];
        formFactors = before_->report.at("form_factors"); // those still in use
        if (!paint)
            for (const char* ofMaterials : {"channels", "sky_elements"}) formFactors.erase(ofMaterials);
    }
    change.scene = made;
    before_ = made;
    spoiltBefore_ = spoilt;
    board_.update([&](LiveStatus& status) {
        status.working.clear();
        status.refused.clear();
        status.scene = made->report;
        status.sketches += !anew;
        status.warnOfScene();
    });
    deliver_(std::move(change));
}

} // namespace heliodon::app
