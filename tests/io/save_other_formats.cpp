// Tests of save_model for formats other than glTF, and of its refusals.
#include "item3d/core/error.h"
#include "tests/support/io.h"

namespace item3d {
namespace {

using namespace testing_support;

TEST(SaveModel, ObjKeepsMaterials) {
    const fs::path folder = fresh_folder("obj");
    const Model model = load_model(data_folder() / "gltf" / "full_pbr.glb");
    save_model(folder / "a.obj", model);
    const Model back = load_model(folder / "a.obj");
    const Material& material = back.materials[0];
    ASSERT_GE(material.base_color_texture, 0);
    ASSERT_GE(material.metallic_roughness_texture, 0);
    ASSERT_GE(material.normal_texture, 0);
    EXPECT_NEAR(material.normal_scale, 0.5f, 1e-6f);
    const Image& orm = back.textures[material.metallic_roughness_texture].image;
    const Image& old = model.textures[model.materials[0].metallic_roughness_texture].image;
    EXPECT_NEAR(orm.at(0, 0, 1), old.at(0, 0, 1), 1e-6f);
    EXPECT_NEAR(orm.at(0, 0, 2), old.at(0, 0, 2), 1e-6f);
    expect_same_triangles(model, back, 1e-6f);
}

TEST(SaveModel, RefusesOtherExtensionsAndFolders) {
    const Model model = load_model(data_folder() / "gltf" / "sparse.gltf");
    EXPECT_THROW(save_model("/tmp/a.fbx", model), InputError);
    EXPECT_THROW(save_model("/nowhere/a.glb", model), InputError);
}

}  // namespace
}  // namespace item3d
