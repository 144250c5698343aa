#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "core/base/rng.hpp"
#include "core/math/elementary.hpp"

namespace odoless {
namespace {

constexpr std::size_t kArguments = 1024;

// One function over numbers between `low` and `high`: items are calls.
template <class Function>
void call(benchmark::State& state, double low, double high, Function function) {
  Rng rng(1);
  std::vector<double> arguments(kArguments);
  for (double& x : arguments) {
    x = rng.uniform(low, high);
  }
  for (auto _ : state) {
    double sum = 0.0;
    for (const double x : arguments) {
      sum += function(x);
    }
    benchmark::DoNotOptimize(sum);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kArguments));
}

double library_sincos(double x) { return std::sin(x) + std::cos(x); }

double own_sincos(double x) {
  const auto [sin, cos] = math::sincos(x);
  return sin + cos;
}

// NOLINTBEGIN(cppcoreguidelines-macro-usage,bugprone-macro-parentheses): the text of a call is its name in the report
#define ODOLESS_BENCH(name, low, high, own, library)                            \
  BENCHMARK_CAPTURE(call, name / own, low, high, [](double x) { return own; }); \
  BENCHMARK_CAPTURE(call, name / library, low, high, [](double x) { return library; })
// NOLINTEND(cppcoreguidelines-macro-usage,bugprone-macro-parentheses)

ODOLESS_BENCH(sin, -3.2, 3.2, math::sin(x), std::sin(x));
ODOLESS_BENCH(cos, -3.2, 3.2, math::cos(x), std::cos(x));
ODOLESS_BENCH(sincos, -3.2, 3.2, own_sincos(x), library_sincos(x));
ODOLESS_BENCH(tan, -1.5, 1.5, math::tan(x), std::tan(x));
ODOLESS_BENCH(atan2, -3.0, 3.0, math::atan2(x, 1.0 - x), std::atan2(x, 1.0 - x));
ODOLESS_BENCH(asin, -1.0, 1.0, math::asin(x), std::asin(x));
ODOLESS_BENCH(exp, -20.0, 0.0, math::exp(x), std::exp(x));
ODOLESS_BENCH(expm1, -2.0, 0.0, math::expm1(x), std::expm1(x));
ODOLESS_BENCH(log, 1e-6, 1.0, math::log(x), std::log(x));
ODOLESS_BENCH(log1p, 0.0, 1.0, math::log1p(x), std::log1p(x));
ODOLESS_BENCH(erf, 0.0, 4.0, math::erf(x), std::erf(x));
ODOLESS_BENCH(hypot, -3.0, 3.0, math::hypot(x, 1.0 - x), std::hypot(x, 1.0 - x));

}  // namespace
}  // namespace odoless
