// Pictures as vision networks want them, as transformers' CLIPImageProcessor, BlipImageProcessor
// and ViTImageProcessor make them: resize, centre crop, normalisation.
#pragma once

#include "item3d/core/config.h"
#include "item3d/tensors/tensor.h"

#include <array>
#include <filesystem>

namespace item3d {

/// How pictures are resized, by Pillow's numbers.
enum class ResizeFilter { bilinear = 2, bicubic = 3 };

/// preprocessor_config.json.
struct ImageProcessorConfig {
    /// The shorter edge, where `height` is 0; else the exact size.
    int shortest_edge = 224;
    int height = 0;
    int width = 0;
    bool center_crop = true;
    int crop_height = 224;
    int crop_width = 224;
    ResizeFilter filter = ResizeFilter::bicubic;
    /// Else alpha is left out, as it is in front of a ViTImageProcessor.
    bool alpha_over_white = true;
    double rescale_factor = 1.0 / 255;
    std::array<double, 3> mean{0.48145466, 0.4578275, 0.40821073};
    std::array<double, 3> deviation{0.26862954, 0.26130258, 0.27577711};

    static ImageProcessorConfig from_config(const Config& config);
};

class ImageProcessor {
  public:
    explicit ImageProcessor(const ImageProcessorConfig& config) : config_(config) {}
    /// Reads FOLDER/preprocessor_config.json. Throws InputError, also for options that are not
    /// supported (a filter that is neither bicubic nor bilinear).
    static ImageProcessor load(const std::filesystem::path& folder);
    /// The same for a network that reads squares of `image_size` pixels; InputError, too, when some
    /// pictures would not become such.
    static ImageProcessor load(const std::filesystem::path& folder, int image_size);

    /// Bytes [H, W, C] (grey or RGB, with alpha or without) -> [1, 3, h, w] float32,
    /// exactly as Pillow resizes them (resize_picture).
    at::Tensor process(const at::Tensor& bytes) const;
    /// The resized bytes [h, w, 3] before cropping and normalising.
    at::Tensor resize(const at::Tensor& bytes) const;

    /// The same for pictures that need gradients: [N, 3, H, W] sRGB in [0, 1] -> [N, 3, h, w],
    /// without rounding to bytes (which moves values by less than 1 / 255). Differentiable.
    at::Tensor process_differentiably(const at::Tensor& images) const;

    /// {h, w} of what becomes of a picture of that size.
    std::array<int, 2> output_size(int height, int width) const;
    const ImageProcessorConfig& config() const { return config_; }

  private:
    std::array<int, 2> resized_size(int height, int width) const;
    at::Tensor crop_and_normalize(const at::Tensor& planes) const;

    ImageProcessorConfig config_;
};

/// Pillow's resize (bicubic with a = -0.5, or bilinear; widened when shrinking) of bytes [H, W, C]
/// to [height, width, C]: two passes, weights in 22-bit fixed point, rounded to bytes after each.
/// Horizontal first, but (since Pillow 13) where more than twice as many rows go as columns do.
at::Tensor resize_picture(const at::Tensor& bytes, int height, int width, ResizeFilter filter);
/// The same, bicubic.
at::Tensor resize_bicubic(const at::Tensor& bytes, int height, int width);

}  // namespace item3d
