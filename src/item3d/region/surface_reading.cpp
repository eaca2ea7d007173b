#include "item3d/region/surface_reading.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/lighting/environment.h"
#include "item3d/region/seen_shape.h"
#include "item3d/render/render.h"
#include "item3d/render/srgb.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr int light_size = 64;
constexpr float view_width = 0.6f;  ///< field of view in radians
/// Rings of cameras: elevation in radians, and number of cameras.
constexpr std::pair<float, int> rings[] = {{0.3f, 8}, {-0.5f, 3}, {1.1f, 3}};
constexpr std::int64_t point_count = 1 << 16;
/// Smallest resolution of the depth map of the visibility test.
constexpr int min_depth_pixels = 192;

std::vector<Camera> cameras_around(const Model& model) {
    std::vector<Camera> cameras;
    for (const auto& [elevation, count] : rings)
        for (const Camera& camera : turntable(model.bounds(), count, elevation, view_width))
            cameras.push_back(camera);
    return cameras;
}

/// Accumulator of each point's weight and weighted values over views.
class Gathering {
  public:
    explicit Gathering(const Surface& points)
        : position_(points.position.detach().cpu().contiguous()),
          normal_(points.normal.detach().cpu().contiguous()),
          weight_(at::zeros({points.count()})) {}

    /// answers: values [Q, D, D] in the view. depth: [D, D], 0 where the view shows no surface.
    void add(const Camera& camera, const at::Tensor& answers, const at::Tensor& depth) {
        const std::int64_t questions = answers.size(0), count = weight_.size(0);
        const int size = static_cast<int>(depth.size(0));
        if (!sum_.defined()) sum_ = at::zeros({questions, count});
        const Mat4 to_clip = camera.world_to_clip(size, size);
        const float* a = answers.const_data_ptr<float>();
        const float* d = depth.const_data_ptr<float>();
        const float* p = position_.const_data_ptr<float>();
        const float* n = normal_.const_data_ptr<float>();
        float* weight = weight_.mutable_data_ptr<float>();
        float* sum = sum_.mutable_data_ptr<float>();
        parallel_for(
            "gather_answers", count,
            [&](std::int64_t i) {
                const Vec3 position(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
                const Vec3 way = camera.position() - position;
                const float facing = std::abs(
                    glm::dot(glm::normalize(way), Vec3(n[3 * i], n[3 * i + 1], n[3 * i + 2])));
                const Vec4 clip = to_clip * Vec4(position, 1);
                if (clip.w <= 0 || facing < 0.1f) return;
                const auto pixel = [&](float at) {
                    return std::clamp(
                        static_cast<int>((0.5f + 0.5f * at / clip.w) * static_cast<float>(size)), 0,
                        size - 1);
                };
                const int at = (size - 1 - pixel(clip.y)) * size + pixel(clip.x);
                // The tolerance is 1 % of the distance, and more where the surface is oblique to
                // the view.
                if (d[at] <= 0 || clip.w > d[at] * (1 + 0.01f / facing)) return;
                weight[i] += facing;
                for (std::int64_t q = 0; q < questions; ++q)
                    sum[q * count + i] += facing * a[q * size * size + at];
            },
            1024);
    }
    at::Tensor seen() const { return weight_.gt(0); }
    at::Tensor means() const { return sum_ / weight_.clamp_min(1e-6); }

  private:
    at::Tensor position_, normal_, weight_, sum_;
};

}  // namespace

int reading_views() {
    int views = 0;
    for (const auto& [elevation, count] : rings)
        views += count;
    return views;
}

SurfaceReading read_surface(const RegionScene& scene, int pixels, const ViewReader& reader) {
    const at::NoGradGuard no_grad;
    Random random(0, RandomStream::region);
    const Surface points = SurfaceSampler(scene.geometry, scene.space).sample(point_count, random);
    const EnvironmentLight light =
        prefilter(make_light_preset("studio", 128), light_size, scene.geometry.positions.device());
    const BoundingSphere sphere = bounding_sphere(scene.model);
    const int depth_pixels = (min_depth_pixels + pixels - 1) / pixels * pixels;
    RenderOptions options;
    options.width = options.height = pixels;
    Gathering gathering(points);
    for (const Camera& camera : cameras_around(scene.model)) {
        if (interrupted()) throw Interrupted("before the region was found");
        const std::vector<Camera> one{camera};
        const at::Tensor linear = render(scene.geometry, scene.textured, light, one, options);
        const at::Tensor color = linear.narrow(3, 0, 3) + (1 - linear.narrow(3, 3, 1));
        ModelView view;
        view.image = linear_to_srgb(color.clamp(0, 1)).permute({0, 3, 1, 2}).contiguous();
        const Raster raster = rasterize(scene.geometry, one, depth_pixels, depth_pixels);
        view.shape = seen_shape(raster, interpolate_surface(scene.geometry, raster, one), sphere);
        const at::Tensor answers = at::upsample_bilinear2d(reader(view).to(at::kFloat).unsqueeze(0),
                                                           {depth_pixels, depth_pixels}, false);
        gathering.add(camera, answers[0].cpu().contiguous(), raster.depth[0].cpu().contiguous());
    }
    const auto [low, high] = scene.model.bounds();
    SurfaceReading reading;
    reading.triangle = points.triangle.cpu().contiguous();
    reading.position = points.position.detach().cpu().contiguous();
    reading.seen = gathering.seen();
    reading.values = gathering.means();
    reading.spacing = 4.5f * glm::length(high - low) / std::sqrt(static_cast<float>(point_count));
    return reading;
}

}  // namespace item3d
