#include "item3d/region/color_selector.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/io/text.h"
#include "item3d/metrics/color.h"

#include <cmath>

namespace item3d {
namespace {

constexpr float usual_distance = 12;
constexpr float fading = 0.5f;  ///< width of the transition from 1 to 0, relative to the distance

/// Scales of naming_space(). Worn or shaded paint keeps its hue and its name, so hue counts most.
/// Chroma counts only where it is low. Lightness counts just enough to distinguish brown from
/// orange.
constexpr float hue_scale = 60, little_chroma = 10, lightness_scale = 0.35f;
constexpr float named_fading = 8;  ///< distance over which names blend

/// Converts CIELAB colours [N, 3] to a space [N, 3] in which distances approximate differences in
/// colour naming.
at::Tensor naming_space(const at::Tensor& lab) {
    const at::Tensor ab = lab.narrow(1, 1, 2);
    const at::Tensor chroma = ab.square().sum(1, true).sqrt();
    return at::cat(
        {lightness_scale * lab.narrow(1, 0, 1), hue_scale * ab / (chroma + little_chroma)}, 1);
}

/// Returns CIELAB [P, 3] of the model's own base colour, on the CPU.
at::Tensor own_lab(const TexturedMaterials& textured, const Surface& surface) {
    Surface sharp = surface;  // footprints would blur the colours
    sharp.uv_footprint = at::Tensor();
    sharp.further_uv_footprints.clear();
    return lab_of(textured.sample(sharp).base_color.cpu());
}

at::Tensor row_of(const Lab& color) {
    return at::tensor(
        {static_cast<float>(color.l), static_cast<float>(color.a), static_cast<float>(color.b)});
}

class ColorSelector : public Selector {
  public:
    ColorSelector(const TexturedMaterials& textured, const Lab& color, float distance)
        : textured_(textured), lab_(row_of(color)), distance_(distance) {}

    at::Tensor weight(const Surface& surface) const override {
        const at::Tensor distance = (own_lab(textured_, surface) - lab_).square().sum(1).sqrt();
        return ((1 + fading) - distance / distance_).div(fading).clamp(0, 1);
    }

  private:
    const TexturedMaterials& textured_;
    at::Tensor lab_;
    float distance_;
};

class NamedSelector : public Selector {
  public:
    NamedSelector(const TexturedMaterials& textured, std::size_t chosen)
        : textured_(textured), chosen_(static_cast<std::int64_t>(chosen)) {
        std::vector<at::Tensor> rows;
        for (const NamedColor& color : basic_colors())
            rows.push_back(row_of(srgb_to_lab(color.srgb)));
        colors_ = naming_space(at::stack(rows));
    }
    at::Tensor weight(const Surface& surface) const override {
        const at::Tensor own = naming_space(own_lab(textured_, surface));
        const at::Tensor distance = (own.unsqueeze(1) - colors_).square().sum(2).sqrt();
        at::Tensor others = distance.clone();
        others.select(1, chosen_).fill_(1e9f);
        const at::Tensor lead = others.amin(1) - distance.select(1, chosen_);
        return (0.5f + lead / named_fading).clamp(0, 1);
    }

  private:
    const TexturedMaterials& textured_;
    at::Tensor colors_;  ///< [N, 3] in naming_space()
    std::int64_t chosen_;
};

}  // namespace

at::Tensor lab_of(const at::Tensor& linear) {
    // The rows give X, Y and Z relative to D65.
    const at::Tensor to_xyz =
        at::tensor({0.4124564f / 0.95047f, 0.3575761f / 0.95047f, 0.1804375f / 0.95047f, 0.2126729f,
                    0.7151522f, 0.0721750f, 0.0193339f / 1.08883f, 0.1191920f / 1.08883f,
                    0.9503041f / 1.08883f})
            .reshape({3, 3});
    const at::Tensor xyz = linear.clamp_min(0).matmul(to_xyz.t());
    constexpr double delta = 6.0 / 29;
    const at::Tensor f = at::where(xyz > delta * delta * delta, xyz.pow(1.0 / 3),
                                   xyz / (3 * delta * delta) + 4.0 / 29);
    const at::Tensor x = f.select(1, 0), y = f.select(1, 1), z = f.select(1, 2);
    return at::stack({116 * y - 16, 500 * (x - y), 200 * (y - z)}, 1);
}

std::unique_ptr<Selector> select_color(const SelectorText& text, const RegionScene& scene) {
    const std::size_t tilde = text.value.find('~');
    float distance = usual_distance;
    if (tilde != std::string::npos) {
        const auto number = parse_number(trim(text.value.substr(tilde + 1)));
        if (!number || !(*number > 0) || !std::isfinite(*number))
            throw InputError(text.whole, "the distance must be a number above 0",
                             "as in " + text.form);
        distance = static_cast<float>(*number);
    }
    Vec3 srgb;
    try {
        srgb = parse_color(to_lower(text.value.substr(0, tilde)));
    } catch (const InputError&) {
        throw InputError(text.whole, "is not a colour",
                         "use the name of a basic colour, #rrggbb, or r,g,b in [0, 1]");
    }
    return std::make_unique<ColorSelector>(scene.textured, srgb_to_lab(srgb), distance);
}

std::unique_ptr<Selector> select_named(const SelectorText& text, const RegionScene& scene) {
    std::vector<std::string> names;
    const std::string wanted = to_lower(text.value);
    for (const NamedColor& color : basic_colors()) {
        if (color.name == (wanted == "grey" ? "gray" : wanted))
            return std::make_unique<NamedSelector>(scene.textured, names.size());
        names.push_back(color.name);
    }
    throw InputError(text.whole, "is not a basic colour",
                     fmt::format("choose from {}", fmt::join(names, ", ")));
}

}  // namespace item3d
