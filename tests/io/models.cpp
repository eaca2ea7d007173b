// Tests of load_model on difficult but valid files.
#include "item3d/core/error.h"
#include "item3d/io/obj/triangulate.h"
#include "tests/support/io.h"

namespace item3d {
namespace {

using namespace testing_support;

Model load_gltf(const std::string& name) {
    return load_model(data_folder() / "gltf" / name);
}
Model load_obj(const std::string& name) {
    return load_model(data_folder() / "nasty" / name);
}

void check_against_manifest(const fs::path& folder) {
    const nlohmann::json manifest = read_manifest(folder);
    for (const auto& [name, entry] : manifest.items()) {
        SCOPED_TRACE(name);
        const Model model = load_model(folder / name);
        expect_sound(model);
        EXPECT_EQ(model.triangle_count(), entry["triangles"].get<std::size_t>());
        if (entry["bbox"].is_array()) expect_box(model, entry["bbox"]);
    }
}

TEST(LoadModel, FindsWhatTheManifestsSay) {
    check_against_manifest(data_folder() / "gltf");
    check_against_manifest(data_folder() / "nasty");
}

TEST(LoadModel, ReadsModelsOfOtherSoftware) {
    for (const fs::path& folder : reference_data::folders()) {
        SCOPED_TRACE(folder.string());
        check_against_manifest(folder / "meshes" / "nasty");
        if (fs::exists(folder / "gltf" / "generated"))
            check_against_manifest(folder / "gltf" / "generated");
        int count = 0;
        for (const auto& entry :
             fs::recursive_directory_iterator(folder / "meshes" / "thirdparty")) {
            if (entry.path().extension() != ".obj") continue;
            SCOPED_TRACE(entry.path().string());
            expect_sound(load_model(entry.path()));
            ++count;
        }
        EXPECT_GE(count, 8);
    }
    const fs::path boxes = reference_data::crops() / "gltf" / "thirdparty";
    std::vector<fs::path> paths;
    for (const char* name :
         {"Box.glb", "BoxInterleaved.glb", "BoxVertexColors.glb", "singleBlendshapeCube_sparse.glb",
          "BoxDraco/BoxDraco.gltf", "BoxMeshopt.glb"})
        paths.push_back(boxes / name);
    if (fs::exists(logo_box())) paths.push_back(logo_box());
    for (const fs::path& path : paths) {
        SCOPED_TRACE(path.string());
        const Model model = load_model(path);
        expect_sound(model);
        EXPECT_EQ(model.triangle_count(), 12u);
    }
}

TEST(LoadModel, KeepsMirroredNodesFacingOutwards) {
    const Model model = load_gltf("hierarchy_trs.glb");
    ASSERT_EQ(model.primitives.size(), 3u);
    int mirrored = 0;
    for (const Primitive& primitive : model.primitives) {
        EXPECT_GT(signed_volume(primitive), 0.5);
        mirrored += primitive.is_mirrored;
        // Face normals and vertex normals agree.
        for (std::size_t t = 0; t < primitive.indices.size(); t += 3) {
            const std::uint32_t* i = &primitive.indices[t];
            const Vec3 face = glm::cross(primitive.positions[i[1]] - primitive.positions[i[0]],
                                         primitive.positions[i[2]] - primitive.positions[i[0]]);
            EXPECT_GT(glm::dot(glm::normalize(face), primitive.normals[i[0]]), 0.9f);
        }
    }
    EXPECT_EQ(mirrored, 1);
}

TEST(LoadModel, StripsAndFansFaceOneWay) {
    const Model model = load_gltf("strip_fan_points_lines.glb");
    for (const Primitive& primitive : model.primitives) {
        for (const Vec3& normal : primitive.normals)
            EXPECT_NEAR(normal.z, 1.0f, 1e-5f);
    }
}

TEST(LoadModel, ReadsColorsMaterialsAndTheDefaultMaterial) {
    const Model colored = load_gltf("vertex_colors_u8.glb");
    ASSERT_EQ(colored.primitives[0].colors.size(), colored.primitives[0].positions.size());
    for (std::size_t i = 0; i < colored.primitives[0].colors.size(); ++i) {
        const Vec3 want = colored.primitives[0].positions[i] + Vec3(0.5f);
        EXPECT_NEAR(glm::distance(Vec3(colored.primitives[0].colors[i]), want), 0.0f, 0.01f);
    }
    const Model several = load_gltf("multi_material.glb");
    ASSERT_EQ(several.materials.size(), 3u);
    EXPECT_EQ(several.materials[1].name, "gold");
    EXPECT_EQ(several.materials[1].metallic_factor, 1.0f);
    EXPECT_NEAR(several.materials[1].roughness_factor, 0.2f, 1e-6f);
    const Material& otherwise = several.materials[several.primitives[2].material];
    EXPECT_EQ(otherwise.metallic_factor, 1.0f);
    EXPECT_EQ(otherwise.roughness_factor, 1.0f);

    const Model full = load_gltf("full_pbr.glb");
    const Material& material = full.materials[0];
    EXPECT_EQ(material.occlusion_texture, material.metallic_roughness_texture);
    EXPECT_NEAR(material.occlusion_strength, 0.7f, 1e-6f);
    EXPECT_NEAR(material.normal_scale, 0.5f, 1e-6f);
    EXPECT_NEAR(material.emissive_factor.z, 0.2f, 1e-6f);
    EXPECT_NEAR(full.textures[material.metallic_roughness_texture].image.at(0, 0, 1), 30.0f / 255,
                1e-6f);

    const Model masked = load_gltf("mask_unlit_doublesided.glb");
    EXPECT_EQ(masked.materials[0].alpha, Material::Alpha::mask);
    EXPECT_TRUE(masked.materials[0].double_sided);
    EXPECT_EQ(masked.textures[0].image.channels, 4);
    EXPECT_EQ(load_gltf("percent_uri.gltf").textures.size(), 1u);
}

TEST(LoadModel, TransformsTextureCoordinates) {
    const Model model = load_gltf("texcoord1_transform.glb");
    const auto file = read_gltf_file(data_folder() / "gltf" / "texcoord1_transform.glb");
    // TEXCOORD_1 has 24 pairs of floats, which are transformed here by the extension's own formula.
    const auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
    const auto& view =
        file.json["bufferViews"]
                 [file.json["accessors"][attributes["TEXCOORD_1"].get<int>()]["bufferView"]
                      .get<int>()];
    const auto* raw =
        reinterpret_cast<const float*>(file.binary.data() + view["byteOffset"].get<int>());
    const double angle = 0.3;
    for (int i = 0; i < 24; ++i) {
        const double u = 2.0 * raw[2 * i], v = 3.0 * raw[2 * i + 1];
        EXPECT_NEAR(model.primitives[0].uvs[i].x, 0.25 + std::cos(angle) * u + std::sin(angle) * v,
                    1e-5);
        EXPECT_NEAR(model.primitives[0].uvs[i].y, 0.5 - std::sin(angle) * u + std::cos(angle) * v,
                    1e-5);
    }
}

TEST(LoadModel, ReadsMtl) {
    const Model model = load_obj("multi_material.obj");
    ASSERT_EQ(model.materials.size(), 3u);
    EXPECT_EQ(model.materials[0].name, "red");
    EXPECT_NEAR(model.materials[0].roughness_factor, 0.3f, 1e-6f);
    EXPECT_EQ(model.materials[0].metallic_factor, 0.0f);
    EXPECT_EQ(model.materials[1].name, "blue metal");
    EXPECT_EQ(model.materials[1].metallic_factor, 1.0f);
    const Material& textured = model.materials[2];
    ASSERT_GE(textured.base_color_texture, 0);
    EXPECT_EQ(model.textures[textured.base_color_texture].image.width, 32);
    ASSERT_GE(textured.normal_texture, 0);
    EXPECT_NEAR(textured.normal_scale, 0.2f, 1e-6f);
    // The options are -s 2 2 1 -o 0.5 0 0. Then v is inverted, so u is in [0.5, 2.5] and v in
    // [-1, 1].
    Vec2 low(9.0f), high(-9.0f);
    for (const Vec2& uv : model.primitives[2].uvs) {
        low = glm::min(low, uv);
        high = glm::max(high, uv);
    }
    EXPECT_EQ(low, Vec2(0.5f, -1.0f));
    EXPECT_EQ(high, Vec2(2.5f, 1.0f));
}

TEST(LoadModel, ReadsNvdiffrecsMaterials) {
    const fs::path folder = fresh_folder("nvdiffrec");
    const std::string cube = read_text(data_folder() / "nasty" / "no_uv_quads.obj");
    write_atomically(folder / "a.mtl", std::string_view("newmtl m\nbsdf pbr\nKs 0.0 0.2 1.0\n"));
    write_atomically(folder / "a.obj", std::string_view("mtllib a.mtl\nusemtl m\n" + cube));
    const Material metal = load_model(folder / "a.obj").materials[0];
    EXPECT_NEAR(metal.roughness_factor, 0.2f, 1e-6f);
    EXPECT_EQ(metal.metallic_factor, 1.0f);
    EXPECT_EQ(metal.occlusion_texture, -1);
    // The dialect's mark is missing, so Ks is a specular colour.
    write_atomically(folder / "a.mtl", std::string_view("newmtl m\nKs 0.0 0.2 1.0\nNs 250\n"));
    const Material plain = load_model(folder / "a.obj").materials[0];
    EXPECT_NEAR(plain.roughness_factor, 0.5f, 1e-6f);
    EXPECT_EQ(plain.metallic_factor, 0.0f);
}

TEST(LoadModel, CombinesGreyMaps) {
    const fs::path folder = fresh_folder("grey_maps");
    const std::string cube = read_text(data_folder() / "nasty" / "no_uv_quads.obj");
    save_image(folder / "rough.png", Image(8, 8, 1, 0.6f));
    save_image(folder / "metal.png", Image(4, 4, 1, 0.2f));
    write_atomically(
        folder / "a.mtl",
        std::string_view("newmtl m\nmap_Pr rough.png\nmap_Pm C:\\pictures\\metal.png\n"));
    write_atomically(folder / "a.obj", std::string_view("mtllib a.mtl\nusemtl m\n" + cube));
    const Model model = load_model(folder / "a.obj");
    const Image& image = model.textures[model.materials[0].metallic_roughness_texture].image;
    EXPECT_EQ(image.width, 8);
    EXPECT_NEAR(image.at(5, 5, 1), 0.6f, 1e-5f);
    EXPECT_NEAR(image.at(5, 5, 2), 0.2f, 1e-5f);
    EXPECT_EQ(model.materials[0].metallic_factor, 1.0f);
}

TEST(LoadModel, SplitsObjVerticesBySeams) {
    const Model model = load_obj("mixed_uv.obj");
    const Primitive& primitive = model.primitives[0];
    EXPECT_GT(primitive.positions.size(), 8u);
    // The first corner of the first face has vt (0, 0), and v is inverted.
    EXPECT_EQ(primitive.uvs[primitive.indices[0]], Vec2(0.0f, 1.0f));
    const Model smooth = load_obj("no_uv_quads.obj");
    EXPECT_EQ(smooth.primitives[0].positions.size(), 8u);
    EXPECT_NEAR(glm::dot(smooth.primitives[0].normals[0],
                         glm::normalize(smooth.primitives[0].positions[0])),
                1.0f, 0.1f);
}

double area(std::span<const Vec3> corners, std::span<const std::uint32_t> triangles) {
    double sum = 0.0;
    for (std::size_t t = 0; t < triangles.size(); t += 3) {
        const Vec3 a = corners[triangles[t]];
        const double signed_area =
            0.5 * glm::cross(corners[triangles[t + 1]] - a, corners[triangles[t + 2]] - a).z;
        EXPECT_GE(signed_area, -1e-6);
        sum += signed_area;
    }
    return sum;
}

TEST(Triangulate, CutsConcavePolygonsWithoutOverlap) {
    const Vec3 ell[] = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
    // Triangle fans differ with the first corner, but the area must not.
    for (std::size_t shift = 0; shift < 6; ++shift) {
        std::vector<Vec3> corners(std::begin(ell), std::end(ell));
        std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(shift),
                    corners.end());
        EXPECT_NEAR(area(corners, triangulate_polygon(corners)), 3.0, 1e-6);
    }
    std::vector<Vec3> star;
    for (int i = 0; i < 200; ++i) {
        const float radius = i % 2 ? 1.0f : 0.3f;
        const float angle = static_cast<float>(i) * pi / 100.0f;
        star.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0f);
    }
    EXPECT_NEAR(area(star, triangulate_polygon(star)), 100.0 * 0.3 * std::sin(pi / 100.0), 1e-4);
    // A self-intersecting star still gives triangles.
    const Vec3 crossed[] = {
        {0, 1, 0}, {0.6f, -0.8f, 0}, {-1, 0.3f, 0}, {1, 0.3f, 0}, {-0.6f, -0.8f, 0}};
    EXPECT_EQ(triangulate_polygon(crossed).size(), 9u);
}

TEST(SmoothNormals, WeighByAreaAndJoinEqualPositions) {
    Primitive primitive;
    // A large triangle faces +Z and a small one +X. They share an edge by equal positions, not by
    // indices.
    primitive.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 0}, {0, 2, 0}, {0, 0, -1}};
    primitive.indices = {0, 1, 2, 3, 5, 4};
    compute_smooth_normals(primitive);
    const Vec3 face = glm::cross(Vec3(0, 0, -1), Vec3(0, 2, 0));
    const Vec3 want = glm::normalize(Vec3(0, 0, 4) + face);
    EXPECT_NEAR(glm::distance(primitive.normals[0], want), 0.0f, 1e-6f);
    EXPECT_NEAR(glm::distance(primitive.normals[3], want), 0.0f, 1e-6f);
    EXPECT_NEAR(primitive.normals[1].z, 1.0f, 1e-6f);
}

TEST(ModelFiles, AreKnownByTheirExtensions) {
    for (const char* name : {"a.glb", "A.GLB", "b/a.gltf", "a.vrm", "a.obj"})
        EXPECT_TRUE(is_model_file(name)) << name;
    for (const char* name : {"a.png", "a", "glb", "a.glb.txt"})
        EXPECT_FALSE(is_model_file(name)) << name;
    EXPECT_EQ(model_extensions_text(), ".glb, .gltf, .vrm or .obj");
}

}  // namespace
}  // namespace item3d
