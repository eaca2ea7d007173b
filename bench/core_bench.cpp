// Benchmark of the machine's peak rates of copying, gathering and multiplying, on all OpenMP
// threads. docs/benchmarks.md compares the stages of the renderer with these rates.

#include "item3d/core/parallel.h"

#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

namespace item3d {
namespace {

constexpr std::int64_t block = 1 << 14;

/// Copies much more data than the caches hold. The reported bytes/s count reads and writes.
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

/// Gathers rows of four floats at random places of a table, as rendering gathers vertices and
/// texels if they lack locality. The reported items/s count rows.
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

constexpr int chains = 10;  // hide a multiply-add's latency and fit into 16 registers
constexpr int steps = 4096;

/// Performs chains * steps multiply-adds of a vector.
template <typename Vector>
inline __attribute__((always_inline)) float multiply_add_chains(float x) {
    const Vector factor = Vector{} + x, half = Vector{} + 0.5f;
    Vector chain[chains];
    for (int k = 0; k < chains; ++k)
        chain[k] = factor + static_cast<float>(k);
    for (int step = 0; step < steps; ++step)
#pragma GCC unroll 10
        for (int k = 0; k < chains; ++k)
            chain[k] = chain[k] * factor + half;
    float sum = 0;
    for (int k = 0; k < chains; ++k)
        sum += chain[k][0];
    return sum;
}

using Vector4 [[gnu::vector_size(16)]] = float;
float multiply_add_plain(float x) {
    return multiply_add_chains<Vector4>(x);
}

#if defined(__x86_64__)
using Vector8 [[gnu::vector_size(32)]] = float;
__attribute__((target("avx2,fma"))) float multiply_add_avx2(float x) {
    return multiply_add_chains<Vector8>(x);
}
#endif

void multiply_add(benchmark::State& state, float (*run)(float), int lanes) {
    constexpr std::int64_t count = 256;
    std::vector<float> sums(count);
    float* out = sums.data();
    for (auto _ : state) {
        parallel_for(
            "multiply_add", count,
            [=](std::int64_t i) { out[i] = run(0.5f + 1e-6f * static_cast<float>(i)); }, 16);
        benchmark::ClobberMemory();
    }
    state.counters["flops"] = benchmark::Counter(
        static_cast<double>(state.iterations() * count * steps * 2 * chains * lanes),
        benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(multiply_add, sse2, multiply_add_plain, 4)->UseRealTime();
#if defined(__x86_64__)
BENCHMARK_CAPTURE(multiply_add, avx2, multiply_add_avx2, 8)->UseRealTime();
#endif

}  // namespace
}  // namespace item3d

BENCHMARK_MAIN();
