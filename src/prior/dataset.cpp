#include "item3d/prior/dataset.h"

#include "item3d/core/error.h"
#include "item3d/prior/captions.h"
#include "item3d/prior/shapes.h"
#include "item3d/render/shade.h"

#include <algorithm>

namespace item3d {
namespace {

/// sRGB colours behind the object at the top and the bottom of the picture.
struct Background {
    Vec3 top, bottom;
};

Background random_background(Random& random, const std::string& light) {
    const auto draw = [&](double low, double high) {
        return static_cast<float>(random.uniform(low, high));
    };
    Vec3 color;
    if (random.chance(.85)) {
        // Greys, mostly light ones: what the editor renders against.
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

torch::Tensor to_image(const ShapeView& view, const torch::Tensor& encoded,
                       const Background& background, bool mirrored, torch::Tensor& covered) {
    torch::Tensor image = torch::empty({picture_size, picture_size, 3});
    covered = torch::zeros({picture_size, picture_size});
    auto* out = image.data_ptr<float>();
    auto* cover = covered.data_ptr<float>();
    std::vector<Vec3> sum(static_cast<std::size_t>(picture_size) * picture_size, Vec3(0.0f));
    const auto* color = encoded.data_ptr<float>();
    for (std::size_t i = 0; i < view.count(); ++i) {
        const int y = view.pixel[i] / view_size / 2;
        int x = view.pixel[i] % view_size / 2;
        if (mirrored) x = picture_size - 1 - x;
        const auto at = static_cast<std::size_t>(y * picture_size + x);
        cover[at] += .25f;
        sum[at] += Vec3(color[3 * i], color[3 * i + 1], color[3 * i + 2]) * .25f;
    }
    for (int y = 0; y < picture_size; ++y) {
        const Vec3 behind =
            glm::mix(background.top, background.bottom, static_cast<float>(y) / (picture_size - 1));
        for (int x = 0; x < picture_size; ++x) {
            const auto at = static_cast<std::size_t>(y * picture_size + x);
            const Vec3 value = sum[at] + behind * (1 - cover[at]);
            for (std::size_t c = 0; c < 3; ++c)
                out[3 * at + c] = value[static_cast<int>(c)];
        }
    }
    return image;
}

}  // namespace

ExampleSource::ExampleSource(std::vector<ShapeView> views, std::vector<TrainingLight> lights,
                             std::uint64_t seed)
    : views_(std::move(views)), lights_(std::move(lights)), seed_(seed) {
    ITEM3D_CHECK(!views_.empty() && !lights_.empty(), "examples need views and lights");
}

Example ExampleSource::draw(std::int64_t index) const {
    Random random(seed_, static_cast<std::uint64_t>(index));
    const auto view =
        static_cast<std::size_t>(random.index(static_cast<std::int64_t>(views_.size())));
    return draw_example(random, views_[view], lights_);
}

Example draw_example(Random& random, const ShapeView& view,
                     const std::vector<TrainingLight>& lights, const ExampleWish& wish) {
    ITEM3D_CHECK(wish.light || !lights.empty(), "an example needs a light");
    const torch::NoGradGuard no_grad;
    const ProceduralMaterial material = make_material(random, wish.material);
    const TrainingLight& light = wish.light ? *wish.light
                                            : lights[static_cast<std::size_t>(random.index(
                                                  static_cast<std::int64_t>(lights.size())))];
    const float occlusion_weight =
        random.chance(.5) ? 0.0f : static_cast<float>(random.uniform(.3, .8));
    const auto exposure =
        static_cast<float>(std::exp(random.normal(0, wish.plain_background ? 0 : .12)));
    const bool mirrored = random.chance(.5);

    const auto count = static_cast<std::int64_t>(view.count());
    Surface surface;
    surface.pixel = torch::empty({count}, torch::kInt64);  // says how many points there are
    surface.position = torch::empty({count, 3});
    surface.normal = torch::empty({count, 3});
    surface.view = torch::empty({count, 3});
    surface.tangent = torch::zeros({count, 4});
    MaterialSample sample;
    sample.base_color = torch::empty({count, 3});
    sample.orm = torch::empty({count, 3});
    auto* position = surface.position.data_ptr<float>();
    auto* normal = surface.normal.data_ptr<float>();
    auto* direction = surface.view.data_ptr<float>();
    auto* base = sample.base_color.data_ptr<float>();
    auto* orm = sample.orm.data_ptr<float>();
    for (std::size_t i = 0; i < view.count(); ++i) {
        const Vec3 p = view.position_at(i), n = view.normal_at(i);
        const Vec3 v = glm::normalize(view.camera - p);
        const MaterialValue value = material.at(p, n);
        for (std::size_t c = 0; c < 3; ++c) {
            const int k = static_cast<int>(c);
            position[3 * i + c] = p[k];
            normal[3 * i + c] = n[k];
            direction[3 * i + c] = v[k];
            base[3 * i + c] = value.base_color[k];
        }
        orm[3 * i] = 1 - occlusion_weight * (1 - static_cast<float>(view.occlusion[i]) / 255.0f);
        orm[3 * i + 1] = std::clamp(value.roughness, .05f, 1.0f);
        orm[3 * i + 2] = value.metallic;
    }
    const torch::Tensor radiance = shade(surface, sample, light.light) * exposure;
    const torch::Tensor encoded = linear_to_srgb(radiance.clamp(0, 1)).contiguous();

    Background background = random_background(random, light.kind);
    if (wish.plain_background) background = {Vec3(.8f), Vec3(.8f)};
    Example example;
    example.image = to_image(view, encoded, background, mirrored, example.covered);
    example.depth = mirrored ? view.depth.flip(2) : view.depth;
    const ShapeClass& shape = shape_classes()[static_cast<std::size_t>(view.shape_class)];
    example.caption = make_caption(random, shape.nouns, material.phrases, light.phrases);
    example.facts = facts_of(shape, material, light);
    example.material = material.kind;
    example.light = light.kind;
    return example;
}

}  // namespace item3d
