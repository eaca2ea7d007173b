// A sky, a sun and a ground, in eight numbers.
#pragma once

#include "item3d/lighting/optimized/light_model.h"

namespace item3d {

/// What the numbers mean, see PhysicalLight.
struct PhysicalValues {
    float exposure = 0;    ///< stops; at 0 the brightest white surface has radiance 1, about
    float sun_share = 0;   ///< of the energy of the whole light
    float sun_warmth = 0;  ///< mired from white (D65); above 0: warmer
    float sky_warmth = 0;
    float ground = 0;  ///< radiance of the ground over that of the sky
    float glow = 0;    ///< of the horizon below the sun, over the sky
    SkyAngles sun;
};

/// Radiance from direction d, with a sun at s:
///
///   2^exposure / (1 + 3 share) [(1 - share) ambient(d) + share lobe(d, s)]
///
/// lobe: a soft disk; ambient: a sky that goes over into the sun's colour and glows towards the
/// sun's side of the horizon, and a ground. Both have a mean radiance of about 1, so that share
/// moves energy between them and leaves the brightness to exposure. Colours are white multiplied by
/// Wien's exp(-c2 / (lambda T)) for a difference in 1 / T at the wavelengths of the primaries: the
/// Planckian locus around white, with no green or magenta to run off to, and smooth in mired.
///
/// The warmer the sun, the lower it stands; a dark light is colder (moonlight), and a warm one is
/// not as dark as a night. The direction is a parameter too, but a weak one: few words say it. It
/// is no parameter where the options say where the light comes from.
class PhysicalLight : public LightModel {
  public:
    PhysicalLight(const Image& light, const LightModelOptions& options);
    at::Tensor cube(int size) const override;
    Image image(int height) const override;
    at::Tensor regularization() const override;
    NamedTensors named_parameters() const override;
    PhysicalValues values() const;

  private:
    at::Tensor radiance(const at::Tensor& directions) const;
    at::Tensor sun_direction() const;

    std::optional<SkyAngles> held_;  ///< the sun's direction, where it is none of the parameters
    float start_azimuth_ = 0;        ///< radians
    at::Tensor numbers_;             ///< [8], unbounded; see physical_light.cpp
    at::Tensor start_;
};

}  // namespace item3d
