#include "item3d/region/words_selector.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/parallel.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/lighting/environment.h"
#include "item3d/networks/vision_language/segmenter.h"
#include "item3d/region/point_grid.h"
#include "item3d/region/surface_patches.h"
#include "item3d/render/render.h"
#include "item3d/render/srgb.h"
#include "item3d/scene/camera.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr int picture_size = 192;
constexpr int light_size = 64;
constexpr float view_width = 0.6f;  ///< field of view, radians
/// Elevations of rings of cameras, radians, and how many each has.
constexpr std::pair<float, int> rings[] = {{0.3f, 8}, {-0.5f, 3}, {1.1f, 3}};
constexpr std::int64_t point_count = 1 << 16;
constexpr float enough = 0.4f;
/// A patch of which less is named, or more, is not, or is, in the region as a whole.
constexpr double least_part = 0.25, largest_part = 0.75;
/// Mean probability of what is taken, below which a look is recommended.
constexpr double sure = 0.6;

std::vector<Camera> cameras_around(const Model& model) {
    std::vector<Camera> cameras;
    for (const auto& [elevation, count] : rings)
        for (const Camera& camera : turntable(model.bounds(), count, elevation, view_width))
            cameras.push_back(camera);
    return cameras;
}

/// What the network says of points of the surface.
struct Votes {
    at::Tensor triangle;             ///< [K] int64
    at::Tensor position;             ///< [K, 3]
    std::vector<float> probability;  ///< [K]; -1: no view sees the point
};

/// Sums over views of each point's weight, and of its probability times that.
class Gathering {
  public:
    explicit Gathering(const Surface& points)
        : position_(points.position.detach().cpu().contiguous()),
          normal_(points.normal.detach().cpu().contiguous()),
          weight_(static_cast<std::size_t>(points.count()), 0.0f),
          named_(weight_) {}

    /// mask, depth: [S, S]; depth 0 where nothing is seen.
    void add(const Camera& camera, const at::Tensor& mask, const at::Tensor& depth) {
        const int size = static_cast<int>(mask.size(0));
        const Mat4 to_clip = camera.world_to_clip(size, size);
        const float* m = mask.const_data_ptr<float>();
        const float* d = depth.const_data_ptr<float>();
        const float* p = position_.const_data_ptr<float>();
        const float* n = normal_.const_data_ptr<float>();
        parallel_for(
            "gather_votes", position_.size(0),
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
                // A pixel's slant, and a hundredth of the way for its neighbours.
                if (d[at] <= 0 || clip.w > d[at] * (1 + 0.01f / facing)) return;
                weight_[static_cast<std::size_t>(i)] += facing;
                named_[static_cast<std::size_t>(i)] += facing * m[at];
            },
            1024);
    }
    std::vector<float> probabilities() const {
        std::vector<float> result;
        for (std::size_t i = 0; i < weight_.size(); ++i)
            result.push_back(weight_[i] > 0 ? named_[i] / weight_[i] : -1.0f);
        return result;
    }

  private:
    at::Tensor position_, normal_;
    std::vector<float> weight_, named_;
};

Votes gather_votes(const std::string& prompt, const RegionScene& scene) {
    Random random(0, RandomStream::region);
    const Surface points = SurfaceSampler(scene.geometry, scene.space).sample(point_count, random);
    const EnvironmentLight light =
        prefilter(make_light_preset("studio", 128), light_size, scene.geometry.positions.device());
    Gathering gathering(points);
    for (const Camera& camera : cameras_around(scene.model)) {
        RenderOptions options;
        options.width = options.height = picture_size;
        const std::vector<Camera> one{camera};
        const at::Tensor linear = render(scene.geometry, scene.textured, light, one, options);
        const at::Tensor color = linear.narrow(3, 0, 3) + (1 - linear.narrow(3, 3, 1));
        const at::Tensor picture =
            linear_to_srgb(color.clamp(0, 1)).permute({0, 3, 1, 2}).contiguous();
        const at::Tensor mask = scene.segmenter->masks(picture, {prompt})[0][0];
        const Raster raster = rasterize(scene.geometry, one, picture_size, picture_size);
        gathering.add(camera, mask.cpu().contiguous(), raster.depth[0].cpu().contiguous());
    }
    return {points.triangle.cpu().contiguous(), points.position.detach().cpu().contiguous(),
            gathering.probabilities()};
}

/// Probabilities of points that a view sees, looked up between them.
class PointField {
  public:
    PointField(const Votes& votes, float reach)
        : probability_(votes.probability), grid_(votes.position, reach) {}

    /// Mean around the place, the nearest counting most; -1 where there is no point.
    float at(Vec3 place) const {
        float sum = 0, weights = 0;
        grid_.for_each_near(place, [&](std::int64_t i, Vec3 point) {
            const float probability = probability_[static_cast<std::size_t>(i)];
            if (probability < 0) return;
            const Vec3 apart = (point - place) / grid_.reach();
            const float weight = std::exp(-4 * glm::dot(apart, apart));
            sum += weight * probability;
            weights += weight;
        });
        return weights > 1e-6f ? sum / weights : -1.0f;
    }

  private:
    std::vector<float> probability_;
    PointGrid grid_;
};

class WordsSelector : public Selector {
  public:
    enum class Verdict : char { outside, inside, by_place };

    WordsSelector(SurfacePatches patches, std::vector<Verdict> verdicts, PointField field)
        : patches_(std::move(patches)), verdicts_(std::move(verdicts)), field_(std::move(field)) {}

    at::Tensor weight(const Surface& surface) const override {
        const at::Tensor triangle = surface.triangle.cpu().contiguous();
        const at::Tensor position = surface.position.detach().cpu().contiguous();
        at::Tensor weights = at::zeros({triangle.size(0)}, at::kFloat);
        const std::int64_t* t = triangle.const_data_ptr<std::int64_t>();
        const float* p = position.const_data_ptr<float>();
        float* out = weights.data_ptr<float>();
        parallel_for(
            "region_words", triangle.size(0),
            [&](std::int64_t i) {
                const int patch = patches_.of_triangle[static_cast<std::size_t>(t[i])];
                const Verdict verdict = verdicts_[static_cast<std::size_t>(patch)];
                if (verdict == Verdict::inside) out[i] = 1;
                if (verdict == Verdict::by_place)
                    out[i] = field_.at(Vec3(p[3 * i], p[3 * i + 1], p[3 * i + 2])) > enough ? 1 : 0;
            },
            512);
        return weights;
    }

  private:
    SurfacePatches patches_;
    std::vector<Verdict> verdicts_;
    PointField field_;
};

}  // namespace

std::unique_ptr<Selector> select_words(const SelectorText& text, const RegionScene& scene) {
    if (scene.segmenter == nullptr)
        throw InputError(text.whole, "the prior has no segmenter that could find it",
                         "give one by --segmenter, or choose another selector");
    const at::NoGradGuard no_grad;
    scene.segmenter->warn_of_lost_words(text.whole, text.value);
    const Votes votes = gather_votes(text.value, scene);
    SurfacePatches patches = find_patches(scene);
    const std::size_t count = patches.area.size();
    std::vector<double> seen(count, 0), named(count, 0);
    double taken = 0, confidence = 0;
    float highest = 0;
    const std::int64_t* t = votes.triangle.const_data_ptr<std::int64_t>();
    for (std::size_t i = 0; i < votes.probability.size(); ++i) {
        const float probability = votes.probability[i];
        highest = std::max(highest, probability);
        if (probability < 0) continue;
        const auto patch =
            static_cast<std::size_t>(patches.of_triangle[static_cast<std::size_t>(t[i])]);
        seen[patch] += 1;
        if (probability <= enough) continue;
        named[patch] += 1;
        taken += 1;
        confidence += probability;
    }
    if (taken == 0)
        throw InputError(
            text.whole, "nothing of the kind is seen on the model",
            fmt::format("the likeliest place reaches {:.0f} %, {:.0f} are needed; try other "
                        "words, or view= or sphere=",
                        100 * highest, 100 * enough));
    std::vector<WordsSelector::Verdict> verdicts;
    for (std::size_t i = 0; i < count; ++i) {
        const double part = seen[i] > 0 ? named[i] / seen[i] : 0;
        verdicts.push_back(part < least_part     ? WordsSelector::Verdict::outside
                           : part > largest_part ? WordsSelector::Verdict::inside
                                                 : WordsSelector::Verdict::by_place);
    }
    // A large patch is cut even where little of it is named: a handle may be of one piece with a
    // cup.
    const double all = static_cast<double>(votes.probability.size());
    for (std::size_t i = 0; i < count; ++i)
        if (seen[i] > 0.1 * all && named[i] > 0.005 * all &&
            verdicts[i] == WordsSelector::Verdict::outside)
            verdicts[i] = WordsSelector::Verdict::by_place;
    const double mean = confidence / taken;
    note(fmt::format("{}: {:.1f} % of what is seen, mean probability {:.0f} %{}", text.whole,
                     100 * taken / all, 100 * mean,
                     mean < sure ? "; look at it by item3d region" : ""));
    const auto [low, high] = scene.model.bounds();
    const float cell = 1.5f * glm::length(high - low) / std::sqrt(static_cast<float>(point_count));
    return std::make_unique<WordsSelector>(std::move(patches), std::move(verdicts),
                                           PointField(votes, 3 * cell));
}

std::unique_ptr<Segmenter> load_wanted_segmenter(const RegionRequest& request,
                                                 const std::filesystem::path& folder,
                                                 at::Device device) {
    if (folder.empty() || !request.needs_segmenter()) return nullptr;
    return std::make_unique<Segmenter>(Segmenter::load_to_run(folder, device, at::kFloat));
}

}  // namespace item3d
