#include "item3d/lighting/layout.h"

#include "item3d/core/error.h"
#include "item3d/core/parallel.h"
#include "item3d/lighting/environment.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace item3d {

namespace {

// The faces are in the order right, left, up, down, front, back.
constexpr std::size_t back_face = 5;
const std::array<CubeFaceAxes, 6> face_axes = {{
    {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
    {{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
    {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
    {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
    {{0, 0, -1}, {1, 0, 0}, {0, 1, 0}},
    {{0, 0, 1}, {-1, 0, 0}, {0, 1, 0}},
}};

/// Positions of a layout's faces, in units of a face from the upper left corner.
struct FacePlaces {
    int columns;
    int rows;
    std::array<std::array<int, 2>, 6> place;
    bool back_is_upside_down;
};

const FacePlaces wide_cross{4, 3, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}}, false};
const FacePlaces tall_cross{3, 4, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {1, 3}}}, true};
const FacePlaces row_strip{6, 1, {{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}}, false};
const FacePlaces column_strip{1, 6, {{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}}}, false};

bool fits(const Image& image, const FacePlaces& places) {
    return image.width % places.columns == 0 && image.height % places.rows == 0 &&
           image.width / places.columns == image.height / places.rows;
}

Vec3 texel(const Image& image, int x, int y) {
    return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
}

/// Interpolates bilinearly at (x, y) in pixels, within the rectangle of pixels that begins at
/// (left, top).
Vec3 bilinear(const Image& image, float x, float y, int left, int top, int width, int height) {
    const float column = std::clamp(x - 0.5f, 0.0f, static_cast<float>(width - 1));
    const float row = std::clamp(y - 0.5f, 0.0f, static_cast<float>(height - 1));
    const int x0 = static_cast<int>(column);
    const int y0 = static_cast<int>(row);
    const int x1 = left + std::min(x0 + 1, width - 1);
    const int y1 = top + std::min(y0 + 1, height - 1);
    const Vec3 above = glm::mix(texel(image, left + x0, top + y0), texel(image, x1, top + y0),
                                column - static_cast<float>(x0));
    const Vec3 below = glm::mix(texel(image, left + x0, y1), texel(image, x1, y1),
                                column - static_cast<float>(x0));
    return glm::mix(above, below, row - static_cast<float>(y0));
}

Vec3 look_up_cube(const Image& image, const FacePlaces& places,
                  const std::array<CubeFaceAxes, 6>& all_axes, Vec3 direction) {
    std::size_t face = 0;
    for (std::size_t other = 1; other < 6; ++other) {
        if (glm::dot(direction, all_axes[other].forward) >
            glm::dot(direction, all_axes[face].forward))
            face = other;
    }
    const CubeFaceAxes& axes = all_axes[face];
    const float depth = glm::dot(direction, axes.forward);
    Vec2 p(glm::dot(direction, axes.right) / depth, -glm::dot(direction, axes.up) / depth);
    if (face == back_face && places.back_is_upside_down) p = -p;
    const int side = image.width / places.columns;
    return bilinear(image, (p.x + 1) / 2 * side, (p.y + 1) / 2 * side, places.place[face][0] * side,
                    places.place[face][1] * side, side, side);
}

Vec3 look_up_probe(const Image& image, Vec3 direction) {
    const float across = std::hypot(direction.x, direction.y);
    const float distance = std::atan2(across, -direction.z) / pi;
    const Vec2 p = across > 0 ? Vec2(direction.x, -direction.y) * (distance / across) : Vec2(0);
    return bilinear(image, (p.x + 1) / 2 * image.width, (p.y + 1) / 2 * image.height, 0, 0,
                    image.width, image.height);
}

LightLayout detect(const Image& image, const std::string& subject) {
    if (image.width == 2 * image.height) return LightLayout::equirectangular;
    if (fits(image, wide_cross) || fits(image, tall_cross)) return LightLayout::cross;
    if (fits(image, row_strip) || fits(image, column_strip)) return LightLayout::strip;
    if (image.width == image.height) return LightLayout::angular;
    throw InputError(
        subject,
        fmt::format("{}x{} does not fit any layout of light files", image.width, image.height),
        "equirectangular is 2:1, a cross 4:3 or 3:4, a strip 6:1 or 1:6, angular 1:1; or convert "
        "it by item3d light with --layout equirectangular");
}

}  // namespace

const std::vector<std::string>& light_layout_names() {
    static const std::vector<std::string> names = {"auto", "equirectangular", "cross", "strip",
                                                   "angular"};
    return names;
}

LightLayout parse_light_layout(const std::string& name) {
    const auto& names = light_layout_names();
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
        throw InputError("layout '" + name + "'", "unknown layout",
                         fmt::format("layouts are {}", fmt::join(names, ", ")));
    }
    return static_cast<LightLayout>(found - names.begin());
}

Image to_equirectangular(const Image& image, LightLayout layout, const std::string& subject) {
    ITEM3D_CHECK(image.channels == 3 && !image.empty(), "a light has three channels");
    if (layout == LightLayout::automatic) layout = detect(image, subject);
    if (layout == LightLayout::equirectangular) return image;
    if (layout == LightLayout::angular) {
        if (image.width != image.height) {
            throw InputError(subject,
                             fmt::format("an angular map must be square, found {}x{}", image.width,
                                         image.height),
                             "crop the image, or choose another layout");
        }
        return light_from(std::max(2, image.height / 2),
                          [&](Vec3 direction) { return look_up_probe(image, direction); });
    }
    const bool is_cross = layout == LightLayout::cross;
    for (const FacePlaces* places :
         {is_cross ? &wide_cross : &row_strip, is_cross ? &tall_cross : &column_strip}) {
        if (!fits(image, *places)) continue;
        return light_from(2 * (image.width / places->columns), [&](Vec3 direction) {
            return look_up_cube(image, *places, face_axes, direction);
        });
    }
    throw InputError(subject,
                     fmt::format("{}, found {}x{}",
                                 is_cross ? "a cross must have an aspect ratio of 4:3 or 3:4"
                                          : "a strip must have an aspect ratio of 6:1 or 1:6",
                                 image.width, image.height),
                     "crop the image, or choose another layout");
}

Image faces_to_equirectangular(const Image& row, const std::array<CubeFaceAxes, 6>& axes) {
    ITEM3D_CHECK(row.channels == 3 && fits(row, row_strip),
                 "a cube needs six square faces in a row");
    return light_from(2 * row.height, [&](Vec3 direction) {
        return look_up_cube(row, row_strip, axes, direction);
    });
}

Image light_from(int height, const std::function<Vec3(Vec3)>& radiance) {
    Image light(2 * height, height, 3);
    parallel_for(
        "light", height,
        [&](std::int64_t row) {
            const auto y = static_cast<float>(row);
            for (int x = 0; x < light.width; ++x) {
                Vec3 sum(0);
                for (int sample = 0; sample < 4; ++sample) {
                    const float u =
                        static_cast<float>(x) + 0.25f + 0.5f * static_cast<float>(sample & 1);
                    const float v = y + 0.25f + 0.5f * static_cast<float>(sample >> 1);
                    sum += radiance(equirectangular_direction(u / light.width, v / height));
                }
                for (int c = 0; c < 3; ++c)
                    light.at(x, static_cast<int>(row), c) = sum[c] / 4;
            }
        },
        1);
    return light;
}

Vec3 look_up(const Image& light, Vec3 direction) {
    const Vec2 uv = equirectangular_uv(direction);
    const float x = uv.x * light.width - 0.5f;
    const float y = std::clamp(uv.y * light.height - 0.5f, 0.0f, light.height - 1.0f);
    const float column = std::floor(x);
    const int x0 = (static_cast<int>(column) + light.width) % light.width;
    const int x1 = (x0 + 1) % light.width;
    const int y0 = static_cast<int>(y);
    const int y1 = std::min(y0 + 1, light.height - 1);
    const Vec3 above = glm::mix(texel(light, x0, y0), texel(light, x1, y0), x - column);
    const Vec3 below = glm::mix(texel(light, x0, y1), texel(light, x1, y1), x - column);
    return glm::mix(above, below, y - static_cast<float>(y0));
}

}  // namespace item3d
