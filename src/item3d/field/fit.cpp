#include "item3d/field/fit.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/field/adam.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/srgb.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

namespace item3d {
namespace {

/// Adam's epsilon. The size of a step does not depend on the gradient's size unless the gradient is
/// below epsilon. With a smaller epsilon, the fit of a surface of one colour filled the hash table
/// with noise. The noise cancelled out until an edit changed the network; then white chairs got
/// grey speckles.
constexpr double negligible_gradient = 1e-6;

/// Number of steps before the hash table is trained. In these steps the network learns what the
/// whole surface has in common. Otherwise each table entry would learn a part of it, and the parts
/// would be unequal, since some entries are read more often than others.
constexpr int network_steps = 40;

/// Returns [8] weights of the encoded values' squared errors.
at::Tensor column_weights() {
    constexpr float base_color = 1.0f / 3, orm = 0.5f / 3, slope = 0.1f / 3;
    return at::tensor({base_color, base_color, base_color, orm, orm, orm, slope, slope});
}

/// Surface points for several steps, and the values that NeuralTexture::encoded() should have
/// there. The tensors carry no gradients.
struct Examples {
    at::Tensor positions;  ///< [steps, P, 3]
    at::Tensor values;     ///< [steps, P, 8]
};

Examples draw_examples(const SurfaceSampler& sampler, const FieldSpace& space,
                       const TexturedMaterials& materials, float steepest, std::int64_t steps,
                       std::int64_t points, Random& random) {
    const at::NoGradGuard no_grad;
    const Surface surface = sampler.sample(steps * points, random);
    const MaterialSample own = materials.sample(surface);
    at::Tensor slopes = at::zeros({steps * points, 2}, own.orm.options());
    if (own.normal.defined())
        slopes = (own.normal.narrow(1, 0, 2) / own.normal.narrow(1, 2, 1).clamp_min(1e-3f))
                     .clamp(-steepest, steepest);
    const at::Tensor values = at::cat(
        {linear_to_srgb(own.base_color.clamp(0.0f, 1.0f)), own.orm.clamp(0.0f, 1.0f), slopes}, 1);
    // The samples follow the order of the triangles. Each step takes every `steps`-th sample, and
    // so covers the whole surface.
    const auto deal = [&](const at::Tensor& rows) {
        return rows.reshape({points, steps, -1}).transpose(0, 1).contiguous();
    };
    return {deal(space.positions(surface)), deal(values)};
}

double psnr(const at::Tensor& difference) {
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
    // This assumes that texels are evenly distributed and that half of the atlas is used, which is
    // typical.
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
    Random random(options.seed, RandomStream::fit);
    Adam adam;
    AdamOptions adam_options;
    adam_options.epsilon = negligible_gradient;
    adam.add_group("table", {field->table()}, adam_options);
    adam.add_group("network", field->network_parameters(), adam_options);
    const int alone = std::min(network_steps, options.steps), steps = alone + options.steps;
    std::optional<Progress> progress;
    if (options.show_progress) progress.emplace("fit", steps);
    const float steepest = field->options().ranges.normal_slope;
    const at::Tensor weights = column_weights().to(field->table().device());
    Examples drawn;
    for (int step = 0; step < steps; ++step) {
        // The points of many steps are drawn at once, because drawing the points of one step takes
        // as long.
        constexpr int steps_drawn = 16;
        const int place = step % steps_drawn;
        if (place == 0)
            drawn = draw_examples(sampler, space, materials, steepest,
                                  std::min(steps_drawn, steps - step), options.batch, random);
        const at::Tensor difference = field->encoded(drawn.positions[place]) - drawn.values[place];
        adam.zero_grad();
        (difference.square() * weights).sum().div(double(options.batch)).backward();
        if (step < alone) field->table().mutable_grad() = at::Tensor();
        // The rate falls along a cosine to a hundredth. The last, small steps average out the noise
        // of the batches.
        const double part = static_cast<double>(std::max(0, step - alone)) / options.steps;
        const double decay = 0.01 + 0.99 * 0.5 * (1.0 + std::cos(3.14159265358979 * part));
        adam.options("table").learning_rate = options.table_learning_rate * decay;
        adam.options("network").learning_rate = options.network_learning_rate * decay;
        adam.step();
        if (progress) progress->update(step + 1);
        if (interrupted()) throw Interrupted("while fitting the neural texture");
    }
    adam.zero_grad();
    progress.reset();

    const at::NoGradGuard no_grad;
    const Examples fresh = draw_examples(sampler, space, materials, steepest, 1, 32768, random);
    const at::Tensor difference = field->encoded(fresh.positions[0]) - fresh.values[0];
    FitResult result;
    result.base_color_psnr = psnr(difference.narrow(1, 0, 3));
    result.orm_psnr = psnr(difference.narrow(1, 3, 3));
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
}

void shift_mean(NeuralTexture& field, const Geometry& geometry, const FieldSpace& space,
                OrmChannel channel, float mean) {
    constexpr float max_variation = 0.5f;  // standard deviation before the activation
    const at::NoGradGuard no_grad;
    Random random(0, RandomStream::metallic);
    const at::Tensor positions =
        space.positions(SurfaceSampler(geometry, space).sample(4096, random));
    at::Tensor bias = field->output_bias(channel);
    at::Tensor weights = field->output_weights(channel);
    const auto values = [&] {
        return field->forward(positions).orm.select(1, static_cast<std::int64_t>(channel));
    };
    /// Sets the bias so that the mean becomes `wanted`.
    const auto solve = [&](float wanted) {
        // Values increase with the bias. Beyond these bounds the sigmoid is flat.
        float low = -32.0f, high = 32.0f;
        for (int step = 0; step < 26; ++step) {
            const float middle = 0.5f * (low + high);
            bias.fill_(middle);
            (values().mean().item<float>() < wanted ? low : high) = middle;
        }
    };
    // The variation is measured at the middle of the range, where the activation is steep.
    solve(0.5f);
    const at::Tensor shown = values().clamp(1e-4f, 1.0f - 1e-4f);
    const float variation = (shown / (1.0f - shown)).log().std().item<float>();
    if (variation > max_variation) weights.mul_(max_variation / variation);
    solve(mean);
}

}  // namespace item3d
