#include "item3d/lighting/optimized/directions.h"

#include "item3d/lighting/environment.h"
#include "item3d/render/kernels/cube.h"

namespace item3d {
namespace {

void store(float*& out, const Vec3& direction) {
    for (int c = 0; c < 3; ++c)
        *out++ = direction[c];
}

}  // namespace

at::Tensor cube_directions(int size) {
    at::Tensor directions = at::empty({6, size, size, 3});
    float* out = directions.data_ptr<float>();
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                store(out,
                      glm::normalize(kernels::cube_direction(face, kernels::texel_centre(x, size),
                                                             kernels::texel_centre(y, size))));
    return directions;
}

at::Tensor map_directions(int height) {
    const int width = 2 * height;
    at::Tensor directions = at::empty({height, width, 3});
    float* out = directions.data_ptr<float>();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            store(out, equirectangular_direction((static_cast<float>(x) + 0.5f) / width,
                                                 (static_cast<float>(y) + 0.5f) / height));
    return directions;
}

}  // namespace item3d
