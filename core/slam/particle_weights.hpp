#pragma once

#include <span>

namespace odoless {

/// Weights proportional to exp(log_weight), with sum 1. The spans have the same size, at least 1; finite values, or
/// minus infinity, but not for all.
void normalise_weights(std::span<const double> log_weights, std::span<double> weights);

/// Number of equally weighted particles that would be worth as much: 1 / sum of squares [liu1996metropolized; method
/// 7].
[[nodiscard]] double effective_particles(std::span<const double> weights);

/// Systematic resampling [carpenter1999improved; method 7]: how often each particle goes on, `wanted` times in all.
/// Particle i gets weights[i] * wanted copies, rounded up or down.
///
/// @param weights  Sum 1, up to rounding.
/// @param offset   Uniform in [0, 1), the only chance in it.
void systematic_copies(std::span<const double> weights, int wanted, double offset, std::span<int> copies);

/// Sets the weights of the weakest half (rounded down) to 0, of equal ones the later, and normalises the others.
/// `scratch` has the size of `weights`.
void drop_weakest_half(std::span<double> weights, std::span<int> scratch);

}  // namespace odoless
