// What this machine can do at most, on all threads that OpenMP gives: the measure of how far the
// renderer's stages are from its limits (docs/benchmarks.md).

#include "item3d/core/parallel.h"

#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

namespace item3d {
namespace {

constexpr std::int64_t block = 1 << 14;

/// Reads and writes far more than the caches hold; bytes/s counts both.
void copy_memory(benchmark::State& state) {
    const std::int64_t floats = state.range(0) * (1 << 18);
    const std::vector<float> source(static_cast<std::size_t>(floats), 1.0f);
    std::vector<float> target(source.size());
    const float* in = source.data();
    float* out = target.data();
    for (auto _ : state) {
        parallel_for(
            "copy", floats, [=](std::int64_t i) { out[i] = in[i]; }, block);
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(state.iterations() * floats * 8);
}
BENCHMARK(copy_memory)->Arg(4)->Arg(256)->ArgName("MiB")->UseRealTime();

/// Rows of four floats at random places of a table: what vertices and texels cost where neighbours
/// are not near each other. items/s counts rows.
void gather_rows(benchmark::State& state) {
    const std::uint32_t rows = static_cast<std::uint32_t>(state.range(0)) * (1 << 16);
    const std::vector<float> table(std::size_t{4} * rows, 1.0f);
    constexpr std::int64_t count = 1 << 20;
    std::vector<float> sums(count);
    const float* in = table.data();
    float* out = sums.data();
    for (auto _ : state) {
        parallel_for(
            "gather", count,
            [=](std::int64_t i) {
                // Knuth's multiplicative hash.
                const std::uint32_t row = static_cast<std::uint32_t>(i) * 2654435761u % rows;
                const float* at = in + std::size_t{4} * row;
                out[i] = (at[0] + at[1]) + (at[2] + at[3]);
            },
            block);
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * count);
}
BENCHMARK(gather_rows)->Arg(1)->Arg(16)->Arg(256)->ArgName("MiB")->UseRealTime();

template <int Chains>
inline __attribute__((always_inline)) float multiply_add_chains(float x) {
    float chain[Chains];
    for (int k = 0; k < Chains; ++k)
        chain[k] = x + static_cast<float>(k);
    for (int step = 0; step < 4096; ++step)
        for (int k = 0; k < Chains; ++k)
            chain[k] = chain[k] * x + 0.5f;
    float sum = 0;
    for (int k = 0; k < Chains; ++k)
        sum += chain[k];
    return sum;
}

constexpr int plain_chains = 48, wide_chains = 96;  // enough to hide an addition's latency

float multiply_add_plain(float x) {
    return multiply_add_chains<plain_chains>(x);
}

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("avx2,fma"))) float multiply_add_avx2(float x) {
    return multiply_add_chains<wide_chains>(x);
}
#endif

void multiply_add(benchmark::State& state, float (*run)(float), int chains) {
    constexpr std::int64_t count = 256;
    std::vector<float> sums(count);
    float* out = sums.data();
    for (auto _ : state) {
        parallel_for(
            "multiply_add", count,
            [=](std::int64_t i) { out[i] = run(0.5f + 1e-6f * static_cast<float>(i)); }, 16);
        benchmark::ClobberMemory();
    }
    state.counters["flops"] =
        benchmark::Counter(static_cast<double>(state.iterations() * count * 4096 * 2 * chains),
                           benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(multiply_add, sse2, multiply_add_plain, plain_chains)->UseRealTime();
#if defined(__x86_64__) && defined(__GNUC__)
BENCHMARK_CAPTURE(multiply_add, avx2, multiply_add_avx2, wide_chains)->UseRealTime();
#endif

}  // namespace
}  // namespace item3d

BENCHMARK_MAIN();
