#include "item3d/prior/data/dataset.h"

#include "item3d/core/error.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/instructions.h"
#include "item3d/prior/data/shapes/shapes.h"
#include "item3d/render/image_tensor.h"
#include "item3d/render/shade.h"
#include "item3d/render/srgb.h"

#include <algorithm>
#include <optional>

namespace item3d {
namespace {

/// sRGB colours behind the object at the top and the bottom of the image.
struct Background {
    Vec3 top, bottom;
};

Background random_background(Random& random, const std::string& light) {
    const auto draw = [&](double low, double high) {
        return static_cast<float>(random.uniform(low, high));
    };
    Vec3 color;
    if (random.chance(.85)) {
        // Most backgrounds are grey, mostly light grey, like those that edits render over.
        color = Vec3(random.chance(.75) ? draw(.5, 1) : draw(.02, .5));
        for (int c = 0; c < 3; ++c)
            color[c] += static_cast<float>(random.normal(0, .015));
    } else {
        color = Vec3{draw(.1, .95), draw(.1, .95), draw(.1, .95)};
    }
    if (light == "sunset" && random.chance(.4)) color = Vec3(.85f, .5f, .35f) * draw(.7, 1.1);
    if (light == "night" && random.chance(.5)) color = Vec3(.06f, .07f, .12f) * draw(.3, 1.6);
    const Vec3 other = random.chance(.3) ? color * draw(.6, 1.3) : color;
    return {glm::clamp(color, 0.0f, 1.0f), glm::clamp(other, 0.0f, 1.0f)};
}

at::Tensor to_image(const ShapeView& view, const at::Tensor& encoded, const Background& background,
                    bool mirrored, at::Tensor& covered) {
    const int size = view.size / view_samples;
    constexpr float share = 1.0f / (view_samples * view_samples);
    at::Tensor image = at::empty({size, size, 3});
    covered = at::zeros({size, size});
    auto* out = image.data_ptr<float>();
    auto* cover = covered.data_ptr<float>();
    std::vector<Vec3> sum(static_cast<std::size_t>(size) * size, Vec3(0.0f));
    const auto* color = encoded.data_ptr<float>();
    for (std::size_t i = 0; i < view.count(); ++i) {
        const int y = view.pixel[i] / view.size / view_samples;
        int x = view.pixel[i] % view.size / view_samples;
        if (mirrored) x = size - 1 - x;
        const auto at = static_cast<std::size_t>(y * size + x);
        cover[at] += share;
        sum[at] += Vec3(color[3 * i], color[3 * i + 1], color[3 * i + 2]) * share;
    }
    for (int y = 0; y < size; ++y) {
        const Vec3 behind =
            glm::mix(background.top, background.bottom, static_cast<float>(y) / (size - 1));
        for (int x = 0; x < size; ++x) {
            const auto at = static_cast<std::size_t>(y * size + x);
            const Vec3 value = sum[at] + behind * (1 - cover[at]);
            for (std::size_t c = 0; c < 3; ++c)
                out[3 * at + c] = value[static_cast<int>(c)];
        }
    }
    return image;
}

/// Draws a part with its own material, or none. `index` becomes its index in view.parts.
std::optional<PartMaterial> draw_part(Random& random, const ShapeView& view,
                                      const ProceduralMaterial& rest, const ExampleWish& wish,
                                      std::size_t& index) {
    const std::vector<std::size_t> visible = visible_parts(view);
    if (wish.part == "none" || visible.empty()) return {};
    if (!wish.part.empty()) {
        const auto found = std::find(view.parts.begin(), view.parts.end(), wish.part);
        if (found == view.parts.end()) return {};
        index = static_cast<std::size_t>(found - view.parts.begin());
    } else {
        if (!random.chance(two_part_share)) return {};
        index = visible[static_cast<std::size_t>(
            random.index(static_cast<std::int64_t>(visible.size())))];
    }
    MaterialWish own = wish.part_material;
    // Patterns are hard to see on small parts, so half of the free choices are plain.
    if (own.kind.empty() && random.chance(.5)) own.kind = "plain";
    ProceduralMaterial material = make_material(random, own);
    while (wish.part_material.kind.empty() && material.kind == rest.kind &&
           material.color == rest.color)
        material = make_material(random, own);
    return PartMaterial{view.parts[index], std::move(material)};
}

/// Fills in material values and normals of a view's points. The occlusion in `orm` is the fraction
/// of the light that arrives.
void fill_points(const ShapeView& view, const ProceduralMaterial& rest, const PartMaterial* part,
                 std::size_t part_index, const SkyLight& sky, float shadow, Surface& surface,
                 MaterialSample& sample) {
    const auto count = static_cast<std::int64_t>(view.count());
    surface.pixel = at::empty({count}, at::kLong);  // determines the number of points
    surface.position = at::empty({count, 3});
    surface.normal = at::empty({count, 3});
    surface.view = at::empty({count, 3});
    surface.tangent = at::zeros({count, 4});
    sample.base_color = at::empty({count, 3});
    sample.orm = at::empty({count, 3});
    auto* position = surface.position.data_ptr<float>();
    auto* normal = surface.normal.data_ptr<float>();
    auto* direction = surface.view.data_ptr<float>();
    auto* base = sample.base_color.data_ptr<float>();
    auto* orm = sample.orm.data_ptr<float>();
    for (std::size_t i = 0; i < view.count(); ++i) {
        const Vec3 p = view.position_at(i), n = view.normal_at(i);
        const Vec3 v = glm::normalize(view.camera - p);
        const bool own = part && view.part[i] == part_index;
        const MaterialValue value = (own ? part->material : rest).at(p, n);
        const Vec3 bent = value.slope == Vec3(0.0f) ? n : bent_normal(n, value.slope);
        for (std::size_t c = 0; c < 3; ++c) {
            const int k = static_cast<int>(c);
            position[3 * i + c] = p[k];
            normal[3 * i + c] = bent[k];
            direction[3 * i + c] = v[k];
            base[3 * i + c] = value.base_color[k];
        }
        orm[3 * i] = shadow > 0 ? 1 - shadow * (1 - arriving_share(view.sky[i], n, sky)) : 1.0f;
        orm[3 * i + 1] = std::clamp(value.roughness, .05f, 1.0f);
        orm[3 * i + 2] = value.metallic;
    }
}

}  // namespace

std::vector<std::size_t> visible_parts(const ShapeView& view) {
    std::vector<std::size_t> counts(view.parts.size(), 0);
    for (const std::uint8_t part : view.part)
        ++counts[part];
    std::vector<std::size_t> visible;
    for (std::size_t i = 1; i < counts.size(); ++i)
        if (counts[i] * 50 > view.count() && counts[i] * 10 < view.count() * 9)
            visible.push_back(i);
    return visible;
}

ExampleSource::ExampleSource(std::vector<ShapeView> views, std::vector<TrainingLight> lights,
                             std::uint64_t seed, float pattern_weight)
    : views_(std::move(views)), lights_(std::move(lights)), seed_(seed) {
    wish_.material.pattern_weight = pattern_weight;
    wish_.part_material.pattern_weight = pattern_weight;
    ITEM3D_CHECK(!views_.empty() && !lights_.empty(), "examples need views and lights");
}

const ShapeView& ExampleSource::draw_view(Random& random) const {
    return views_[static_cast<std::size_t>(random.index(static_cast<std::int64_t>(views_.size())))];
}

Example ExampleSource::draw(std::int64_t index) const {
    Random random(seed_, static_cast<std::uint64_t>(index));
    return draw_example(random, draw_view(random), lights_, wish_);
}

InstructionPair ExampleSource::draw_pair(std::int64_t index) const {
    Random random(seed_, static_cast<std::uint64_t>(index));
    return draw_instruction_pair(random, draw_view(random), lights_, wish_);
}

namespace {

const TrainingLight& draw_light(Random& random, const std::vector<TrainingLight>& lights,
                                const ExampleWish& wish) {
    ITEM3D_CHECK(wish.light || !lights.empty(), "an example needs a light");
    if (wish.light) return *wish.light;
    return lights[static_cast<std::size_t>(random.index(static_cast<std::int64_t>(lights.size())))];
}

/// Inputs of an image besides its view and materials.
struct Scenery {
    const TrainingLight& light;
    float shadow, exposure;
    bool mirrored;
    Background background;
};

Scenery draw_scenery(Random& random, const TrainingLight& light, const ExampleWish& wish) {
    // An edit may render with or without shadows.
    const float shadow = random.chance(.3) ? 0.0f : static_cast<float>(random.uniform(.6, 1));
    const auto exposure =
        static_cast<float>(std::exp(random.normal(0, wish.plain_background ? 0 : .12)));
    const bool mirrored = random.chance(.5);
    Background background = random_background(random, light.kind);
    if (wish.plain_background) background = {Vec3(.8f), Vec3(.8f)};
    return {light, shadow, exposure, mirrored, background};
}

/// Draws an image of the view. Sets `covered`, see Example::covered.
at::Tensor draw_image(const ShapeView& view, const Scenery& scenery, const ProceduralMaterial& rest,
                      const PartMaterial* part, std::size_t part_index, at::Tensor& covered) {
    Surface surface;
    MaterialSample sample;
    fill_points(view, rest, part, part_index, scenery.light.sky, scenery.shadow, surface, sample);
    const at::Tensor radiance = shade(surface, sample, scenery.light.light) * scenery.exposure;
    const at::Tensor encoded = linear_to_srgb(radiance.clamp(0, 1)).contiguous();
    return to_image(view, encoded, scenery.background, scenery.mirrored, covered);
}

at::Tensor cells_of(const ShapeView& view, const Scenery& scenery) {
    return scenery.mirrored ? view.cells.flip(2) : view.cells;
}

}  // namespace

Example draw_example(Random& random, const ShapeView& view,
                     const std::vector<TrainingLight>& lights, const ExampleWish& wish) {
    const at::NoGradGuard no_grad;
    const ProceduralMaterial material = make_material(random, wish.material);
    const TrainingLight& light = draw_light(random, lights, wish);
    std::size_t part_index = 0;
    const std::optional<PartMaterial> part = draw_part(random, view, material, wish, part_index);
    const PartMaterial* own = part ? &*part : nullptr;
    const Scenery scenery = draw_scenery(random, light, wish);

    Example example;
    example.image = draw_image(view, scenery, material, own, part_index, example.covered);
    example.cells = cells_of(view, scenery);
    const ShapeClass& shape = shape_classes()[static_cast<std::size_t>(view.shape_class)];
    ImageWords words{shape.nouns, material.phrases, light.phrases, {}};
    if (part) words.part = PartWords{part->noun, part->material.phrases};
    example.caption = make_caption(random, words);
    example.labels = labels_of(shape, material, light, own);
    example.material = material.kind;
    example.light = light.kind;
    example.view = &view;
    example.mirrored = scenery.mirrored;
    example.own_part = part_index;
    example.phrases = material.phrases;
    if (part) example.part_phrases = part->material.phrases;
    return example;
}

InstructionPair draw_instruction_pair(Random& random, const ShapeView& view,
                                      const std::vector<TrainingLight>& lights,
                                      const ExampleWish& wish) {
    const at::NoGradGuard no_grad;
    const ProceduralMaterial material = make_material(random, wish.material);
    const TrainingLight& light = draw_light(random, lights, wish);
    std::size_t part_index = 0;
    const std::optional<PartMaterial> part = draw_part(random, view, material, wish, part_index);
    const Scenery scenery = draw_scenery(random, light, wish);
    const ShapeClass& shape = shape_classes()[static_cast<std::size_t>(view.shape_class)];

    InstructionPair pair;
    at::Tensor covered;
    pair.cells = cells_of(view, scenery);
    pair.before = draw_image(view, scenery, material, nullptr, 0, covered);
    if (part) {
        pair.after = draw_image(view, scenery, material, &*part, part_index, covered);
        pair.instruction = instruction_for_part(random, part->noun, part->material.phrases);
        return pair;
    }
    ProceduralMaterial other = make_material(random, wish.material);
    while (other.kind == material.kind && other.color == material.color)
        other = make_material(random, wish.material);
    pair.after = draw_image(view, scenery, other, nullptr, 0, covered);
    pair.instruction = instruction_for_object(random, shape.nouns, other.phrases);
    return pair;
}

}  // namespace item3d
