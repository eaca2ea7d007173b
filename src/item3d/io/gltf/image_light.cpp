#include "item3d/io/gltf/image_light.h"

#include "item3d/core/error.h"
#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/document.h"
#include "item3d/io/image/formats.h"
#include "item3d/io/image/png.h"
#include "item3d/lighting/environment.h"

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

constexpr float gamma = 2.2f;
constexpr float largest_rgbd = 255;  ///< maximum of RGBD

float brightest(const Image& image) {
    return *std::max_element(image.pixels.begin(), image.pixels.end());
}

/// Returns one square face of an image with six faces in a row, divided by `intensity` and encoded
/// as RGBD.
Image to_rgbd(const Image& row, int face, float intensity) {
    const int size = row.height;
    Image rgbd(size, size, 4);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            Vec3 radiance;
            for (int c = 0; c < 3; ++c)
                radiance[c] = row.at(face * size + x, y, c) / intensity;
            const float maximum = std::max({radiance.x, radiance.y, radiance.z, 1.0f});
            const float divisor = std::max(1.0f, std::floor(255 / maximum)) / 255;
            for (int c = 0; c < 3; ++c)
                rgbd.at(x, y, c) = std::pow(std::min(1.0f, divisor * radiance[c]), 1 / gamma);
            rgbd.at(x, y, 3) = divisor;
        }
    }
    return rgbd;
}

/// Decodes a pixel: four channels are RGBD, three are linear radiance.
Vec3 decoded(const Image& image, int x, int y) {
    Vec3 radiance;
    for (int c = 0; c < 3; ++c)
        radiance[c] = std::pow(image.at(x, y, image.channels >= 3 ? c : 0), gamma);
    return image.channels == 4 ? radiance / std::max(image.at(x, y, 3), 1 / largest_rgbd)
                               : radiance;
}

/// Returns the light of the document's scene, or else the document's first light.
GltfObject chosen_light(const GltfObject& root, const GltfObject& lights) {
    std::size_t index = 0;
    if (root.list_size("scenes") > 0) {
        const std::size_t scene = root.index("scene", root.list_size("scenes")).value_or(0);
        if (const auto all = root.item("scenes", scene).object("extensions"))
            if (const auto own = all->object(image_based_extension))
                index = own->index("light", lights.list_size("lights")).value_or(0);
    }
    return lights.item("lights", index);
}

/// Returns the light's level 0 as six faces in a row.
Image read_faces(const SourceDocument& document, const GltfObject& light) {
    const auto levels = light.json().find("specularImages");
    if (levels == light.json().end() || !levels->is_array() || levels->empty() ||
        !levels->front().is_array() || levels->front().size() != 6)
        light.fail("has no specularImages of six faces");
    Image row;
    for (int face = 0; face < 6; ++face) {
        const Json& index = levels->front()[static_cast<std::size_t>(face)];
        if (!index.is_number_unsigned() ||
            index.get<std::size_t>() >= root_of(document).list_size("images"))
            light.fail(
                fmt::format("specularImages: '{}' is not an image of the document", index.dump()));
        const std::string subject =
            fmt::format("{}: images[{}]", document.path.string(), index.dump());
        const Image image =
            decode_image(read_image_bytes(document, index.get<std::size_t>()), subject).image;
        if (face == 0) row = Image(6 * image.height, image.height, 3);
        if (image.width != image.height || image.height != row.height)
            light.fail("specularImages must be squares of the same size in each level");
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const Vec3 radiance = decoded(image, x, y);
                for (int c = 0; c < 3; ++c)
                    row.at(face * image.width + x, y, c) = radiance[c];
            }
        }
    }
    return row;
}

}  // namespace

std::size_t add_image_based_light(GltfBuilder& builder, const ImageBasedLight& light) {
    ITEM3D_CHECK(light.specular.size() > 1, "an image-based light has several levels");
    // The brightest texel sets the scale: a sun keeps its full radiance, and dark parts lose
    // precision.
    float intensity = 1;
    for (const Image& level : light.specular)
        intensity = std::max(intensity, brightest(level) / largest_rgbd);

    Json levels = Json::array();
    for (std::size_t level = 0; level < light.specular.size(); ++level) {
        Json faces = Json::array();
        for (int face = 0; face < 6; ++face) {
            Json image{{"name", fmt::format("light_{}_{}", level, face)}};
            builder.embed_image(
                image, encode_png(to_rgbd(light.specular[level], face, intensity), 8), "image/png");
            faces.push_back(append(builder.json(), "images", std::move(image)));
        }
        levels.push_back(std::move(faces));
    }
    Json coefficients = Json::array();
    for (const Vec3& coefficient : light.irradiance) {
        const Vec3 scaled = coefficient / intensity;
        coefficients.push_back({scaled.x, scaled.y, scaled.z});
    }
    return append(builder.json()["extensions"][image_based_extension], "lights",
                  Json{{"name", "light"},
                       {"intensity", intensity},
                       {"irradianceCoefficients", std::move(coefficients)},
                       {"specularImageSize", light.specular.front().height},
                       {"specularImages", std::move(levels)}});
}

Image load_image_based_light(const std::filesystem::path& path) {
    const auto document = parse_gltf(path, read_bytes(path));
    const GltfObject root = root_of(*document);
    const auto extensions = root.object("extensions");
    const auto lights = extensions ? extensions->object(image_based_extension) : std::nullopt;
    if (!lights || lights->list_size("lights") == 0) {
        throw InputError(path.string(),
                         fmt::format("contains no image-based light ({})", image_based_extension),
                         "use a preset, an .hdr or an .exr file");
    }
    const GltfObject light = chosen_light(root, *lights);
    const Image faces = faces_to_equirectangular(read_faces(*document, light), gltf_face_axes);
    const auto intensity = static_cast<float>(light.number("intensity", 1));
    std::vector<double> q = light.numbers("rotation", 4);
    if (q.empty()) q = {0, 0, 0, 1};
    const glm::quat rotation(static_cast<float>(q[3]), static_cast<float>(q[0]),
                             static_cast<float>(q[1]), static_cast<float>(q[2]));
    if (!(intensity >= 0) || !(glm::length(rotation) > 0))
        light.fail("intensity is below 0, or rotation is zero");
    const glm::quat back = glm::inverse(glm::normalize(rotation));
    return light_from(faces.height,
                      [&](Vec3 direction) { return intensity * look_up(faces, back * direction); });
}

}  // namespace item3d
