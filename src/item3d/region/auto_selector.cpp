#include "item3d/region/auto_selector.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/guidance/reading.h"
#include "item3d/region/patch_vote.h"
#include "item3d/region/region_readers.h"

namespace item3d {
namespace {

constexpr int difference_noises = 3;
/// Differences are clipped at `outlier` times the mean and divided by that value. Points with a
/// result above enough_difference belong to the region.
constexpr double outlier = 4, enough_difference = 0.5;
/// Maximum native size of a prior for which views are rendered at twice that size. In views of the
/// native size, one latent cell would cover as much as an eye of the model.
constexpr int small_native_size = 128;

int difference_pixels(const DiffusionModel& prior) {
    const int native = prior.native_size();
    return native <= small_native_size ? 2 * native : native;
}

const RegionReaders& sentences_of(const SelectorText& text, const RegionScene& scene) {
    if (scene.readers == nullptr || scene.readers->from.empty() || scene.readers->to.empty())
        throw InputError(text.whole, "needs two sentences to compare", "give both --from and --to");
    if (!scene.readers->prior)
        throw InputError(text.whole, "needs a prior, but none is available",
                         "choose another selector");
    if (scene.readers->from == scene.readers->to)
        throw InputError(
            text.whole,
            fmt::format("the prior reads --from and --to as the same: '{}'", scene.readers->from),
            "describe the change in words that it knows (item3d prior info lists them)");
    return *scene.readers;
}

}  // namespace

std::unique_ptr<Selector> select_auto(const SelectorText& text, const RegionScene& scene) {
    const RegionReaders& readers = sentences_of(text, scene);
    const at::NoGradGuard no_grad;
    const DiffusionModel& prior = *readers.prior;
    const TextEmbedding from = prior.encode_text({readers.from});
    const TextEmbedding to = prior.encode_text({readers.to});
    ReadingOptions options;
    options.noises = difference_noises;
    const SurfaceReading reading =
        read_surface(scene, difference_pixels(prior), [&](const ModelView& view) {
            const GuidanceInput input{view.image.to(prior.device()), view.shape, {}};
            return prediction_difference(prior, input, from, to, options);
        });
    const at::Tensor difference = reading.values[0];
    const double mean = difference.index({reading.seen}).mean().item<double>();
    PatchVote vote = vote_by_patch(scene, reading, normalize_difference(difference, mean, outlier),
                                   static_cast<float>(enough_difference));
    const auto times_mean = [&](const at::Tensor& value) {
        return mean > 0 ? value.item<double>() / mean : 0;
    };
    if (vote.taken == 0)
        throw InputError(
            text.whole,
            "the difference between the sentences is about the same everywhere on the model",
            fmt::format("its maximum is {:.1f} times the mean, at least {:.0f} times is needed; "
                        "name the part in both (\"a white cow with black spots\"), or use words= "
                        "or another selector",
                        times_mean(difference.masked_fill(reading.seen.logical_not(), 0).max()),
                        outlier * enough_difference));
    const double times = times_mean(difference.index({vote.inside}).mean());
    note(
        fmt::format("{}: {:.1f} % of the visible surface, where the difference between the "
                    "sentences is {:.1f} times the mean; check it with item3d region",
                    text.whole, 100 * vote.taken, times));
    return std::move(vote.selector);
}

}  // namespace item3d
