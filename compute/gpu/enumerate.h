// Vulkan's lists, which are asked for twice: how many there are, then which.
#pragma once

#include <cstdint>
#include <vector>

#include "compute/gpu/error.h"

namespace heliodon::gpu {

// list(&count, nullptr), then list(&count, values); `name`: of the call. Throws Error.
template<class T, class List> std::vector<T> enumerate(const char* name, const List& list) {
    uint32_t count = 0;
    check(list(&count, nullptr), name);
    std::vector<T> values(count);
    check(list(&count, values.data()), name);
    values.resize(count);
    return values;
}

} // namespace heliodon::gpu
