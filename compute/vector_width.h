// How wide the vectors are that kernels of the host compute with. None contracts products and sums, so that
// their bits do not depend on it. None may be asked for more than widestVectors().
#pragma once

namespace heliodon::compute {

enum class VectorWidth { baseline, avx2, avx512 };

inline VectorWidth widestVectors() { // of this processor
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f")) return VectorWidth::avx512;
    if (__builtin_cpu_supports("avx2")) return VectorWidth::avx2;
#endif
    return VectorWidth::baseline;
}

} // namespace heliodon::compute
