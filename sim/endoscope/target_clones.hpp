#pragma once
// A function so marked is compiled for AVX-512, AVX2 and the baseline, and the best is chosen when the program starts.
// The sanitizers' own start-up code does not stand the selection, which happens before it.
#if defined(HEARTSERVO_SANITIZED) || !defined(__x86_64__) || !defined(__GNUC__) || defined(__clang__)
#define HEARTSERVO_TARGET_CLONES
#else
#define HEARTSERVO_TARGET_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif
