// Tests of which parts save_model keeps and which it changes.
#include "item3d/core/error.h"
#include "tests/support/io.h"

namespace item3d {
namespace {

using namespace testing_support;

// Returns only a few models, because every write waits for the disk.
std::vector<fs::path> some_models() {
    std::vector<fs::path> paths;
    for (const char* name :
         {"gltf/full_pbr.glb", "gltf/percent_uri.gltf", "gltf/quantized.glb",
          "gltf/hierarchy_trs.glb", "gltf/multi_material.glb", "gltf/sparse.gltf",
          "gltf/draco_edgebreaker.glb", "gltf/meshopt_filters.glb", "nasty/multi_material.obj",
          "nasty/vertex_colors_w.obj"}) {
        paths.push_back(data_folder() / name);
    }
    return paths;
}

std::vector<fs::path> models_to_save() {
    std::vector<fs::path> paths;
    for (const char* folder : {"gltf", "nasty"}) {
        for (const auto& entry : fs::directory_iterator(data_folder() / folder)) {
            const std::string extension = entry.path().extension().string();
            if (extension == ".glb" || extension == ".gltf" || extension == ".obj") {
                paths.push_back(entry.path());
            }
        }
    }
    std::sort(paths.begin(), paths.end());
    return paths;
}

MaterialEdit whole_edit(int seed) {
    MaterialEdit edit;
    edit.base_color = checkered_image(16 + seed, 8, 3);
    edit.metallic_roughness = checkered_image(16 + seed, 9, 3);
    edit.normal = checkered_image(16 + seed, 10, 3);
    return edit;
}

bool is_used(const Model& model, int material) {
    for (const Primitive& primitive : model.primitives) {
        if (primitive.material == material) return true;
    }
    return false;
}

void expect_edited(const Model& model, int index, const MaterialEdit& edit) {
    const Material& material = model.materials[static_cast<std::size_t>(index)];
    ASSERT_GE(material.base_color_texture, 0);
    ASSERT_GE(material.metallic_roughness_texture, 0);
    ASSERT_GE(material.normal_texture, 0);
    EXPECT_EQ(material.base_color_factor, Vec4(1.0f));
    EXPECT_EQ(material.metallic_factor, 1.0f);
    EXPECT_EQ(material.roughness_factor, 1.0f);
    EXPECT_EQ(material.normal_scale, 1.0f);
    EXPECT_EQ(material.occlusion_texture, material.metallic_roughness_texture);
    expect_same_image(model.textures[material.base_color_texture].image, *edit.base_color, 1e-6f);
    expect_same_image(model.textures[material.metallic_roughness_texture].image,
                      *edit.metallic_roughness, 1e-6f);
    expect_same_image(model.textures[material.normal_texture].image, *edit.normal, 1e-6f);
}

TEST(SaveModel, WithoutAnEditKeepsTheDocumentAndItsBytes) {
    const fs::path folder = fresh_folder("keep");
    for (const fs::path& path : models_to_save()) {
        if (path.extension() != ".glb") continue;
        SCOPED_TRACE(path.string());
        save_model(folder / path.filename(), load_model(path));
        const GltfFile before = read_gltf_file(path);
        const GltfFile after = read_gltf_file(folder / path.filename());
        EXPECT_EQ(before.json, after.json);
        EXPECT_EQ(before.json.dump(), after.json.dump());  // keys have the same order as well
        EXPECT_EQ(before.binary, after.binary);
    }
}

TEST(SaveModel, LoadsBackTheSameInEveryFormat) {
    const fs::path folder = fresh_folder("round");
    for (const char* extension : {".glb", ".gltf", ".obj"}) {
        const bool all = std::string(extension) == ".glb";
        for (const fs::path& path : all ? models_to_save() : some_models()) {
            SCOPED_TRACE(path.string() + " as " + extension);
            const Model model = load_model(path);
            const fs::path copy = folder / (path.stem().string() + "_copy" + extension);
            save_model(copy, model);
            const Model back = load_model(copy);
            expect_sound(back);
            if (copy.extension() != ".obj") {
                expect_same_triangles(model, back, 1e-7f, path.extension() != ".obj");
                ASSERT_EQ(model.materials.size(), back.materials.size());
                for (std::size_t i = 0; i < model.materials.size(); ++i) {
                    EXPECT_EQ(model.materials[i].base_color_factor,
                              back.materials[i].base_color_factor);
                    EXPECT_EQ(model.materials[i].name, back.materials[i].name);
                    EXPECT_EQ(model.materials[i].roughness_factor,
                              back.materials[i].roughness_factor);
                    EXPECT_EQ(model.materials[i].normal_texture >= 0,
                              back.materials[i].normal_texture >= 0);
                }
                ASSERT_EQ(model.textures.size(), back.textures.size());
                for (std::size_t i = 0; i < model.textures.size(); ++i) {
                    expect_same_image(model.textures[i].image, back.textures[i].image, 1e-6f);
                }
            } else {
                EXPECT_EQ(model.triangle_count(), back.triangle_count());
                const auto box = model.bounds();
                expect_box(back, {{box[0].x, box[0].y, box[0].z}, {box[1].x, box[1].y, box[1].z}});
            }
        }
    }
}

TEST(SaveModel, EditsMaterialsAndNothingElse) {
    const fs::path folder = fresh_folder("edit");
    for (const fs::path& path : models_to_save()) {
        SCOPED_TRACE(path.string());
        const Model model = load_model(path);
        ModelEdit edit;
        for (std::size_t i = 0; i < model.materials.size(); ++i) {
            if (is_used(model, static_cast<int>(i)))
                edit.materials[static_cast<int>(i)] = whole_edit(static_cast<int>(i));
        }
        const fs::path copy = folder / (path.stem().string() + ".glb");
        save_model(copy, model, edit);
        const Model back = load_model(copy);
        expect_sound(back);
        for (const auto& [index, material_edit] : edit.materials)
            expect_edited(back, index, material_edit);
        for (const Primitive& primitive : back.primitives)
            EXPECT_TRUE(primitive.colors.empty());
        if (path.extension() == ".obj") continue;
        // Primitives without UVs get a dummy set, because a texture requires one.
        expect_same_triangles(model, back, 1e-7f, !model.primitives[0].uvs.empty());
        if (path.extension() != ".glb") continue;
        expect_nothing_else_changed(read_gltf_file(path), read_gltf_file(copy));
    }
}

TEST(SaveModel, GivesPrimitivesNewTextureCoordinates) {
    for (const char* extension : {".glb", ".gltf", ".obj"}) {
        const bool all = std::string(extension) == ".glb";
        const fs::path folder = fresh_folder("uvs_" + std::string(extension + 1));
        for (const fs::path& path : all ? models_to_save() : some_models()) {
            SCOPED_TRACE(path.string() + " as " + extension);
            const Model model = load_model(path);
            ModelEdit edit;
            for (std::size_t i = 0; i < model.primitives.size(); ++i) {
                edit.primitives[static_cast<int>(i)] = exploded(model.primitives[i]);
                const int material = model.primitives[i].material;
                edit.materials[material] = whole_edit(material);
            }
            const fs::path copy = folder / (path.stem().string() + extension);
            save_model(copy, model, edit);
            const Model back = load_model(copy);
            expect_sound(back);
            if (copy.extension() == ".obj") {
                EXPECT_EQ(model.triangle_count(), back.triangle_count());
                continue;
            }
            Model want = model;
            for (std::size_t i = 0; i < want.primitives.size(); ++i) {
                const PrimitiveEdit& changed = edit.primitives[static_cast<int>(i)];
                Primitive& primitive = want.primitives[i];
                const Primitive old = primitive;
                primitive.positions.clear();
                primitive.normals.clear();
                for (const std::uint32_t vertex : changed.source_vertices) {
                    primitive.positions.push_back(old.positions[vertex]);
                    primitive.normals.push_back(old.normals[vertex]);
                }
                primitive.uvs = changed.uvs;
                primitive.indices = changed.indices;
            }
            expect_same_triangles(want, back, 1e-7f);
            for (const auto& [index, material_edit] : edit.materials) {
                expect_edited(back, index, material_edit);
            }
        }
    }
}

// The material's emission is not edited, so it keeps the old texture coordinates.
TEST(SaveModel, KeepsTexturesThatWereNotEditedWhereTheyWere) {
    const fs::path folder = fresh_folder("old_uvs");
    const fs::path path = data_folder() / "gltf" / "full_pbr.glb";
    const Model model = load_model(path);
    ModelEdit edit;
    edit.primitives[0] = exploded(model.primitives[0]);
    edit.materials[0].base_color = checkered_image(8, 8, 4);
    save_model(folder / "a.glb", model, edit);
    const auto after = read_gltf_file(folder / "a.glb").json;
    const auto& material = after["materials"][0];
    EXPECT_FALSE(material["pbrMetallicRoughness"]["baseColorTexture"].contains("texCoord"));
    EXPECT_EQ(material["pbrMetallicRoughness"]["metallicRoughnessTexture"]["texCoord"], 1);
    EXPECT_EQ(material["normalTexture"]["texCoord"], 1);
    EXPECT_EQ(material["normalTexture"]["scale"], 0.5);
    EXPECT_EQ(material["occlusionTexture"]["strength"], 0.7);
    EXPECT_TRUE(after["meshes"][0]["primitives"][0]["attributes"].contains("TEXCOORD_1"));
}

// Unknown data is kept, and textures inside of extensions use the coordinates of their image.
TEST(SaveModel, KeepsExtensionsExtrasAndVariants) {
    const fs::path folder = fresh_folder("extensions");
    save_model(folder / "a.gltf", load_model(data_folder() / "gltf" / "full_pbr.glb"));
    auto json = read_gltf_file(folder / "a.gltf").json;
    json["extensionsUsed"] = {"VENDOR_thing", "KHR_materials_clearcoat", "KHR_materials_variants"};
    json["extras"] = {{"big", 9007199254740993}, {"small", 0.1}, {"text", "\u00e9"}};
    json["nodes"][0]["extensions"]["VENDOR_thing"] = {{"a", {1, 2.5, nullptr}}};
    json["materials"][0]["extensions"]["KHR_materials_clearcoat"] = {
        {"clearcoatTexture", {{"index", 0}}},
        {"clearcoatNormalTexture", {{"index", 0}, {"texCoord", 0}}}};
    write_atomically(folder / "a.gltf", std::string_view(json.dump()));

    const Model model = load_model(folder / "a.gltf");
    ModelEdit edit;
    edit.primitives[0] = exploded(model.primitives[0]);
    edit.materials[0] = whole_edit(0);
    save_model(folder / "b.glb", model, edit);
    const auto after = read_gltf_file(folder / "b.glb").json;
    EXPECT_EQ(after["extras"].dump(), json["extras"].dump());
    EXPECT_EQ(after["nodes"], json["nodes"]);
    EXPECT_EQ(after["extensionsUsed"], json["extensionsUsed"]);
    const auto& clearcoat = after["materials"][0]["extensions"]["KHR_materials_clearcoat"];
    EXPECT_EQ(clearcoat["clearcoatTexture"]["texCoord"], 1);
    EXPECT_EQ(clearcoat["clearcoatNormalTexture"]["texCoord"], 1);

    // If there are variants, other materials use set 0, so the new coordinates become another set.
    json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "v"}}};
    json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] = {
        {{"material", 0}, {"variants", {0}}}};
    write_atomically(folder / "a.gltf", std::string_view(json.dump()));
    save_model(folder / "c.glb", load_model(folder / "a.gltf"), edit);
    const auto varied = read_gltf_file(folder / "c.glb").json;
    const auto& material = varied["materials"][0];
    EXPECT_EQ(material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"], 1);
    EXPECT_FALSE(
        material["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"].contains("texCoord"));
    EXPECT_EQ(varied["meshes"][0]["primitives"][0]["extensions"],
              json["meshes"][0]["primitives"][0]["extensions"]);
    EXPECT_EQ(load_model(folder / "c.glb").primitives[0].uvs, edit.primitives[0].uvs);
}

// Files of the older specular-glossiness model become metallic-roughness when edited.
TEST(SaveModel, ReplacesSpecularGlossiness) {
    const fs::path folder = fresh_folder("glossiness");
    save_model(folder / "a.gltf", load_model(data_folder() / "gltf" / "vertex_colors_u8.glb"));
    auto json = read_gltf_file(folder / "a.gltf").json;
    json["extensionsUsed"] = {"KHR_materials_pbrSpecularGlossiness"};
    json["materials"][0].erase("pbrMetallicRoughness");
    json["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {
        {"diffuseFactor", {0.2, 0.4, 0.6, 1.0}}, {"glossinessFactor", 0.75}};
    write_atomically(folder / "a.gltf", std::string_view(json.dump()));
    const Model model = load_model(folder / "a.gltf");
    EXPECT_NEAR(model.materials[0].base_color_factor.y, 0.4f, 1e-6f);
    EXPECT_NEAR(model.materials[0].roughness_factor, 0.25f, 1e-6f);
    EXPECT_EQ(model.materials[0].metallic_factor, 0.0f);
    ModelEdit edit;
    edit.materials[0].base_color = checkered_image(4, 4, 3);
    save_model(folder / "b.glb", model, edit);
    const Material material = load_model(folder / "b.glb").materials[0];
    EXPECT_EQ(material.metallic_factor, 0.0f);
    EXPECT_NEAR(material.roughness_factor, 0.25f, 1e-6f);
    EXPECT_GE(material.base_color_texture, 0);
}

TEST(SaveModel, UnlitMaterialsStayUnlitUntilTheyAreEdited) {
    const fs::path folder = fresh_folder("unlit");
    Model model = load_model(data_folder() / "gltf" / "vertex_colors_u8.glb");
    EXPECT_FALSE(model.materials[0].unlit);
    model.materials[0].unlit = true;
    model.source.reset();
    save_model(folder / "a.gltf", model);
    const auto json = read_gltf_file(folder / "a.gltf").json;
    EXPECT_EQ(json["extensionsUsed"], nlohmann::json::array({"KHR_materials_unlit"}));
    const Model unlit = load_model(folder / "a.gltf");
    EXPECT_TRUE(unlit.materials[0].unlit);
    ModelEdit edit;
    edit.materials[0].base_color = checkered_image(4, 4, 3);
    save_model(folder / "b.gltf", unlit, edit);
    EXPECT_FALSE(load_model(folder / "b.gltf").materials[0].unlit);
}

TEST(SaveModel, KeepsTheTextureTransformWhenTheLayoutStays) {
    const fs::path folder = fresh_folder("transform");
    const Model model = load_model(data_folder() / "gltf" / "texcoord1_transform.glb");
    ModelEdit edit;
    edit.materials[0] = whole_edit(1);
    save_model(folder / "a.glb", model, edit);
    const Model back = load_model(folder / "a.glb");
    // All five slots use one set of coordinates; otherwise the reader would have left some out.
    expect_edited(back, 0, edit.materials[0]);
    expect_same_triangles(model, back, 1e-6f);
}

TEST(SaveModel, KeepsSkinsMorphTargetsAndAnimations) {
    const fs::path folder = fresh_folder("skins");
    const fs::path path = data_folder() / "gltf" / "morph_skin.glb";
    const Model model = load_model(path);
    ModelEdit edit;
    edit.primitives[0] = exploded(model.primitives[0]);
    edit.materials[0] = whole_edit(0);
    save_model(folder / "a.glb", model, edit);
    const auto after = read_gltf_file(folder / "a.glb").json;
    const auto& primitive = after["meshes"][0]["primitives"][0];
    for (const char* name : {"JOINTS_0", "WEIGHTS_0", "POSITION", "NORMAL", "TEXCOORD_0"}) {
        ASSERT_TRUE(primitive["attributes"].contains(name)) << name;
        EXPECT_EQ(after["accessors"][primitive["attributes"][name].get<std::size_t>()]["count"], 36)
            << name;
    }
    EXPECT_EQ(after["accessors"][primitive["targets"][0]["POSITION"].get<std::size_t>()]["count"],
              36);
    EXPECT_EQ(after["skins"], read_gltf_file(path).json["skins"]);
}

// Three nodes share one mesh, and one of the nodes is mirrored. Equal edits are stored once.
TEST(SaveModel, EditsASharedMeshOnceAndCopiesItWhenEditsDiffer) {
    const fs::path folder = fresh_folder("shared");
    const Model model = load_model(data_folder() / "gltf" / "hierarchy_trs.glb");
    ASSERT_EQ(model.primitives.size(), 3u);
    const auto plain = std::find_if(model.primitives.begin(), model.primitives.end(),
                                    [](const Primitive& p) { return !p.is_mirrored; });
    ModelEdit edit;
    edit.materials[0] = whole_edit(0);
    const PrimitiveEdit one = exploded(*plain);
    for (int i = 0; i < 3; ++i) {
        edit.primitives[i] = one;
        if (!model.primitives[i].is_mirrored) continue;
        for (std::size_t t = 0; t < one.indices.size(); t += 3) {
            std::swap(edit.primitives[i].indices[t + 1], edit.primitives[i].indices[t + 2]);
        }
    }
    save_model(folder / "same.glb", model, edit);
    EXPECT_EQ(read_gltf_file(folder / "same.glb").json["meshes"].size(), 1u);
    const Model same = load_model(folder / "same.glb");
    for (const Primitive& primitive : same.primitives)
        EXPECT_GT(signed_volume(primitive), 0.0);

    for (Vec2& uv : edit.primitives[2].uvs)
        uv *= 0.5f;
    save_model(folder / "differ.glb", model, edit);
    EXPECT_EQ(read_gltf_file(folder / "differ.glb").json["meshes"].size(), 2u);
    const Model differ = load_model(folder / "differ.glb");
    EXPECT_EQ(differ.primitives[2].uvs, edit.primitives[2].uvs);
    EXPECT_EQ(differ.primitives[0].uvs, edit.primitives[0].uvs);
}

// Editing one primitive of a material must not break the others.
TEST(SaveModel, PrimitivesThatShareAMaterialKeepTheirCoordinates) {
    const fs::path folder = fresh_folder("share_material");
    Model made;
    made.materials.emplace_back();
    made.materials[0].base_color_texture = 0;
    made.textures.push_back({"t", checkered_image(4, 4, 3), 8, Wrap::clamp_to_edge, Wrap::repeat});
    for (int i = 0; i < 2; ++i) {
        Primitive primitive;
        primitive.name = "p" + std::to_string(i);
        primitive.positions = {{0, 0, 1.0f * i}, {1, 0, 1.0f * i}, {0, 1, 1.0f * i}};
        primitive.uvs = {{0.25f, 0}, {1, 0.5f}, {0, 0.75f}};
        primitive.indices = {0, 1, 2};
        compute_smooth_normals(primitive);
        made.primitives.push_back(primitive);
    }
    save_model(folder / "a.glb", made);
    const Model model = load_model(folder / "a.glb");
    EXPECT_EQ(model.textures[0].wrap_u, Wrap::clamp_to_edge);
    EXPECT_EQ(model.textures[0].wrap_v, Wrap::repeat);
    ModelEdit edit;
    edit.materials[0] = whole_edit(2);
    edit.primitives[1] = exploded(model.primitives[1]);
    save_model(folder / "b.glb", model, edit);
    const Model back = load_model(folder / "b.glb");
    EXPECT_EQ(back.primitives[0].uvs, model.primitives[0].uvs);
    EXPECT_EQ(back.primitives[1].uvs, edit.primitives[1].uvs);
    EXPECT_EQ(back.primitives[0].name, "p0");
    expect_edited(back, 0, edit.materials[0]);
}

TEST(SaveModel, MakesAGlbThatStandsAlone) {
    const fs::path folder = fresh_folder("alone");
    const Model model = load_model(data_folder() / "gltf" / "percent_uri.gltf");
    save_model(folder / "a.glb", model);
    const auto json = read_gltf_file(folder / "a.glb").json;
    EXPECT_FALSE(json["buffers"][0].contains("uri"));
    EXPECT_FALSE(json["images"][0].contains("uri"));
    EXPECT_EQ(json["images"][0]["mimeType"], "image/png");
    EXPECT_EQ(load_model(folder / "a.glb").textures.size(), 1u);
    // A .gltf keeps the names of its files.
    save_model(folder / "b.gltf", model);
    EXPECT_TRUE(fs::exists(folder / "my buffer.bin"));
    EXPECT_EQ(read_gltf_file(folder / "b.gltf").json,
              read_gltf_file(data_folder() / "gltf" / "percent_uri.gltf").json);
}

TEST(SaveModel, EditsRealModels) {
    const fs::path references = reference_data::crops();
    const fs::path boxes = references / "gltf" / "thirdparty";
    std::vector<fs::path> paths = {boxes / "Box.glb", boxes / "singleBlendshapeCube_sparse.glb",
                                   boxes / "BoxVertexColors.glb",
                                   references / "meshes" / "spot" / "spot.obj"};
    if (fs::exists(logo_box())) paths.push_back(logo_box());
    const fs::path folder = fresh_folder("real");
    for (const fs::path& path : paths) {
        SCOPED_TRACE(path.string());
        const Model model = load_model(path);
        ModelEdit edit;
        for (std::size_t i = 0; i < model.primitives.size(); ++i) {
            edit.primitives[static_cast<int>(i)] = exploded(model.primitives[i]);
            edit.materials[model.primitives[i].material] = whole_edit(3);
        }
        const fs::path copy = folder / (path.stem().string() + ".glb");
        save_model(copy, model, edit);
        const Model back = load_model(copy);
        expect_sound(back);
        EXPECT_EQ(back.primitives[0].uvs, edit.primitives[0].uvs);
    }
}

}  // namespace
}  // namespace item3d
