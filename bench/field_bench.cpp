// Benchmark of the neural texture in one iteration of an edit: lookup, gradient and optimizer step.
// The arguments are the number of surface points, and the levels and features of the hash grid. The
// points lie on a sphere, in an order as coherent as that of an image's pixels.
#include "item3d/field/adam.h"
#include "item3d/field/neural_texture.h"
#include "item3d/tensors/tensor.h"

#include <benchmark/benchmark.h>

namespace item3d {
namespace {

at::Tensor sphere_points(std::int64_t count) {
    const at::Tensor i = at::arange(count).to(at::kFloat);
    const at::Tensor y = 1.0f - 2.0f * (i + 0.5f) / static_cast<float>(count);
    const at::Tensor r = at::sqrt(1.0f - y * y);
    const at::Tensor angle = i * 0.05f;
    return at::stack({r * at::cos(angle), y, r * at::sin(angle)}, 1).contiguous();
}

NeuralTextureOptions shape(std::int64_t levels, std::int64_t features) {
    NeuralTextureOptions options;
    options.levels = static_cast<int>(levels);
    options.features = static_cast<int>(features);
    return options;
}

void encode_forward(benchmark::State& state) {
    const at::NoGradGuard no_grad;
    const NeuralTextureOptions options = shape(state.range(1), state.range(2));
    const HashGrid grid = HashGrid::make(options.levels, options.features, options.log2_table_size,
                                         options.base_resolution, options.finest_resolution);
    const at::Tensor points = sphere_points(state.range(0)) * 0.5f + 0.5f;
    const at::Tensor table = at::rand({grid.entries(), grid.features});
    for (auto _ : state)
        benchmark::DoNotOptimize(encode(grid, points, table));
}

void encode_backward(benchmark::State& state) {
    const NeuralTextureOptions options = shape(state.range(1), state.range(2));
    const HashGrid grid = HashGrid::make(options.levels, options.features, options.log2_table_size,
                                         options.base_resolution, options.finest_resolution);
    const at::Tensor points = sphere_points(state.range(0)) * 0.5f + 0.5f;
    at::Tensor table = at::rand({grid.entries(), grid.features}).set_requires_grad(true);
    const at::Tensor seed = at::rand({state.range(0), grid.output_width()});
    for (auto _ : state) {
        state.PauseTiming();
        table.mutable_grad() = at::Tensor();
        const at::Tensor out = encode(grid, points, table);
        state.ResumeTiming();
        out.backward(seed);
    }
}

/// Times forward pass, backward pass and optimizer step of the neural texture.
void field_iteration(benchmark::State& state) {
    NeuralTexture field(shape(state.range(1), state.range(2)));
    Adam adam;
    adam.add_group("table", {field->table()}, {});
    adam.add_group("network", field->network_parameters(), {});
    const at::Tensor points = sphere_points(state.range(0));
    for (auto _ : state) {
        adam.zero_grad();
        const MaterialSample sample = field->forward(points);
        (sample.base_color.square().mean() + sample.orm.square().mean()).backward();
        adam.step();
    }
}

void adam_step(benchmark::State& state) {
    NeuralTexture field(shape(state.range(1), state.range(2)));
    Adam adam;
    adam.add_group("table", {field->table()}, {});
    field->forward(sphere_points(state.range(0))).base_color.sum().backward();
    for (auto _ : state)
        adam.step();
}

void sizes(benchmark::internal::Benchmark* benchmark) {
    for (const int count : {1500, 6000, 20000}) {
        benchmark->Args({count, 6, 4});
        benchmark->Args({count, 16, 2});
    }
    benchmark->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(encode_forward)->Apply(sizes);
BENCHMARK(encode_backward)->Apply(sizes);
BENCHMARK(adam_step)->Apply(sizes);
BENCHMARK(field_iteration)->Apply(sizes);

}  // namespace
}  // namespace item3d
