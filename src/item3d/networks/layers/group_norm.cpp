#include "item3d/networks/layers/group_norm.h"

#include "item3d/kernels/cpu/norm/norm_kernel.h"
#include "item3d/tensors/parallel_ranges.h"

#include <ATen/autocast_mode.h>
#include <torch/csrc/autograd/custom_function.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace item3d {
namespace {

using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

/// Sizes of a feature map, and its partition into pieces for the threads. A piece is a range of one
/// image's pixels. The partition, and therefore the sums, do not depend on the number of threads.
struct NormMap {
    std::int64_t images, pixels, channels, groups;
    static constexpr std::int64_t piece = 1024;

    NormMap(const at::Tensor& x, std::int64_t group_count)
        : images(x.size(0)),
          pixels(x.size(2) * x.size(3)),
          channels(x.size(1)),
          groups(group_count) {}
    std::int64_t pieces() const { return (pixels + piece - 1) / piece; }

    /// Calls f(piece, image, offset of its first number, number of pixels) for each piece, on all
    /// threads.
    template <typename Function>
    void for_each_piece(const Function& f) const {
        parallel_ranges(images * pieces(), 1, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t i = begin; i < end; ++i) {
                const std::int64_t image = i / pieces(), first = i % pieces() * piece;
                f(i, image, (image * pixels + first) * channels, std::min(piece, pixels - first));
            }
        });
    }

    /// Returns two sums [2, channels] for each image. add(image, offset of the first number, number
    /// of pixels, sums) adds the sums over one piece to `sums`.
    template <typename Add>
    std::vector<double> sums(const Add& add) const {
        const auto width = static_cast<std::size_t>(2 * channels);
        std::vector<double> parts(width * static_cast<std::size_t>(images * pieces()));
        for_each_piece(
            [&](std::int64_t i, std::int64_t image, std::int64_t first, std::int64_t count) {
                add(image, first, count, parts.data() + static_cast<std::size_t>(i) * width);
            });
        std::vector<double> result(width * static_cast<std::size_t>(images));
        for (std::int64_t i = 0; i < images * pieces(); ++i)
            for (std::size_t k = 0; k < width; ++k)
                result[static_cast<std::size_t>(i / pieces()) * width + k] +=
                    parts[static_cast<std::size_t>(i) * width + k];
        return result;
    }
};

/// Four values for each image and channel, [N, C] each.
struct NormValues {
    explicit NormValues(const NormMap& map)
        : all(at::empty({4, map.images, map.channels}, at::kFloat)) {}
    explicit NormValues(at::Tensor kept) : all(std::move(kept)) {}
    float* scale() const { return all[0].data_ptr<float>(); }
    float* offset() const { return all[1].data_ptr<float>(); }
    float* mean() const { return all[2].data_ptr<float>(); }  ///< mean of the channel's group
    /// Reciprocal deviation of the group.
    float* deviation() const { return all[3].data_ptr<float>(); }
    at::Tensor all;
};

template <typename Number>
const auto& kernel_of() {
    return kernel_for_this_processor<Number>(
        []<InstructionSet instructions> { return norm_kernel<instructions, Number>(); });
}

template <typename Number>
const Number* numbers_of(const at::Tensor& tensor) {
    return static_cast<const Number*>(tensor.data_ptr());
}

template <typename Number>
NormValues measure(const NormMap& map, const Number* x, const float* weight, const float* bias,
                   double epsilon) {
    const std::int64_t channels = map.channels, width = channels / map.groups;
    // Uses the first pixel of each image as an estimate of the image's mean.
    std::vector<float> zero(static_cast<std::size_t>(channels)),
        one(static_cast<std::size_t>(channels), 1.0f);
    std::vector<float> shift(static_cast<std::size_t>(map.images * channels));
    {
        std::vector<double> unused(static_cast<std::size_t>(channels));
        for (std::int64_t n = 0; n < map.images; ++n) {
            std::vector<double> first(static_cast<std::size_t>(channels));
            kernel_of<Number>()->add_channel_sums(x + n * map.pixels * channels, 1, channels,
                                                  zero.data(), first.data(), unused.data());
            std::copy(first.begin(), first.end(), shift.begin() + n * channels);
        }
    }
    const std::vector<double> sums =
        map.sums([&](std::int64_t n, std::int64_t first, std::int64_t count, double* to) {
            kernel_of<Number>()->add_channel_sums(x + first, count, channels,
                                                  shift.data() + n * channels, to, to + channels);
        });
    const NormValues values(map);
    float *scale = values.scale(), *offset = values.offset(), *group_mean = values.mean(),
          *deviation = values.deviation();
    for (std::int64_t n = 0; n < map.images; ++n) {
        const double* sum = sums.data() + 2 * n * channels;
        for (std::int64_t g = 0; g < map.groups; ++g) {
            const auto count = static_cast<double>(map.pixels);
            double mean = 0, square = 0;
            for (std::int64_t c = g * width; c < (g + 1) * width; ++c)
                mean += sum[c] / count + shift[static_cast<std::size_t>(n * channels + c)];
            mean /= static_cast<double>(width);
            for (std::int64_t c = g * width; c < (g + 1) * width; ++c) {
                const double apart = shift[static_cast<std::size_t>(n * channels + c)] - mean;
                square += sum[channels + c] / count + 2 * apart * sum[c] / count + apart * apart;
            }
            const double variance = std::max(0.0, square / static_cast<double>(width));
            const double inverse = 1 / std::sqrt(variance + epsilon);
            for (std::int64_t c = g * width; c < (g + 1) * width; ++c) {
                const std::int64_t i = n * channels + c;
                const double factor = inverse * weight[c];
                scale[i] = static_cast<float>(factor);
                offset[i] = static_cast<float>(bias[c] - mean * factor);
                group_mean[i] = static_cast<float>(mean);
                deviation[i] = static_cast<float>(inverse);
            }
        }
    }
    return values;
}

template <typename Number>
NormValues normalize(const NormMap& map, const at::Tensor& x, const at::Tensor& weight,
                     const at::Tensor& bias, double epsilon, bool silu, const at::Tensor& y) {
    const auto* from = numbers_of<Number>(x);
    auto* to = static_cast<Number*>(y.data_ptr());
    const NormValues values =
        measure(map, from, weight.data_ptr<float>(), bias.data_ptr<float>(), epsilon);
    const float *scale = values.scale(), *offset = values.offset();
    map.for_each_piece([&](std::int64_t, std::int64_t n, std::int64_t first, std::int64_t count) {
        kernel_of<Number>()->apply(from + first, count, map.channels, scale + n * map.channels,
                                   offset + n * map.channels, silu, to + first);
    });
    return values;
}

template <typename Number>
void back(const NormMap& map, const at::Tensor& input, const at::Tensor& gradient,
          const NormValues& values, bool silu, const at::Tensor& result) {
    const std::int64_t channels = map.channels, width = channels / map.groups;
    const auto *x = numbers_of<Number>(input), *dy = numbers_of<Number>(gradient);
    auto* dx = static_cast<Number*>(result.data_ptr());
    const float *scale = values.scale(), *offset = values.offset(), *mean = values.mean(),
                *deviation = values.deviation();
    const std::vector<double> sums = map.sums([&](std::int64_t n, std::int64_t first,
                                                  std::int64_t count, double* to) {
        const std::int64_t at = n * channels;
        kernel_of<Number>()->add_gradient_sums(x + first, dy + first, count, channels, scale + at,
                                               offset + at, mean + at, silu, to, to + channels);
    });
    // The gradient of x is deviation (d - mean(d) - h mean(d h)), where h is the normalized x, and
    // d is the gradient of h.
    std::vector<float> constant(static_cast<std::size_t>(map.images * channels)),
        slope(constant.size());
    for (std::int64_t n = 0; n < map.images; ++n) {
        const double* sum = sums.data() + 2 * n * channels;
        for (std::int64_t g = 0; g < map.groups; ++g) {
            const std::int64_t at = n * channels + g * width;
            // scale is deviation times weight.
            double mean_d = 0, mean_dh = 0;
            for (std::int64_t c = g * width; c < (g + 1) * width; ++c) {
                const double factor = scale[n * channels + c];
                mean_d += factor * sum[c];
                mean_dh += factor * deviation[at] * sum[channels + c];
            }
            const auto count = static_cast<double>(map.pixels * width);
            mean_d /= count;
            mean_dh /= count;
            for (std::int64_t i = at; i < at + width; ++i) {
                const double tilt = -mean_dh * deviation[at];
                slope[static_cast<std::size_t>(i)] = static_cast<float>(tilt);
                constant[static_cast<std::size_t>(i)] =
                    static_cast<float>(-mean_d - tilt * mean[at]);
            }
        }
    }
    map.for_each_piece([&](std::int64_t, std::int64_t n, std::int64_t first, std::int64_t count) {
        const std::int64_t at = n * channels;
        kernel_of<Number>()->apply_gradient(x + first, dy + first, count, channels, scale + at,
                                            offset + at, constant.data() + at, slope.data() + at,
                                            silu, dx + first);
    });
}

struct FusedNorm : torch::autograd::Function<FusedNorm> {
    static at::Tensor forward(AutogradContext* context, const at::Tensor& input,
                              const at::Tensor& weight, const at::Tensor& bias, std::int64_t groups,
                              double epsilon, bool silu) {
        const at::Tensor x = input.contiguous(at::MemoryFormat::ChannelsLast);
        const NormMap map(x, groups);
        const at::Tensor y = at::empty_like(x);
        const auto run = x.scalar_type() == at::kBFloat16 ? normalize<BFloat16> : normalize<float>;
        const NormValues values = run(map, x, weight.to(at::kFloat).contiguous(),
                                      bias.to(at::kFloat).contiguous(), epsilon, silu, y);
        context->save_for_backward({x, values.all});
        context->saved_data["groups"] = groups;
        context->saved_data["silu"] = silu;
        return y;
    }
    static tensor_list backward(AutogradContext* context, tensor_list gradients) {
        const auto saved = context->get_saved_variables();
        const at::Tensor& x = saved[0];
        const at::Tensor dy =
            gradients[0].to(x.scalar_type()).contiguous(at::MemoryFormat::ChannelsLast);
        const at::Tensor dx = at::empty_like(x);
        const auto run = x.scalar_type() == at::kBFloat16 ? back<BFloat16> : back<float>;
        run(NormMap(x, context->saved_data["groups"].toInt()), x, dy, NormValues(saved[1]),
            context->saved_data["silu"].toBool(), dx);
        return {dx, {}, {}, {}, {}, {}};
    }
};

bool runs(at::ScalarType dtype) {
    return (dtype == at::kFloat && kernel_of<float>()) ||
           (dtype == at::kBFloat16 && kernel_of<BFloat16>());
}

}  // namespace

at::Tensor group_norm(torch::nn::GroupNorm& norm, const at::Tensor& x, Activation activation) {
    const bool silu = activation == Activation::silu;
    const at::Tensor &weight = norm->weight, &bias = norm->bias;
    const bool ours = x.is_cpu() && x.dim() == 4 && x.size(1) % register_numbers == 0 &&
                      weight.defined() && !weight.requires_grad() && !bias.requires_grad() &&
                      x.scalar_type() == weight.scalar_type() && runs(x.scalar_type()) &&
                      !at::autocast::is_autocast_enabled(at::kCPU);
    if (ours)
        return FusedNorm::apply(x, weight, bias, norm->options.num_groups(), norm->options.eps(),
                                silu);
    const at::Tensor y = norm(x);
    return silu ? at::silu(y) : y;
}

}  // namespace item3d
