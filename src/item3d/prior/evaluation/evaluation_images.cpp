#include "item3d/prior/evaluation/evaluation_images.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/networks/diffusion/generate.h"
#include "item3d/networks/diffusion/generate_defaults.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/dataset.h"
#include "item3d/prior/data/shapes/shapes.h"
#include "item3d/render/image_tensor.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace item3d {
namespace {

/// Returns those of `wanted` that the prior was trained on, at most `count`.
std::vector<std::string> known_of(const std::vector<std::string>& wanted,
                                  const std::set<std::string>& words, int count) {
    std::vector<std::string> known;
    for (const std::string& word : wanted)
        if (static_cast<int>(known.size()) < count && (words.empty() || words.count(word)))
            known.push_back(word);
    return known;
}

/// Returns objects that are recognizable by their outline, easy and hard ones.
std::vector<std::string> sample_objects(const std::set<std::string>& words, int count) {
    return known_of({"mug", "chair", "car", "apple", "cow", "house", "guitar", "mushroom", "vase",
                     "ball", "cube", "bottle", "lamp", "table", "duck"},
                    words, count);
}

/// Returns captions of colours, metals, materials and patterns. If a caption can have any colours,
/// they are red and white.
std::vector<std::string> sample_materials(const std::set<std::string>& words, int count) {
    const std::vector<std::string> names =
        known_of({"red", "gold", "wood", "marble", "brick", "striped", "checkered", "moss", "blue",
                  "silver", "stone", "grass", "rust"},
                 words, count);
    std::vector<std::string> captions;
    for (const std::string& name : names) {
        std::string caption = "a " + name + " {o}";
        for (const MaterialWord& word : material_words())
            if (word.word == name)
                caption = word.colored_caption.empty() ? word.caption : word.colored_caption;
        fill_in(caption, "{c}", "red");
        fill_in(caption, "{d}", "white");
        captions.push_back(caption);
    }
    return captions;
}

/// Stacks images to [N, 3, H, W] in [0, 1].
at::Tensor stack_images(const std::vector<Image>& images) {
    std::vector<at::Tensor> all;
    for (const Image& image : images)
        all.push_back(to_tensor(image).permute({2, 0, 1}));
    return at::stack(all);
}

/// Returns a view of a whole held-out shape of the class.
ShapeView whole_view(const std::string& object, std::uint64_t seed) {
    std::vector<ShapeView> views = make_views(object, training_variants, 6, seed);
    const auto found = std::find_if(views.begin(), views.end(),
                                    [](const ShapeView& view) { return !view.close_up; });
    return found == views.end() ? views[0] : *found;
}

}  // namespace

SampleGrid draw_samples(const std::filesystem::path& prior, const DiffusionModel& pipeline,
                        const std::set<std::string>& words, int side, bool with_shape,
                        std::uint64_t seed) {
    SampleGrid grid;
    grid.objects = sample_objects(words, side);
    grid.materials = sample_materials(words, side);
    std::vector<at::Tensor> conditions;
    if (with_shape)
        for (const std::string& object : grid.objects)
            conditions.push_back(
                shape_condition(whole_view(object, seed).cells.to(at::kFloat).unsqueeze(0),
                                pipeline.condition_channels()));
    GenerateOptions options = generate_defaults(prior, pipeline);
    options.show_progress = false;
    Progress progress(with_shape ? "samples in given shapes" : "samples",
                      static_cast<std::int64_t>(grid.objects.size() * grid.materials.size()));
    for (const std::string& material : grid.materials) {
        for (std::size_t column = 0; column < grid.objects.size(); ++column) {
            std::string prompt = material;
            fill_in(prompt, "{o}", grid.objects[column]);
            options.prompt = mend_articles(prompt);
            options.seed = seed + grid.prompts.size();
            const at::Tensor image =
                generate(pipeline, options, with_shape ? conditions[column] : at::Tensor());
            grid.prompts.push_back(options.prompt);
            grid.images.push_back(to_image(image[0]));
            progress.update(static_cast<std::int64_t>(grid.prompts.size()));
        }
    }
    return grid;
}

nlohmann::json score_samples(const Clip& clip, const SampleGrid& grid) {
    const at::NoGradGuard no_grad;
    const at::Tensor images = clip.embed_images(stack_images(grid.images));
    const at::Tensor cosines = images.mm(clip.embed_texts(grid.prompts).t());
    const auto count = static_cast<std::int64_t>(grid.prompts.size());
    const auto columns = static_cast<std::int64_t>(grid.objects.size());
    const at::Tensor truth = at::arange(count), found = cosines.argmax(1);
    const auto part = [](const at::Tensor& right) {
        return std::round(1000 * right.to(at::kDouble).mean().item<double>()) / 1000;
    };
    const auto row = [&](const at::Tensor& index) { return index.div(columns, "floor"); };
    return {{"pictures", count},
            {"right", part(found == truth)},
            {"object_right", part(found.remainder(columns) == truth.remainder(columns))},
            {"material_right", part(row(found) == row(truth))},
            {"similarity", cosines.diagonal().mean().item<double>()}};
}

ReconstructionMeasure measure_autoencoder(const DiffusionModel& pipeline,
                                          const std::vector<ShapeView>& views, int images,
                                          std::uint64_t seed) {
    constexpr int shown = 12;
    const at::NoGradGuard no_grad;
    const std::vector<TrainingLight> lights =
        make_training_lights(mix_bits(seed + 2), std::min(images, 32), 1);
    ReconstructionMeasure measure;
    double squares = 0, object_squares = 0, object_weight = 0;
    for (int i = 0; i < images; ++i) {
        Random random(seed, 0xae0000 + static_cast<std::uint64_t>(i));
        const auto view =
            static_cast<std::size_t>(random.index(static_cast<std::int64_t>(views.size())));
        const Example example = draw_example(random, views[view], lights);
        const at::Tensor image = example.image.permute({2, 0, 1}).unsqueeze(0) * 2 - 1;
        const at::Tensor decoded = pipeline.decode_image(pipeline.encode_image(image)).clamp(-1, 1);
        const at::Tensor error = ((decoded - image) / 2).square().mean(1)[0];
        squares += error.mean().item<double>();
        object_squares += (error * example.covered).sum().item<double>();
        object_weight += example.covered.sum().item<double>();
        if (i >= shown) continue;
        measure.images.push_back(to_image(example.image));
        measure.reconstructions.push_back(to_image((decoded[0].permute({1, 2, 0}) + 1) / 2));
    }
    measure.psnr = -10 * std::log10(squares / images);
    measure.object_psnr = -10 * std::log10(object_squares / object_weight);
    return measure;
}

}  // namespace item3d
