// Tests that skins, colours and all other data of a model stay in a file of several variants.
#include "tests/support/merged_variants.h"

namespace item3d {
namespace {

using namespace testing_support;

/// Adds an accessor of vertex joints, with four unsigned shorts for each vertex.
std::size_t add_joints(GltfQuad& quad) {
    const std::size_t index = quad.add_indices({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
    quad.json["accessors"][index]["type"] = "VEC4";
    quad.json["accessors"][index]["count"] = 4;
    return index;
}

void set_bounds(GltfQuad& quad, std::size_t accessor, const GltfJson& minimum,
                const GltfJson& greatest) {
    quad.json["accessors"][accessor]["min"] = minimum;
    quad.json["accessors"][accessor]["max"] = greatest;
}

/// Returns a shop_quad() with two joints, a named morph target, and an animation.
GltfQuad moving_quad() {
    GltfQuad quad = shop_quad();
    set_bounds(quad, 0, {-1, -1, 0}, {1, 1, 0});
    const std::size_t joints = add_joints(quad);
    const std::size_t weights =
        quad.add_floats({1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, "VEC4");
    const std::size_t target = quad.add_floats({0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 2}, "VEC3");
    set_bounds(quad, target, {0, 0, 0}, {0, 0, 2});
    for (GltfJson& primitive : quad.json["meshes"][0]["primitives"]) {
        primitive["attributes"]["JOINTS_0"] = joints;
        primitive["attributes"]["WEIGHTS_0"] = weights;
        primitive["targets"] = GltfJson::array({GltfJson{{"POSITION", target}}});
    }
    quad.json["meshes"][0]["weights"] = {0.25};
    quad.json["meshes"][0]["extras"]["targetNames"] = {"smile"};
    quad.json["nodes"][0]["skin"] = 0;
    quad.json["nodes"].push_back(GltfJson{{"name", "hip"}, {"children", {2}}});
    quad.json["nodes"].push_back(GltfJson{{"name", "knee"}});
    quad.json["scenes"][0]["nodes"].push_back(1);
    quad.json["skins"] = GltfJson::array({GltfJson{{"joints", {1, 2}}}});
    const std::size_t times = quad.add_floats({0, 1}, "VEC2");
    quad.json["accessors"][times]["type"] = "SCALAR";
    quad.json["accessors"][times]["count"] = 2;
    set_bounds(quad, times, {0}, {1});
    const std::size_t values = quad.add_floats({0, 1}, "VEC2");
    quad.json["accessors"][values]["type"] = "SCALAR";
    quad.json["accessors"][values]["count"] = 2;
    quad.json["animations"] = GltfJson::array({GltfJson::parse(
        R"({"channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]})")});
    quad.json["animations"][0]["samplers"] =
        GltfJson::array({GltfJson{{"input", times}, {"output", values}}});
    return quad;
}

TEST_F(MergedVariants, SkinsMorphTargetsAndAnimationsStay) {
    begin("moving", moving_quad());
    const Model source = load_model(request_.model);
    ModelEdit golden = plain_edit(Vec3(1, 1, 0));
    golden.primitives[0] = exploded(source.primitives[0]);
    add("a golden quad", golden);
    write_variants(request_);
    const GltfJson before = read_gltf_file(request_.model).json;
    const GltfJson after = read_gltf_file(request_.output).json;
    for (const char* key : {"nodes", "skins", "animations", "scenes"})
        EXPECT_EQ(after[key], before[key]) << key;
    const GltfJson& mesh = after["meshes"][0];
    EXPECT_EQ(mesh["weights"], before["meshes"][0]["weights"]);
    EXPECT_EQ(mesh["extras"], before["meshes"][0]["extras"]);
    EXPECT_EQ(mesh["primitives"][1], before["meshes"][0]["primitives"][1]);
    const GltfJson& primitive = mesh["primitives"][0];
    for (const char* name : {"POSITION", "NORMAL", "TEXCOORD_0", "JOINTS_0", "WEIGHTS_0"}) {
        ASSERT_TRUE(primitive["attributes"].contains(name)) << name;
        const auto accessor = primitive["attributes"][name].get<std::size_t>();
        EXPECT_EQ(after["accessors"][accessor]["count"], 6) << name;
    }
    ASSERT_EQ(primitive["targets"].size(), 1u);
    const auto target = primitive["targets"][0]["POSITION"].get<std::size_t>();
    EXPECT_EQ(after["accessors"][target]["count"], 6);
    for (const char* variant : {"original", "golden quad"})
        expect_same_triangles(load_model(request_.output, {.variant = variant}), source, 0.0f,
                              std::string(variant) == "original");
}

TEST_F(MergedVariants, VertexColoursStayWhereEditsLeaveThem) {
    GltfQuad quad = shop_quad();
    quad.primitive()["attributes"]["COLOR_0"] =
        quad.add_floats({1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1, 1, 1, 1, 1}, "VEC4");
    begin("colours", quad);
    for (const bool is_new : {false, true}) {
        request_.edits.clear();
        ModelEdit golden = plain_edit(Vec3(1, 1, 0));
        golden.materials[0].includes_vertex_colors = false;
        if (is_new) golden.primitives[0] = exploded(load_model(request_.model).primitives[0]);
        add("a golden quad", golden);
        write_variants(request_);
        const GltfJson json = read_gltf_file(request_.output).json;
        const GltfJson& attributes = json["meshes"][0]["primitives"][0]["attributes"];
        ASSERT_TRUE(attributes.contains("COLOR_0"));
        EXPECT_EQ(json["accessors"][attributes["COLOR_0"].get<std::size_t>()]["count"],
                  is_new ? 6 : 4);
        EXPECT_EQ(color_in("golden quad"), Vec3(1, 1, 0));
    }
}

TEST_F(MergedVariants, PrimitivesThatShareAMaterialShareItsLooks) {
    GltfQuad quad = shop_quad();
    quad.json["meshes"][0]["primitives"][1]["material"] = 0;
    quad.json["meshes"].push_back(quad.json["meshes"][0]);
    quad.json["nodes"].push_back(GltfJson{{"mesh", 1}, {"translation", {0, 0, 9}}});
    quad.json["scenes"][0]["nodes"].push_back(1);
    begin("shared", quad);
    add("a golden quad", plain_edit(Vec3(1, 1, 0)));
    add("a blue quad", plain_edit(Vec3(0, 0, 1)));
    write_variants(request_);
    const GltfJson json = read_gltf_file(request_.output).json;
    // The materials are the paint, the handle, which no edit changes, and one for each of two
    // edits.
    EXPECT_EQ(json["materials"].size(), 4u);
    EXPECT_EQ(json["images"].size(), 3u);
    EXPECT_EQ(json["meshes"].size(), 2u);
    for (const GltfJson& mesh : json["meshes"])
        for (const GltfJson& primitive : mesh["primitives"])
            EXPECT_EQ(primitive, json["meshes"][0]["primitives"][0]);
    for (std::size_t primitive = 0; primitive < 4; ++primitive)
        EXPECT_EQ(color_in("blue quad", primitive), Vec3(0, 0, 1));
}

TEST_F(MergedVariants, TransformsOfTexturesStayWithTheirOwn) {
    GltfQuad quad = shop_quad();
    const GltfJson transform = {{"offset", {0.5, 0}}, {"scale", {0.5, 0.5}}};
    quad.material()["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]
                   ["KHR_texture_transform"] = transform;
    quad.use("KHR_texture_transform");
    begin("transforms", quad);
    const Model source = load_model(request_.model);
    ModelEdit blue = plain_edit(Vec3(0, 0, 1));
    for (const bool is_new : {false, true}) {
        request_.edits.clear();
        if (is_new) blue.primitives[0] = exploded(source.primitives[0]);
        add("a blue quad", blue);
        write_variants(request_);
        const GltfJson json = read_gltf_file(request_.output).json;
        const GltfJson& shown =
            json["materials"][json["meshes"][0]["primitives"][0]["material"].get<std::size_t>()];
        EXPECT_EQ(shown["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]
                       ["KHR_texture_transform"]["scale"],
                  transform["scale"]);
        EXPECT_EQ(json["extensionsUsed"][0], "KHR_texture_transform");
        expect_same_triangles(load_model(request_.output, {.variant = "original"}), source, 1e-6f,
                              true);
        EXPECT_EQ(color_in("original"), Vec3(1, 0, 0));
        EXPECT_EQ(color_in("blue quad"), Vec3(0, 0, 1));
    }
}

TEST_F(MergedVariants, ExtensionsOfOthersStay) {
    GltfQuad quad = shop_quad();
    const std::size_t shade = quad.add_texture(plain_image(4, Vec3(0.2f, 0, 0)));
    quad.material()["extensions"]["VRMC_materials_mtoon"] = {
        {"specVersion", "1.0"}, {"shadeMultiplyTexture", {{"index", shade}}}};
    quad.json["nodes"].push_back(GltfJson{{"name", "tail"}});
    quad.json["scenes"][0]["nodes"].push_back(1);
    quad.json["extensions"]["VRMC_springBone"] = {
        {"specVersion", "1.0"},
        {"springs",
         GltfJson::array({GltfJson{{"joints", GltfJson::array({GltfJson{{"node", 1}}})}}})}};
    quad.json["nodes"][1]["extensions"]["VRMC_node_constraint"] = {
        {"specVersion", "1.0"}, {"constraint", {{"roll", {{"source", 0}, {"rollAxis", "X"}}}}}};
    for (const char* name : {"VRMC_materials_mtoon", "VRMC_springBone", "VRMC_node_constraint"})
        quad.use(name);
    quad.json["extras"]["owner"] = "Ada";
    begin("others", quad);
    add("a blue quad", plain_edit(Vec3(0, 0, 1)));
    write_variants(request_);
    const GltfJson before = read_gltf_file(request_.model).json;
    const GltfJson after = read_gltf_file(request_.output).json;
    EXPECT_EQ(after["extensions"]["VRMC_springBone"], before["extensions"]["VRMC_springBone"]);
    EXPECT_EQ(after["nodes"], before["nodes"]);
    EXPECT_EQ(after["extras"], before["extras"]);
    EXPECT_EQ(after["materials"][0], before["materials"][0]);
    for (const GltfJson& name : before["extensionsUsed"])
        EXPECT_NE(std::find(after["extensionsUsed"].begin(), after["extensionsUsed"].end(), name),
                  after["extensionsUsed"].end())
            << name;
    for (const GltfJson& texture : after["textures"])
        EXPECT_LT(texture["source"].get<std::size_t>(), after["images"].size());

    quad.json["extensions"]["VRMC_vrm"]["specVersion"] = "1.0";
    request_.edits.clear();
    begin("avatar", quad);
    add("a blue quad", plain_edit(Vec3(0, 0, 1)));
    EXPECT_NE(problem().find("is an avatar (VRM)"), std::string::npos) << problem();
}

}  // namespace
}  // namespace item3d
