#include "item3d/render/antialias.h"

#include "item3d/core/error.h"
#include "item3d/render/checks.h"
#include "item3d/render/crossings.h"
#include "item3d/render/cuda/module.h"
#include "item3d/render/kernels/antialias.h"
#include "item3d/render/topology.h"

#include <torch/csrc/autograd/custom_function.h>

#include <cstring>

namespace item3d {
namespace {

using kernels::AntialiasParameters;
using kernels::Crossing;
using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

struct AntialiasInput {
    at::Tensor triangles, neighbours, triangle, depth;
};

AntialiasParameters antialias_parameters(const AntialiasInput& input,
                                         const at::Tensor& positions_clip) {
    return {positions_clip.const_data_ptr<float>(),
            input.triangles.const_data_ptr<std::int32_t>(),
            input.neighbours.const_data_ptr<std::int32_t>(),
            input.triangle.const_data_ptr<std::int32_t>(),
            input.depth.const_data_ptr<float>(),
            positions_clip.size(1),
            static_cast<int>(input.triangle.size(2)),
            static_cast<int>(input.triangle.size(1))};
}

/// Returns all silhouette crossings in the order of their pixels, as a tensor of Crossing's bytes.
at::Tensor find_crossings(const AntialiasParameters& p, std::int64_t views) {
    const std::vector<std::vector<Crossing>> by_row = list_crossings(p, views);
    std::size_t count = 0;
    for (const auto& row : by_row)
        count += row.size();
    at::Tensor bytes = at::empty({static_cast<std::int64_t>(count * sizeof(Crossing))}, at::kByte);
    std::uint8_t* out = bytes.data_ptr<std::uint8_t>();
    for (const auto& row : by_row) {
        if (row.empty()) continue;
        std::memcpy(out, row.data(), row.size() * sizeof(Crossing));
        out += row.size() * sizeof(Crossing);
    }
    return bytes;
}

template <typename F>
void for_each_crossing(const at::Tensor& bytes, const F& f) {
    const std::uint8_t* in = bytes.const_data_ptr<std::uint8_t>();
    Crossing crossing;
    for (std::int64_t offset = 0; offset < bytes.numel();
         offset += static_cast<std::int64_t>(sizeof(Crossing))) {
        std::memcpy(&crossing, in + offset, sizeof(Crossing));
        f(crossing);
    }
}

/// Blends on a CUDA device: each thread computes one pixel of the result.
at::Tensor blend_on_cuda(const AntialiasParameters& raster, const at::Tensor& image) {
    at::Tensor result = at::empty_like(image);
    kernels::BlendParameters p{};
    p.raster = raster;
    p.image = image.const_data_ptr<float>();
    p.channels = image.size(3);
    p.blended = result.data_ptr<float>();
    cuda::run(cuda::render_table().antialias, p,
              image.numel() / std::max<std::int64_t>(1, p.channels), image.device());
    return result;
}

/// Computes the gradients on a CUDA device. clip: positions_clip, or an undefined tensor if its
/// gradient is not needed.
tensor_list blend_backward_on_cuda(const AntialiasParameters& raster, const at::Tensor& image,
                                   const at::Tensor& gradient, const at::Tensor& clip) {
    at::Tensor by_image = at::empty_like(image);
    kernels::BlendParameters p{};
    p.raster = raster;
    p.image = image.const_data_ptr<float>();
    p.channels = image.size(3);
    p.gradient = gradient.const_data_ptr<float>();
    p.image_gradient = by_image.data_ptr<float>();
    const std::int64_t pixels = image.numel() / std::max<std::int64_t>(1, p.channels);
    const auto launch = [&](const Accumulator& sums) {
        p.clip_gradient = sums;
        cuda::run(cuda::render_table().antialias_backward, p, pixels, image.device());
    };
    if (!clip.defined()) {
        launch({});
        return {by_image, at::Tensor(), at::Tensor()};
    }
    const at::Tensor sums = cuda::sum_on_device(clip.numel(), 2 * pixels, image.device(), launch);
    return {by_image, sums.view(clip.sizes()), at::Tensor()};
}

/// Antialiasing as an autograd function. On the CPU, all threads find the crossings, but one thread
/// blends their pixel pairs: a pixel belongs to several pairs, and a fixed order makes its sum
/// reproducible.
struct Antialias : torch::autograd::Function<Antialias> {
    static at::Tensor forward(AutogradContext* context, const at::Tensor& image,
                              const at::Tensor& positions_clip, const AntialiasInput& input) {
        const AntialiasParameters p = antialias_parameters(input, positions_clip);
        if (image.is_cuda()) {
            context->save_for_backward({image, positions_clip, input.triangles, input.neighbours,
                                        input.triangle, input.depth});
            return blend_on_cuda(p, image);
        }
        const at::Tensor crossings = find_crossings(p, image.size(0));
        at::Tensor result = image.clone();
        const std::int64_t channels = image.size(3);
        const float* in = image.const_data_ptr<float>();
        float* out = result.data_ptr<float>();
        for_each_crossing(crossings, [&](const Crossing& crossing) {
            kernels::blend_crossing(crossing, in, channels, out);
        });
        context->save_for_backward({image, positions_clip, input.triangles, input.neighbours,
                                    input.triangle, input.depth, crossings});
        return result;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const auto saved = context->get_saved_variables();
        const at::Tensor gradient = gradients[0].contiguous();
        const at::Tensor& image = saved[0];
        const AntialiasParameters p =
            antialias_parameters({saved[2], saved[3], saved[4], saved[5]}, saved[1]);
        if (image.is_cuda())
            return blend_backward_on_cuda(p, image, gradient,
                                          context->needs_input_grad(1) ? saved[1] : at::Tensor());
        const std::int64_t channels = image.size(3);
        const float* in = image.const_data_ptr<float>();
        const float* by_out = gradient.const_data_ptr<float>();
        at::Tensor by_image = gradient.clone(), by_clip;
        float* by_in = by_image.data_ptr<float>();
        Accumulator clip_gradient;
        if (context->needs_input_grad(1)) {
            by_clip = at::zeros_like(saved[1]);
            clip_gradient.values = by_clip.data_ptr<float>();
        }
        for_each_crossing(saved[6], [&](const Crossing& crossing) {
            kernels::blend_crossing_backward(p, crossing, in, by_out, channels, by_in,
                                             clip_gradient);
        });
        return {by_image, by_clip, at::Tensor()};
    }
};

}  // namespace

at::Tensor antialias(const at::Tensor& image_, const Raster& raster, const Geometry& geometry) {
    constexpr const char* op = "antialias";
    const at::Device device = operation_device(op, image_);
    const std::int64_t views = raster.views(), height = raster.height(), width = raster.width();
    const at::Tensor image =
        checked(op, "image", image_, at::kFloat, {views, height, width, -1}, device);
    const at::Tensor positions_clip =
        checked(op, "raster.positions_clip", raster.positions_clip, at::kFloat,
                {views, geometry.positions.size(0), 4}, device);
    AntialiasInput input;
    input.triangles = checked(op, "triangles", geometry.triangles, at::kInt, {-1, 3}, device);
    input.neighbours = checked(
        op, "neighbours",
        geometry.neighbours.defined()
            ? geometry.neighbours
            : triangle_neighbours(geometry.positions.cpu(), geometry.triangles.cpu()).to(device),
        at::kInt, {input.triangles.size(0), 3}, device);
    input.triangle =
        checked(op, "raster.triangle", raster.triangle, at::kInt, {views, height, width}, device);
    input.depth =
        checked(op, "raster.depth", raster.depth, at::kFloat, {views, height, width}, device);
    return Antialias::apply(image, positions_clip, input);
}

}  // namespace item3d
