#include "item3d/field/fit.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/field/adam.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

namespace item3d {
namespace {

constexpr float orm_weight = 0.5f;
constexpr float normal_weight = 0.1f;

/// What the field should return, in the space of the loss. Constants.
struct Target {
    torch::Tensor base_color;  ///< [P, 3] sRGB-encoded
    torch::Tensor orm;         ///< [P, 3]
    torch::Tensor normal;      ///< [P, 3]
};

Target make_target(const Surface& surface, const TexturedMaterials& materials) {
    const torch::NoGradGuard no_grad;
    const MaterialSample own = materials.sample(surface);
    Target target;
    target.base_color = linear_to_srgb(own.base_color.clamp(0.0f, 1.0f));
    target.orm = own.orm.clamp(0.0f, 1.0f);
    target.normal =
        own.normal.defined()
            ? own.normal
            : torch::tensor({0.0f, 0.0f, 1.0f}, own.base_color.options()).expand_as(own.base_color);
    return target;
}

double psnr(const torch::Tensor& difference) {
    return -10.0 * std::log10(std::max(1e-12, difference.square().mean().item<double>()));
}

}  // namespace

NeuralTextureOptions suggest_field_options(const Geometry& geometry, const FieldSpace& space,
                                           int texture_size, std::uint64_t seed) {
    NeuralTextureOptions options;
    options.seed = seed;
    options.bounds = space.bounds();
    const Vec3 size = options.bounds[1] - options.bounds[0];
    const float extent = std::max({size.x, size.y, size.z, 1e-20f});
    for (Vec3& corner : options.bounds) {
        corner += (&corner == &options.bounds[0] ? -0.001f : 0.001f) * extent;
    }
    // Texels cover the surface evenly at best; half of an atlas is used, typically.
    const double texels = 0.5 * texture_size * texture_size;
    const double texel_edge = std::sqrt(SurfaceSampler(geometry, space).area() / texels);
    options.finest_resolution =
        std::clamp(static_cast<int>(std::lround(extent / texel_edge)), 64, 1024);
    return options;
}

FitResult fit_to_materials(NeuralTexture& field, const Geometry& geometry, const FieldSpace& space,
                           const TexturedMaterials& materials, const FitOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    const SurfaceSampler sampler(geometry, space);
    Random random(options.seed, 0x666974);
    Adam adam;
    const std::size_t table =
        adam.add_group({field->table()},
                       {.learning_rate = options.table_learning_rate, .beta1 = 0.9, .beta2 = 0.99});
    const std::size_t network = adam.add_group(
        field->network_parameters(),
        {.learning_rate = options.network_learning_rate, .beta1 = 0.9, .beta2 = 0.99});
    std::optional<Progress> progress;
    if (options.show_progress) progress.emplace("fit", options.steps);
    for (int step = 0; step < options.steps; ++step) {
        const Surface surface = sampler.sample(options.batch, random);
        const Target target = make_target(surface, materials);
        const MaterialSample sample = field->forward(space.positions(surface));
        const torch::Tensor loss =
            (linear_to_srgb(sample.base_color) - target.base_color).square().mean() +
            orm_weight * (sample.orm - target.orm).square().mean() +
            normal_weight * (sample.normal - target.normal).square().mean();
        adam.zero_grad();
        loss.backward();
        // A cosine from the full rate to a hundredth: the last steps average out the batches'
        // noise.
        const double decay =
            0.01 + 0.99 * 0.5 * (1.0 + std::cos(3.14159265358979 * step / options.steps));
        adam.options(table).learning_rate = options.table_learning_rate * decay;
        adam.options(network).learning_rate = options.network_learning_rate * decay;
        adam.step();
        if (progress) progress->update(step + 1);
        if (interrupted()) throw Interrupted("interrupted while the neural texture was fitted");
    }
    adam.zero_grad();
    progress.reset();

    const torch::NoGradGuard no_grad;
    const Surface surface = sampler.sample(32768, random);
    const Target target = make_target(surface, materials);
    const MaterialSample sample = field->forward(space.positions(surface));
    FitResult result;
    result.base_color_psnr = psnr(linear_to_srgb(sample.base_color) - target.base_color);
    result.orm_psnr = psnr(sample.orm - target.orm);
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
}

void shift_metallic(NeuralTexture& field, const Geometry& geometry, const FieldSpace& space,
                    float mean) {
    const torch::NoGradGuard no_grad;
    Random random(0, 0x6d6574616c);
    const torch::Tensor positions =
        space.positions(SurfaceSampler(geometry, space).sample(4096, random));
    torch::Tensor bias = field->metallic_bias();
    const float start = bias.item<float>();
    // Metallic rises with the bias; a sigmoid is flat beyond these.
    float low = start - 16.0f;
    float high = start + 16.0f;
    for (int step = 0; step < 24; ++step) {
        const float middle = 0.5f * (low + high);
        bias.fill_(middle);
        const float reached = field->forward(positions).orm.select(1, 2).mean().item<float>();
        (reached < mean ? low : high) = middle;
    }
}

}  // namespace item3d
