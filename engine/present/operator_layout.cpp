#include "engine/present/operator_layout.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <span>
#include <sstream>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <imgui.h>

#include "compute/gpu/image.h"
#include "engine/passes/lettering.h"

namespace heliodon::present {

namespace {

const ImVec4 kAmber{1.0f, 0.74f, 0.30f, 1}, kGrey{0.60f, 0.63f, 0.68f, 1}, kRed{1.0f, 0.42f, 0.36f, 1},
    kGreen{0.45f, 0.85f, 0.55f, 1};

ImU32 packed(const std::array<float, 3>& colour, float alpha = 1) {
    return ImGui::ColorConvertFloat4ToU32({colour[0], colour[1], colour[2], alpha});
}

void grey(const char* text) {
    ImGui::TextColored(kGrey, "%s", text);
}

// ImGui alone would break lines after points and commas, within numbers; it still breaks words too long.
void wrapped(const std::string& text) {
    const float room = ImGui::GetContentRegionAvail().x;
    std::string lines, line;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        const std::string longer = line.empty() ? word : line + ' ' + word;
        if (line.empty() || ImGui::CalcTextSize(longer.c_str()).x <= room) {
            line = longer;
            continue;
        }
        lines += line + '\n';
        line = word;
    }
    ImGui::TextWrapped("%s", (lines + line).c_str());
}

// Label on the left in a column of its own, then the widget over the rest of the line.
void label(const char* text) {
    ImGui::AlignTextToFramePadding();
    grey(text);
    ImGui::SameLine(92);
    ImGui::SetNextItemWidth(-1);
}

bool slider(const char* id, double& value, double low, double high, const char* format,
            ImGuiSliderFlags flags = 0) {
    return ImGui::SliderScalar(id, ImGuiDataType_Double, &value, &low, &high, format, flags);
}

// Fits a picture into a frame, placed and outlined; returns its rectangle.
PlacedPicture fitted(const gpu::Image& picture, ImVec2 at, ImVec2 room) {
    const auto width = static_cast<float>(picture.info().width),
               height = static_cast<float>(picture.info().height);
    const float scale = std::min(room.x / width, room.y / height);
    const float left = std::floor(at.x + 0.5f * (room.x - scale * width)),
                top = std::floor(at.y + 0.5f * (room.y - scale * height));
    return {&picture, left, top, left + scale * width, top + scale * height};
}

// Words far from what they name would be taken for another's, as happens where the picture is small.
bool isNear(const passes::Label& label, const passes::Box& box) {
    constexpr double kNear = 24; // pixels
    glm::dvec2 middle{};
    for (const glm::dvec2& p : label.outline) middle += p / static_cast<double>(label.outline.size());
    const auto near = [&](glm::dvec2 p) {
        return glm::distance(p, glm::clamp(p, box.low, box.high)) < kNear;
    };
    return near(middle) || std::ranges::any_of(label.outline, near);
}

// A box for each outline that has words, none where it has no free place beside it; outlines without are
// lines that words keep off.
const std::vector<std::optional<passes::Box>>&
placeWords(const PlacedPicture& placed, const std::vector<OperatorOutline>& outlines, LabelsKept& kept) {
    constexpr double kClear = 2, kOutward = 20; // pixels
    const passes::Box within{{placed.left, placed.top}, {placed.right, placed.bottom}};
    std::vector<passes::Label> labels;
    std::vector<passes::Line> lines;
    for (const OperatorOutline& outline : outlines) {
        if (outline.points.empty()) continue;
        if (outline.label.empty()) {
            for (size_t i = 0; i < outline.points.size(); ++i)
                lines.push_back({outline.points[i], outline.points[(i + 1) % outline.points.size()]});
            continue;
        }
        const ImVec2 words = ImGui::CalcTextSize(outline.label.c_str());
        const glm::dvec2 outward = outline.points.front() - 0.5 * (within.low + within.high);
        labels.push_back({outline.points,
                          {words.x + 8.0, words.y + 2.0},
                          kOutward * outward / std::max(1.0, glm::length(outward))});
    }
    if (within == kept.within && labels == kept.labels && lines == kept.lines) return kept.boxes;
    kept = {labels, lines, within, {}};
    for (const passes::Box& box : passes::placeLabels(labels, within, kClear, lines)) {
        const bool free = within.contains(box) && std::ranges::none_of(kept.boxes, [&](const auto& other) {
                              return other && other->covers(box);
                          });
        const bool shown = free && isNear(labels[kept.boxes.size()], box);
        kept.boxes.push_back(shown ? std::optional(box) : std::nullopt);
    }
    return kept.boxes;
}

void drawOutlines(const PlacedPicture& placed, std::vector<OperatorOutline> outlines, LabelsKept& kept) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    const double scale = (placed.right - placed.left) / static_cast<double>(placed.picture->info().width);
    list->PushClipRect({placed.left, placed.top}, {placed.right, placed.bottom}, true);
    for (OperatorOutline& outline : outlines) {
        std::vector<ImVec2> points;
        for (glm::dvec2& p : outline.points) {
            p = glm::dvec2(placed.left, placed.top) + scale * (p + 0.5);
            points.push_back({static_cast<float>(p.x), static_cast<float>(p.y)});
        }
        const int count = static_cast<int>(points.size());
        list->AddPolyline(points.data(), count, IM_COL32(10, 10, 14, 190), ImDrawFlags_Closed, 3.5f);
        list->AddPolyline(points.data(), count, packed(outline.colour), ImDrawFlags_Closed, 1.6f);
    }
    auto place = placeWords(placed, outlines, kept).begin();
    for (const OperatorOutline& outline : outlines) { // labels go over all outlines
        if (outline.points.empty() || outline.label.empty()) continue;
        const std::optional<passes::Box>& box = *place++;
        if (!box) continue;
        const ImVec2 low{std::round(static_cast<float>(box->low.x)),
                         std::round(static_cast<float>(box->low.y))},
            size{static_cast<float>(box->high.x - box->low.x), static_cast<float>(box->high.y - box->low.y)};
        list->AddRectFilled(low, {low.x + size.x, low.y + size.y}, IM_COL32(15, 16, 20, 190), 4);
        list->AddText({low.x + 4, low.y + 1}, packed(outline.colour), outline.label.c_str());
    }
    list->PopClipRect();
}

// One pixel around: pictures keep that far from the edge of their room.
void frame(const PlacedPicture& p) {
    ImGui::GetWindowDrawList()->AddRect({p.left - 1, p.top - 1}, {p.right + 1, p.bottom + 1},
                                        IM_COL32(70, 74, 84, 255));
}

void layOutPictures(std::vector<PlacedPicture>& pictures, const OperatorStatus& status,
                    OperatorActions& actions, LabelsKept& kept) {
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const auto count = static_cast<float>(std::max<size_t>(1, status.outputs.size()));
    const float line = ImGui::GetTextLineHeightWithSpacing(), gap = 8;
    const float thumb = std::min((room.x - 2 - gap * (count - 1)) / count, 0.36f * room.y * 4 / 3);
    const float below = 0.75f * thumb + 2 * line + 3 * gap;
    // What the camera sees.
    ImGui::TextColored(status.cameraFails ? kRed : kGrey, "%s", status.camera.c_str());
    if (!status.working.empty()) {
        ImGui::SameLine();
        ImGui::TextColored(kAmber, "   %s", status.working.c_str());
    }
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const ImVec2 size{room.x, std::max(60.0f, room.y - below - line)};
    if (status.cameraPicture) {
        const PlacedPicture placed = fitted(*status.cameraPicture, {at.x + 1, at.y}, {size.x - 2, size.y});
        pictures.push_back(placed);
        frame(placed);
        drawOutlines(placed, status.outlines, kept);
    } else {
        ImGui::GetWindowDrawList()->AddRect(at, {at.x + size.x, at.y + size.y}, IM_COL32(70, 74, 84, 255));
        ImGui::GetWindowDrawList()->AddText({at.x + 16, at.y + 14}, ImGui::GetColorU32(kGrey),
                                            "no picture yet");
    }
    // What each output shows.
    for (size_t i = 0; i < status.outputs.size(); ++i) {
        const OperatorOutput& output = status.outputs[i];
        const float left = at.x + 1 + static_cast<float>(i) * (thumb + gap);
        ImGui::SetCursorScreenPos({left, at.y + size.y + gap});
        ImGui::PushID(static_cast<int>(i));
        ImGui::BeginGroup();
        ImGui::TextColored(output.open ? ImGui::GetStyleColorVec4(ImGuiCol_Text) : kGrey, "%s",
                           output.title.c_str());
        const ImVec2 corner = ImGui::GetCursorScreenPos();
        if (output.picture && output.open) {
            const PlacedPicture placed = fitted(*output.picture, corner, {thumb, 0.75f * thumb});
            pictures.push_back(placed);
            frame(placed);
        } else {
            ImGui::GetWindowDrawList()->AddRect(corner, {corner.x + thumb, corner.y + 0.75f * thumb},
                                                IM_COL32(70, 74, 84, 255));
        }
        if (ImGui::InvisibleButton("full", {thumb, 0.75f * thumb}) && output.open)
            actions.toggleFullScreen.push_back(i);
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("%s", output.fullScreen ? "click: show it in a window" : "click: full screen");
        grey(output.state.c_str());
        ImGui::EndGroup();
        ImGui::PopID();
    }
}

void layOutTime(OperatorControls& c, const OperatorStatus& status) {
    ImGui::PushFont(ImGui::GetIO().Fonts->Fonts.back()); // the large one of styleOperatorWindow
    ImGui::TextColored(kAmber, "%s", status.clock.c_str());
    ImGui::PopFont();
    ImGui::SameLine();
    ImGui::BeginGroup();
    ImGui::TextUnformatted(status.date.c_str());
    grey(status.sun.c_str());
    ImGui::EndGroup();
    label("time");
    const int minutes = static_cast<int>(c.hour * 60 + 1e-6);
    slider("##time", c.hour, 0, 24 - 1.0 / 60, fmt::format("{:02}:{:02}", minutes / 60, minutes % 60).c_str(),
           ImGuiSliderFlags_NoInput);
    label("day");
    const int days = std::chrono::year(c.year).is_leap() ? 366 : 365;
    ImGui::SliderInt("##day", &c.dayOfYear, 1, days, "%d of the year");
    label("play");
    if (ImGui::Button(c.playing ? "stop" : "play", {56, 0})) c.playing = !c.playing;
    ImGui::SameLine();
    if (ImGui::RadioButton("hours", !c.playDays)) c.playDays = false;
    ImGui::SameLine();
    if (ImGui::RadioButton("days", c.playDays)) c.playDays = true;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1);
    slider("##speed", c.speed, c.playDays ? 1 : 0.1, c.playDays ? 60 : 6,
           c.playDays ? "%.0f days/s" : "%.1f h/s", ImGuiSliderFlags_Logarithmic);
}

void layOutSky(OperatorControls& c, const OperatorStatus& status) {
    label("weather");
    const bool perez = c.sky.starts_with("perez:"), file = c.sky == kWeatherFile;
    const char* chosen = perez ? "sun and sky in W/m2" : file ? status.weather.c_str() : c.sky.c_str();
    if (ImGui::BeginCombo("##sky", chosen)) {
        if (!status.weather.empty() && ImGui::Selectable(status.weather.c_str(), file)) c.sky = kWeatherFile;
        for (const char* name : {"clear", "intermediate", "overcast"})
            if (ImGui::Selectable(name, c.sky == name)) c.sky = name;
        for (int type = 1; type <= 15; ++type) {
            const std::string name = fmt::format("cie:{}", type);
            if (ImGui::Selectable(name.c_str(), c.sky == name)) c.sky = name;
        }
        if (ImGui::Selectable("sun and sky in W/m2", perez) && !perez) c.sky = "perez:600,150";
        ImGui::EndCombo();
    }
    double direct = 0, diffuse = 0;
    if (perez && std::sscanf(c.sky.c_str(), "perez:%lf,%lf", &direct, &diffuse) == 2) {
        label("");
        const float half = 0.5f * (ImGui::GetContentRegionAvail().x - 8);
        ImGui::SetNextItemWidth(half);
        bool changed = slider("##direct", direct, 0, 1000, "sun %.0f");
        ImGui::SameLine();
        ImGui::SetNextItemWidth(half);
        changed |= slider("##diffuse", diffuse, 0, 500, "sky %.0f");
        if (changed) c.sky = fmt::format("perez:{:.0f},{:.0f}", direct, diffuse);
    }
    if (file) return; // it has its own site
    label("site");
    double place[2] = {c.latitudeDeg, c.longitudeDeg};
    if (ImGui::InputScalarN("##site", ImGuiDataType_Double, place, 2, nullptr, nullptr, "%.2f",
                            ImGuiInputTextFlags_EnterReturnsTrue)) {
        c.latitudeDeg = std::clamp(place[0], -90.0, 90.0);
        c.longitudeDeg = std::clamp(place[1], -180.0, 180.0);
    }
}

void layOutLegend(const passes::FalseScale& scale) {
    ImVec2 at = ImGui::GetCursorScreenPos();
    constexpr float kBelow = 20; // black, and a gap
    const float width = ImGui::GetContentRegionAvail().x - kBelow, height = 14;
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(at, {at.x + 14, at.y + height}, packed({0, 0, 0}));
    list->AddRect(at, {at.x + 14, at.y + height}, ImGui::GetColorU32(kGrey));
    list->AddText({at.x + 3, at.y + height + 3}, ImGui::GetColorU32(kGrey), "<");
    at.x += kBelow;
    constexpr int kSteps = 64;
    for (int i = 0; i < kSteps; ++i) {
        const glm::vec3 c = passes::viridis((i + 0.5) / kSteps);
        const float left = at.x + width * static_cast<float>(i) / kSteps;
        list->AddRectFilled({left, at.y}, {left + width / kSteps + 1, at.y + height},
                            packed({c.x, c.y, c.z}));
    }
    ImGui::Dummy({width, height});
    const ImVec2 numbers = ImGui::GetCursorScreenPos();
    float free = at.x; // to the right of the numbers so far
    for (double lux : passes::legendTicks(scale)) {
        const double t = std::log(lux / scale.lowLux) / std::log(scale.highLux / scale.lowLux);
        const std::string text = passes::legendNumber(lux);
        const float x = at.x + width * static_cast<float>(t), wide = ImGui::CalcTextSize(text.c_str()).x;
        const float left = std::clamp(x - wide / 2, at.x, at.x + width - wide);
        if (left < free) continue;
        free = left + wide + 6;
        list->AddLine({x, at.y + height}, {x, at.y + height + 3}, ImGui::GetColorU32(kGrey));
        list->AddText({left, numbers.y}, ImGui::GetColorU32(kGrey), text.c_str());
    }
    ImGui::Dummy({width, ImGui::GetTextLineHeight()});
}

void layOutPicture(OperatorControls& c, const OperatorStatus& status) {
    label("white");
    ImGui::Checkbox("auto", &c.autoExposure);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1);
    double white = c.autoExposure ? status.whiteLux : c.whiteLux;
    if (slider("##white", white, 1, 50000, "%.0f lux", ImGuiSliderFlags_Logarithmic)) {
        c.autoExposure = false;
        c.whiteLux = white;
    } else if (!c.autoExposure && white <= 0) {
        c.whiteLux = 1000;
    } else if (c.autoExposure && status.whiteLux > 0) {
        c.whiteLux = status.whiteLux; // where it stays when "auto" is taken away
    }
    label("colours");
    ImGui::Checkbox("lux as colour", &c.falseColour);
    ImGui::SameLine();
    ImGui::Checkbox("blue sky, warm sun", &c.skyColour);
    if (c.falseColour && status.scale) layOutLegend(*status.scale);
    label("show");
    constexpr std::pair<Shown, const char*> kShown[]{{Shown::light, "light"},
                                                     {Shown::grid, "grid"},
                                                     {Shown::white, "white"},
                                                     {Shown::black, "black"},
                                                     {Shown::identify, "names"}};
    for (const auto& [shown, name] : kShown) {
        if (shown != Shown::light) ImGui::SameLine();
        const bool on = c.shown == shown;
        if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
        if (ImGui::Button(name)) c.shown = shown;
        if (on) ImGui::PopStyleColor();
    }
}

void layOutFacts(const OperatorStatus& status) {
    if (!status.refused.empty()) {
        ImGui::TextColored(kRed, "The latest sketch is not shown:");
        wrapped(status.refused);
    }
    for (const std::string& warning : status.warnings) {
        ImGui::PushStyleColor(ImGuiCol_Text, kAmber);
        wrapped(warning);
        ImGui::PopStyleColor();
    }
    for (const auto& [name, value] : status.facts) {
        grey(name.c_str());
        ImGui::SameLine(128);
        wrapped(value);
    }
}

void layOutKeys() {
    for (const auto& [keys, what] : operatorKeys()) {
        ImGui::TextUnformatted(keys.c_str());
        ImGui::SameLine(128);
        grey(what.c_str());
    }
}

bool heading(const char* text, bool open = true) {
    ImGui::Spacing();
    return ImGui::CollapsingHeader(text, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

} // namespace

const std::vector<std::pair<std::string, std::string>>& operatorKeys() {
    static const std::vector<std::pair<std::string, std::string>> keys{
        {"wheel, left right", "time of day, 10 minutes (ctrl: 1)"},
        {"shift + wheel, up down", "day of the year (ctrl: 7)"},
        {"space", "play, stop"},
        {"C", "lux as colour"},
        {"E", "automatic exposure, or as it is"},
        {"F", "full screen, or a window"},
        {"G W B I L", "grid, white, black, names, light"},
        {"Esc, Q", "quit"}};
    return keys;
}

void styleOperatorWindow() {
    ImGuiIO& io = ImGui::GetIO();
    // Names of places and projectors in Latin, Greek or Cyrillic letters.
    static constexpr ImWchar letters[]{0x20, 0x24F, 0x370, 0x52F, 0x1E00, 0x1EFF, 0x2010, 0x203A, 0};
    const std::span<const uint8_t> file = passes::fontFile();
    ImFontConfig ours; // ImGui reads the file where it is
    ours.FontDataOwnedByAtlas = false;
    const auto font = [&](float size, const ImWchar* ranges) {
        return io.Fonts->AddFontFromMemoryTTF(const_cast<uint8_t*>(file.data()),
                                              static_cast<int>(file.size()), size, &ours, ranges);
    };
    font(15, letters);
    font(38, nullptr);
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 0;
    style.ChildRounding = style.FrameRounding = style.GrabRounding = style.PopupRounding = 4;
    style.WindowBorderSize = 0;
    style.ItemSpacing = {8, 6};
    style.FramePadding = {8, 4};
    style.Colors[ImGuiCol_ChildBg] = {0.115f, 0.122f, 0.14f, 1};
    style.Colors[ImGuiCol_FrameBg] = {0.18f, 0.19f, 0.22f, 1};
    style.Colors[ImGuiCol_FrameBgHovered] = {0.23f, 0.24f, 0.28f, 1};
    style.Colors[ImGuiCol_FrameBgActive] = {0.27f, 0.28f, 0.33f, 1};
    // Dark enough that a slider's value can be read over its handle.
    style.Colors[ImGuiCol_SliderGrab] = {0.50f, 0.34f, 0.10f, 1};
    style.Colors[ImGuiCol_SliderGrabActive] = {0.60f, 0.41f, 0.12f, 1};
    style.Colors[ImGuiCol_CheckMark] = {1.0f, 0.74f, 0.30f, 1};
    style.Colors[ImGuiCol_Button] = {0.22f, 0.23f, 0.27f, 1};
    style.Colors[ImGuiCol_ButtonHovered] = {0.32f, 0.30f, 0.28f, 1};
    style.Colors[ImGuiCol_ButtonActive] = {0.62f, 0.43f, 0.14f, 1};
    style.Colors[ImGuiCol_Header] = {0.17f, 0.18f, 0.21f, 1};
    style.Colors[ImGuiCol_HeaderHovered] = {0.25f, 0.25f, 0.27f, 1};
    style.Colors[ImGuiCol_HeaderActive] = {0.30f, 0.28f, 0.25f, 1};
    style.Colors[ImGuiCol_Text] = {0.90f, 0.91f, 0.93f, 1};
}

std::vector<PlacedPicture> layOutOperatorWindow(OperatorControls& controls, const OperatorStatus& status,
                                                OperatorActions& actions, LabelsKept& kept) {
    std::vector<PlacedPicture> pictures;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    constexpr float kColumn = 400; // of the controls
    constexpr ImGuiWindowFlags kPlain = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                        ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoScrollWithMouse |
                                        ImGuiWindowFlags_NoBringToFrontOnFocus;
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize(size);
    ImGui::Begin("operator", nullptr, kPlain);
    ImGui::BeginChild("pictures", {std::max(120.0f, size.x - kColumn - 24), 0}, false,
                      kPlain | ImGuiWindowFlags_NoScrollbar);
    layOutPictures(pictures, status, actions, kept);
    ImGui::EndChild();
    ImGui::SameLine();
    // The wheel is for the time: here too nothing scrolls by it.
    ImGui::BeginChild("controls", {0, 0}, true, ImGuiWindowFlags_NoScrollWithMouse);
    layOutTime(controls, status);
    ImGui::Separator();
    layOutSky(controls, status);
    ImGui::Separator();
    layOutPicture(controls, status);
    if (heading("Status")) layOutFacts(status);
    if (heading("Keys", false)) layOutKeys();
    ImGui::Spacing();
    if (ImGui::Button("quit")) actions.quit = true;
    ImGui::EndChild();
    ImGui::End();
    return pictures;
}

} // namespace heliodon::present
