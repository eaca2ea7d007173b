#include "item3d/region/masks.h"

#include "item3d/field/bake/bake.h"
#include "item3d/field/bake/fill.h"

#include <algorithm>

namespace item3d {
namespace {

constexpr int rows_at_once = 32;

Image mask_of(const Region& region, const Model& model, const Geometry& geometry,
              const Atlas& atlas, const TextureSet& set, int texture_size) {
    const int material = set.materials.front();
    const auto [width, height] = atlas_size(model, material, texture_size);
    std::vector<UvTriangle> triangles;
    for (const std::int32_t t : set.triangles)
        triangles.push_back(atlas.triangles[static_cast<std::size_t>(t)]);
    UvRaster raster = rasterize_uv(triangles, width, height, wrap_of(model, material));
    if (!set.shared.empty()) claim_texels(raster, triangles);
    widen(raster);
    Image mask(width, height, 1);
    std::vector<std::uint8_t> covered;
    for (const UvOwner& owner : raster.owners)
        covered.push_back(owner.triangle >= 0 ? 1 : 0);
    for (int first = 0; first < height; first += rows_at_once) {
        std::vector<std::int64_t> triangle, texel;
        std::vector<float> barycentrics;
        for (int y = first; y < std::min(height, first + rows_at_once); ++y) {
            for (int x = 0; x < width; ++x) {
                const std::int32_t t = raster.at(x, y);
                if (t < 0) continue;
                const auto index = static_cast<std::size_t>(t);
                const Vec2 weights = uv_barycentrics(triangles[index], raster.uv_at(x, y));
                triangle.push_back(set.triangles[index]);
                texel.push_back(static_cast<std::int64_t>(y) * width + x);
                barycentrics.insert(barycentrics.end(), {weights.x, weights.y});
            }
        }
        if (triangle.empty()) continue;
        const at::Device device = geometry.positions.device();
        const Surface surface =
            surface_at(geometry, at::tensor(triangle, at::kLong).to(device),
                       at::tensor(barycentrics, at::kFloat).view({-1, 2}).to(device));
        const at::Tensor weights = region.weight(surface).cpu().contiguous();
        for (std::size_t i = 0; i < texel.size(); ++i)
            mask.pixels[static_cast<std::size_t>(texel[i])] = weights.const_data_ptr<float>()[i];
    }
    continue_weights(mask, covered, texture_padding);
    return mask;
}

}  // namespace

std::map<int, Image> region_masks(const Region& region, const Model& model,
                                  const Geometry& geometry, const Atlas& atlas, int texture_size) {
    const at::NoGradGuard no_grad;
    std::map<int, Image> masks;
    for (const TextureSet& set : atlas.sets)
        if (set.is_own())
            masks[set.materials.front()] =
                mask_of(region, model, geometry, atlas, set, texture_size);
    return masks;
}

}  // namespace item3d
