#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/render/checks.h"
#include "item3d/render/kernels/texture.h"
#include "item3d/render/textured.h"

#include <torch/csrc/autograd/custom_function.h>

namespace item3d {
namespace {

using kernels::TextureParameters;
using kernels::TextureWrap;
using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

TextureWrap kernel_wrap(Wrap wrap) {
    switch (wrap) {
        case Wrap::mirrored_repeat:
            return TextureWrap::mirrored_repeat;
        case Wrap::clamp_to_edge:
            return TextureWrap::clamp_to_edge;
        default:
            return TextureWrap::repeat;
    }
}

TextureParameters texture_parameters(const torch::Tensor& texture, const torch::Tensor& uv,
                                     std::int64_t wrap_u, std::int64_t wrap_v) {
    return {texture.const_data_ptr<float>(),   uv.const_data_ptr<float>(),
            static_cast<int>(texture.size(0)), static_cast<int>(texture.size(1)),
            static_cast<int>(texture.size(2)), static_cast<TextureWrap>(wrap_u),
            static_cast<TextureWrap>(wrap_v)};
}

struct SampleTexture : torch::autograd::Function<SampleTexture> {
    static torch::Tensor forward(AutogradContext* context, const torch::Tensor& texture,
                                 const torch::Tensor& uv, std::int64_t wrap_u,
                                 std::int64_t wrap_v) {
        torch::Tensor values = torch::empty({uv.size(0), texture.size(2)}, torch::kFloat32);
        float* out = values.data_ptr<float>();
        const TextureParameters p = texture_parameters(texture, uv, wrap_u, wrap_v);
        parallel_for(
            "sample_texture", uv.size(0),
            [=](std::int64_t i) { kernels::texture_forward(p, i, out); }, 8192);
        context->save_for_backward({texture, uv});
        context->saved_data["wrap_u"] = wrap_u;
        context->saved_data["wrap_v"] = wrap_v;
        return values;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const auto saved = context->get_saved_variables();
        const TextureParameters p =
            texture_parameters(saved[0], saved[1], context->saved_data["wrap_u"].toInt(),
                               context->saved_data["wrap_v"].toInt());
        const torch::Tensor gradient = gradients[0].contiguous();
        torch::Tensor by_texture = torch::zeros_like(saved[0]);
        const float* in = gradient.const_data_ptr<float>();
        float* out = by_texture.data_ptr<float>();
        // One thread, for the same bytes again; buffers of many threads would cost more to sum.
        for (std::int64_t i = 0; i < saved[1].size(0); ++i)
            kernels::texture_backward(p, i, in, out);
        return {by_texture, torch::Tensor(), torch::Tensor(), torch::Tensor()};
    }
};

}  // namespace

torch::Tensor sample_texture(const torch::Tensor& texture_, const torch::Tensor& uv_, Wrap wrap_u,
                             Wrap wrap_v) {
    const torch::Tensor texture =
        checked("sample_texture", "texture", texture_, torch::kFloat32, {-1, -1, -1});
    const torch::Tensor uv =
        checked("sample_texture", "uv", uv_.detach(), torch::kFloat32, {-1, 2});
    ITEM3D_CHECK(texture.numel() > 0, "sample_texture: a texture with texels");
    return SampleTexture::apply(texture, uv, static_cast<std::int64_t>(kernel_wrap(wrap_u)),
                                static_cast<std::int64_t>(kernel_wrap(wrap_v)));
}

}  // namespace item3d
