// Tests of models written with lights, and of lights read from models.
#include "item3d/io/gltf/light.h"

#include "item3d/core/error.h"
#include "item3d/io/load_light.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/image_based_light.h"
#include "item3d/lighting/layout.h"
#include "tests/support/io.h"

#include <functional>
#include <limits>

namespace item3d {
namespace {

using namespace testing_support;

/// Returns a radiance that differs on every face of a cube. A lamp is brighter than RGBD can store.
Vec3 radiance_of(Vec3 d) {
    if (glm::dot(d, glm::normalize(Vec3(0.3f, 0.8f, -0.5f))) > 0.97f) return Vec3(900);
    return Vec3(0.5f + 0.4f * d.x, 0.5f + 0.4f * d.y, 3.0f + 2.0f * d.z);
}

Image faces_of(int size, const std::function<Vec3(Vec3)>& radiance) {
    Image row(6 * size, size, 3);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < 6 * size; ++x) {
            const CubeFaceAxes& axes = gltf_face_axes[static_cast<std::size_t>(x / size)];
            const float s = (2.0f * (x % size) + 1) / size - 1, t = (2.0f * y + 1) / size - 1;
            const Vec3 value =
                radiance(glm::normalize(axes.forward + s * axes.right - t * axes.up));
            for (int c = 0; c < 3; ++c)
                row.at(x, y, c) = value[c];
        }
    }
    return row;
}

ImageBasedLight some_light() {
    return {irradiance_harmonics(light_from(32, radiance_of)),
            {faces_of(32, radiance_of), faces_of(16, [](Vec3) { return Vec3(510, 1, 0.2f); })}};
}

fs::path write_lit(const std::string& name) {
    const fs::path path = fresh_folder("light_" + name) / "lit.glb";
    ModelLights lights;
    lights.surroundings = some_light();
    save_lit_model(path, load_model(data_folder() / "gltf/full_pbr.glb"), lights);
    return path;
}

TEST(ImageBasedLight, HarmonicsAreTheIrradianceOfSmoothLight) {
    // The light consists of bands 0 to 2 only, so that nothing is truncated.
    const Image light = light_from(
        64, [](Vec3 d) { return Vec3(1 + 0.5f * d.y, 1 + d.x * d.z, 1 - 0.3f * d.z + d.y * d.y); });
    const auto harmonics = irradiance_harmonics(light);
    for (const Vec3 n : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0.6f, 0.48f, -0.64f)}) {
        const auto basis = spherical_harmonics(n);
        Vec3 sum(0);
        for (std::size_t i = 0; i < 9; ++i)
            sum += basis[i] * harmonics[i];
        EXPECT_LT(glm::distance(sum / pi, irradiance_over_pi(light, n)), 4e-3f);
    }
}

// This is the extension's orientation, written out: the faces are OpenGL's, mirrored.
TEST(ImageBasedLight, FacesAreOpenGlsMirrored) {
    const std::array<Vec3, 6> upper_left = {{{1, 1, -1},     // +X
                                             {-1, 1, 1},     // -X
                                             {1, 1, -1},     // +Y
                                             {1, -1, 1},     // -Y
                                             {1, 1, 1},      // +Z
                                             {-1, 1, -1}}};  // -Z
    for (std::size_t face = 0; face < 6; ++face) {
        const CubeFaceAxes& axes = gltf_face_axes[face];
        EXPECT_EQ(axes.forward - axes.right + axes.up, upper_left[face]) << face;
    }
}

TEST(ImageBasedLight, IsAddedToADocumentThatStaysAsItWas) {
    const GltfFile before = read_gltf_file(data_folder() / "gltf/full_pbr.glb");
    GltfFile after = read_gltf_file(write_lit("document"));
    const auto& light = after.json["extensions"]["EXT_lights_image_based"]["lights"][0];
    const auto& scene = after.json["scenes"][after.json.value("scene", 0)];
    EXPECT_EQ(scene["extensions"]["EXT_lights_image_based"]["light"], 0);
    EXPECT_EQ(after.json["extensionsUsed"].back(), "EXT_lights_image_based");
    EXPECT_EQ(light["irradianceCoefficients"].size(), 9u);
    for (const auto& coefficient : light["irradianceCoefficients"])
        EXPECT_EQ(coefficient.size(), 3u);
    EXPECT_EQ(light["specularImageSize"], 32);
    EXPECT_FLOAT_EQ(light["intensity"], 900.0f / 255);  // the lamp is above 255
    ASSERT_EQ(light["specularImages"].size(), 2u);
    const fs::path picture = fresh_folder("light_face") / "face.png";
    for (std::size_t level = 0; level < 2; ++level) {
        ASSERT_EQ(light["specularImages"][level].size(), 6u);
        for (const std::size_t index : light["specularImages"][level]) {
            const auto& image = after.json["images"][index];
            const auto& view = after.json["bufferViews"][image["bufferView"].get<std::size_t>()];
            const std::size_t offset = view["byteOffset"], length = view["byteLength"];
            ASSERT_LE(offset + length, after.binary.size());
            const auto first = after.binary.begin() + static_cast<std::ptrdiff_t>(offset);
            write_quickly(picture, Bytes(first, first + static_cast<std::ptrdiff_t>(length)));
            const Image face = load_image(picture);
            EXPECT_EQ(face.width, 32 >> level);
            EXPECT_EQ(face.height, 32 >> level);
            EXPECT_EQ(face.channels, 4);
        }
    }
    // The binary chunk may be up to three bytes longer than the buffer.
    const std::size_t bytes = after.json["buffers"][0]["byteLength"];
    EXPECT_EQ((bytes + 3) / 4 * 4, after.binary.size());
    // Without the light, the document is unchanged.
    EXPECT_TRUE(std::equal(before.binary.begin(), before.binary.end(), after.binary.begin()));
    EXPECT_EQ(after.json["materials"], before.json["materials"]);
    EXPECT_EQ(after.json["nodes"], before.json["nodes"]);
    EXPECT_EQ(after.json["meshes"], before.json["meshes"]);
    for (std::size_t i = 0; i < before.json["images"].size(); ++i)
        EXPECT_EQ(after.json["images"][i], before.json["images"][i]);
}

TEST(ImageBasedLight, ReadsBackAsItWas) {
    const Image light = load_light(write_lit("back").string());
    ASSERT_EQ(light.height, 64);
    int compared = 0;
    for (const Vec3 d : {Vec3(1, 0.2f, 0.1f), Vec3(-1, 0.1f, 0.3f), Vec3(-0.5f, 1, -0.2f),
                         Vec3(0.2f, -1, 0.4f), Vec3(0.3f, 0.2f, 1), Vec3(0.4f, -0.2f, -1)}) {
        const Vec3 expected = radiance_of(glm::normalize(d));
        const Vec3 found = look_up(light, glm::normalize(d));
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(found[c], expected[c], 0.03f * expected[c] + 0.01f) << c;
        ++compared;
    }
    EXPECT_EQ(compared, 6);
    // The lamp's radiance exceeds an 8-bit image and is kept too.
    EXPECT_NEAR(look_up(light, glm::normalize(Vec3(0.3f, 0.8f, -0.5f))).x, 900, 1);
}

TEST(ImageBasedLight, ExplainsWhatItCannotRead) {
    EXPECT_THROW(load_light((data_folder() / "gltf/full_pbr.glb").string()), InputError);
    const fs::path good = write_lit("bad");
    GltfFile file = read_gltf_file(good);
    const fs::path bad = good.parent_path() / "bad.gltf";
    const auto expect_refused = [&](const std::function<void(nlohmann::ordered_json&)>& spoil) {
        auto json = file.json;
        json["buffers"][0]["uri"] = "lit.bin";
        write_quickly(good.parent_path() / "lit.bin", file.binary);
        spoil(json["extensions"]["EXT_lights_image_based"]["lights"][0]);
        const std::string text = json.dump();
        write_quickly(bad, Bytes(text.begin(), text.end()));
        EXPECT_THROW(load_light(bad.string()), InputError);
    };
    expect_refused([](auto& light) { light.erase("specularImages"); });
    expect_refused([](auto& light) { light["specularImages"][0].erase(0); });
    expect_refused([](auto& light) { light["specularImages"][0][2] = 4711; });
    expect_refused([](auto& light) { light["specularImages"][0][2] = "two"; });
    expect_refused(
        [](auto& light) { light["specularImages"][0][3] = light["specularImages"][1][3]; });
    expect_refused([](auto& light) { light["intensity"] = -1; });
    expect_refused([](auto& light) { light["rotation"] = {0, 0, 0, 0}; });
}

// Radiances beyond the range of half floats become infinite, as suns may.
TEST(LoadLight, InfiniteAndUndefinedValuesAreReplaced) {
    const fs::path folder = fresh_folder("light_infinite");
    Image light(8, 4, 3, 0.5f);
    light.at(3, 1, 0) = std::numeric_limits<float>::infinity();
    light.at(4, 1, 2) = std::numeric_limits<float>::quiet_NaN();
    light.at(5, 1, 1) = -std::numeric_limits<float>::infinity();
    const auto load = [&](const char* name, int bits, std::string& said) {
        save_image(folder / name, light, bits);
        testing::internal::CaptureStderr();
        const Image loaded = load_light((folder / name).string());
        said = testing::internal::GetCapturedStderr();
        return loaded;
    };
    std::string said;
    for (const int bits : {16, 32}) {
        const Image loaded = load("a.exr", bits, said);
        EXPECT_EQ(loaded.at(3, 1, 0), 65504.0f);
        EXPECT_EQ(loaded.at(4, 1, 2), 0.0f);
        EXPECT_EQ(loaded.at(5, 1, 1), 0.0f);
        EXPECT_EQ(loaded.at(0, 0, 0), 0.5f);
        EXPECT_NE(said.find("1 values are infinite"), std::string::npos) << said;
        EXPECT_NE(said.find("1 values are not numbers"), std::string::npos) << said;
        EXPECT_NE(said.find("1 negative values"), std::string::npos) << said;
    }
    // 3e38 is finite but makes sums infinite, so it is replaced. 2e6 is beyond half floats and
    // stays.
    light.at(3, 1, 0) = 3e38f;
    light.at(4, 1, 2) = 2e6f;
    light.at(5, 1, 1) = 0.5f;
    EXPECT_EQ(load("b.exr", 32, said).at(3, 1, 0), 2e6f);
    EXPECT_NE(said.find("1 values are infinite or above"), std::string::npos) << said;
    save_image(folder / "c.hdr", light);
    testing::internal::CaptureStderr();
    EXPECT_NEAR(load_light((folder / "c.hdr").string()).at(4, 1, 2), 2e6f, 2e4f);
    testing::internal::GetCapturedStderr();
    light = Image(8, 4, 3, std::numeric_limits<float>::quiet_NaN());
    save_image(folder / "d.exr", light, 32);
    EXPECT_THROW(load_light((folder / "d.exr").string()), InputError);
}

}  // namespace
}  // namespace item3d
