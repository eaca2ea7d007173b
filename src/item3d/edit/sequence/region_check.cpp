#include "item3d/edit/sequence/region_check.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/edit/material_source.h"
#include "item3d/edit/region_views.h"
#include "item3d/region/region.h"

#include <algorithm>
#include <memory>
#include <optional>

namespace item3d {
namespace {

constexpr std::int64_t compared_points = 1 << 15;
constexpr double min_overlap = 0.005;  ///< share of the smaller region

class RegionCheck {
  public:
    explicit RegionCheck(const Model& model)
        : model_(model), geometry_(Geometry::from_model(model)) {}

    /// Returns the region's weights at points of the whole surface, [P]. Undefined if the region
    /// depends on textures or covers everything.
    at::Tensor weights_of(const EditRequest& edit) {
        const std::vector<int> materials = select_materials(model_, edit.plan.material);
        if (!edit.plan.edits_texture) return {};
        RegionRequest request{edit.plan.region, edit.plan.exclude, edit.plan.feather};
        if (request.include == std::vector<std::string>{"all"}) request.include.clear();
        if (request.is_everything()) return {};
        const FieldSpace space(model_, materials);
        const RegionScene scene{model_, geometry_, textured(), space, nullptr, false};
        std::vector<std::string> selectors = request.include;
        selectors.insert(selectors.end(), request.exclude.begin(), request.exclude.end());
        if (!std::all_of(selectors.begin(), selectors.end(), is_independent_of_textures)) {
            for (const std::string& text : selectors)
                if (!text.starts_with("words=") && text != "auto") make_selector(text, scene);
            return {};
        }
        // If there are only exclusions, they apply to the region of the colour that the sentences
        // name. That region depends on textures.
        if (request.include.empty()) return {};
        const Region region(request, scene);
        RegionViews(region.points(), model_, geometry_);
        return weights_at(region);
    }

  private:
    const TexturedMaterials& textured() {
        if (!textured_) textured_.emplace(model_);
        return *textured_;
    }
    at::Tensor weights_at(const Region& region) {
        if (!surface_) {
            const FieldSpace whole(model_, select_materials(model_, {}));
            Random random(0, RandomStream::region);
            surface_ = SurfaceSampler(geometry_, whole).sample(compared_points, random);
        }
        at::Tensor is_edited =
            at::zeros({static_cast<std::int64_t>(model_.materials.size())}, at::kFloat);
        for (const int index : region.materials())
            is_edited[index] = 1;
        return region.weight(*surface_).squeeze(1) * is_edited.index_select(0, surface_->material);
    }

    const Model& model_;
    Geometry geometry_;
    std::optional<TexturedMaterials> textured_;
    std::optional<Surface> surface_;  ///< points of all materials
};

void note_overlap(const std::string& plan, std::size_t first, std::size_t second,
                  const at::Tensor& a, const at::Tensor& b) {
    const double smaller = std::min(a.sum().item<double>(), b.sum().item<double>());
    const double common = at::minimum(a, b).sum().item<double>();
    if (smaller <= 0 || common < min_overlap * smaller) return;
    note(
        fmt::format("{}: edits {} and {} overlap on {:.0f} % of the smaller region; there, edit {} "
                    "changes the result of edit {}",
                    plan, first + 1, second + 1, 100 * common / smaller, second + 1, first + 1));
}

}  // namespace

std::string edit_name(const std::string& plan, std::size_t index) {
    return fmt::format("{}: edit {}", plan, index + 1);
}

void check_regions(const std::string& plan, const std::vector<EditRequest>& edits,
                   const Model& model) {
    const at::NoGradGuard no_grad;
    RegionCheck check(model);
    std::vector<at::Tensor> weights;
    for (std::size_t i = 0; i < edits.size(); ++i) {
        try {
            weights.push_back(check.weights_of(edits[i]));
        } catch (const InputError& error) {
            throw InputError(edit_name(plan, i), error.what());
        }
    }
    for (std::size_t j = 0; j < weights.size(); ++j)
        for (std::size_t i = 0; i < j; ++i)
            if (weights[i].defined() && weights[j].defined())
                note_overlap(plan, i, j, weights[i], weights[j]);
}

}  // namespace item3d
