#pragma once

/// Marks a hot loop that the compiler vectorises: on x86-64 it is compiled twice and the wider version is taken where
/// the processor has it. The sums are of integers or in a fixed order, so both give the same bits.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define ODOLESS_HOT __attribute__((target_clones("avx2", "default")))
#else
#define ODOLESS_HOT
#endif
