#include "item3d/baselines/texel_list.h"

#include "item3d/core/error.h"
#include "item3d/field/surface_points.h"

#include <algorithm>
#include <utility>

namespace item3d {
namespace {

/// Width in texels of the padding around an island.
constexpr int padding = 4;

/// Copies texels to adjacent empty cells, `padding` times.
void pad(std::vector<std::int64_t>& cells, std::size_t first, int width, int height) {
    const auto place = [&](int x, int y) {
        return first + static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    };
    for (int layer = 0; layer < padding; ++layer) {
        std::vector<std::pair<std::size_t, std::int64_t>> found;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                if (cells[place(x, y)] >= 0) continue;
                for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
                    const std::int64_t other =
                        cells[place((x + dx + width) % width, (y + dy + height) % height)];
                    if (other < 0) continue;
                    found.emplace_back(place(x, y), other);
                    break;
                }
            }
        }
        for (const auto& [cell, texel] : found)
            cells[cell] = texel;
    }
}

at::Tensor wrapped_cell(const at::Tensor& cell, const at::Tensor& size, Wrap wrap) {
    if (wrap == Wrap::clamp_to_edge) return at::minimum(cell.clamp_min(0), size - 1);
    const at::Tensor twice = wrap == Wrap::mirrored_repeat ? 2 * size : size;
    const at::Tensor inside = ((cell % twice) + twice) % twice;
    return at::where(inside < size, inside, twice - 1 - inside);
}

/// Normalises planes [1, C + 1, H, W] to weight 1 everywhere. The last channel is the weight; the
/// input's other channels are values multiplied by it. Pixels of weight 0 are filled from coarser
/// levels; if all weights are 0, they stay 0.
at::Tensor push_down(const at::Tensor& planes) {
    const std::int64_t height = planes.size(2), width = planes.size(3);
    const at::Tensor weight = planes.slice(1, planes.size(1) - 1);
    const at::Tensor unit = planes / weight.clamp_min(1e-12) * (weight > 0);
    if (height == 1 && width == 1) return unit;
    const std::int64_t rows = height % 2, columns = width % 2;
    const at::Tensor even = at::constant_pad_nd(unit, {0, columns, 0, rows});
    const at::Tensor coarse = push_down(at::avg_pool2d(
        even, {std::min<std::int64_t>(2, even.size(2)), std::min<std::int64_t>(2, even.size(3))}));
    const at::Tensor finer =
        at::upsample_bilinear2d(coarse, {even.size(2), even.size(3)}, /*align_corners=*/false);
    return at::where(weight > 0, unit, finer.slice(2, 0, height).slice(3, 0, width));
}

}  // namespace

/// Texels of all texture sets during construction.
struct TexelList::Found {
    std::vector<std::int64_t> cells;      ///< texel of each cell
    std::vector<std::int64_t> own_cells;  ///< cell of each texel
    std::vector<std::int64_t> triangles;
    std::vector<float> barycentrics;
};

Geometry atlas_geometry(const Model& model, const Atlas& atlas, at::Device device) {
    if (atlas.primitives.empty()) return Geometry::from_model(model, device);
    Model remade = model;
    for (const auto& [index, edit] : atlas.primitives) {
        Primitive& primitive = remade.primitives[static_cast<std::size_t>(index)];
        primitive = apply(edit, primitive);
    }
    return Geometry::from_model(remade, device);
}

TexelList::TexelList(const Model& model, const Geometry& geometry, const Atlas& atlas,
                     int texture_size, int max_edge) {
    ITEM3D_CHECK(static_cast<std::int64_t>(atlas.triangles.size()) == geometry.triangles.size(0),
                 "atlas and geometry are of different models");
    Found found;
    for (const TextureSet& set : atlas.sets)
        add(model, atlas, set, texture_size, max_edge, found);
    const at::Device device = geometry.positions.device();
    std::vector<std::int64_t> grid_of(model.materials.size(), -1);
    for (std::size_t g = 0; g < grids_.size(); ++g)
        for (const int material : grids_[g].materials)
            grid_of[static_cast<std::size_t>(material)] = static_cast<std::int64_t>(g);
    grid_of_ = at::tensor(grid_of, at::kLong).to(device);
    texel_of_ = at::tensor(found.cells, at::kLong).to(device);
    cell_of_ = at::tensor(found.own_cells, at::kLong).to(device);
    triangle_ = at::tensor(found.triangles, at::kLong).to(device);
    barycentrics_ = at::tensor(found.barycentrics, at::kFloat).view({-1, 2}).to(device);
    surface_ = on(geometry);
}

Surface TexelList::on(const Geometry& geometry) const {
    return surface_at(geometry, triangle_, barycentrics_);
}

void TexelList::add(const Model& model, const Atlas& atlas, const TextureSet& set, int texture_size,
                    int max_edge, Found& found) {
    Grid grid;
    grid.materials = set.materials;
    const int material = set.materials.front();
    auto [width, height] = atlas_size(model, material, texture_size, !set.is_own());
    const double scale = std::min(1.0, static_cast<double>(max_edge) / std::max(width, height));
    grid.width = std::max(1, static_cast<int>(width * scale));
    grid.height = std::max(1, static_cast<int>(height * scale));
    grid.wrap = wrap_of(model, material);
    grid.first = static_cast<std::int64_t>(found.cells.size());
    std::vector<UvTriangle> corners;
    for (const std::int32_t t : set.triangles)
        corners.push_back(atlas.triangles[static_cast<std::size_t>(t)]);
    UvRaster raster = rasterize_uv(corners, grid.width, grid.height, grid.wrap);
    if (!set.shared.empty()) claim_texels(raster, corners);
    widen(raster);
    for (int y = 0; y < grid.height; ++y) {
        for (int x = 0; x < grid.width; ++x) {
            const std::int32_t t = raster.at(x, y);
            found.cells.push_back(t < 0 ? -1 : static_cast<std::int64_t>(found.triangles.size()));
            if (t < 0) continue;
            found.own_cells.push_back(static_cast<std::int64_t>(found.cells.size()) - 1);
            const Vec2 weights =
                uv_barycentrics(corners[static_cast<std::size_t>(t)], raster.uv_at(x, y));
            found.triangles.push_back(set.triangles[static_cast<std::size_t>(t)]);
            found.barycentrics.insert(found.barycentrics.end(), {weights.x, weights.y});
        }
    }
    pad(found.cells, static_cast<std::size_t>(grid.first), grid.width, grid.height);
    grids_.push_back(std::move(grid));
}

at::Tensor TexelList::has(const Surface& points) const {
    return grid_of_.index_select(0, points.material) >= 0;
}

at::Tensor TexelList::lookup(const at::Tensor& values, const Surface& points, bool nearest) const {
    at::Tensor result = at::zeros({points.count(), values.size(1)}, values.options());
    const at::Tensor grid_of = grid_of_.index_select(0, points.material);
    for (std::size_t g = 0; g < grids_.size(); ++g) {
        const Grid& grid = grids_[g];
        const at::Tensor rows = (grid_of == static_cast<std::int64_t>(g)).nonzero().select(1, 0);
        if (rows.numel() == 0) continue;
        const at::Tensor uv = points.uv.index_select(0, rows);
        const at::Tensor x = uv.select(1, 0) * grid.width - (nearest ? 0.0 : 0.5);
        const at::Tensor y = uv.select(1, 1) * grid.height - (nearest ? 0.0 : 0.5);
        const at::Tensor x0 = x.floor(), y0 = y.floor();
        const at::Tensor width = at::full({1}, grid.width, rows.options());
        const at::Tensor height = at::full({1}, grid.height, rows.options());
        at::Tensor sum = at::zeros({rows.size(0), values.size(1)}, values.options());
        at::Tensor weights = at::zeros({rows.size(0), 1}, values.options());
        for (int corner = 0; corner < (nearest ? 1 : 4); ++corner) {
            const int dx = corner % 2, dy = corner / 2;
            const at::Tensor cell =
                grid.first + wrapped_cell(y0.to(at::kLong) + dy, height, grid.wrap.v) * grid.width +
                wrapped_cell(x0.to(at::kLong) + dx, width, grid.wrap.u);
            const at::Tensor texel = texel_of_.index_select(0, cell);
            at::Tensor weight = (texel >= 0).to(values.scalar_type());
            if (!nearest) weight = weight * (1 - (x - x0 - dx).abs()) * (1 - (y - y0 - dy).abs());
            weight = weight.unsqueeze(1);
            sum = sum + weight * values.index_select(0, texel.clamp_min(0));
            weights = weights + weight;
        }
        result.index_copy_(0, rows, sum / weights.clamp_min(1e-12));
    }
    return result;
}

at::Tensor TexelList::spread(const at::Tensor& values, const at::Tensor& known) const {
    const at::Tensor weight = known.to(values.scalar_type()).unsqueeze(1);
    at::Tensor dense = at::zeros({texel_of_.size(0), values.size(1) + 1}, values.options());
    dense.index_copy_(0, cell_of_, at::cat({values * weight, weight}, 1));
    for (const Grid& grid : grids_) {
        at::Tensor cells = dense.narrow(0, grid.first, std::int64_t{grid.width} * grid.height);
        const at::Tensor planes =
            cells.t().reshape({1, values.size(1) + 1, grid.height, grid.width});
        cells.copy_(push_down(planes).flatten(2)[0].t());
    }
    return dense.index_select(0, cell_of_).slice(1, 0, values.size(1));
}

std::map<int, Image> TexelList::images(const at::Tensor& values) const {
    const at::Tensor dense =
        (values.index_select(0, texel_of_.clamp_min(0)) * (texel_of_ >= 0).unsqueeze(1))
            .cpu()
            .contiguous();
    std::map<int, Image> images;
    for (const Grid& grid : grids_) {
        Image image(grid.width, grid.height, 3);
        const float* from = dense.const_data_ptr<float>() + 3 * grid.first;
        std::copy(from, from + image.pixels.size(), image.pixels.begin());
        images[grid.materials.front()] = std::move(image);
    }
    return images;
}

}  // namespace item3d
