#include "item3d/metrics/clip_score.h"

#include "item3d/core/error.h"

namespace item3d {
namespace {

/// Batch size that makes matrix products efficient. Larger batches take more memory, and more time
/// to allocate it.
constexpr int images_at_once = 8;

/// Minimum length of a difference of two unit vectors. The direction of a shorter difference is
/// only rounding error.
constexpr double min_length = 1e-5;

/// Returns the cosine of each row of a [N, D] with b [1, D]; 0 if a vector is shorter than
/// min_length.
at::Tensor cosines(const at::Tensor& a, const at::Tensor& b) {
    const at::Tensor lengths = a.norm(2, {-1}) * b.norm(2, {-1});
    const at::Tensor products = (a * b).sum(-1);
    const at::Tensor too_short = a.norm(2, {-1}).lt(min_length) | b.norm(2, {-1}).lt(min_length);
    return (products / lengths.clamp_min(1e-12)).masked_fill(too_short, 0);
}

}  // namespace

ClipScores clip_scores(const Clip& clip, const at::Tensor& before, const at::Tensor& after,
                       const std::string& from, const std::string& to) {
    ITEM3D_CHECK(before.sizes() == after.sizes() && before.size(0) > 0,
                 "both image sets must be of one shape");
    const at::NoGradGuard no_grad;
    const at::Tensor texts = clip.embed_texts({from, to}).cpu().to(at::kDouble);
    std::vector<at::Tensor> rows;
    for (const at::Tensor& some : at::cat({before, after}).split(images_at_once))
        rows.push_back(clip.embed_images(some).cpu().to(at::kDouble));
    const auto both = at::cat(rows).chunk(2);
    const at::Tensor was = both[0], is = both[1];
    const at::Tensor target = texts.narrow(0, 1, 1);
    const at::Tensor scores = at::stack({cosines(is, target), cosines(was, target),
                                         cosines(is - was, target - texts.narrow(0, 0, 1))},
                                        1);
    const auto score_of = [](const at::Tensor& row) {
        return ClipScore{row[0].item<double>(), row[1].item<double>(), row[2].item<double>()};
    };
    ClipScores result;
    for (const at::Tensor& row : scores.unbind(0))
        result.views.push_back(score_of(row));
    result.mean = score_of(scores.mean(0));
    return result;
}

void to_json(nlohmann::json& json, const ClipScore& score) {
    json = {{"global", score.global},
            {"global_before", score.global_before},
            {"directional", score.directional}};
}

}  // namespace item3d
