#include "item3d/region/words_selector.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/networks/vision_language/segmenter.h"
#include "item3d/region/patch_vote.h"

namespace item3d {
namespace {

constexpr int picture_size = 192;
constexpr float enough = 0.4f;
/// Mean probability of what is taken, below which a look is recommended.
constexpr double sure = 0.6;

}  // namespace

std::unique_ptr<Selector> select_words(const SelectorText& text, const RegionScene& scene) {
    if (scene.segmenter == nullptr)
        throw InputError(text.whole, "the prior has no segmenter that could find it",
                         "give one by --segmenter, or choose another selector");
    const at::NoGradGuard no_grad;
    scene.segmenter->warn_of_lost_words(text.whole, text.value);
    const SurfaceReading reading = read_surface(scene, picture_size, [&](const ModelView& view) {
        return scene.segmenter->masks(view.picture, {text.value})[0];
    });
    PatchVote vote = vote_by_patch(scene, reading, reading.values[0], enough);
    if (vote.taken == 0)
        throw InputError(
            text.whole, "nothing of the kind is seen on the model",
            fmt::format("the likeliest place reaches {:.0f} %, {:.0f} are needed; try other "
                        "words, or view= or sphere=",
                        100 * vote.highest, 100 * enough));
    note(fmt::format("{}: {:.1f} % of what is seen, mean probability {:.0f} %{}", text.whole,
                     100 * vote.taken, 100 * vote.mean,
                     vote.mean < sure ? "; look at it by item3d region" : ""));
    return std::move(vote.selector);
}

std::unique_ptr<Segmenter> load_wanted_segmenter(const RegionRequest& request,
                                                 const std::filesystem::path& folder,
                                                 at::Device device) {
    if (folder.empty() || !request.needs_segmenter()) return nullptr;
    return std::make_unique<Segmenter>(Segmenter::load_to_run(folder, device, at::kFloat));
}

}  // namespace item3d
