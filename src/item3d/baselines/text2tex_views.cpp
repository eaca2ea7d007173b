#include "item3d/baselines/text2tex_views.h"

#include "item3d/baselines/trimap.h"
#include "item3d/core/error.h"

namespace item3d {
namespace {

constexpr double flattest = 0.1;
/// A view counts as best if its cosine is at most this below the best.
constexpr double as_good = 0.02;
constexpr double fresh_weight = 1, update_weight = 0.5, keep_weight = 0.1;
constexpr double punishment = 0.01;
constexpr int text2tex_pixels = 768;

}  // namespace

GenerationMask make_generation_mask(const GenerationInput& input) {
    const std::int64_t size = input.cosine.size(3);
    // Erosion by two squares of 3 pixels equals erosion by one of 5.
    const int width = scaled_width(5 * 1200 / text2tex_pixels, size);
    const at::Tensor seen = erode((input.cosine > flattest).to(at::kFloat), width) * input.editable;
    const at::Tensor is_best = (input.cosine + as_good >= input.best).to(at::kFloat);
    GenerationMask mask;
    mask.fresh = seen * (1 - input.painted);
    mask.update = seen * input.painted * is_best;
    mask.keep = seen * input.painted * (1 - is_best);
    return mask;
}

double view_heat(const GenerationMask& mask) {
    const at::Tensor sum = fresh_weight * mask.fresh.sum() + update_weight * mask.update.sum() +
                           keep_weight * mask.keep.sum();
    return sum.item<double>() / static_cast<double>(mask.fresh.numel());
}

std::size_t choose_view(const std::vector<double>& heats, const std::vector<bool>& taken) {
    ITEM3D_CHECK(!heats.empty() && heats.size() == taken.size(), "a heat for each view");
    const auto heat = [&](std::size_t i) { return heats[i] * (taken[i] ? punishment : 1.0); };
    std::size_t chosen = 0;
    for (std::size_t i = 1; i < heats.size(); ++i)
        if (heat(i) > heat(chosen)) chosen = i;
    return chosen;
}

}  // namespace item3d
