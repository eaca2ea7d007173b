#include "python/src/texture.h"

#include "item3d/render/kernels/mipmap.h"

#include <algorithm>

namespace item3d::python {
namespace {

using Table = cuda::RenderTable;

constexpr std::int64_t anisotropic = 4;
/// Lookup::boundary from which on a value encodes glTF's wrap modes of both axes.
constexpr std::int64_t wrap_modes = 16;

bool is_known(const Lookup& in) {
    const bool by_axes = in.boundary >= wrap_modes && in.boundary < wrap_modes + 9;
    if (in.filter == anisotropic) return by_axes || in.boundary == 0 || in.boundary == 1;
    return in.filter >= 0 && in.filter < anisotropic && in.boundary >= 0 && in.boundary <= 3;
}

/// Tensors that the forward and the backward pass share, and the kernels' parameters for them.
struct Inputs {
    std::vector<Tensor> levels;
    Tensor uv, slopes, bias, footprint;
    std::int64_t views, height, width, pixels, texels = 0;
    bool program;
    kernels::TextureWrap wrap_u, wrap_v;  ///< used if `program` is true
    kernels::MipmapParameters p{};

    Inputs(const Operation& call, const Lookup& in)
        : uv(call.checked("uv", in.uv, ScalarType::Float, {-1, -1, -1, in.boundary == 3 ? 3 : 2})),
          views(uv.size(0)),
          height(uv.size(1)),
          width(uv.size(2)),
          pixels(views * height * width),
          program(in.filter == anisotropic) {
        if (!is_known(in))
            call.fail("unknown filter or boundary, or anisotropic with 'zero' or 'cube'");
        p.filter = static_cast<kernels::MipmapFilter>(program ? 1 : in.filter);
        p.boundary = static_cast<kernels::MipmapBoundary>(program ? 0 : in.boundary);
        using kernels::TextureWrap;
        wrap_u = wrap_v = in.boundary == 0 ? TextureWrap::repeat : TextureWrap::clamp_to_edge;
        if (in.boundary >= wrap_modes) {
            wrap_u = static_cast<TextureWrap>((in.boundary - wrap_modes) % 3);
            wrap_v = static_cast<TextureWrap>((in.boundary - wrap_modes) / 3);
        }
        p.pixels_per_view = std::max<std::int64_t>(1, height * width);
        p.uv = floats(uv);
        add_levels(call, in);
        const Sizes per_pixel{views, height, width, p.is_cube() ? 6 : 4};
        if (in.slopes) {
            slopes = call.checked("uv derivatives", *in.slopes, ScalarType::Float, per_pixel);
            p.slopes = floats(slopes);
        }
        if (in.bias) {
            bias = call.checked("level bias", *in.bias, ScalarType::Float, {views, height, width});
            p.bias = floats(bias);
        }
        if (program && in.slopes) {
            footprint = call.empty({pixels, 4});
            call.run<kernels::slopes_to_footprint>(
                &Table::slopes_to_footprint,
                kernels::SlopeParameters{p.slopes, mutable_floats(footprint)}, 4 * pixels, 16384);
        }
    }

    /// Returns the parameters of item3d's anisotropic lookup in the texture of one view.
    /// first: the pixel to which the lookup's index 0 belongs.
    kernels::TextureParameters program_lookup(std::int64_t view, std::int64_t first) const {
        kernels::TextureParameters t{};
        for (int level = 0; level < p.level_count; ++level) {
            t.levels[level] = p.levels[level];
            const std::int64_t offset = p.shared ? 0 : view * p.texels(level) * p.channels;
            t.levels[level].texels += offset;
            t.levels[level].first += offset;
        }
        t.level_count = p.level_count;
        t.channels = p.channels;
        t.uv = p.uv + 2 * first;
        t.footprint = p.slopes == nullptr ? nullptr : floats(footprint) + 4 * first;
        t.wrap_u = wrap_u;
        t.wrap_v = wrap_v;
        return t;
    }

  private:
    void add_levels(const Operation& call, const Lookup& in) {
        const bool cube = p.is_cube();
        const Sizes any = cube ? Sizes{-1, 6, -1, -1, -1} : Sizes{-1, -1, -1, -1};
        if (in.mips.size() + 1 > kernels::max_texture_levels)
            call.fail("at most 16 levels, found " + std::to_string(in.mips.size() + 1));
        levels.push_back(call.checked("texture", in.texture, ScalarType::Float, any));
        const std::int64_t axis = cube ? 2 : 1, batch = levels[0].size(0);
        if (batch != 1 && batch != views)
            call.fail("texture must be one for all views or one for each of the " +
                      std::to_string(views) + ", found " + std::to_string(batch));
        p.shared = batch == 1;
        p.channels = static_cast<int>(levels[0].size(axis + 2));
        for (std::size_t i = 0; i <= in.mips.size(); ++i) {
            std::int64_t rows = levels[0].size(axis), columns = levels[0].size(axis + 1);
            if (i == 0 && (rows < 1 || columns < 1 || (cube && rows != columns)))
                call.fail("texture must have texels, and those of a cube be square");
            if (i > 0) {
                rows = std::max<std::int64_t>(1, levels[i - 1].size(axis) / 2);
                columns = std::max<std::int64_t>(1, levels[i - 1].size(axis + 1) / 2);
                levels.push_back(call.checked(("level " + std::to_string(i)).c_str(),
                                              in.mips[i - 1], ScalarType::Float,
                                              cube ? Sizes{batch, 6, rows, columns, p.channels}
                                                   : Sizes{batch, rows, columns, p.channels}));
            }
            p.levels[i] = {floats(levels[i]), static_cast<int>(rows), static_cast<int>(columns),
                           texels};
            texels += levels[i].numel();
        }
        p.level_count = static_cast<int>(levels.size());
    }
};

}  // namespace

Tensor texture(const Tensor& texture, const std::vector<Tensor>& mips, const Tensor& uv,
               const std::optional<Tensor>& slopes, const std::optional<Tensor>& bias,
               std::int64_t filter, std::int64_t boundary) {
    const Operation call("texture", uv);
    const Inputs in(call, {texture, mips, uv, slopes, bias, filter, boundary});
    kernels::MipmapParameters p = in.p;
    const Tensor result = call.empty({in.views, in.height, in.width, p.channels});
    p.values = mutable_floats(result);
    if (!in.program) {
        call.run<kernels::mipmap_forward>(&Table::mipmap, p, in.pixels);
        return result;
    }
    for (std::int64_t view = 0; view < in.views; ++view) {
        const kernels::TextureParameters t = in.program_lookup(view, view * p.pixels_per_view);
        float* values = p.values + view * p.pixels_per_view * p.channels;
        if (call.on_device())
            call.launch(&Table::texture, {t, values, nullptr, nullptr, {}}, in.height * in.width);
        else
            parallel_for(
                "texture", in.height * in.width,
                [&](std::int64_t i) { kernels::texture_forward(t, i, values); }, 4096);
    }
    return result;
}

std::tuple<Tensor, Tensor, Tensor, Tensor> texture_backward(
    const Tensor& texture, const std::vector<Tensor>& mips, const Tensor& uv,
    const std::optional<Tensor>& slopes, const std::optional<Tensor>& bias, std::int64_t filter,
    std::int64_t boundary, const Tensor& gradient_, bool texels_wanted, bool others_wanted) {
    const Operation call("texture backward", uv);
    const Inputs in(call, {texture, mips, uv, slopes, bias, filter, boundary});
    kernels::MipmapParameters p = in.p;
    const Tensor gradient = call.checked("gradient", gradient_, ScalarType::Float,
                                         {in.views, in.height, in.width, p.channels});
    p.value_gradient = floats(gradient);
    const auto like = [&](bool wanted, const Tensor& tensor) {
        return wanted ? call.zeros(sizes_of(tensor)) : call.empty({0});
    };
    const Tensor by_uv = like(others_wanted, in.uv);
    const Tensor by_slopes = like(others_wanted && slopes, in.slopes);
    const Tensor by_bias = like(others_wanted && bias, in.bias);
    if (others_wanted) {
        p.uv_gradient = mutable_floats(by_uv);
        if (slopes) p.slope_gradient = mutable_floats(by_slopes);
        if (bias) p.bias_gradient = mutable_floats(by_bias);
    }
    std::vector<kernels::TextureParameters> program;
    for (std::int64_t view = 0; in.program && !call.on_device() && view < in.views; ++view)
        program.push_back(in.program_lookup(view, 0));
    const auto visit = [&](std::int64_t pixel, const Accumulator& sums) {
        if (!in.program) {
            kernels::mipmap_backward(p, pixel, sums);
            return;
        }
        const kernels::TextureParameters& t =
            program[static_cast<std::size_t>(pixel / p.pixels_per_view)];
        if (sums.wanted()) kernels::texture_backward(t, pixel, p.value_gradient, sums);
        if (others_wanted) kernels::texture_uv_backward(t, pixel, p.value_gradient, p.uv_gradient);
    };
    const auto launch = [&](const Accumulator& sums) {
        if (!in.program) {
            call.launch(&Table::mipmap_backward, {p, sums}, in.pixels);
            return;
        }
        for (std::int64_t view = 0; view < in.views; ++view) {
            const std::int64_t first = view * p.pixels_per_view;
            const cuda::TextureLaunchParameters one{
                in.program_lookup(view, first), nullptr, p.value_gradient + first * p.channels,
                others_wanted ? p.uv_gradient + 2 * first : nullptr, sums};
            if (sums.wanted()) call.launch(&Table::texture_backward, one, p.pixels_per_view);
            if (others_wanted) call.launch(&Table::texture_uv_backward, one, p.pixels_per_view);
        }
    };
    if (texels_wanted)
        return {call.sum(in.pixels, {in.texels}, visit, launch), by_uv, by_slopes, by_bias};
    call.visit(in.pixels, visit, launch);
    return {call.empty({0}), by_uv, by_slopes, by_bias};
}

Tensor halve(const Tensor& texture_) {
    const Operation call("halve", texture_);
    const Tensor texture = call.checked("texture", texture_, ScalarType::Float, {-1, -1, -1, -1});
    const std::int64_t maps = texture.size(0), height = texture.size(1), width = texture.size(2);
    if (height % 2 != 0 || width % 2 != 0)
        call.fail("texture must have even sides, found " + std::to_string(height) + " x " +
                  std::to_string(width));
    const Tensor result = call.empty({maps, height / 2, width / 2, texture.size(3)});
    const std::int64_t count = height / 2 * (width / 2), channels = texture.size(3);
    for (std::int64_t map = 0; map < maps; ++map)
        call.run<kernels::halve_texture>(
            &Table::halve_texture,
            kernels::HalveParameters{floats(texture) + 4 * map * count * channels,
                                     static_cast<int>(width), static_cast<int>(channels),
                                     mutable_floats(result) + map * count * channels},
            count, 16384);
    return result;
}

Tensor halve_backward(const Tensor& gradient_) {
    const Operation call("halve backward", gradient_);
    const Tensor gradient =
        call.checked("gradient", gradient_, ScalarType::Float, {-1, -1, -1, -1});
    const std::int64_t maps = gradient.size(0), height = gradient.size(1);
    const std::int64_t width = gradient.size(2), channels = gradient.size(3);
    const std::int64_t count = height * width;
    const Tensor result = call.empty({maps, 2 * height, 2 * width, channels});
    for (std::int64_t map = 0; map < maps; ++map)
        call.run<kernels::halve_texture_backward>(
            &Table::halve_texture_backward,
            kernels::HalveParameters{floats(gradient) + map * count * channels,
                                     static_cast<int>(2 * width), static_cast<int>(channels),
                                     mutable_floats(result) + 4 * map * count * channels},
            count, 16384);
    return result;
}

void add_halve_backward(const Tensor& gradient_, Tensor finer) {
    const Operation call("add_halve backward", gradient_);
    const Tensor gradient =
        call.checked("gradient", gradient_, ScalarType::Float, {-1, -1, -1, -1});
    const std::int64_t maps = gradient.size(0), height = gradient.size(1);
    const std::int64_t width = gradient.size(2), channels = gradient.size(3);
    if (!finer.is_contiguous()) call.fail("finer must be contiguous");
    call.checked("finer", finer, ScalarType::Float, {maps, 2 * height, 2 * width, channels});
    if (call.on_device()) {
        const Tensor spread = halve_backward(gradient);
        call.launch(&Table::add_value,
                    kernels::ValueParameters{floats(spread), mutable_floats(finer), 0},
                    finer.numel());
        return;
    }
    const std::int64_t row = width * channels;
    parallel_for(
        "add_halve backward", maps * height,
        [&](std::int64_t y) {
            // One row of the gradient belongs to two rows of the finer level.
            std::vector<float> spread(static_cast<std::size_t>(4 * row));
            const kernels::HalveParameters p{floats(gradient) + y * row,
                                             static_cast<int>(2 * width),
                                             static_cast<int>(channels), spread.data()};
            for (std::int64_t x = 0; x < width; ++x)
                kernels::halve_texture_backward(p, x);
            float* sum = mutable_floats(finer) + 4 * y * row;
            for (std::int64_t i = 0; i < 4 * row; ++i)
                sum[i] += spread[static_cast<std::size_t>(i)];
        },
        std::max<std::int64_t>(1, 16384 / std::max<std::int64_t>(1, width)));
}

}  // namespace item3d::python
