// Integer loops compiled for several instruction sets, chosen when the program starts.
#pragma once

// Integer results are the same bytes on all of them. Where the compiler or the C library cannot
// choose, or a sanitizer runs before the choice is made, the plain build is used.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__) &&       \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define DEVSEG_SIMD_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define DEVSEG_SIMD_CLONES
#endif
