#include "item3d/field/bake/texel_values.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/tensors/workers.h"

#include <ATen/Parallel.h>

#include <algorithm>
#include <mutex>

namespace item3d {
namespace {

constexpr int packed_width = 10;
constexpr int samples_at_once = 16384;

/// Returns [P, 3, 3] with rows tangent, bitangent, normal of glTF's tangent space.
at::Tensor tangent_frame(const at::Tensor& normal, const at::Tensor& tangent) {
    const auto unit = [](const at::Tensor& v) {
        return v / at::sqrt(v.square().sum(1, true)).clamp_min(1e-12);
    };
    const at::Tensor direction = tangent.narrow(1, 0, 3);
    const at::Tensor t = unit(direction - normal * (normal * direction).sum(1, true));
    const at::Tensor b = at::cross(normal, t, 1) * tangent.narrow(1, 3, 1).sign();
    return at::stack({t, b, normal}, 1);
}

}  // namespace

TexelEvaluator::TexelEvaluator(const BakeScene& scene, const TextureSet& set, int width, int height,
                               int supersampling, TexelNeeds needs)
    : scene_(scene),
      width_(width),
      height_(height),
      samples_(std::max(width, height) > 2048 ? 1 : std::max(1, supersampling)),
      needs_(needs),
      model_triangles_(set.triangles) {
    const int material = set.materials.front();
    ITEM3D_CHECK(
        static_cast<std::int64_t>(scene.atlas.triangles.size()) == scene.geometry.triangles.size(0),
        "atlas and geometry are of different models");
    for (const std::int32_t t : model_triangles_) {
        triangles_.push_back(scene.atlas.triangles[static_cast<std::size_t>(t)]);
    }
    raster_ = rasterize_uv(triangles_, width * samples_, height * samples_,
                           wrap_of(scene.model, material));
    if (!set.shared.empty()) claim_texels(raster_, triangles_);
    if (samples_ == 1) widen(raster_);
    // The source's normals may be in the tangent space of a UV map other than the atlas's.
    const bool moves =
        !set.is_own() || scene.model.materials[static_cast<std::size_t>(material)].normal_uvs != 0;
    if (needs.normals && moves) {
        Model remade;
        for (std::size_t i = 0; i < scene.model.primitives.size(); ++i) {
            const auto edit = scene.atlas.primitives.find(static_cast<int>(i));
            const Primitive& primitive = scene.model.primitives[i];
            remade.primitives.push_back(
                edit == scene.atlas.primitives.end() ? primitive : apply(edit->second, primitive));
            if (set.has(primitive.material)) remade.primitives.back().tangents.clear();
        }
        atlas_geometry_ = Geometry::from_model(remade, scene.geometry.positions.device());
    }
}

int TexelEvaluator::rows_at_once() const {
    return std::max(1, samples_at_once / (width_ * samples_ * samples_));
}

at::Tensor TexelEvaluator::frame_change(const Surface& surface, const at::Tensor& triangle,
                                        const at::Tensor& barycentrics) const {
    if (!atlas_geometry_) return {};
    const Surface remade = surface_at(*atlas_geometry_, triangle, barycentrics);
    // The normals go from the old tangent space to the world, and from there to the new tangent
    // space.
    return at::matmul(tangent_frame(surface.normal, remade.tangent),
                      tangent_frame(surface.normal, surface.tangent).transpose(1, 2));
}

at::Tensor TexelEvaluator::pack(const MaterialSample& sample, const at::Tensor& rotation) const {
    const std::int64_t count = sample.base_color.size(0);
    at::Tensor normal =
        sample.normal.defined()
            ? sample.normal
            : at::tensor({0.0f, 0.0f, 1.0f}, sample.base_color.options()).expand({count, 3});
    if (rotation.defined()) normal = at::matmul(rotation, normal.unsqueeze(2)).squeeze(2);
    const at::Tensor alpha = sample.alpha.defined()
                                 ? sample.alpha.unsqueeze(1)
                                 : at::ones({count, 1}, sample.base_color.options());
    return at::cat(
               {sample.base_color.clamp(0.0f, 1.0f), sample.orm.clamp(0.0f, 1.0f), normal, alpha},
               1)
        .cpu()
        .contiguous();
}

TexelMaterial TexelEvaluator::read(const float* row) const {
    return {Vec3(row[0], row[1], row[2]), Vec3(row[3], row[4], row[5]),
            Vec3(row[6], row[7], row[8]), row[9]};
}

void TexelEvaluator::for_rows(NeuralTexture& fitted, NeuralTexture& now,
                              const std::function<void(const std::vector<TexelValue>&)>& take,
                              const std::function<void(double)>& on_progress) const {
    const int step = rows_at_once();
    const std::int64_t batches = (height_ + step - 1) / step;
    const bool on_cpu = scene_.geometry.positions.device().is_cpu();
    std::mutex mutex;
    std::int64_t done = 0;
    run_workers(batches, on_cpu ? at::get_num_threads() : 1, [&](std::int64_t batch) {
        const int first = static_cast<int>(batch) * step;
        take(rows(first, std::min(height_, first + step), fitted, now));
        const std::lock_guard lock(mutex);
        if (on_progress) on_progress(static_cast<double>(++done) / static_cast<double>(batches));
    });
    if (interrupted()) throw Interrupted("while baking the textures");
}

std::vector<TexelValue> TexelEvaluator::rows(int first, int last, NeuralTexture& fitted,
                                             NeuralTexture& now) const {
    std::vector<TexelValue> texels;
    std::vector<std::int64_t> triangle;
    std::vector<float> barycentrics;
    std::vector<std::size_t> first_sample;  // by texel
    for (int y = first; y < last; ++y) {
        for (int x = 0; x < width_; ++x) {
            const std::size_t before = triangle.size();
            for (int s = 0; s < samples_ * samples_; ++s) {
                const int sample_x = x * samples_ + s % samples_;
                const int sample_y = y * samples_ + s / samples_;
                const std::int32_t t = raster_.at(sample_x, sample_y);
                if (t < 0) continue;
                const Vec2 weights = uv_barycentrics(triangles_[static_cast<std::size_t>(t)],
                                                     raster_.uv_at(sample_x, sample_y));
                triangle.push_back(model_triangles_[static_cast<std::size_t>(t)]);
                barycentrics.insert(barycentrics.end(), {weights.x, weights.y});
            }
            if (triangle.size() == before) continue;
            TexelValue texel;
            texel.x = x;
            texel.y = y;
            texels.push_back(texel);
            first_sample.push_back(before);
        }
    }
    if (texels.empty()) return texels;
    first_sample.push_back(triangle.size());

    const at::Device device = scene_.geometry.positions.device();
    const at::Tensor triangles = at::tensor(triangle, at::kLong).to(device);
    const at::Tensor weights = at::tensor(barycentrics, at::kFloat).view({-1, 2}).to(device);
    const Surface surface = surface_at(scene_.geometry, triangles, weights);
    const at::Tensor rotation = frame_change(surface, triangles, weights);
    const at::Tensor positions = scene_.space.positions(surface);
    const at::Tensor values[3] = {
        needs_.source ? pack(scene_.materials.sample(surface), rotation) : at::Tensor(),
        pack(fitted->forward(positions), rotation), pack(now->forward(positions), rotation)};
    const at::Tensor parts =
        scene_.weight ? scene_.weight(surface).cpu().contiguous() : at::Tensor();
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const float share = 1.0f / static_cast<float>(first_sample[i + 1] - first_sample[i]);
        TexelMaterial* targets[3] = {&texels[i].source, &texels[i].fitted, &texels[i].now};
        for (int k = needs_.source ? 0 : 1; k < 3; ++k) {
            float mean[packed_width] = {};
            for (std::size_t s = first_sample[i]; s < first_sample[i + 1]; ++s) {
                const float* row = values[k].data_ptr<float>() + s * packed_width;
                for (int c = 0; c < packed_width; ++c)
                    mean[c] += share * row[c];
            }
            *targets[k] = read(mean);
        }
        if (!parts.defined()) continue;
        texels[i].weight = 0;
        for (std::size_t s = first_sample[i]; s < first_sample[i + 1]; ++s)
            texels[i].weight += parts.const_data_ptr<float>()[s];
        texels[i].weight *= share;
    }
    return texels;
}

}  // namespace item3d
