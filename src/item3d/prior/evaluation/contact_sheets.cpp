#include "item3d/prior/evaluation/contact_sheets.h"

#include "item3d/prior/data/dataset.h"
#include "item3d/prior/data/shapes/shapes.h"

#include <algorithm>
#include <array>

namespace item3d {
namespace {

constexpr int gap = 2;

/// Layout of images side by side.
class SheetWriter {
  public:
    SheetWriter(const SheetOptions& options, std::size_t count)
        : options_(options), tile_(options.image + gap) {
        const auto columns = static_cast<std::size_t>(options.columns);
        const auto rows = static_cast<int>((count + columns - 1) / columns);
        sheet_.image = Image(options.columns * tile_, rows * tile_, 3, 1.0f);
    }

    /// Adds an image [S, S, 3].
    void add(const at::Tensor& image, const std::string& caption) {
        const int i = static_cast<int>(sheet_.captions.size());
        const int left = i % options_.columns * tile_, top = i / options_.columns * tile_;
        const auto* pixels = image.const_data_ptr<float>();
        for (int y = 0; y < options_.image; ++y)
            for (int x = 0; x < options_.image; ++x)
                for (int c = 0; c < 3; ++c)
                    sheet_.image.at(left + x, top + y, c) =
                        pixels[(y * options_.image + x) * 3 + c];
        sheet_.captions.push_back(caption);
    }
    Sheet finish() { return std::move(sheet_); }

  private:
    SheetOptions options_;
    int tile_;
    Sheet sheet_;
};

/// Returns a view that shows much of the shape. The view is the one with the most visible parts
/// among a few views of the whole shape.
ShapeView good_view(const std::string& shape_class, int variant, const SheetOptions& options) {
    std::vector<ShapeView> views =
        make_views(shape_class, variant, 6, options.seed, 96, options.image);
    const auto in_sight = [](const ShapeView& view) {
        std::vector<int> counts(view.parts.size(), 0);
        for (const std::uint8_t part : view.part)
            ++counts[part];
        return std::count_if(counts.begin(), counts.end(), [](int n) { return n > 60; });
    };
    return *std::max_element(views.begin(), views.end(), [&](const auto& a, const auto& b) {
        return std::pair(!a.close_up, in_sight(a)) < std::pair(!b.close_up, in_sight(b));
    });
}

ExampleSource sheet_source(const SheetOptions& options) {
    std::vector<TrainingLight> lights = make_training_lights(options.seed + 1, 64, 2);
    return ExampleSource(make_view_pool(false, options.variants, 4, options.seed, 2, options.image),
                         std::move(lights), options.seed);
}

TrainingLight sheet_light(const std::string& kind, std::uint64_t seed) {
    Random random(seed, 3);
    return make_training_light(random, kind);
}

}  // namespace

Sheet example_sheet(const SheetOptions& options) {
    const ExampleSource source = sheet_source(options);
    const int count = options.columns * options.rows;
    SheetWriter sheet(options, static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        const Example example = source.draw(i);
        sheet.add(example.image, example.caption);
    }
    return sheet.finish();
}

Sheet instruction_sheet(const SheetOptions& options) {
    const ExampleSource source = sheet_source(options);
    const int count = std::max(1, options.columns * options.rows / 2);
    SheetWriter sheet(options, static_cast<std::size_t>(2 * count));
    for (int i = 0; i < count; ++i) {
        const InstructionPair pair = source.draw_pair(i);
        sheet.add(pair.before, "before");
        sheet.add(pair.after, pair.instruction);
    }
    return sheet.finish();
}

Sheet object_sheet(const SheetOptions& options) {
    const TrainingLight light = sheet_light("studio", options.seed);
    const auto& classes = shape_classes();
    SheetWriter sheet(options, classes.size());
    for (std::size_t i = 0; i < classes.size(); ++i) {
        const ShapeView view = good_view(classes[i].name, static_cast<int>(i) % 5, options);
        ExampleWish wish{{"plain", "gray", ""}, &light, true, "none", {"plain", "salmon", ""}};
        if (view.parts.size() > 1) wish.part = view.parts[1];
        Random random(options.seed, i);
        sheet.add(draw_example(random, view, {}, wish).image,
                  classes[i].nouns[0] + (classes[i].held_out ? " (held out)" : ""));
    }
    return sheet.finish();
}

Sheet material_sheet(const SheetOptions& options) {
    const TrainingLight light = sheet_light("studio", options.seed);
    const auto& words = material_words();
    const std::array<ShapeView, 2> views{good_view("vase", 1, options),
                                         good_view("chair", 4, options)};
    SheetWriter sheet(options, 2 * words.size());
    for (std::size_t i = 0; i < words.size(); ++i)
        for (std::size_t k = 0; k < views.size(); ++k) {
            Random random(options.seed, 100 * i + k);
            ExampleWish wish{words[i].wish, &light, true, "none", {}};
            sheet.add(draw_example(random, views[k], {}, wish).image, words[i].word);
        }
    return sheet.finish();
}

Sheet light_sheet(const SheetOptions& options) {
    const std::array<ShapeView, 3> views{good_view("teddy", 1, options),
                                         good_view("teapot", 0, options),
                                         good_view("chair", 3, options)};
    const std::array<MaterialWish, 3> materials{MaterialWish{"plain", "white", ""},
                                                MaterialWish{"metal", "gold", ""},
                                                MaterialWish{"wood", "", ""}};
    const auto& kinds = light_kinds();
    SheetWriter sheet(options, views.size() * kinds.size());
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        const TrainingLight light = sheet_light(kinds[i], options.seed);
        for (std::size_t k = 0; k < views.size(); ++k) {
            Random random(options.seed, 9 + k);
            ExampleWish wish{materials[k], &light, true, "none", {}};
            sheet.add(draw_example(random, views[k], {}, wish).image, kinds[i]);
        }
    }
    return sheet.finish();
}

}  // namespace item3d
