// A light in the form of glTF's image-based lights: spherical harmonics of its irradiance, and a
// chain of levels for rising roughness. The levels are looked up in the chain of prefilter(), with
// the cubic interpolation between lobes of kernels/shade.h.
//
//     level 0: the light itself, size x size      level k: size / 2^k, roughness k / 4
//     an image  [size, 6 size, 3]: the six faces side by side, in glTF's orientation
#include "item3d/render/prefilter/image_based_light.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/prefilter/environment_light.h"
#include "item3d/render/prefilter/equirectangular.h"
#include "item3d/render/prefilter/specular_chain.h"

#include <functional>

namespace item3d {
namespace {

constexpr int level_count = 5;

Image draw_faces(int size, const std::function<Vec3(Vec3)>& radiance) {
    Image row(6 * size, size, 3);
    parallel_for("faces", row.height, [&](std::int64_t y) {
        const float t = kernels::texel_centre(static_cast<int>(y), size);
        for (int x = 0; x < row.width; ++x) {
            const CubeFaceAxes& axes = gltf_face_axes[static_cast<std::size_t>(x / size)];
            const float s = kernels::texel_centre(x % size, size);
            const Vec3 value =
                radiance(glm::normalize(axes.forward + s * axes.right - t * axes.up));
            for (int c = 0; c < 3; ++c)
                row.at(x, static_cast<int>(y), c) = value[c];
        }
    });
    return row;
}

}  // namespace

ImageBasedLight make_image_based_light(const Image& light, int size) {
    ITEM3D_CHECK(size >= 256 && size <= 1024, "an image-based light has faces of 256 to 1024");
    const at::NoGradGuard no_grad;
    const at::Tensor cube = equirectangular_to_cube(to_tensor(light), size).contiguous();
    const EnvironmentLight prefiltered = prefilter(cube);
    kernels::ShadeParameters chain{};
    set_specular_chain(chain,
                       specular_levels_of(prefiltered.specular, prefiltered.roughness.data()));
    const auto look_up = [](const float* map, int map_size, Vec3 direction) {
        return kernels::cube_value(map,
                                   kernels::cube_taps(kernels::cube_point(direction), map_size));
    };
    ImageBasedLight result;
    result.irradiance = irradiance_harmonics(light);
    result.specular.push_back(draw_faces(size, [&](Vec3 direction) {
        return look_up(cube.const_data_ptr<float>(), size, direction);
    }));
    for (int level = 1; level < level_count; ++level) {
        const float roughness = static_cast<float>(level) / (level_count - 1);
        const kernels::SpecularLevels between = kernels::specular_levels(chain, roughness);
        result.specular.push_back(draw_faces(size >> level, [&](Vec3 direction) {
            Vec3 radiance(0.0f);
            for (int i = 0; i < 4; ++i) {
                const int lobe = between.first + i;
                radiance += between.weight[i] *
                            look_up(chain.specular[lobe], chain.specular_size[lobe], direction);
            }
            return radiance;
        }));
    }
    return result;
}

}  // namespace item3d
