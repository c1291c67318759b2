#include "engine/app/projector_displays.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "geometry/input_error.h"

namespace heliodon::app {

void assignDisplays(geometry::Rig& rig, const std::vector<std::string>& choices) {
    for (const std::string& choice : choices) {
        const size_t sign = choice.find('=');
        const auto at = std::ranges::find(rig.projectors, choice.substr(0, sign), &geometry::Projector::id);
        if (sign == std::string::npos || sign + 1 == choice.size() || at == rig.projectors.end()) {
            std::vector<std::string> names;
            for (const geometry::Projector& projector : rig.projectors) names.push_back(projector.id);
            throw geometry::InputError(
                "--display", choice, fmt::format("expected PROJECTOR=OUTPUT, of {}", fmt::join(names, ", ")));
        }
        at->display = choice.substr(sign + 1);
    }
}

std::string displayNotice(const geometry::Rig& rig, size_t projector,
                          const std::vector<std::optional<present::Display>>& covered) {
    const std::optional<present::Display>& own = covered[projector];
    if (!own || own->name.empty()) return ""; // an ordinary window
    const geometry::Projector& p = rig.projectors[projector];
    if (own->width != p.width || own->height != p.height)
        return fmt::format("display '{}' has {} x {} pixels and the rig's '{}' {} x {}: the picture is "
                           "stretched, expected a display that is set to the projector's size",
                           own->name, own->width, own->height, p.id, p.width, p.height);
    for (size_t other = 0; other < covered.size(); ++other) {
        if (other == projector || !covered[other] || present::sharedPixels(*covered[other], *own) == 0)
            continue;
        if (other == rig.projectors.size())
            return fmt::format(
                "the operator's window lies on display '{}', over the picture of '{}': drag it "
                "to another, or connect one more",
                own->name, p.id);
        if (covered[other]->name.empty() || other > projector) continue; // said of the later one
        return fmt::format(
            "displays '{}' and '{}' show the same part of the desktop, so of '{}' and '{}' only "
            "one is seen: expected displays beside each other",
            own->name, covered[other]->name, p.id, rig.projectors[other].id);
    }
    return "";
}

} // namespace heliodon::app
