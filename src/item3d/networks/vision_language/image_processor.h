// Image preprocessing of vision networks as in transformers' CLIPImageProcessor, BlipImageProcessor
// and ViTImageProcessor: resize, centre crop, normalisation.
#pragma once

#include "item3d/core/config.h"
#include "item3d/tensors/tensor.h"

#include <array>
#include <filesystem>

namespace item3d {

/// Resize filters, by Pillow's numbers.
enum class ResizeFilter { bilinear = 2, bicubic = 3 };

/// Configuration in preprocessor_config.json.
struct ImageProcessorConfig {
    /// Size of the shorter edge, if `height` is 0. Otherwise images are resized to height x width.
    int shortest_edge = 224;
    int height = 0;
    int width = 0;
    bool center_crop = true;
    int crop_height = 224;
    int crop_width = 224;
    ResizeFilter filter = ResizeFilter::bicubic;
    /// True if images with alpha are composited over white, false if alpha is dropped, as in a
    /// ViTImageProcessor.
    bool alpha_over_white = true;
    double rescale_factor = 1.0 / 255;
    std::array<double, 3> mean{0.48145466, 0.4578275, 0.40821073};
    std::array<double, 3> deviation{0.26862954, 0.26130258, 0.27577711};

    static ImageProcessorConfig from_config(const Config& config);
};

class ImageProcessor {
  public:
    explicit ImageProcessor(const ImageProcessorConfig& config) : config_(config) {}
    /// Reads FOLDER/preprocessor_config.json. Throws InputError, also for unsupported options (a
    /// filter that is neither bicubic nor bilinear).
    static ImageProcessor load(const std::filesystem::path& folder);
    /// Reads the folder for a network whose inputs are squares of `image_size` pixels. Also throws
    /// InputError if the result for some images would have another size.
    static ImageProcessor load(const std::filesystem::path& folder, int image_size);

    /// Converts bytes [H, W, C] (grey or RGB, with or without alpha) to [1, 3, h, w] float32,
    /// resized exactly as by Pillow (resize_image).
    at::Tensor process(const at::Tensor& bytes) const;
    /// Returns the resized bytes [h, w, 3] before cropping and normalising.
    at::Tensor resize(const at::Tensor& bytes) const;

    /// Processes images [N, 3, H, W] sRGB in [0, 1] differentiably, to [N, 3, h, w], without
    /// rounding to bytes (which moves values by less than 1 / 255).
    at::Tensor process_differentiably(const at::Tensor& images) const;

    /// Returns the output size {h, w} of an image of the given size.
    std::array<int, 2> output_size(int height, int width) const;
    const ImageProcessorConfig& config() const { return config_; }

  private:
    std::array<int, 2> resized_size(int height, int width) const;
    at::Tensor crop_and_normalize(const at::Tensor& planes) const;

    ImageProcessorConfig config_;
};

/// Resizes bytes [H, W, C] to [height, width, C] as Pillow does. The filter is bicubic with a =
/// -0.5, or bilinear, and is widened where the image shrinks. Each of the two passes has weights in
/// 22-bit fixed point and rounds to bytes. The horizontal pass is first, except (since Pillow 13)
/// where rows shrink more than twice as much as columns.
at::Tensor resize_image(const at::Tensor& bytes, int height, int width, ResizeFilter filter);
/// Resizes with the bicubic filter.
at::Tensor resize_bicubic(const at::Tensor& bytes, int height, int width);

}  // namespace item3d
