// Split-sum approximation, summed over every texel instead of looked up in prefiltered levels.
#include "bench/reference_split_sum.h"

#include "item3d/core/parallel.h"
#include "item3d/lighting/environment.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/kernels/shade.h"
#include "item3d/render/prefilter/bsdf_table.h"

#include <algorithm>
#include <cmath>

namespace item3d::reference {

ExactSplitSum::ExactSplitSum(const Image& map, int finer) : map_(map) {
    const at::Tensor pixels = to_tensor(map);
    const auto source = pixels.accessor<float, 3>();
    const int height = map.height * finer, width = map.width * finer;
    for (int y = 0; y < height; ++y) {
        const auto angle = static_cast<float>(texel_solid_angle(y, height));
        const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
        const float row = std::clamp(v * static_cast<float>(map.height) - 0.5f, 0.0f,
                                     static_cast<float>(map.height - 1));
        const int y0 = static_cast<int>(row), y1 = std::min(y0 + 1, map.height - 1);
        for (int x = 0; x < width; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width);
            const float column = u * static_cast<float>(map.width) - 0.5f;
            const float left = std::floor(column);
            const int x0 = (static_cast<int>(left) + map.width) % map.width;
            const int x1 = (x0 + 1) % map.width;
            const float fx = column - left, fy = row - static_cast<float>(y0);
            Vec3 radiance;
            for (int c = 0; c < 3; ++c)
                radiance[c] = (1 - fy) * ((1 - fx) * source[y0][x0][c] + fx * source[y0][x1][c]) +
                              fy * ((1 - fx) * source[y1][x0][c] + fx * source[y1][x1][c]);
            direction_.push_back(equirectangular_direction(u, v));
            flux_.push_back(radiance * angle);
            solid_angle_.push_back(angle);
        }
    }
}

Vec3 ExactSplitSum::prefiltered(Vec3 direction, float roughness) const {
    const float alpha2 = std::pow(roughness, 4.0f);
    double sum[3] = {0, 0, 0}, norm = 0;
    for (std::size_t i = 0; i < direction_.size(); ++i) {
        const float cosine = glm::dot(direction, direction_[i]);
        if (cosine <= 0) continue;
        const float d = 0.5f * (1 + cosine) * (alpha2 - 1) + 1;  // (n.h)^2 = (1 + n.l) / 2
        const float weight = cosine / (d * d);
        for (int c = 0; c < 3; ++c)
            sum[c] += static_cast<double>(weight) * flux_[i][c];
        norm += static_cast<double>(weight) * solid_angle_[i];
    }
    return Vec3(sum[0] / norm, sum[1] / norm, sum[2] / norm);
}

at::Tensor ExactSplitSum::radiance(const std::vector<Vec3>& normals, const std::vector<Vec3>& views,
                                   const std::vector<Vec3>& base_colors, float metallic,
                                   float roughness) const {
    const at::Tensor table = bsdf_table();
    const auto table_size = static_cast<int>(table.size(0));
    at::Tensor out = at::empty({static_cast<std::int64_t>(normals.size()), 3});
    auto* values = out.data_ptr<float>();
    parallel_for(
        "exact_split_sum", out.size(0),
        [&](std::int64_t i) {
            const auto index = static_cast<std::size_t>(i);
            const Vec3 n = normals[index], v = views[index], base_color = base_colors[index];
            const float cosine = glm::dot(n, v);
            const kernels::BsdfValue bsdf = kernels::bsdf_lookup(
                table.const_data_ptr<float>(), table_size, std::max(cosine, 0.0f), roughness);
            const Vec3 f0 = Vec3(kernels::dielectric_f0 * (1 - metallic)) + metallic * base_color;
            const Vec3 specular = prefiltered(glm::normalize(2 * cosine * n - v), roughness) *
                                  (f0 * bsdf.scale + Vec3(bsdf.bias));
            const Vec3 radiance =
                specular + (1 - metallic) * base_color * irradiance_over_pi(map_, n);
            for (int c = 0; c < 3; ++c)
                values[3 * i + c] = radiance[c];
        },
        1);
    return out;
}

}  // namespace item3d::reference
