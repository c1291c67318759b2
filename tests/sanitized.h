// Whether this build watches memory: arithmetic takes several times as long. What a test compares with double
// precision may be a part there, which runs the same code; the plain build compares all of it.
#pragma once

namespace heliodon::test {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

} // namespace heliodon::test
