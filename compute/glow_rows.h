// How a year keeps what blinds scatter, beside patches in the sun.
#pragma once

#include <cstddef>

#include "compute/daylight_transport.h"

namespace heliodon::compute {

// Rows of what a sensor answers to light of one hour: patches (sun), patches of blinds in the order of their
// groups (even glow), slats' lobes as in SlatLobes, lobes of all patches of a group together, by node,
// patches once more, for light that runs on smoothly, and cells of what stands outside, for what falls on
// them.
struct GlowRows {
    explicit GlowRows(const TransportParts& parts, size_t patches) : glow(patches), lobes(patches) {
        for (const GlowingBlinds::Group& group : parts.blinds.groups()) lobes += group.patches.size();
        groupLobes = lobes + parts.slats.rows();
        smooth = groupLobes;
        if (!parts.slats.empty()) smooth += parts.blinds.groups().size() * daylight::kSlatLobes;
        outside = smooth + patches;
        all = outside + parts.reflection.cells().size();
    }
    size_t glow, lobes, groupLobes, smooth, outside, all;
};

} // namespace heliodon::compute
