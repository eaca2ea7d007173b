#include "item3d/region/color_selector.h"

#include "item3d/core/error.h"
#include "item3d/io/text.h"
#include "item3d/metrics/color.h"

#include <cmath>

namespace item3d {
namespace {

constexpr float usual_distance = 12;
constexpr float fading = 0.5f;  ///< of the distance

class ColorSelector : public Selector {
  public:
    ColorSelector(const TexturedMaterials& textured, const Lab& color, float distance)
        : textured_(textured),
          lab_(at::tensor({static_cast<float>(color.l), static_cast<float>(color.a),
                           static_cast<float>(color.b)})),
          distance_(distance) {}

    at::Tensor weight(const Surface& surface) const override {
        Surface sharp = surface;  // footprints would blur what a pixel covers
        sharp.uv_footprint = at::Tensor();
        sharp.further_uv_footprints.clear();
        const at::Tensor lab = lab_of(textured_.sample(sharp).base_color.cpu());
        const at::Tensor distance = (lab - lab_).square().sum(1).sqrt();
        return ((1 + fading) - distance / distance_).div(fading).clamp(0, 1);
    }

  private:
    const TexturedMaterials& textured_;
    at::Tensor lab_;
    float distance_;
};

}  // namespace

at::Tensor lab_of(const at::Tensor& linear) {
    // Rows: X, Y, Z over those of D65.
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
        srgb = parse_color(text.value.substr(0, tilde));
    } catch (const InputError& error) {
        throw InputError(text.whole, error.what());
    }
    return std::make_unique<ColorSelector>(scene.textured, srgb_to_lab(srgb), distance);
}

}  // namespace item3d
