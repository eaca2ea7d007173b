#include "item3d/region/region.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/random.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr std::int64_t sampled_points = 1 << 16;
constexpr std::int64_t kept_points = 4096;
constexpr double min_share = 1e-7;  ///< share of the surface below which a region is empty

/// Returns the maximum of the selectors' weights.
at::Tensor united(const std::vector<std::unique_ptr<Selector>>& selectors, const Surface& surface) {
    at::Tensor weights = selectors.front()->weight(surface);
    for (std::size_t i = 1; i < selectors.size(); ++i)
        weights = at::maximum(weights, selectors[i]->weight(surface));
    return weights;
}

template <typename Condition>
bool has_selector(const RegionRequest& request, const Condition& condition) {
    return std::any_of(request.include.begin(), request.include.end(), condition) ||
           std::any_of(request.exclude.begin(), request.exclude.end(), condition);
}

}  // namespace

bool RegionRequest::needs_segmenter() const {
    return has_selector(*this, [](const std::string& text) { return text.starts_with("words="); });
}

bool RegionRequest::needs_sentences() const {
    return has_selector(*this, [](const std::string& text) { return text == "auto"; });
}

Region::Region(const RegionRequest& request, const RegionScene& scene) : request_(request) {
    const at::NoGradGuard no_grad;
    for (const std::string& text : request.include)
        include_.push_back(make_selector(text, scene));
    for (const std::string& text : request.exclude)
        exclude_.push_back(make_selector(text, scene));
    Random random(0, RandomStream::region);
    const SurfaceSampler sampler(scene.geometry, scene.space);
    const Surface surface = sampler.sample(sampled_points, random);
    const at::Tensor inside = unfeathered(surface);
    const at::Tensor positions = surface.position.cpu();
    if (request.feather > 0) {
        const auto [low, high] = scene.model.bounds();
        const auto spacing =
            static_cast<float>(std::sqrt(sampler.area() / static_cast<double>(sampled_points)));
        feather_.emplace(positions.index({inside.le(0)}), positions.index({inside.gt(0)}), spacing,
                         request.feather / 100 * glm::length(high - low));
    }
    share_ = weight(surface).mean().item<double>();
    const at::Tensor indices = inside.gt(0).nonzero().squeeze(1);
    if (indices.size(0) == 0 || share_ < min_share) {
        std::vector<std::string> all = request.include;
        if (all.empty()) all.emplace_back("everything");
        throw InputError(
            fmt::format("{}", fmt::join(all, ", ")),
            indices.size(0) > 0       ? "the region is empty after feathering"
            : request.exclude.empty() ? "nothing of the edited materials is in this region"
                                      : "the region is empty after the exclusion",
            "run item3d region MODEL --region ... -o FOLDER to see what a selector selects");
    }
    const at::Tensor materials = surface.material.cpu().index_select(0, indices);
    for (std::size_t m = 0; m < scene.model.materials.size(); ++m)
        if (materials.eq(static_cast<std::int64_t>(m)).any().item<bool>())
            materials_.push_back(static_cast<int>(m));
    const std::int64_t step = std::max<std::int64_t>(1, indices.size(0) / kept_points);
    const at::Tensor kept = indices.slice(0, 0, indices.size(0), step);
    points_ = {positions.index_select(0, kept), surface.normal.cpu().index_select(0, kept)};
}

at::Tensor Region::unfeathered(const Surface& surface) const {
    at::Tensor weights = include_.empty() ? at::ones({surface.count()}) : united(include_, surface);
    if (!exclude_.empty()) weights = (weights - united(exclude_, surface)).clamp_min(0);
    return weights;
}

at::Tensor Region::weight(const Surface& surface) const {
    const at::NoGradGuard no_grad;
    if (surface.count() == 0) return at::zeros({0, 1}, surface.position.options());
    at::Tensor weights = unfeathered(surface);
    if (feather_) weights = weights * feather_->weight(surface.position.detach().cpu(), weights);
    return weights.unsqueeze(1).to(surface.position.device());
}

}  // namespace item3d
