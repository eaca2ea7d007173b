#include "item3d/layers/image_sum.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/parallel.h"
#include "item3d/layers/layer_use.h"
#include "item3d/layers/source_image.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

constexpr std::int64_t sum_rows = 16;

/// Returns the change of a whole image, resized to [height, width, channels] int32.
at::Tensor enlarged(const LayerImage& image, int width, int height) {
    at::Tensor whole = at::zeros({image.height, image.width, image.channels}, at::kInt);
    whole.slice(0, image.y, image.y + image.change.size(0))
        .slice(1, image.x, image.x + image.change.size(1))
        .slice(2, image.channel, image.channel + image.change.size(2))
        .copy_(image.change);
    at::Tensor result = at::empty({height, width, image.channels}, at::TensorOptions(at::kInt));
    const auto* from = whole.const_data_ptr<std::int32_t>();
    auto* to = result.data_ptr<std::int32_t>();
    struct Place {
        int first, second;
        double weight;
    };
    const auto place = [](int i, int count, int of) {
        const double at = (i + 0.5) * of / count - 0.5;
        const int low = static_cast<int>(std::floor(at));
        return Place{std::clamp(low, 0, of - 1), std::clamp(low + 1, 0, of - 1), at - low};
    };
    for (int y = 0; y < height; ++y) {
        const Place down = place(y, height, image.height);
        for (int x = 0; x < width; ++x) {
            const Place across = place(x, width, image.width);
            for (int c = 0; c < image.channels; ++c) {
                const auto value = [&](int column, int row) -> double {
                    return from[(static_cast<std::int64_t>(row) * image.width + column) *
                                    image.channels +
                                c];
                };
                const double above = std::lerp(value(across.first, down.first),
                                               value(across.second, down.first), across.weight);
                const double below = std::lerp(value(across.first, down.second),
                                               value(across.second, down.second), across.weight);
                *to++ =
                    static_cast<std::int32_t>(std::lround(std::lerp(above, below, down.weight)));
            }
        }
    }
    return result;
}

/// A term whose change is accessed as rows of a rectangle.
struct Rows {
    at::Tensor change;
    std::int64_t x, y, width, height;
    int first_channel;
    std::int64_t strength;
    unsigned channels;

    template <typename T>
    void add_row(std::int64_t row, int count, std::vector<std::int64_t>& sums) const {
        const int own = static_cast<int>(change.size(2));
        const T* values = change.const_data_ptr<T>() + (row - y) * width * own;
        std::int64_t* out = sums.data() + x * count + first_channel;
        for (std::int64_t column = 0; column < width; ++column, values += own, out += count)
            for (int c = 0; c < own; ++c)
                if (channels >> (first_channel + c) & 1u) out[c] += strength * values[c];
    }
    void add(std::int64_t row, int count, std::vector<std::int64_t>& sums) const {
        if (row < y || row >= y + height) return;
        if (change.scalar_type() == at::kChar)
            add_row<std::int8_t>(row, count, sums);
        else if (change.scalar_type() == at::kShort)
            add_row<std::int16_t>(row, count, sums);
        else
            add_row<std::int32_t>(row, count, sums);
    }
};

/// Returns the image before the edit, from the model or from the layer.
Image image_before(const ImageTerm& term, const LayerImage& shape, const Model& model, int material,
                   const MaterialEdit& changes, bool remakes_uvs) {
    const at::Tensor& source = term.image->source;
    if (!source.defined()) {
        if (!has_source_image(model, material, shape, changes, remakes_uvs))
            throw InputError(term.subject,
                             "lacks the original image of material '" +
                                 model.materials[static_cast<std::size_t>(material)].name + "'",
                             "apply it to the model that it was made for");
        return source_image(model, material, shape, changes);
    }
    Image image(shape.width, shape.height, shape.channels);
    const at::Tensor values = source.to(at::kInt).contiguous();
    const auto* from = values.const_data_ptr<std::int32_t>();
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = from_file_value(from[i], shape.bits);
    return image;
}

/// Returns the shape of the largest term; throws InputError if other terms cannot be resized to it.
LayerImage common_shape(const std::vector<ImageTerm>& terms, const std::string& material) {
    LayerImage shape = *terms.front().image;
    for (const ImageTerm& term : terms) {
        const LayerImage& own = *term.image;
        const bool has_room = !own.source_size && !own.source.defined() && !own.occlusion_size;
        const bool same_size = own.width == shape.width && own.height == shape.height;
        if ((!same_size && !has_room) || own.channels != shape.channels || own.bits != shape.bits)
            throw InputError(
                term.subject,
                fmt::format("its texture of material '{}' has {} x {} pixels and {} channels, that "
                            "of {} has {} x {} and {}",
                            material, own.width, own.height, own.channels, terms.front().subject,
                            shape.width, shape.height, shape.channels),
                "make the edits of a material with the same --texture-size");
        shape.width = std::max(shape.width, own.width);
        shape.height = std::max(shape.height, own.height);
    }
    return shape;
}

}  // namespace

EditedTexture image_sum(const std::vector<ImageTerm>& terms, const Model& model, int material,
                        const MaterialEdit& changes, bool remakes_uvs) {
    const at::NoGradGuard no_grad;
    const LayerImage shape =
        common_shape(terms, model.materials[static_cast<std::size_t>(material)].name);
    Image image = image_before(terms.front(), shape, model, material, changes, remakes_uvs);
    std::vector<Rows> rows;
    for (const ImageTerm& term : terms) {
        const LayerImage& own = *term.image;
        if (!own.change.defined()) continue;
        if (own.width == shape.width && own.height == shape.height) {
            const at::Tensor change = own.change.contiguous();
            rows.push_back({change, own.x, own.y, change.size(1), change.size(0), own.channel,
                            term.strength, term.channels});
        } else {
            rows.push_back({enlarged(own, shape.width, shape.height), 0, 0, shape.width,
                            shape.height, 0, term.strength, term.channels});
        }
    }
    constexpr std::int64_t one = LayerUse::strength_steps;
    const std::int64_t largest = shape.bits > 8 ? 65535 : 255;
    const auto row_values =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
    parallel_for(
        "picture_sum", image.height,
        [&](std::int64_t y) {
            float* pixels = image.pixels.data() + static_cast<std::size_t>(y) * row_values;
            std::vector<std::int64_t> sums(row_values);
            for (std::size_t i = 0; i < row_values; ++i)
                sums[i] = one * to_file_value(pixels[i], shape.bits);
            for (const Rows& term : rows)
                term.add(y, image.channels, sums);
            for (std::size_t i = 0; i < row_values; ++i) {
                const std::int64_t sum = std::clamp<std::int64_t>(sums[i], 0, one * largest);
                pixels[i] =
                    from_file_value(static_cast<std::int32_t>((sum + one / 2) / one), shape.bits);
            }
        },
        sum_rows);
    return EditedTexture(std::move(image), shape.bits);
}

}  // namespace item3d
