// Drawing that is cut to a part of its picture.
#pragma once

#include <vulkan/vulkan.h>

#include "engine/passes/view.h"

namespace heliodon::passes {

inline void setScissor(VkCommandBuffer commands, const PixelRect& part) {
    const VkRect2D rect{{part.x, part.y},
                        {static_cast<uint32_t>(part.width), static_cast<uint32_t>(part.height)}};
    vkCmdSetScissor(commands, 0, 1, &rect);
}

} // namespace heliodon::passes
