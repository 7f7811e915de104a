// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// Before a function: it is compiled once per instruction set and chosen at start. The operations and their order are
/// the same in each, so numbers are too. Functions that it is to take along say TRELLIS_ALONG.
///
/// The sanitizers' builds go without: what chooses runs before the sanitizer is ready.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define TRELLIS_CLONES __attribute__((target_clones("avx2", "default")))
#define TRELLIS_ALONG [[gnu::always_inline]] inline
#else
#define TRELLIS_CLONES
#define TRELLIS_ALONG inline
#endif
