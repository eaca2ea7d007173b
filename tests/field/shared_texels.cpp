// Tests of UV maps that show a texel in several places. The field must have one value there, so
// that it can be baked.
#include "item3d/field/atlas/shared_texels.h"

#include "item3d/core/progress.h"
#include "item3d/field/adam.h"
#include "item3d/field/bake/bake.h"
#include "item3d/field/fit.h"
#include "item3d/render/srgb.h"
#include "tests/support/field_models.h"

#include <gtest/gtest.h>

#include <memory>

namespace item3d {
namespace {

using testing::make_model;
using testing::make_quad;

/// Returns a model of one material. Each texture has a single value, so that a field fits it.
Model make_plain(std::vector<Primitive> primitives, int width, int height, Wrap wrap) {
    Model model = make_model(primitives.front());
    model.primitives = std::move(primitives);
    for (Texture& texture : model.textures) {
        texture.image = Image(width, height, 3);
        std::fill(texture.image.pixels.begin(), texture.image.pixels.end(), 128.0f / 255);
        texture.wrap_u = texture.wrap_v = wrap;
    }
    return model;
}

/// Returns two quads, each of which shows half of a face. The UVs of the second quad are mirrored.
Model make_mirrored_halves() {
    return make_plain({make_quad(), make_quad(Vec2(1, 0), Vec2(0, 1), Vec3(2, 0, 0))}, 64, 64,
                      Wrap::repeat);
}

/// Returns a row of eight faces. The first four use one texel of a strip, the last four another
/// texel.
Model make_palette() {
    std::vector<Primitive> faces;
    for (int i = 0; i < 8; ++i) {
        const Vec2 uv((i < 4 ? 1.5f : 5.5f) / 8, 0.5f);
        faces.push_back(make_quad(uv, uv, Vec3(2.5f * static_cast<float>(i), 0, 0)));
    }
    return make_plain(std::move(faces), 8, 1, Wrap::clamp_to_edge);
}

struct SharedScene {
    explicit SharedScene(Model source, const std::vector<int>& edited = {0})
        : model((set_verbosity(Verbosity::quiet), std::move(source))),
          geometry(Geometry::from_model(model)),
          materials(model),
          space(model, edited),
          atlas(make_atlas(model, space, edited, 0, UvPolicy::automatic)) {
        space.share(std::make_shared<SharedTexels>(model, atlas, 0, at::kCPU));
    }
    ~SharedScene() { set_verbosity(Verbosity::normal); }

    Surface points(std::uint64_t seed, std::int64_t count = 4096) const {
        Random random(seed);
        return SurfaceSampler(geometry, space).sample(count, random);
    }

    Model model;
    Geometry geometry;
    TexturedMaterials materials;
    FieldSpace space;
    Atlas atlas;
};

/// Two fields that are fitted to the scene. One is then trained towards a colour that depends on
/// each point's position, but not on its texel.
struct Edited {
    explicit Edited(const SharedScene& scene) {
        NeuralTextureOptions options;
        options.levels = 5;
        options.log2_table_size = 14;
        options.base_resolution = 8;
        options.finest_resolution = 64;
        options.bounds = scene.space.bounds();
        now = NeuralTexture(options);
        FitOptions fit;
        fit.steps = 60;
        fit.batch = 2048;
        fit.show_progress = false;
        fit_to_materials(now, scene.geometry, scene.space, scene.materials, fit);
        fitted = snapshot(now);
        Adam adam;
        adam.add_group("table", {now->table()}, {.learning_rate = 0.01});
        adam.add_group("network", now->network_parameters(), {.learning_rate = 0.003});
        for (std::uint64_t i = 0; i < 30; ++i) {
            const Surface surface = scene.points(100 + i, 1024);
            const at::Tensor goal = 0.5f + 0.3f * at::sin(surface.position);
            adam.zero_grad();
            (now->forward(scene.space.positions(surface)).base_color - goal)
                .square()
                .mean()
                .backward();
            adam.step();
        }
        adam.zero_grad();
    }

    NeuralTexture now{nullptr}, fitted{nullptr};
};

ModelEdit baked_edit(const SharedScene& scene, Edited& edited) {
    BakeOptions options;
    options.show_progress = false;
    return bake({scene.model, scene.geometry, scene.materials, scene.space, scene.atlas},
                edited.fitted, edited.now, options);
}

/// Returns the PSNR in sRGB between the baked model and the field at surface points.
double psnr_of_bake(const SharedScene& scene, Edited& edited) {
    const at::NoGradGuard no_grad;
    const ModelEdit edit = baked_edit(scene, edited);
    Model baked = scene.model;
    baked.textures[0].image = *edit.materials.at(0).base_color;
    const Surface surface = scene.points(7);
    const at::Tensor seen = edited.now->forward(scene.space.positions(surface)).base_color;
    const at::Tensor shown = TexturedMaterials(baked).sample(surface).base_color;
    const double error =
        (linear_to_srgb(shown) - linear_to_srgb(seen.clamp(0, 1))).square().mean().item<double>();
    return -10 * std::log10(error);
}

TEST(SharedTexels, MirroredHalvesAreOnePlace) {
    const SharedScene scene(make_mirrored_halves());
    ASSERT_TRUE(scene.atlas.sets.at(0).is_own());
    ASSERT_TRUE(scene.atlas.has_shared_texels());
    const Surface surface = scene.points(3);
    const at::Tensor place = scene.space.positions(surface);
    const at::Tensor x = surface.position.select(1, 0);
    // The space maps points of the second quad to their mirror images in the first.
    const at::Tensor expected = at::where(x > 1, 2 - x, x);
    const at::Tensor apart = (place.select(1, 0) - expected).abs();
    EXPECT_LT(apart.max().item<float>(), 2 * 2.0f / 64);  // two texels, near the common edge
    EXPECT_LT(apart.median().item<float>(), 1e-5f);
    EXPECT_LT((place.select(1, 1) - surface.position.select(1, 1)).abs().max().item<float>(),
              1e-4f);
}

TEST(SharedTexels, ATextureThatRepeatsIsOnePlace) {
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat}) {
        const SharedScene scene(make_plain({make_quad(Vec2(0.0f), Vec2(3.0f))}, 32, 32, wrap));
        ASSERT_TRUE(scene.atlas.sets.at(0).is_own());
        const Surface surface = scene.points(3);
        const at::Tensor place = scene.space.positions(surface);
        // The quad's edge is 2 long, and the texture repeats three times along it. All points are
        // mapped into two adjacent repeats, which are 4 / 3 long together.
        for (int axis = 0; axis < 2; ++axis) {
            const at::Tensor along = place.select(1, axis);
            EXPECT_LT((along.max() - along.min()).item<float>(), 1.34f);
            const at::Tensor own = surface.position.select(1, axis);
            const at::Tensor turns = (own - along) * 1.5f;
            if (wrap == Wrap::repeat) {
                EXPECT_LT((turns - turns.round()).abs().max().item<float>(), 0.02f);
            }
        }
    }
}

TEST(SharedTexels, BakedIsWhatWasSeen) {
    for (const Model& model :
         {make_mirrored_halves(), make_palette(),
          make_plain({make_quad(Vec2(0.0f), Vec2(3.0f))}, 32, 32, Wrap::mirrored_repeat)}) {
        const SharedScene scene(model);
        ASSERT_TRUE(scene.atlas.sets.at(0).is_own());
        Edited edited(scene);
        EXPECT_GT(psnr_of_bake(scene, edited), 40);
    }
}

TEST(SharedTexels, MaterialsOfOneTextureAreBakedOnce) {
    Model model = make_mirrored_halves();
    model.materials.push_back(model.materials[0]);
    model.primitives[1].material = 1;
    const SharedScene scene(model, {0, 1});
    ASSERT_EQ(scene.atlas.sets.size(), 1u);
    ASSERT_TRUE(scene.atlas.has_shared_texels());
    Edited edited(scene);
    EXPECT_GT(psnr_of_bake(scene, edited), 40);
    const ModelEdit edit = baked_edit(scene, edited);
    EXPECT_EQ(edit.materials.at(0).base_color.identity(),
              edit.materials.at(1).base_color.identity());

    Model other = scene.model;
    other.materials[1].base_color_factor = Vec4(0.5f, 1, 1, 1);
    const SharedScene apart(other, {0, 1});
    EXPECT_EQ(apart.atlas.sets.size(), 2u);
    EXPECT_FALSE(apart.atlas.has_shared_texels());
}

TEST(SharedTexels, VertexColorsThatDifferGetTexelsOfTheirOwn) {
    Model model = make_mirrored_halves();
    model.textures.clear();
    Material& material = model.materials[0];
    material.base_color_texture = material.metallic_roughness_texture = -1;
    material.occlusion_texture = material.normal_texture = -1;
    const auto is_own = [&] {
        const FieldSpace space(model, {0});
        set_verbosity(Verbosity::quiet);
        const Atlas atlas = choose_uvs(model, space, {0}, UvPolicy::recolored);
        set_verbosity(Verbosity::normal);
        return atlas.sets.at(0).is_own();
    };
    for (Primitive& primitive : model.primitives)
        primitive.colors.assign(primitive.positions.size(), Vec4(1, 0.5f, 0, 1));
    EXPECT_TRUE(is_own());
    model.primitives[1].colors[0] = Vec4(0, 0, 1, 1);
    EXPECT_FALSE(is_own());
}

TEST(SharedTexels, FacesOfOneTexelAreOnePlace) {
    const SharedScene scene(make_palette());
    const Surface surface = scene.points(3, 256);
    const at::Tensor place = scene.space.positions(surface);
    const at::Tensor first = surface.position.select(1, 0) < 8.5f;
    for (const at::Tensor& half : {first, first.logical_not()}) {
        const at::Tensor places = place.index({half});
        EXPECT_LT((places - places[0]).abs().max().item<float>(), 1e-5f);
    }
}

TEST(SharedTexels, MapsWithoutSharedTexelsAreNotTouched) {
    const SharedScene scene(make_plain({make_quad()}, 16, 16, Wrap::repeat));
    EXPECT_FALSE(scene.atlas.has_shared_texels());
    const Surface surface = scene.points(3, 64);
    EXPECT_TRUE(at::equal(scene.space.positions(surface), surface.position));
}

}  // namespace
}  // namespace item3d
