#include "item3d/networks/vision_language/image_processor.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/parallel.h"
#include "item3d/tensors/tensor.h"

#include <ATen/ops/_upsample_bilinear2d_aa.h>

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr int precision_bits = 22;

/// Cubic convolution of Keys with a = -0.5.
double bicubic(double x) {
    constexpr double a = -0.5;
    x = std::abs(x);
    if (x < 1) return ((a + 2) * x - (a + 3)) * x * x + 1;
    if (x < 2) return (((x - 5) * x + 8) * x - 4) * a;
    return 0;
}

/// Returns half the filter's width, in samples of the coarser side.
double support_of(ResizeFilter filter) {
    return filter == ResizeFilter::bicubic ? 2 : 1;
}

double weight_at(ResizeFilter filter, double x) {
    return filter == ResizeFilter::bicubic ? bicubic(x) : std::max(0.0, 1 - std::abs(x));
}

/// Weights of a resampling. Each output sample has a first input sample, and weights of that sample
/// and the following ones.
struct Filter {
    int taps = 0;  ///< weights per sample; unused ones are zero
    std::vector<int> first, count;
    std::vector<std::int32_t> weights;
};

Filter make_filter(int input, int output, ResizeFilter kind) {
    const double scale = static_cast<double>(input) / output;
    const double width = std::max(scale, 1.0);
    const double support = support_of(kind) * width;
    Filter filter;
    filter.taps = static_cast<int>(std::ceil(support)) * 2 + 1;
    filter.weights.assign(static_cast<std::size_t>(output) * filter.taps, 0);
    std::vector<double> values(filter.taps);
    for (int i = 0; i < output; ++i) {
        const double center = (i + 0.5) * scale;
        const int first = std::max(0, static_cast<int>(center - support + 0.5));
        const int count = std::min(input, static_cast<int>(center + support + 0.5)) - first;
        double sum = 0;
        for (int k = 0; k < count; ++k) {
            values[k] = weight_at(kind, (k + first - center + 0.5) / width);
            sum += values[k];
        }
        for (int k = 0; k < count; ++k) {
            const double fixed = values[k] / sum * (1 << precision_bits);
            filter.weights[static_cast<std::size_t>(i) * filter.taps + k] =
                static_cast<std::int32_t>(fixed < 0 ? fixed - 0.5 : fixed + 0.5);
        }
        filter.first.push_back(first);
        filter.count.push_back(count);
    }
    return filter;
}

/// Resamples the middle dimension of [outer, input, inner] bytes.
at::Tensor resample(const at::Tensor& bytes, int output, ResizeFilter kind) {
    const auto outer = bytes.size(0), inner = bytes.size(2);
    const int input = static_cast<int>(bytes.size(1));
    if (input == output) return bytes;
    const Filter filter = make_filter(input, output, kind);
    at::Tensor result = at::empty({outer, output, inner}, at::kByte);
    const std::uint8_t* from = bytes.const_data_ptr<std::uint8_t>();
    std::uint8_t* to = result.mutable_data_ptr<std::uint8_t>();
    parallel_for("resample", outer * output, [&](std::int64_t index) {
        const std::int64_t row = index / output, sample = index % output;
        const std::int32_t* weights = &filter.weights[sample * filter.taps];
        const std::uint8_t* source = from + (row * input + filter.first[sample]) * inner;
        for (std::int64_t i = 0; i < inner; ++i) {
            std::int32_t sum = 1 << (precision_bits - 1);
            for (int k = 0; k < filter.count[sample]; ++k)
                sum += source[k * inner + i] * weights[k];
            to[index * inner + i] =
                static_cast<std::uint8_t>(std::clamp(sum >> precision_bits, 0, 255));
        }
    });
    return result;
}

/// Expands grey to three channels, and drops alpha or composites it over white, in bytes as Pillow
/// does.
at::Tensor to_rgb(const at::Tensor& bytes, bool alpha_over_white) {
    const auto channels = bytes.size(2);
    const at::Tensor color =
        channels < 3 ? bytes.narrow(2, 0, 1).expand({-1, -1, 3}) : bytes.narrow(2, 0, 3);
    if (!alpha_over_white || (channels != 2 && channels != 4)) return color;
    const at::Tensor alpha = bytes.narrow(2, channels - 1, 1).to(at::kLong);
    // Divides by 255 as Pillow does, by (x + (x >> 8)) >> 8, in numbers with seven more bits than
    // bytes have.
    const at::Tensor sum = 128 * (color * alpha + 255 * (255 - alpha)) + (0x80 << 7);
    return sum.bitwise_right_shift(8).add(sum).bitwise_right_shift(8 + 7).to(at::kByte);
}

std::array<double, 3> three_numbers(const Config& config, const std::string& key,
                                    const std::array<double, 3>& fallback) {
    if (!config.has(key)) return fallback;
    const std::vector<double> values = config.numbers(key);
    if (values.size() != 3) config.fail(key, "three numbers");
    return {values[0], values[1], values[2]};
}

/// Maximum edge of a resized image, so that a hostile config cannot request terabytes.
constexpr int largest_edge = 8192;

int edge(const Config& config, const std::string& key, int fallback) {
    const int value = config.size(key, fallback);
    if (value > largest_edge) config.fail(key, "at most " + std::to_string(largest_edge));
    return value;
}

}  // namespace

at::Tensor resize_bicubic(const at::Tensor& bytes, int height, int width) {
    return resize_image(bytes, height, width, ResizeFilter::bicubic);
}

at::Tensor resize_image(const at::Tensor& bytes, int height, int width, ResizeFilter filter) {
    ITEM3D_CHECK(bytes.dim() == 3 && bytes.scalar_type() == at::kByte, "wanted bytes [H, W, C]");
    ITEM3D_CHECK(bytes.numel() > 0 && height > 0 && width > 0, "an image must not be empty");
    const auto lost_rows = bytes.size(0) - height, lost_columns = bytes.size(1) - width;
    const auto horizontally = [&](const at::Tensor& image) {
        return resample(image, width, filter);
    };
    const auto vertically = [&](const at::Tensor& image) {
        return resample(image.view({1, image.size(0), -1}), height, filter)
            .view({height, image.size(1), image.size(2)});
    };
    const at::Tensor image = bytes.cpu().contiguous();
    return lost_rows > 0 && lost_rows > 2 * lost_columns ? horizontally(vertically(image))
                                                         : vertically(horizontally(image));
}

ImageProcessorConfig ImageProcessorConfig::from_config(const Config& config) {
    ImageProcessorConfig result;
    for (const char* flag : {"do_resize", "do_rescale", "do_normalize"})
        config.expect(flag, true);
    // ViTImageProcessor has other defaults, and its numeric size means both edges.
    const bool vit = config.text("image_processor_type", config.text("feature_extractor_type", ""))
                         .starts_with("ViT");
    const int resample = config.integer("resample", vit ? 2 : 3);
    if (resample != 2 && resample != 3) config.fail("resample", "2 (bilinear) or 3 (bicubic)");
    result.filter = static_cast<ResizeFilter>(resample);
    if (vit) result.mean = result.deviation = {.5, .5, .5};
    result.alpha_over_white = !vit;
    // Old files have a number instead of an object.
    if (config.has("size") && config.json().at("size").is_object()) {
        const Config size(config.json().at("size"), config.subject() + ": size");
        if (size.has("shortest_edge")) {
            result.shortest_edge = edge(size, "shortest_edge", 224);
        } else {
            if (!size.has("height") || !size.has("width"))
                config.fail("size", "shortest_edge, or height and width");
            result.height = edge(size, "height", 224);
            result.width = edge(size, "width", 224);
        }
    } else if (vit) {
        result.height = result.width = edge(config, "size", 224);
    } else {
        result.shortest_edge = edge(config, "size", result.shortest_edge);
    }
    result.center_crop = config.boolean("do_center_crop", config.has("crop_size"));
    if (config.has("crop_size") && config.json().at("crop_size").is_object()) {
        const Config crop(config.json().at("crop_size"), config.subject() + ": crop_size");
        result.crop_height = edge(crop, "height", result.crop_height);
        result.crop_width = edge(crop, "width", result.crop_width);
    } else {
        result.crop_height = result.crop_width = edge(config, "crop_size", result.crop_width);
    }
    result.rescale_factor = config.number("rescale_factor", result.rescale_factor);
    result.mean = three_numbers(config, "image_mean", result.mean);
    result.deviation = three_numbers(config, "image_std", result.deviation);
    for (const double value : result.deviation)
        if (!(value > 0)) config.fail("image_std", "positive numbers");
    return result;
}

ImageProcessor ImageProcessor::load(const std::filesystem::path& folder) {
    return ImageProcessor(
        ImageProcessorConfig::from_config(Config::read(folder / "preprocessor_config.json")));
}

ImageProcessor ImageProcessor::load(const std::filesystem::path& folder, int image_size) {
    const ImageProcessor processor = load(folder);
    // Tests two aspect ratios, because a config that keeps the ratio makes a square of only one.
    for (const int width : {image_size, 2 * image_size})
        if (processor.output_size(image_size, width) != std::array<int, 2>{image_size, image_size})
            throw InputError(
                (folder / "preprocessor_config.json").string(),
                fmt::format(
                    "does not scale images to the {0} x {0} pixels of image_size in config.json",
                    image_size),
                "use the configuration that belongs to these weights");
    return processor;
}

std::array<int, 2> ImageProcessor::resized_size(int height, int width) const {
    if (config_.height > 0) return {config_.height, config_.width};
    const std::int64_t edge = config_.shortest_edge;
    const int longer = static_cast<int>(edge * std::max(height, width) / std::min(height, width));
    return height < width ? std::array<int, 2>{config_.shortest_edge, longer}
                          : std::array<int, 2>{longer, config_.shortest_edge};
}

std::array<int, 2> ImageProcessor::output_size(int height, int width) const {
    if (config_.center_crop) return {config_.crop_height, config_.crop_width};
    return resized_size(height, width);
}

at::Tensor ImageProcessor::resize(const at::Tensor& bytes) const {
    ITEM3D_CHECK(bytes.dim() == 3, "an image must be [H, W, C]");
    const auto [height, width] =
        resized_size(static_cast<int>(bytes.size(0)), static_cast<int>(bytes.size(1)));
    return resize_image(to_rgb(bytes, config_.alpha_over_white), height, width, config_.filter);
}

at::Tensor ImageProcessor::process(const at::Tensor& bytes) const {
    return crop_and_normalize(resize(bytes).permute({2, 0, 1}).unsqueeze(0).to(at::kFloat) *
                              config_.rescale_factor);
}

at::Tensor ImageProcessor::process_differentiably(const at::Tensor& images) const {
    ITEM3D_CHECK(images.dim() == 4 && images.size(1) == 3, "images must be [N, 3, H, W]");
    const auto [height, width] =
        resized_size(static_cast<int>(images.size(2)), static_cast<int>(images.size(3)));
    // The bicubic filter overshoots at edges. Bytes cannot exceed [0, 1], so the result is clamped.
    const at::Tensor resized =
        (config_.filter == ResizeFilter::bicubic
             ? at::_upsample_bicubic2d_aa(images, {height, width}, /*align_corners=*/false)
             : at::_upsample_bilinear2d_aa(images, {height, width}, /*align_corners=*/false))
            .clamp(0, 1);
    return crop_and_normalize(resized * (255 * config_.rescale_factor));
}

/// Crops and normalises planes [N, 3, H, W]. Pixels beyond the image are black.
at::Tensor ImageProcessor::crop_and_normalize(const at::Tensor& planes) const {
    at::Tensor result = planes;
    if (config_.center_crop) {
        const auto before = [](std::int64_t size, std::int64_t crop) {
            // Half of the cropped size is rounded down; half of the padding is rounded up.
            return size >= crop ? -((size - crop) / 2) : (crop - size + 1) / 2;
        };
        const std::int64_t top = before(planes.size(2), config_.crop_height);
        const std::int64_t left = before(planes.size(3), config_.crop_width);
        result = at::constant_pad_nd(planes,
                                     {left, config_.crop_width - planes.size(3) - left, top,
                                      config_.crop_height - planes.size(2) - top},
                                     0);
    }
    const auto channel = [&](const std::array<double, 3>& values) {
        return at::tensor({values[0], values[1], values[2]}, at::kDouble)
            .to(planes.options().requires_grad(false))
            .view({1, 3, 1, 1});
    };
    return (result - channel(config_.mean)) / channel(config_.deviation);
}

}  // namespace item3d
