// Fixture for the tests of the baseline methods: a textured sphere, which a small prior paints.
#pragma once

#include "item3d/baselines/painting_scene.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/render/scatter.h"
#include "tests/support/field_models.h"

#include <filesystem>
#include <memory>

namespace item3d::testing {

inline double largest_apart(const at::Tensor& a, const at::Tensor& b) {
    return (a - b).abs().max().item<double>();
}

inline std::filesystem::path model_folder(const char* name) {
    return std::filesystem::path(ITEM3D_TEST_DATA) / "models" / name;
}

/// Painting scene of a unit sphere with a grey texture of edge x edge texels.
struct SphereScene {
    explicit SphereScene(int edge) {
        model.primitives = {make_sphere()};
        Texture texture;
        texture.image = Image(edge, edge, 3);
        for (float& value : texture.image.pixels)
            value = 0.25f;
        model.textures = {texture};
        Material material;
        material.base_color_texture = 0;
        model.materials = {material};
        const FieldSpace space(model, {0});
        const Atlas atlas = make_atlas(model, space, {0}, 0, UvPolicy::keep);
        materials = std::make_unique<TexturedMaterials>(model);
        scene.geometry = atlas_geometry(model, atlas, at::kCPU);
        scene.texels = std::make_unique<const TexelList>(model, scene.geometry, atlas, 0, edge);
        scene.latent_texels =
            std::make_unique<const TexelList>(model, scene.geometry, atlas, 0, edge);
        scene.source = at::full({scene.texels->count(), 3}, 0.25f);
        scene.weight = at::ones({scene.texels->count(), 1});
        scene.materials = materials.get();
        scene.points = model.primitives[0].positions;
        scene.prompt = "a blue ball";
        scene.resolution = 32;
        scene.shape = [](const Raster& raster, const Surface& surface) {
            const auto pixels = [&](const at::Tensor& values) {
                return scatter(values, surface, raster, at::zeros({3}));
            };
            return SeenShape{raster.depth, pixels(surface.position), pixels(surface.normal)};
        };
    }
    /// Loads a small prior of random weights.
    void load_prior() {
        scene.prior = std::make_shared<Pipeline>(Pipeline::load(model_folder("pipeline_sd")));
    }

    Model model;
    std::unique_ptr<TexturedMaterials> materials;
    PaintingScene scene;
};

}  // namespace item3d::testing
