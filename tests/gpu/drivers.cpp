#include "tests/gpu/drivers.h"

#include <initializer_list>

#include <dlfcn.h>

// What the validation layer keeps for the life of the process is its own business. Read by the leak checker,
// where there is one.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libVkLayer_khronos_validation";
}

namespace heliodon::test {

void keepDriversLoaded() {
    for (const char* name :
         {"libvulkan_lvp.so", "libVkLayer_MESA_device_select.so", "libVkLayer_khronos_validation.so"})
        dlopen(name, RTLD_LAZY | RTLD_NODELETE);
}

} // namespace heliodon::test
