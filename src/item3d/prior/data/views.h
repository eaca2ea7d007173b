// Views of procedural shapes from random cameras. A view is a G-buffer that is rendered once and
// shaded many times.
#pragma once

#include "item3d/core/math.h"
#include "item3d/core/random.h"
#include "item3d/tensors/tensor.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace item3d {

/// Default edge of an image in pixels, and edge of its latents.
inline constexpr int prior_image_size = 64;
inline constexpr int latent_size = 16;
/// Channels of the latents. With four, as in large models, an autoencoder this small blurred dots
/// and lost stitches.
inline constexpr int latent_channels = 8;
/// Samples per pixel along one side. A pixel of the image is the mean of view_samples^2 pixels of
/// the G-buffer.
inline constexpr int view_samples = 2;

/// View of one shape. It stores only the P covered pixels of the G-buffer, with 19 bytes each.
/// Coordinates are the shape's own, scaled into the unit sphere.
struct ShapeView {
    int shape_class = 0;  ///< index into shape_classes()
    int variant = 0;
    int size = 0;                        ///< edge of the G-buffer: view_samples times the image's
    bool close_up = false;               ///< true if the shape is larger than the image
    Vec3 camera{0.0f};                   ///< position
    std::vector<std::string> parts;      ///< names of the shape's parts; the first is "" (shapes.h)
    std::vector<std::uint16_t> pixel;    ///< [P] y * size + x
    std::vector<std::int16_t> position;  ///< [P * 3] in units of 1 / 32767
    std::vector<std::int16_t> normal;    ///< [P * 3] unit normals in the same units
    std::vector<std::uint8_t> part;      ///< [P] index into parts
    std::vector<std::uint32_t> sky;      ///< [P] visible parts of the sky (sky_visibility.h)
    /// [shape_cell_channels, latent_size, latent_size] fp16, as from shape_cells() in
    /// networks/diffusion/shape_condition.h.
    at::Tensor cells;

    std::size_t count() const { return pixel.size(); }
    Vec3 position_at(std::size_t i) const {
        return Vec3(position[3 * i], position[3 * i + 1], position[3 * i + 2]) / 32767.0f;
    }
    Vec3 normal_at(std::size_t i) const {
        return glm::normalize(Vec3(normal[3 * i], normal[3 * i + 1], normal[3 * i + 2]));
    }
};

/// Returns `count` views of one shape from random cameras. The azimuth is any, the elevation -10 to
/// 50 degrees, and the horizontal field of view 25 to 45 degrees. The shape fills 70 to 95 % of the
/// image. A fifth of the views are close-ups, in which it fills 110 to 160 %. resolution: number of
/// cells along an edge of the polygonisation grid. image: edge of the images in pixels, at most
/// 128.
std::vector<ShapeView> make_views(const std::string& shape_class, int variant, int count,
                                  std::uint64_t seed, int resolution = 96,
                                  int image = prior_image_size);

/// Returns views of training shapes, `variants` of each class, in a fixed order. If `held_out` is
/// true, returns views of held-out shapes instead, at most `variants` of each class; some classes
/// are held out as a whole. The result is incomplete after an interrupt.
std::vector<ShapeView> make_view_pool(bool held_out, int variants, int views_each,
                                      std::uint64_t seed, int threads,
                                      int image = prior_image_size);

}  // namespace item3d
