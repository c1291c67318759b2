#include "engine/app/display_notice.h"

#include <fmt/format.h>

namespace heliodon::app {

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
        if (other == projector || !covered[other] || present::sharedPixels(*covered[other], *own) == 0) continue;
        if (other == rig.projectors.size())
            return fmt::format("the operator's window lies on display '{}', over the picture of '{}': drag it "
                               "to another, or connect one more",
                               own->name, p.id);
        if (covered[other]->name.empty() || other > projector) continue; // said of the later one
        return fmt::format("displays '{}' and '{}' show the same part of the desktop, so of '{}' and '{}' only "
                           "one is seen: expected displays beside each other",
                           own->name, covered[other]->name, p.id, rig.projectors[other].id);
    }
    return "";
}

} // namespace heliodon::app
