#pragma once
// HEARTSERVO_SIMD on a function of plain loops: GCC compiles it for AVX-512, AVX2 and the baseline and picks at run
// time, so that one binary runs everywhere. Off under sanitizers (the resolver would run before they are ready) and
// where the compiler or the machine has no such thing.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(HEARTSERVO_SANITIZED)
#define HEARTSERVO_SIMD __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define HEARTSERVO_SIMD
#endif
