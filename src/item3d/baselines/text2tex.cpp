#include "item3d/baselines/text2tex.h"

#include "item3d/baselines/leftovers.h"
#include "item3d/baselines/view_lists.h"

#include <algorithm>

namespace item3d {
namespace {

constexpr int text2tex_steps = 50;
constexpr int refinement_views = 20;
constexpr double update_strength = 0.3;
constexpr double min_update = 0.05;      ///< smallest useful share of the model's pixels
constexpr float heat_tolerance = 0.02f;  ///< depth tolerance in renders of candidates, in radii
constexpr int heat_pixels = 128;         ///< size of the images that compare candidates

}  // namespace

Text2Tex::Text2Tex(const PaintingScene& scene, const PainterOptions& options)
    : ViewPainter(scene, options) {
    if (options_.steps == 0) options_.steps = text2tex_steps;
    taken_ = at::zeros({static_cast<std::int64_t>(candidate_views().size())}, at::kBool);
    find_best();
}

std::int64_t Text2Tex::step_count(const PainterOptions& options) {
    if (options.views > 0) return options.views;
    return static_cast<std::int64_t>(principal_views().size()) + refinement_views;
}

void Text2Tex::find_best() {
    best_ = at::zeros_like(painted_);
    for (const auto& list : {principal_views(), candidate_views()})
        for (const ViewAngles& angles : list) {
            const Camera camera = side_view(scene_, angles).camera;
            const Raster raster = rasterize(scene_.geometry, {camera}, heat_pixels, heat_pixels);
            best_ = at::maximum(best_, see_texels(scene_.texels->surface(), camera, raster.depth[0],
                                                  heat_tolerance * scene_.radius)
                                           .cosine);
        }
}

GenerationMask Text2Tex::look(const ViewRender& render) const {
    const at::Tensor is_painted = (painted_ > 0).to(at::kFloat).unsqueeze(1);
    return make_generation_mask({render.editable(),
                                 (render.pixels(is_painted) > 0.5).to(at::kFloat), render.cosine(),
                                 render.pixels(best_.unsqueeze(1))});
}

std::size_t Text2Tex::next_candidate() {
    if (candidates_.empty())
        for (const ViewAngles& angles : candidate_views())
            candidates_.emplace_back(scene_, side_view(scene_, angles), heat_pixels);
    std::vector<double> heats;
    std::vector<bool> taken;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        heats.push_back(view_heat(look(candidates_[i])));
        taken.push_back(taken_[static_cast<std::int64_t>(i)].item<bool>());
    }
    const std::size_t chosen = choose_view(heats, taken);
    taken_[static_cast<std::int64_t>(chosen)] = true;
    return chosen;
}

at::Tensor Text2Tex::draw(const ViewRender& render, const at::Tensor& mask, bool with_background,
                          double strength, std::uint64_t noise) {
    MaskedSampling sampling;
    sampling.steps = options_.steps;
    sampling.strength = strength;
    sampling.image = encode(render.image(colors_));
    sampling.noise = seeded_noise(sampling.image.sizes(), options_.seed, BaselineDraw::views, noise)
                         .to(sampling.image.device());
    const at::Tensor drawn =
        any_in_cells(with_background ? at::maximum(mask, 1 - render.covered()) : mask,
                     sampling.image.size(2), sampling.image.size(3));
    sampling.drawn = [&](int) { return drawn; };
    const at::Tensor image = decode(sample_masked(guided(render, sampling.image), sampling));
    const TexelView& texels = render.texels();
    paint(render, image,
          (sample_image(mask[0], texels.place).squeeze(1) > 0.5).to(at::kFloat) *
              (texels.cosine > 0));
    return image;
}

void Text2Tex::step(std::int64_t index) {
    const at::NoGradGuard no_grad;
    const auto& principal = principal_views();
    const auto number = static_cast<std::size_t>(index);
    const ViewAngles angles =
        number < principal.size() ? principal[number] : candidate_views()[next_candidate()];
    const ViewRender render(scene_, side_view(scene_, angles));
    const GenerationMask mask = look(render);
    at::Tensor image = render.image(colors_);
    const auto noise = 2 * static_cast<std::uint64_t>(index);
    if (mask.fresh.sum().item<float>() > 0) image = draw(render, mask.fresh, true, 1, noise);
    const double share =
        mask.update.sum().item<double>() / std::max(1.0, render.covered().sum().item<double>());
    if (share > min_update) image = draw(render, mask.update, false, update_strength, noise + 1);
    images_.push_back(image);
}

void Text2Tex::finish() {
    colors_ = at::where(scene_.weight > 0,
                        fill_from_neighbours(*scene_.texels, colors_, painted_ > 0), colors_);
}

NamedTensors Text2Tex::state() const {
    NamedTensors tensors = ViewPainter::state();
    tensors.emplace_back("taken", taken_.to(at::kByte));
    return tensors;
}

void Text2Tex::load_state(const CheckpointReader& reader) {
    ViewPainter::load_state(reader);
    taken_ = reader.get("taken").to(at::kBool).clone();
}

}  // namespace item3d
