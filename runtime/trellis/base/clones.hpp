// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// Write TRELLIS_CLONES before a function: the compiler builds it once per instruction set, and the program chooses one
/// at start. All clones do the same operations in the same order, so they give the same numbers. Write TRELLIS_ALONG
/// before the functions that it calls, and TRELLIS_ALONG_LAMBDA after the parameters of lambdas. TRELLIS_WIDE_CLONES
/// adds AVX-512, where it is faster.
///
/// Builds with sanitizers have no clones: the choice runs before the sanitizer is ready.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define TRELLIS_CLONES __attribute__((target_clones("avx2", "default")))
#define TRELLIS_WIDE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#define TRELLIS_ALONG [[gnu::always_inline]] inline
#define TRELLIS_ALONG_LAMBDA __attribute__((always_inline))
#else
#define TRELLIS_CLONES
#define TRELLIS_WIDE_CLONES
#define TRELLIS_ALONG inline
#define TRELLIS_ALONG_LAMBDA
#endif
