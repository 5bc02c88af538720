#pragma once

// What users of the headers alone are told; for those of the target pliant::openmp, which defines
// PLIANT_WITHOUT_AVX, cmake/simd_message.cmake does it.
#if defined(__x86_64__) && defined(__OPTIMIZE__) && !defined(__AVX__) && \
    !defined(PLIANT_WITHOUT_AVX)
#if defined(__clang__)
#pragma clang diagnostic push
#pragma clang diagnostic warning "-W#pragma-messages"  // no error under -Werror
#endif
#pragma message( \
        "Pliant computes elements in SSE registers; with -march=native AVX2 takes about 0.6, AVX-512 a third of the time. -DPLIANT_WITHOUT_AVX silences this.")
#if defined(__clang__)
#pragma clang diagnostic pop
#endif
#endif
