#include "item3d/suite/models.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/field/atlas/uv_raster.h"
#include "item3d/field/bake/fill.h"

#include <cmath>

namespace item3d {

std::map<std::string, std::filesystem::path> named_meshes(const std::vector<std::string>& named) {
    std::map<std::string, std::filesystem::path> meshes;
    for (const std::string& mesh : named) {
        const auto split = mesh.find('=');
        if (split == std::string::npos || split == 0)
            throw UsageError("--mesh " + mesh + ": takes NOUN=FILE");
        meshes[mesh.substr(0, split)] = mesh.substr(split + 1);
    }
    return meshes;
}

std::map<std::string, std::filesystem::path> suite_meshes(const std::vector<std::string>& named) {
    auto meshes = named_meshes(named);
    meshes.try_emplace("mug", assets_folder() / "demo" / "mug.glb");
    return meshes;
}

namespace {

constexpr int texture_size = 1024;

Model with_one_material(const Model& mesh) {
    Model model = mesh;
    // Written as a new document, because the suite edits materials, not files.
    model.source = nullptr;
    model.textures.clear();
    Material material;
    material.name = "surface";
    material.metallic_factor = 0.0f;
    material.roughness_factor = 0.5f;
    model.materials = {material};
    for (Primitive& primitive : model.primitives) {
        primitive.material = 0;
        primitive.colors.clear();
    }
    return model;
}

Vec3 encode(Vec3 linear) {
    return Vec3(linear_to_srgb(linear.x), linear_to_srgb(linear.y), linear_to_srgb(linear.z));
}

/// Paints the texels of one primitive by their 3D position.
template <typename Paint>
void paint_primitive(const Primitive& primitive, Image& image, std::vector<std::uint8_t>& covered,
                     const Paint& paint) {
    std::vector<UvTriangle> triangles;
    for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        triangles.push_back({primitive.uvs[primitive.indices[i]],
                             primitive.uvs[primitive.indices[i + 1]],
                             primitive.uvs[primitive.indices[i + 2]]});
    }
    const UvRaster raster = rasterize_uv(triangles, image.width, image.height);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const int triangle = raster.at(x, y);
            if (triangle < 0) continue;
            const auto first = 3 * static_cast<std::size_t>(triangle);
            const Vec2 weight =
                uv_barycentrics(triangles[static_cast<std::size_t>(triangle)], raster.uv_at(x, y));
            const Vec3 position =
                weight.x * primitive.positions[primitive.indices[first]] +
                weight.y * primitive.positions[primitive.indices[first + 1]] +
                (1 - weight.x - weight.y) * primitive.positions[primitive.indices[first + 2]];
            const Vec3 color = paint(position);
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) = color[c];
            covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                    static_cast<std::size_t>(x)] = 1;
        }
    }
}

}  // namespace

Model plain_model(const Model& mesh, Vec3 base_color) {
    Model model = with_one_material(mesh);
    model.materials[0].base_color_factor = Vec4(base_color, 1.0f);
    return model;
}

Model striped_model(const Model& mesh, Vec3 first, Vec3 second, int axis, int count) {
    Model model = with_one_material(mesh);
    const auto [low, high] = model.bounds();
    const float pairs = static_cast<float>(count) / (high[axis] - low[axis]);
    const Vec3 colors[2] = {encode(first), encode(second)};
    const float start = low[axis];

    Image image(texture_size, texture_size, 3);
    std::vector<std::uint8_t> covered(static_cast<std::size_t>(texture_size) * texture_size, 0);
    for (const Primitive& primitive : model.primitives) {
        ITEM3D_CHECK(!primitive.uvs.empty(), "stripes need a UV map");
        paint_primitive(primitive, image, covered, [&](Vec3 position) {
            const float phase = (position[axis] - start) * pairs;
            return colors[phase - std::floor(phase) < 0.5f ? 0 : 1];
        });
    }
    fill_uncovered(image, covered);
    model.textures.push_back({"stripes", image, 8, Wrap::clamp_to_edge, Wrap::clamp_to_edge});
    model.materials[0].base_color_texture = 0;
    return model;
}

}  // namespace item3d
