// Tests of the shipped demo model, written by apps/make_demo.
#include "item3d/io/load.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

namespace item3d {
namespace {

const std::filesystem::path demo_path =
    std::filesystem::path(ITEM3D_TEST_DATA) / "../../assets/demo/mug.glb";

class DemoMug : public testing::Test {
  protected:
    static void SetUpTestSuite() { model_ = new Model(load_model(demo_path)); }
    static void TearDownTestSuite() { delete model_; }
    const Primitive& primitive() const { return model_->primitives.front(); }
    static Model* model_;
};

Model* DemoMug::model_ = nullptr;

float cross(Vec2 a, Vec2 b) {
    return a.x * b.y - a.y * b.x;
}

TEST_F(DemoMug, IsSmallAndWhole) {
    EXPECT_LT(std::filesystem::file_size(demo_path), 1u << 20);
    ASSERT_EQ(model_->primitives.size(), 1u);
    EXPECT_GT(model_->triangle_count(), 5000u);
    const auto bounds = model_->bounds();
    EXPECT_NEAR(bounds[0].y, 0, 1e-4);
    EXPECT_NEAR(bounds[1].y, 0.095, 5e-4);
    const Material& material = model_->materials[primitive().material];
    ASSERT_GE(material.base_color_texture, 0);
    ASSERT_GE(material.metallic_roughness_texture, 0);
    EXPECT_EQ(model_->textures[material.base_color_texture].image.width, 1024);
    EXPECT_EQ(material.occlusion_texture, material.metallic_roughness_texture);
}

TEST_F(DemoMug, IsClosedAndFacesOutwards) {
    double volume = 0;
    const auto& p = primitive().positions;
    const auto& indices = primitive().indices;
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        const Vec3 a = p[indices[i]];
        const Vec3 b = p[indices[i + 1]];
        const Vec3 c = p[indices[i + 2]];
        volume += glm::dot(a, glm::cross(b, c)) / 6;
        const Vec3 face = glm::cross(b - a, c - a);
        for (int k = 0; k < 3; ++k) {
            EXPECT_GT(glm::dot(primitive().normals[indices[i + k]], face), 0) << i;
        }
    }
    // The volume of the ceramic in cubic centimetres is 94 for the body and 17 for the handle. The
    // sum would be 77 if the handle were inside out, and over 500 if the body were solid.
    EXPECT_NEAR(volume * 1e6, 111, 5);
}

TEST_F(DemoMug, HasAnAtlasThatAnEditCanKeep) {
    constexpr int size = 1024;
    std::vector<int> covered(size * size);
    const auto& uvs = primitive().uvs;
    const auto& indices = primitive().indices;
    ASSERT_EQ(uvs.size(), primitive().positions.size());
    for (const Vec2 uv : uvs) {
        ASSERT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
    }
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        const Vec2 a = uvs[indices[i]] * static_cast<float>(size);
        const Vec2 b = uvs[indices[i + 1]] * static_cast<float>(size);
        const Vec2 c = uvs[indices[i + 2]] * static_cast<float>(size);
        // The corners are clockwise if v points down on paper, so no part of the texture is
        // mirrored.
        ASSERT_LT(cross(b - a, c - a), 0) << i;
        const Vec2 low = glm::floor(glm::min(a, glm::min(b, c)));
        const Vec2 high = glm::ceil(glm::max(a, glm::max(b, c)));
        for (int y = static_cast<int>(low.y); y < static_cast<int>(high.y); ++y) {
            for (int x = static_cast<int>(low.x); x < static_cast<int>(high.x); ++x) {
                const Vec2 p(x + 0.5f, y + 0.5f);
                // Neighbours may share an edge, so only texels at least a hundredth of a texel
                // inside count.
                const float minimum = 0.01f;
                if (-cross(b - a, p - a) > minimum * glm::distance(a, b) &&
                    -cross(c - b, p - b) > minimum * glm::distance(b, c) &&
                    -cross(a - c, p - c) > minimum * glm::distance(c, a)) {
                    ++covered[y * size + x];
                }
            }
        }
    }
    int used = 0;
    for (const int count : covered) {
        ASSERT_LE(count, 1);
        used += count;
    }
    EXPECT_GT(used, size * size / 2);
}

}  // namespace
}  // namespace item3d
