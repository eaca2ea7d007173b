// Texture lookups and mip levels.
#include "item3d/render/cuda/entries.h"
#include "item3d/render/cuda/launch.h"

namespace item3d::cuda {

int texture(const TextureLaunchParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "sample_texture", count,
        [=] __device__(std::int64_t i) { kernels::texture_forward(p.texture, i, p.values); },
        stream);
}

int texture_backward(const TextureLaunchParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "sample_texture backward", count,
        [=] __device__(std::int64_t i) {
            kernels::texture_backward(p.texture, i, p.value_gradient, p.texel_gradient);
        },
        stream);
}

int texture_uv_backward(const TextureLaunchParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "sample_texture by uv", count,
        [=] __device__(std::int64_t i) {
            kernels::texture_uv_backward(p.texture, i, p.value_gradient, p.uv_gradient);
        },
        stream);
}

int halve_texture(const kernels::HalveParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "halve_texture", count, [=] __device__(std::int64_t i) { kernels::halve_texture(p, i); },
        stream);
}

int halve_texture_backward(const kernels::HalveParameters& p, std::int64_t count, Stream stream) {
    return launch(
        "halve_texture backward", count,
        [=] __device__(std::int64_t i) { kernels::halve_texture_backward(p, i); }, stream);
}

}  // namespace item3d::cuda
