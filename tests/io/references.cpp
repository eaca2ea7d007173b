// Tests of an edited glTF's other references to textures that the edit replaced.
#include "tests/support/gltf_quad.h"

namespace item3d {
namespace {

using namespace testing_support;

struct Written {
    GltfJson json;
    std::string messages;
};

/// Returns the document after an edit of material 0, which sets the base colour unless `material`
/// has other maps.
Written edited(GltfQuad& quad, const std::string& name, MaterialEdit material = {},
               bool new_uvs = false) {
    const Model model = load_model(quad.write(fresh_folder("references_" + name)));
    ModelEdit edit;
    if (!material.metallic_roughness) material.base_color = plain_image(4, Vec3(0, 0, 1));
    edit.materials[0] = std::move(material);
    if (new_uvs) edit.primitives[0] = exploded(model.primitives[0]);
    const fs::path path = fresh_folder("references_" + name + "_out") / "out.gltf";
    testing::internal::CaptureStderr();
    save_model(path, model, edit);
    const std::string messages = testing::internal::GetCapturedStderr();
    load_model(path);
    return {read_gltf_file(path).json, messages};
}

GltfQuad painted_quad() {
    GltfQuad quad;
    quad.set_base_color(quad.add_texture(plain_image(2, Vec3(1, 0, 0))));
    return quad;
}

std::size_t base_color_index(const GltfJson& json, std::size_t material = 0) {
    return json["materials"][material]["pbrMetallicRoughness"]["baseColorTexture"]["index"];
}

bool names_extension(const GltfJson& json, const char* key, const std::string& name) {
    return json.contains(key) &&
           std::find(json[key].begin(), json[key].end(), GltfJson(name)) != json[key].end();
}

TEST(References, EmissionOfTheSameImageFollowsOrGoes) {
    GltfQuad quad = painted_quad();
    quad.material()["emissiveFactor"] = {1, 1, 1};
    // The emission has another texture and another image, but with equal content.
    quad.material()["emissiveTexture"]["index"] = quad.add_texture(plain_image(2, Vec3(1, 0, 0)));
    GltfJson followed = edited(quad, "emission").json;
    EXPECT_EQ(followed["materials"][0]["emissiveTexture"]["index"], base_color_index(followed));
    MaterialEdit without;
    without.removes_emission = true;
    GltfJson gone = edited(quad, "emission_gone", without).json;
    EXPECT_FALSE(gone["materials"][0].contains("emissiveTexture"));
    EXPECT_FALSE(gone["materials"][0].contains("emissiveFactor"));
}

TEST(References, EmissionOfAnotherImageStays) {
    GltfQuad quad = painted_quad();
    quad.material()["emissiveTexture"]["index"] = quad.add_texture(plain_image(2, Vec3(0, 1, 0)));
    GltfJson json = edited(quad, "emission_other").json;
    EXPECT_EQ(json["textures"].size(), 2u);
    EXPECT_NE(json["materials"][0]["emissiveTexture"]["index"], base_color_index(json));
}

TEST(References, EmissionThatUnlitHidDoesNotBeginToGlow) {
    GltfQuad quad = painted_quad();
    quad.material()["emissiveFactor"] = {1, 1, 1};
    quad.material()["emissiveTexture"]["index"] = 0;
    quad.material()["extensions"]["KHR_materials_unlit"] = GltfJson::object();
    quad.material()["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 5;
    quad.use("KHR_materials_unlit");
    quad.use("KHR_materials_emissive_strength");
    GltfJson json = edited(quad, "unlit").json;
    EXPECT_FALSE(json["materials"][0].contains("emissiveTexture"));
    EXPECT_FALSE(json["materials"][0].contains("emissiveFactor"));
    EXPECT_FALSE(json["materials"][0].contains("extensions"));
    EXPECT_FALSE(json.contains("extensionsUsed"));
}

TEST(References, ToonTexturesOfBothVrmVersionsFollow) {
    GltfQuad quad = painted_quad();
    quad.material()["extensions"]["VRMC_materials_mtoon"]["shadeMultiplyTexture"]["index"] = 0;
    GltfJson properties;
    properties["textureProperties"] = {{"_MainTex", 0}, {"_ShadeTexture", 0}};
    properties["vectorProperties"]["_Color"] = {0.5, 0.5, 0.5, 0.25};
    quad.json["extensions"]["VRM"]["materialProperties"] = GltfJson::array({properties});
    quad.use("VRMC_materials_mtoon");
    quad.use("VRM");
    Written written = edited(quad, "toon");
    const std::size_t texture = base_color_index(written.json);
    EXPECT_EQ(written.json["textures"].size(), 1u);  // nothing refers to the old texture
    EXPECT_EQ(written.json["materials"][0]["extensions"]["VRMC_materials_mtoon"]
                          ["shadeMultiplyTexture"]["index"],
              texture);
    GltfJson& old = written.json["extensions"]["VRM"]["materialProperties"][0];
    EXPECT_EQ(old["textureProperties"]["_MainTex"], texture);
    EXPECT_EQ(old["textureProperties"]["_ShadeTexture"], texture);
    EXPECT_EQ(old["vectorProperties"]["_Color"], GltfJson({1, 1, 1, 0.25}));
    EXPECT_EQ(written.messages, "");
}

TEST(References, ToonTexturesOfTheirOwnAreAWarning) {
    GltfQuad quad = painted_quad();
    const std::size_t shade = quad.add_texture(plain_image(2, Vec3(0.5f, 0, 0)));
    quad.material()["extensions"]["VRMC_materials_mtoon"]["shadeMultiplyTexture"]["index"] = shade;
    Written written = edited(quad, "toon_own");
    EXPECT_EQ(written.json["textures"].size(), 2u);
    EXPECT_NE(written.json["materials"][0]["extensions"]["VRMC_materials_mtoon"]
                          ["shadeMultiplyTexture"]["index"],
              base_color_index(written.json));
    EXPECT_NE(written.messages.find("shadeMultiplyTexture"), std::string::npos);
}

TEST(References, AnAvatarKeepsItsEnding) {
    GltfQuad quad = painted_quad();
    const Model model = load_model(quad.write(fresh_folder("references_vrm")));
    const fs::path path = fresh_folder("references_vrm_out") / "avatar.vrm";
    save_model(path, model);
    EXPECT_EQ(load_model(path).primitives.size(), 1u);
    EXPECT_TRUE(read_gltf_file(path).json.contains("meshes"));
}

TEST(References, FeatureTexturesFollowTheOldUvMap) {
    GltfQuad quad = painted_quad();
    const std::size_t ids = quad.add_texture(plain_image(2, Vec3(0, 0, 0)));
    GltfJson feature;
    feature["featureCount"] = 2;
    feature["texture"] = {{"index", ids}, {"texCoord", 0}, {"channels", {0}}};
    quad.primitive()["extensions"]["EXT_mesh_features"]["featureIds"] = GltfJson::array({feature});
    GltfJson json = edited(quad, "features", {}, true).json;
    GltfJson& primitive = json["meshes"][0]["primitives"][0];
    EXPECT_TRUE(primitive["attributes"].contains("TEXCOORD_1"));
    EXPECT_EQ(primitive["extensions"]["EXT_mesh_features"]["featureIds"][0]["texture"]["texCoord"],
              1);
    EXPECT_FALSE(
        json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"].contains("texCoord"));
}

TEST(References, LodMaterialsFollowTheOldUvMap) {
    GltfQuad quad = painted_quad();
    quad.material()["extensions"]["MSFT_lod"]["ids"] = {1};
    GltfJson far = quad.material();
    far.erase("extensions");
    quad.json["materials"].push_back(far);
    GltfJson json = edited(quad, "lod", {}, true).json;
    EXPECT_EQ(json["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"], 1);

    // If another primitive uses material 1 too, the old UV map stays in place.
    GltfJson other = quad.primitive();
    other["material"] = 1;
    quad.json["meshes"][0]["primitives"].push_back(other);
    GltfJson shared = edited(quad, "lod_shared", {}, true).json;
    EXPECT_FALSE(
        shared["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"].contains("texCoord"));
    EXPECT_EQ(shared["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"], 1);
}

TEST(References, MeshesThatAreNotShownKeepTheMaterialAsItWas) {
    GltfQuad quad = painted_quad();
    quad.json["meshes"].push_back(quad.json["meshes"][0]);
    quad.json["nodes"].push_back(GltfJson{{"mesh", 1}});
    quad.json["scenes"].push_back(GltfJson{{"nodes", {1}}});
    Written written = edited(quad, "unseen", {}, true);
    EXPECT_EQ(written.json["meshes"][0]["primitives"][0]["material"], 0);
    EXPECT_EQ(written.json["meshes"][1]["primitives"][0]["material"], 1);
    EXPECT_EQ(written.json["materials"][1], quad.material());
    EXPECT_NE(written.messages.find("meshes[1]"), std::string::npos);
}

TEST(References, AnimationsOfAnEditedMaterialAreAWarning) {
    GltfQuad quad = painted_quad();
    GltfJson channel;
    channel["sampler"] = 0;
    channel["target"]["path"] = "pointer";
    channel["target"]["extensions"]["KHR_animation_pointer"]["pointer"] =
        "/materials/0/pbrMetallicRoughness/baseColorFactor";
    quad.json["animations"] = GltfJson::array({GltfJson{{"channels", GltfJson::array({channel})}}});
    EXPECT_NE(edited(quad, "animated").messages.find("baseColorFactor"), std::string::npos);
}

TEST(References, RemovedExtensionsLeaveTheLists) {
    GltfQuad quad = painted_quad();
    quad.material()["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 1;
    quad.material()["extensions"]["KHR_materials_sheen"] = GltfJson::object();
    quad.use("KHR_materials_transmission", true);
    quad.use("KHR_materials_sheen");
    quad.use("VENDOR_of_something_else");
    MaterialEdit edit;
    edit.removed_extensions = {"KHR_materials_transmission"};
    GltfJson json = edited(quad, "removed", edit).json;
    EXPECT_TRUE(json["materials"][0]["extensions"].contains("KHR_materials_sheen"));
    EXPECT_FALSE(json["materials"][0]["extensions"].contains("KHR_materials_transmission"));
    EXPECT_FALSE(names_extension(json, "extensionsUsed", "KHR_materials_transmission"));
    EXPECT_TRUE(names_extension(json, "extensionsUsed", "KHR_materials_sheen"));
    EXPECT_TRUE(names_extension(json, "extensionsUsed", "VENDOR_of_something_else"));
    EXPECT_FALSE(json.contains("extensionsRequired"));
}

TEST(References, ASpecularGlossinessThatWasReplacedIsNotRequired) {
    GltfQuad quad;
    const std::size_t texture = quad.add_texture(plain_image(2, Vec3(1, 0, 0)));
    quad.material().erase("pbrMetallicRoughness");
    GltfJson& old = quad.material()["extensions"]["KHR_materials_pbrSpecularGlossiness"];
    old["diffuseTexture"]["index"] = texture;
    old["specularFactor"] = {0, 0, 0};
    old["glossinessFactor"] = 0.2;
    quad.use("KHR_materials_pbrSpecularGlossiness", true);
    GltfJson json = edited(quad, "glossiness").json;
    EXPECT_FALSE(json.contains("extensionsRequired"));
    EXPECT_FALSE(json.contains("extensionsUsed"));
}

TEST(SpecularGlossiness, GivesBackTheMetalsAndDielectricsThatItWasMadeOf) {
    // Each column is one metallic-roughness material, written in the older model.
    struct Point {
        Vec3 base_color;
        float metallic, roughness;
    };
    const Point points[] = {{{0.8f, 0.5f, 0.2f}, 0, 0.25f}, {{0.8f, 0.5f, 0.2f}, 1, 0.5f}};
    Image diffuse(2, 1, 3), specular(2, 1, 4);
    for (int x = 0; x < 2; ++x) {
        const Point& point = points[x];
        for (int c = 0; c < 3; ++c) {
            const float shine = std::lerp(0.04f, point.base_color[c], point.metallic);
            specular.at(x, 0, c) = linear_to_srgb(shine);
            diffuse.at(x, 0, c) = linear_to_srgb(point.base_color[c] * (1 - point.metallic));
        }
        specular.at(x, 0, 3) = 1 - point.roughness;
    }
    GltfQuad quad;
    const std::size_t textures[] = {quad.add_texture(diffuse), quad.add_texture(specular)};
    quad.material()["pbrMetallicRoughness"] =
        GltfJson::object();  // some exporters write an empty object
    GltfJson& old = quad.material()["extensions"]["KHR_materials_pbrSpecularGlossiness"];
    old["diffuseTexture"]["index"] = textures[0];
    old["specularGlossinessTexture"]["index"] = textures[1];
    quad.use("KHR_materials_pbrSpecularGlossiness", true);
    const Model model = load_model(quad.write(fresh_folder("glossiness_texels")));
    const Material& material = model.materials[0];
    ASSERT_GE(material.metallic_roughness_texture, 0);
    const auto image = [&](int index) {
        return model.textures[static_cast<std::size_t>(index)].image;
    };
    for (int x = 0; x < 2; ++x) {
        const Image base = image(material.base_color_texture);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(srgb_to_linear(base.at(x, 0, c)), points[x].base_color[c], 0.03f) << x << c;
        const Image orm = image(material.metallic_roughness_texture);
        EXPECT_NEAR(orm.at(x, 0, 1), points[x].roughness, 0.01f);
        EXPECT_NEAR(orm.at(x, 0, 2), points[x].metallic, 0.05f);
    }
    EXPECT_EQ(material.metallic_factor, 1.0f);
    EXPECT_EQ(material.roughness_factor, 1.0f);
}

TEST(References, BecomingOpaqueSetsModeAndFactor) {
    GltfQuad quad;
    quad.material()["alphaMode"] = "BLEND";
    quad.material()["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.3};
    MaterialEdit edit;
    edit.makes_opaque = true;
    GltfJson json = edited(quad, "opaque", edit).json;
    EXPECT_FALSE(json["materials"][0].contains("alphaMode"));
    EXPECT_EQ(json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][3], 1.0);
}

}  // namespace
}  // namespace item3d
