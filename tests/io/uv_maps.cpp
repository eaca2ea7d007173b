// Tests of materials whose textures use different texture coordinates.
#include "tests/support/gltf_quad.h"

namespace item3d {
namespace {

using namespace testing_support;

std::string warnings_of(const fs::path& path, Model* model = nullptr) {
    testing::internal::CaptureStderr();
    const Model loaded = load_model(path);
    if (model) *model = loaded;
    return testing::internal::GetCapturedStderr();
}

/// Returns a quad whose base colour and emission use TEXCOORD_0 and whose normals use TEXCOORD_1.
/// The occlusion uses TEXCOORD_1 with a transform.
GltfQuad quad_of_three_layouts() {
    GltfQuad quad;
    const std::size_t texture = quad.add_texture(two_columns(Vec3(1, 0, 0), Vec3(0, 1, 0)));
    quad.primitive()["attributes"]["TEXCOORD_1"] =
        quad.add_floats({0, 0.5f, 0.5f, 0.5f, 0.5f, 0, 0, 0}, "VEC2");
    quad.set_base_color(texture);
    GltfJson& material = quad.material();
    material["normalTexture"] = {{"index", texture}, {"texCoord", 1}};
    material["occlusionTexture"] = {{"index", texture}, {"texCoord", 0}};
    material["occlusionTexture"]["extensions"]["KHR_texture_transform"] = {
        {"offset", {0.25, 0}}, {"scale", {2, 2}}, {"texCoord", 1}};
    material["emissiveTexture"]["index"] = texture;
    quad.use("KHR_texture_transform");
    return quad;
}

TEST(UvMaps, EachTextureHasItsOwn) {
    Model model;
    EXPECT_EQ(warnings_of(quad_of_three_layouts().write(fresh_folder("uv_maps")), &model), "");
    const Material& material = model.materials[0];
    EXPECT_GE(material.base_color_texture, 0);
    EXPECT_GE(material.normal_texture, 0);
    EXPECT_GE(material.occlusion_texture, 0);
    EXPECT_EQ(material.normal_uvs, 1);
    EXPECT_EQ(material.occlusion_uvs, 2);
    EXPECT_EQ(material.emissive_uvs, 0);
    const Primitive& primitive = model.primitives[0];
    EXPECT_EQ(primitive.uvs[1], Vec2(1, 1));
    ASSERT_EQ(primitive.further_uvs.size(), 2u);
    EXPECT_EQ(primitive.further_uvs[0][1], Vec2(0.5f, 0.5f));
    EXPECT_EQ(primitive.further_uvs[1][1], Vec2(1.25f, 1.0f));
}

TEST(UvMaps, AreSplitWithTheCornersOfFlatMeshes) {
    GltfQuad quad = quad_of_three_layouts();
    quad.primitive()["attributes"].erase("NORMAL");
    const Model model = load_model(quad.write(fresh_folder("uv_maps_flat")));
    const Primitive& primitive = model.primitives[0];
    ASSERT_EQ(primitive.positions.size(), 6u);
    for (const std::vector<Vec2>& map : primitive.further_uvs)
        ASSERT_EQ(map.size(), 6u);
    EXPECT_EQ(primitive.further_uvs[0][4], primitive.uvs[4] * 0.5f);
}

TEST(UvMaps, OneThatIsMissingIsAWarningAndTheFactor) {
    GltfQuad quad = quad_of_three_layouts();
    quad.material()["normalTexture"]["texCoord"] = 5;
    Model model;
    const std::string warnings = warnings_of(quad.write(fresh_folder("uv_maps_missing")), &model);
    EXPECT_NE(warnings.find("normalTexture uses TEXCOORD_5"), std::string::npos) << warnings;
    EXPECT_EQ(std::count(warnings.begin(), warnings.end(), '\n'), 1) << warnings;
    EXPECT_EQ(model.materials[0].normal_texture, -1);
    EXPECT_GE(model.materials[0].occlusion_texture, 0);
}

TEST(UvMaps, OneThatSomeMeshesLackIsAWarning) {
    GltfQuad quad;
    quad.set_base_color(quad.add_texture(plain_image(2, Vec3(1, 0, 0))));
    GltfJson plain = quad.primitive();
    plain["attributes"].erase("TEXCOORD_0");
    quad.json["meshes"][0]["primitives"].push_back(plain);
    Model model;
    const std::string warnings = warnings_of(quad.write(fresh_folder("uv_maps_some")), &model);
    EXPECT_NE(warnings.find("1 of its 2 meshes"), std::string::npos) << warnings;
    EXPECT_GE(model.materials[0].base_color_texture, 0);
}

TEST(UvMaps, OfMadeModelsAreWritten) {
    Model model = load_model(quad_of_three_layouts().write(fresh_folder("uv_maps_made")));
    model.source = nullptr;
    const fs::path path = fresh_folder("uv_maps_made_out") / "made.glb";
    save_model(path, model);
    const Model back = load_model(path);
    EXPECT_EQ(back.materials[0].normal_uvs, 1);
    EXPECT_EQ(back.primitives[0].further_uvs, model.primitives[0].further_uvs);
}

ModelEdit edit_with_new_uvs(const Model& model) {
    ModelEdit edit;
    edit.materials[0].base_color = plain_image(4, Vec3(0, 0, 1));
    edit.primitives[0] = exploded(model.primitives[0]);
    return edit;
}

TEST(UvMaps, OfTheSourceStayShownBesideANewOne) {
    const Model model = load_model(quad_of_three_layouts().write(fresh_folder("uv_maps_new")));
    const fs::path path = fresh_folder("uv_maps_new_out") / "new.glb";
    save_model(path, model, edit_with_new_uvs(model));
    Model back;
    EXPECT_EQ(warnings_of(path, &back), "");
    EXPECT_GE(back.materials[0].normal_texture, 0);
    EXPECT_NE(back.materials[0].normal_uvs, 0);
    EXPECT_NE(back.materials[0].occlusion_uvs, back.materials[0].normal_uvs);
    const PrimitiveEdit edit = edit_with_new_uvs(model).primitives.at(0);
    const auto& normal_map =
        back.primitives[0].further_uvs[static_cast<std::size_t>(back.materials[0].normal_uvs - 1)];
    for (std::size_t i = 0; i < edit.uvs.size(); ++i) {
        EXPECT_EQ(back.primitives[0].uvs[i], edit.uvs[i]);
        EXPECT_EQ(normal_map[i], model.primitives[0].further_uvs[0][edit.source_vertices[i]]);
    }
}

TEST(UvMaps, OcclusionThatIsKeptStaysWhereItWas) {
    const fs::path source = quad_of_three_layouts().write(fresh_folder("uv_maps_kept"));
    const Model model = load_model(source);
    const fs::path path = fresh_folder("uv_maps_kept_out") / "kept.gltf";
    ModelEdit edit;
    edit.materials[0].metallic_roughness = plain_image(4, Vec3(1, 0.5f, 0));
    edit.materials[0].keeps_occlusion = true;
    save_model(path, model, edit);
    const auto before = read_gltf_file(source).json["materials"][0]["occlusionTexture"];
    EXPECT_EQ(read_gltf_file(path).json["materials"][0]["occlusionTexture"], before);
    edit.materials[0].keeps_occlusion = false;
    save_model(path, model, edit);
    const auto after = read_gltf_file(path).json["materials"][0];
    EXPECT_EQ(after["occlusionTexture"]["index"],
              after["pbrMetallicRoughness"]["metallicRoughnessTexture"]["index"]);
    EXPECT_FALSE(after["occlusionTexture"].contains("texCoord"));
}

TEST(UvMaps, ANormalTextureThatMovesTakesItsTangentsAlong) {
    GltfQuad quad = quad_of_three_layouts();
    quad.primitive()["attributes"]["TANGENT"] =
        quad.add_floats({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4");
    const Model model = load_model(quad.write(fresh_folder("uv_maps_tangents")));
    const fs::path path = fresh_folder("uv_maps_tangents_out") / "moved.gltf";
    ModelEdit edit;
    edit.materials[0].normal = plain_image(4, Vec3(0.5f, 0.5f, 1));
    save_model(path, model, edit);
    const auto json = read_gltf_file(path).json;
    EXPECT_FALSE(json["meshes"][0]["primitives"][0]["attributes"].contains("TANGENT"));
    EXPECT_FALSE(json["materials"][0]["normalTexture"].contains("texCoord"));
}

TEST(Samplers, AreRead) {
    GltfQuad quad;
    quad.set_base_color(quad.add_texture(plain_image(2, Vec3(1, 0, 0))));
    quad.json["samplers"] =
        GltfJson::array({GltfJson{{"magFilter", 9728}, {"wrapS", 33071}, {"wrapT", 33648}}});
    quad.json["textures"][0]["sampler"] = 0;
    const fs::path folder = fresh_folder("samplers");
    Model model = load_model(quad.write(folder));
    EXPECT_TRUE(model.textures[0].nearest);
    EXPECT_EQ(model.textures[0].wrap_u, Wrap::clamp_to_edge);
    EXPECT_EQ(model.textures[0].wrap_v, Wrap::mirrored_repeat);
    model.source = nullptr;
    save_model(folder / "made.glb", model);
    EXPECT_TRUE(load_model(folder / "made.glb").textures[0].nearest);
    quad.json["samplers"][0]["magFilter"] = 9729;
    EXPECT_FALSE(load_model(quad.write(folder)).textures[0].nearest);
}

}  // namespace
}  // namespace item3d
