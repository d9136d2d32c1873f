#include "arrays.h"

NB_MODULE(_core, m) {
    m.doc() = "The core of lumel. Private: the package around it is the interface.";
    // This file is compiled for any processor, so that it can say what is missing before the rest of the core runs.
#ifdef LUMEL_NEEDS_AVX2
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") || !__builtin_cpu_supports("bmi2"))
        throw nb::import_error("lumel needs a processor with AVX2 (x86-64-v3), which this one is not");
#endif
    bind_scene(m);
    bind_accel(m);
    bind_raster(m);
    bind_session(m);
}
