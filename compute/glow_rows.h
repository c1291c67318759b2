// How a year keeps what blinds scatter, beside patches in the sun.
#pragma once

#include <cstddef>

#include "compute/daylight_transport.h"

namespace heliodon::compute {

// Rows of what a sensor answers to light of one hour: patches (sun), patches of blinds in the order of their
// groups (even glow), slats' lobes as in SlatLobes, and lobes of all patches of a group together, by node.
struct GlowRows {
    explicit GlowRows(const TransportParts& parts, size_t patches) : glow(patches), lobes(patches) {
        for (const GlowingBlinds::Group& group : parts.blinds.groups()) lobes += group.patches.size();
        groupLobes = lobes + parts.slats.rows();
        all = groupLobes;
        if (!parts.slats.empty()) all += parts.blinds.groups().size() * daylight::kSlatNodes;
    }
    size_t glow, lobes, groupLobes, all;
};

} // namespace heliodon::compute
