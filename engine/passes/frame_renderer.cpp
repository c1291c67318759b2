#include "engine/passes/frame_renderer.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include <glm/geometric.hpp>

#include "compute/gpu/commands.h"
#include "compute/gpu/device.h"
#include "engine/passes/device_blend.h"
#include "engine/passes/device_mesh.h"
#include "engine/passes/display_pass.h"
#include "engine/passes/draw_mesh.h"
#include "engine/passes/false_colour.h"
#include "engine/passes/frame_light.h"
#include "engine/passes/frame_output.h"
#include "engine/passes/glow_grids.h"
#include "engine/passes/scene_pass.h"
#include "engine/passes/sun_reach.h"
#include "engine/passes/vertex_light.h"

namespace heliodon::passes {

namespace {

// What a physical wall may stand proud of the surface that was inferred from it, metres: coplanar surfaces of
// the model win over the solids by this much.
constexpr float kPushBack = 0.003f;

// Black columns added at the right.
Image8 widened(const Image8& picture, int columns) {
    Image8 wide{picture.width + columns, picture.height, {}};
    wide.rgb.resize(3 * static_cast<size_t>(wide.width) * static_cast<size_t>(wide.height));
    for (int y = 0; y < picture.height; ++y)
        std::copy_n(picture.pixel(0, y), 3 * picture.width, wide.pixel(0, y));
    return wide;
}

std::vector<uint32_t> allCorners(const DrawMesh& mesh) {
    std::vector<uint32_t> corners(mesh.corners.size());
    std::iota(corners.begin(), corners.end(), 0u);
    return corners;
}

// Of the scene picture, where these corners' triangles are.
std::vector<PixelRect> sunlitParts(const DrawMesh& mesh, std::span<const uint32_t> corners,
                                   const View& view) {
    constexpr int kTile = 64; // as software devices take them
    return placesOf(view, mesh.positions(corners), kTile, 1);
}

// What a picture is drawn from.
enum class Quantity { exitance, illuminance, picture }; // picture: exitance, and openings as bright panes

Quantity quantityOf(const Tone& tone) {
    return tone.map == ToneMap::falseColour ? Quantity::illuminance : Quantity::picture;
}

uint32_t toneConstant(ToneMap map) {
    return map == ToneMap::soft          ? io::kToneSoft
           : map == ToneMap::falseColour ? io::kToneFalseColour
                                         : io::kToneLinear;
}

// What becomes of one drawing of the scene.
enum class Coding { bytes, floats, both };

// sRGB panels are written through the attachment; others by their gamma.
float gammaOf(const geometry::Projector& projector) {
    return projector.response == "srgb" ? 0.0f : std::stof(projector.response);
}

// One geometry on the device.
struct Model {
    Model(gpu::Device& d, FrameScene s)
        : scene(std::move(s)), all(d, scene.all, "preview mesh"), shown(d, scene.shown.mesh, "shown mesh"),
          blend(d, scene.shown.blend, scene.rig), solids(d, scene.solids, "solids"),
          tops(d, scene.tops, "wall tops"), sides(d, scene.sides, "wall sides"),
          table(d, scene.table, "table"), sunTriangles("sun triangles"), volumes("shadow volumes"),
          paneData("panes"), paneEdges("pane edges"), glowCorners("glow"), glowPlaces("glow places"),
          glowGrids("glow grids") {}

    FrameScene scene;
    DeviceMesh all, shown;
    DeviceBlend blend;
    Solid solids, tops, sides, table;
    FrameBuffer sunTriangles, volumes, paneData, paneEdges, glowCorners, glowPlaces, glowGrids;
    std::vector<FrameOutput> outputs; // per projector
    int outputsSupersample = 0;
    std::optional<FrameOutput> previewOutput;
};

} // namespace

struct Sunlight {
    SunDraw draw;
    std::vector<uint32_t> corners; // of the triangles that it may reach
};

// Of one frame, what is added to the light between vertices.
struct AddedLight {
    std::optional<GlowDraw> glow;
    std::optional<Sunlight> sun;
};

struct FrameRenderer::State {
    State(gpu::Device& d, FrameScene scene)
        : device(&d), scenePass(d), displayPass(d), model(std::make_unique<Model>(d, std::move(scene))) {}

    // Uploads what changes with the light.
    AddedLight prepareLight(DeviceMesh& target, const compute::Lighting& light, Quantity quantity,
                            float scale = 1e-3f);
    std::optional<GlowDraw> prepareGlow(const DrawMesh& mesh, const compute::Lighting& light,
                                        const std::vector<glm::vec3>& perLux, float scale);
    std::optional<Sunlight> prepareSun(const DrawMesh& mesh, const compute::Lighting& light, float scale);
    void leaveOutScatter(const compute::Lighting& light, std::vector<glm::vec3>& perVertex) const;
    io::DisplayParams displayParams(const compute::Lighting& light, const Tone& tone) const;
    SceneInputs projectorInputs(size_t i, const AddedLight& added, bool illuminance) const;
    SceneInputs previewInputs(const View& view, const AddedLight& added, Quantity quantity) const;
    void makeOutputs(int supersample);
    void drawGains();
    gpu::Commands recordProjectors(const compute::Lighting& light, const ProjectorOptions& options,
                                   Coding coding, bool readBack);
    std::vector<Image8> bytes() const; // of projectors, read back
    std::vector<ImageF> floats() const;
    FrameOutput& drawView(const compute::Lighting& light, View view, const Tone& tone, bool hdr);
    View previewView(const PreviewOptions& o) const;

    gpu::Device* device;
    ScenePass scenePass;
    DisplayPass displayPass;
    std::unique_ptr<Model> model; // on the heap: it is replaced as a whole
    uint64_t drawing = 0;         // ticket of a draw that was not waited for
};

AddedLight FrameRenderer::State::prepareLight(DeviceMesh& target, const compute::Lighting& light,
                                              Quantity quantity, float scale) {
    const FrameScene& scene = model->scene;
    device->wait(drawing); // it reads what is written here
    std::vector<glm::vec3> perPatch = quantity == Quantity::picture ? pictureLight(scene.mesh, light)
                                      : quantity == Quantity::illuminance
                                          ? indirectIlluminance(scene.mesh, light)
                                          : indirectExitance(scene.mesh, light);
    std::vector<glm::vec3> perLux(perPatch.size(), glm::vec3(1));
    if (quantity != Quantity::illuminance)
        for (size_t p = 0; p < perLux.size(); ++p)
            perLux[p] = scene.mesh.materials[scene.mesh.material[p]].reflectance;
    const compute::LightDetail& detail = light.detail;
    for (size_t p = 0; p < detail.mean.size(); ++p)
        perPatch[p] = glm::max(perPatch[p] - perLux[p] * detail.mean[p], glm::vec3(0));
    std::vector<glm::vec3> perVertex = scene.vertexLight.evaluate(perPatch);
    if (!detail.corners.empty()) scene.vertexLight.addCorners(perLux, detail.corners, perVertex);
    if (quantity == Quantity::illuminance)
        markOpenings(scene, perVertex);
    else if (&target == &model->shown)
        leaveOutScatter(light, perVertex);
    target.mixLight(*device, perVertex, scale);
    return {prepareGlow(target.mesh, light, perLux, scale), prepareSun(target.mesh, light, scale)};
}

std::optional<GlowDraw> FrameRenderer::State::prepareGlow(const DrawMesh& mesh,
                                                          const compute::Lighting& light,
                                                          const std::vector<glm::vec3>& perLux, float scale) {
    if (light.detail.grids.empty()) return std::nullopt;
    const GlowGrids glow(model->scene.mesh, model->scene.vertexLight, light.detail.grids, perLux);
    std::vector<glm::vec3> grids;
    std::vector<DrawCorner> corners;
    std::vector<glm::vec3> places;
    for (size_t t = 0; t < mesh.patch.size(); ++t) {
        const auto on = glow.on(mesh, t);
        if (!on) continue;
        const auto number = static_cast<float>(grids.size() / on->light.size());
        for (const glm::vec3& value : on->light) grids.push_back(scale * value);
        for (size_t k = 0; k < 3; ++k) {
            corners.push_back(mesh.corners[3 * t + k]);
            places.emplace_back(on->at[k], number);
        }
    }
    if (corners.empty()) return std::nullopt;
    return GlowDraw{{&model->glowCorners.write(*device, corners), &model->glowPlaces.write(*device, places)},
                    static_cast<uint32_t>(corners.size()),
                    &model->glowGrids.write(*device, grids)};
}

std::optional<Sunlight> FrameRenderer::State::prepareSun(const DrawMesh& mesh, const compute::Lighting& light,
                                                         float scale) {
    const FrameScene& scene = model->scene;
    const bool sunny = glm::length(light.sunDirection) > 0.5 && scene.panes.size() > 0 &&
                       glm::dot(light.sunNormalIlluminance, glm::vec3(1)) > 0;
    if (!sunny) return std::nullopt;
    const glm::dvec3 towardsSun = glm::normalize(light.sunDirection);
    SunReach reach = sunReach(scene.mesh, mesh, towardsSun, scene.panes.closed());
    if (reach.corners.empty()) return std::nullopt;
    const ShadowCasters::Volumes swept = scene.casters.volumes(towardsSun, reach.plane);
    const SunPaneData data = scene.panes.seenFromSun(towardsSun);
    SunDraw sun;
    sun.triangles = {&model->sunTriangles.write(*device, reach.corners),
                     static_cast<uint32_t>(reach.corners.size())};
    sun.towardsSun = towardsSun;
    sun.kilolux = scale * light.sunNormalIlluminance;
    sun.volumes = &model->volumes.write(*device, swept.corners);
    sun.volumeCount = static_cast<uint32_t>(swept.corners.size());
    sun.capCount = swept.capCorners;
    sun.panes = &model->paneData.write(*device, data.panes);
    sun.paneEdges = &model->paneEdges.write(*device, data.edges);
    return Sunlight{sun, std::move(reach.corners)};
}

// What is left may be negative, until glow and sun are added to it.
void FrameRenderer::State::leaveOutScatter(const compute::Lighting& light,
                                           std::vector<glm::vec3>& perVertex) const {
    if (light.ownScatter.empty()) return;
    const std::vector<glm::vec3> scatter = model->scene.vertexLight.evaluate(light.ownScatter);
    for (size_t i = 0; i < scatter.size(); ++i) perVertex[i] -= scatter[i];
}

io::DisplayParams FrameRenderer::State::displayParams(const compute::Lighting& light,
                                                      const Tone& tone) const {
    io::DisplayParams params{};
    const double white = tone.whiteLux ? *tone.whiteLux : passes::autoWhite(model->scene.mesh, light);
    params.white = static_cast<float>(1e-3 * white);
    params.fullScale = 1;
    if (tone.map != ToneMap::falseColour) return params;
    const FalseScale scale = falseScale(tone, passes::shownLux(model->scene.mesh, light));
    params.falseLow = static_cast<float>(std::log10(scale.lowLux));
    params.falseHigh = static_cast<float>(std::log10(scale.highLux));
    return params;
}

SceneInputs FrameRenderer::State::projectorInputs(size_t i, const AddedLight& added, bool illuminance) const {
    SceneInputs inputs;
    inputs.view = &model->outputs[i].view;
    inputs.surfaces = model->shown.streams(illuminance); // what solids hide has no gain
    inputs.triangles = model->outputs[i].triangles();
    inputs.glow = added.glow;
    if (added.sun) {
        std::vector<uint32_t> seen;
        std::ranges::copy_if(added.sun->corners, std::back_inserter(seen),
                             [&](uint32_t corner) { return model->scene.shown.blend.sees(i, corner / 3); });
        inputs.sun = added.sun->draw;
        inputs.sunlit = sunlitParts(model->shown.mesh, seen, *inputs.view);
    }
    inputs.keepGain = true;
    return inputs;
}

void FrameRenderer::State::makeOutputs(int supersample) {
    if (model->outputsSupersample == supersample) return;
    model->outputs.clear();
    std::vector<View> views =
        supersample == kProjectorSupersample ? model->scene.views : model->scene.projectorViews(supersample);
    for (size_t i = 0; i < views.size(); ++i)
        model->outputs.emplace_back(*device, std::move(views[i]), model->scene.shown.cornersSeenBy(i),
                                    "projector " + model->scene.rig.projectors[i].id);
    if (!views.empty()) drawGains();
    model->outputsSupersample = supersample;
}

// And what is taken off for leaks: the picture of these as light.
void FrameRenderer::State::drawGains() {
    const bool leaks = std::ranges::any_of(model->scene.rig.projectors,
                                           [](const geometry::Projector& p) { return p.blackLevel > 0; });
    gpu::Commands commands(*device);
    for (size_t i = 0; i < model->outputs.size(); ++i) {
        FrameOutput& output = model->outputs[i];
        GainInputs inputs;
        inputs.view = &output.view;
        inputs.corners = &model->shown.corners;
        inputs.count = static_cast<uint32_t>(model->shown.mesh.corners.size());
        inputs.solids = {&model->solids.corners, model->solids.count, glm::vec4(0), 0, kPushBack, false};
        inputs.blend = &model->blend;
        inputs.params.shownReflectance = static_cast<float>(model->scene.rig.surfaceReflectance);
        inputs.params.guard = static_cast<float>(geometry::kBlendGuard);
        inputs.params.falloff = static_cast<float>(geometry::kBlendFalloff);
        inputs.params.leastSlope = static_cast<float>(geometry::kBlendLeastSlope);
        inputs.params.leastFade = static_cast<float>(geometry::kBlendLeastFade);
        inputs.params.endFade = static_cast<float>(geometry::kBlendEndFade);
        inputs.params.leastCosine = static_cast<float>(geometry::kBlendLeastCosine);
        inputs.params.projector = static_cast<uint32_t>(i);
        inputs.params.projectorCount = static_cast<uint32_t>(model->outputs.size());
        scenePass.recordGain(commands, output.scene, inputs);
        if (!leaks) continue;
        io::DisplayParams params{};
        params.white = 1;
        params.fullScale = static_cast<float>(1 / model->scene.shown.blend.candela[i]);
        params.outputWidth = static_cast<uint32_t>(output.view.outputWidth);
        displayPass.record(commands, output.scene.colour, output.warp, output.view,
                           output.target(*device, DisplayTarget::Kind::float32), io::kToneRaw, params);
    }
    device->submitAndWait(std::move(commands));
    if (!leaks) return;
    for (FrameOutput& output : model->outputs) output.setLeaks(*device, output.floats());
}

gpu::Commands FrameRenderer::State::recordProjectors(const compute::Lighting& light,
                                                     const ProjectorOptions& o, Coding coding,
                                                     bool readBack) {
    makeOutputs(o.supersample);
    const FrameScene& scene = model->scene;
    const Quantity quantity = coding == Coding::floats ? Quantity::picture : quantityOf(o.tone);
    const bool illuminance = quantity == Quantity::illuminance;
    const AddedLight added = prepareLight(model->shown, light, quantity);
    io::DisplayParams params = displayParams(light, o.tone);
    gpu::Commands commands(*device);
    for (size_t i = 0; i < model->outputs.size(); ++i) {
        const geometry::Projector& projector = scene.rig.projectors[i];
        FrameOutput& output = model->outputs[i];
        params.fullScale = static_cast<float>(scene.painted.white / scene.shown.blend.candela[i]);
        params.blackLevel = static_cast<float>(projector.blackLevel);
        params.outputWidth = static_cast<uint32_t>(projector.width);
        scenePass.record(commands, output.scene, projectorInputs(i, added, illuminance));
        const auto code = [&](DisplayTarget::Kind kind, float gamma, uint32_t tone) {
            params.gamma = gamma;
            displayPass.record(commands, output.scene.colour, output.warp, output.view,
                               output.target(*device, kind), tone, params, readBack);
        };
        const float gamma = gammaOf(projector);
        if (coding != Coding::floats)
            code(gamma > 0 ? DisplayTarget::Kind::unorm8 : DisplayTarget::Kind::srgb8, gamma,
                 toneConstant(o.tone.map));
        if (coding != Coding::bytes) code(DisplayTarget::Kind::float32, 0, io::kToneRaw);
    }
    return commands;
}

std::vector<Image8> FrameRenderer::State::bytes() const {
    std::vector<Image8> pictures;
    for (const FrameOutput& output : model->outputs) pictures.push_back(output.bytes());
    return pictures;
}

std::vector<ImageF> FrameRenderer::State::floats() const {
    std::vector<ImageF> pictures;
    for (const FrameOutput& output : model->outputs) pictures.push_back(output.floats());
    return pictures;
}

SceneInputs FrameRenderer::State::previewInputs(const View& view, const AddedLight& added,
                                                Quantity quantity) const {
    SceneInputs inputs;
    inputs.view = &view;
    inputs.surfaces = model->all.streams(quantity == Quantity::illuminance);
    inputs.triangles = model->previewOutput->triangles();
    inputs.glow = added.glow;
    if (added.sun) {
        inputs.sun = added.sun->draw;
        inputs.sunlit = sunlitParts(model->all.mesh, added.sun->corners, view);
    }
    if (quantity == Quantity::exitance) return inputs; // nothing but what is simulated
    // Display colours; alpha 2 marks what is not simulated.
    inputs.background = {0.62f, 0.64f, 0.67f, 2};
    inputs.solids.push_back(
        {&model->table.corners, model->table.count, {0.46f, 0.45f, 0.44f, 2}, 0, 0, false});
    if (quantity == Quantity::illuminance) { // a see-through wall would falsify what is read off
        inputs.solids.push_back(
            {&model->tops.corners, model->tops.count, {0.78f, 0.77f, 0.75f, 2}, 0, kPushBack, false});
        return inputs;
    }
    // Walls as a sketch on glass, so that those in front do not hide the room.
    inputs.solids.push_back(
        {&model->tops.corners, model->tops.count, {0.90f, 0.89f, 0.87f, 0.55f}, 0, kPushBack, true});
    inputs.solids.push_back(
        {&model->sides.corners, model->sides.count, {0.85f, 0.84f, 0.82f, 0.13f}, 0.6f, kPushBack, true});
    return inputs;
}

FrameOutput& FrameRenderer::State::drawView(const compute::Lighting& light, View view, const Tone& tone,
                                            bool hdr) {
    std::optional<FrameOutput>& previewOutput = model->previewOutput;
    const bool fits = previewOutput && previewOutput->view.outputWidth == view.outputWidth &&
                      previewOutput->view.outputHeight == view.outputHeight &&
                      previewOutput->view.supersample == view.supersample && view.warp.empty() &&
                      previewOutput->view.warp.empty();
    if (fits)
        previewOutput->view = std::move(view);
    else
        previewOutput.emplace(*device, std::move(view), allCorners(model->all.mesh), "preview");
    const Quantity quantity = hdr ? Quantity::exitance : quantityOf(tone);
    io::DisplayParams params = displayParams(light, tone);
    // A picture is drawn in units of its white, so that see-through walls weigh the same at every exposure.
    const float scale = quantity == Quantity::picture ? 1e-3f / std::exchange(params.white, 1.0f) : 1e-3f;
    const AddedLight added = prepareLight(model->all, light, quantity, scale);
    params.outputWidth = static_cast<uint32_t>(previewOutput->view.outputWidth);
    gpu::Commands commands(*device);
    scenePass.record(commands, previewOutput->scene, previewInputs(previewOutput->view, added, quantity));
    displayPass.record(
        commands, previewOutput->scene.colour, previewOutput->warp, previewOutput->view,
        previewOutput->target(*device, hdr ? DisplayTarget::Kind::float32 : DisplayTarget::Kind::srgb8),
        hdr ? io::kToneRaw : toneConstant(tone.map), params);
    device->submitAndWait(std::move(commands));
    return *previewOutput;
}

View FrameRenderer::State::previewView(const PreviewOptions& o) const {
    const PerspectiveCamera camera = frameAll(model->scene.points, o.azimuthDegrees, o.elevationDegrees,
                                              o.fovDegrees, double(o.width) / o.height);
    return viewOfCamera(camera, o.width, o.height, o.supersample);
}

FrameRenderer::FrameRenderer(gpu::Device& device, const geometry::PatchMesh& mesh,
                             const geometry::Occluders& occluders, const geometry::Rig* rig,
                             const FrameRendererOptions& options)
    : FrameRenderer(device, FrameScene(mesh, occluders, rig, options)) {}
FrameRenderer::FrameRenderer(gpu::Device& device, FrameScene scene)
    : state_(std::make_unique<State>(device, std::move(scene))) {}
FrameRenderer::FrameRenderer(FrameRenderer&&) noexcept = default;
FrameRenderer& FrameRenderer::operator=(FrameRenderer&&) noexcept = default;
FrameRenderer::~FrameRenderer() = default;

void FrameRenderer::replace(FrameScene scene) {
    state_->model = std::make_unique<Model>(*state_->device, std::move(scene));
    state_->makeOutputs(kProjectorSupersample);
}

void FrameRenderer::leaveOut(const std::vector<bool>& projectors) {
    FrameScene scene = std::move(state_->model->scene);
    scene.leaveOut(projectors);
    replace(std::move(scene));
}

const FrameScene& FrameRenderer::scene() const {
    return state_->model->scene;
}

double FrameRenderer::autoWhite(const compute::Lighting& light) const {
    return passes::autoWhite(state_->model->scene.mesh, light);
}

std::vector<float> FrameRenderer::shownLux(const compute::Lighting& light) const {
    return passes::shownLux(state_->model->scene.mesh, light);
}

double FrameRenderer::reachLux() const {
    return state_->model->scene.painted.white;
}

Image8 FrameRenderer::preview(const compute::Lighting& light, const PreviewOptions& options) {
    const int strip = legendWidth(options.height);
    const bool legend = options.tone.map == ToneMap::falseColour && options.tone.legend && strip > 0 &&
                        options.width > 2 * strip;
    PreviewOptions room = options;
    if (legend) room.width -= strip;
    Image8 picture = state_->drawView(light, state_->previewView(room), options.tone, false).bytes();
    if (legend) {
        picture = widened(picture, strip);
        drawLegend(picture, falseScale(options.tone, shownLux(light)));
    }
    return picture;
}

std::vector<Image8> FrameRenderer::projectors(const compute::Lighting& light,
                                              const ProjectorOptions& options) {
    if (state_->model->scene.views.empty()) return {};
    state_->device->submitAndWait(state_->recordProjectors(light, options, Coding::bytes, true));
    return state_->bytes();
}

ImageF FrameRenderer::previewHdr(const compute::Lighting& light, const PreviewOptions& options) {
    return state_->drawView(light, state_->previewView(options), options.tone, true).floats();
}

std::vector<ImageF> FrameRenderer::projectorsHdr(const compute::Lighting& light,
                                                 const ProjectorOptions& options) {
    if (state_->model->scene.views.empty()) return {};
    state_->device->submitAndWait(state_->recordProjectors(light, options, Coding::floats, true));
    return state_->floats();
}

ProjectorPictures FrameRenderer::projectorsBoth(const compute::Lighting& light,
                                                const ProjectorOptions& options) {
    if (state_->model->scene.views.empty()) return {};
    if (options.tone.map == ToneMap::falseColour) // of lux, which are another drawing
        return {projectors(light, options), projectorsHdr(light, options)};
    state_->device->submitAndWait(state_->recordProjectors(light, options, Coding::both, true));
    return {state_->bytes(), state_->floats()};
}

std::vector<const gpu::Image*> FrameRenderer::drawProjectors(const compute::Lighting& light,
                                                             const ProjectorOptions& options) {
    if (state_->model->scene.views.empty()) return {};
    gpu::Commands commands = state_->recordProjectors(light, options, Coding::bytes, false);
    state_->drawing = state_->device->submit(std::move(commands));
    std::vector<const gpu::Image*> pictures;
    for (const FrameOutput& output : state_->model->outputs) pictures.push_back(&output.display->picture);
    return pictures;
}

ImageF FrameRenderer::exitance(const compute::Lighting& light, const View& view) {
    return state_->drawView(light, view, {}, true).floats();
}

} // namespace heliodon::passes
