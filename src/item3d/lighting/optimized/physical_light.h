// The physical light: a sky, a sun and a ground, in eight parameters.
#pragma once

#include "item3d/lighting/optimized/light_model.h"

namespace item3d {

/// Interpreted parameters of a PhysicalLight.
struct PhysicalValues {
    float exposure = 0;    ///< in stops; at 0 the brightest white surface has a radiance of about 1
    float sun_share = 0;   ///< share of the whole light's energy
    float sun_warmth = 0;  ///< in mired from white (D65); positive values are warmer
    float sky_warmth = 0;
    float ground = 0;  ///< radiance of the ground divided by that of the sky
    float glow = 0;  ///< extra radiance at the horizon, most on the sun's side, relative to the sky
    SkyAngles sun;
};

/// The radiance from direction d, with a sun in direction s, is
///
///   2^exposure / (1 + 3 share) [(1 - share) ambient(d) + share lobe(d, s)]
///
/// where share is the sun's share of the energy. lobe is a soft disk. ambient is a ground and a
/// sky, which blends into the sun's colour and glows at the horizon on the sun's side. lobe and
/// ambient have a mean radiance of about 1, so share moves energy between them without changing the
/// brightness. A colour is white multiplied by Wien's exp(-c2 / (lambda T)) for a difference in
/// inverse temperature, at the wavelengths of the primaries. So it is on the Planckian locus around
/// white, which excludes green and magenta, and it is smooth in mired.
///
/// Parameters are coupled: a warmer sun is lower; a dark light is colder (moonlight), and a warm
/// one is not as dark as a night. The sun's direction is a parameter too, but is held close to its
/// initial value, since few words determine it. It is constant if the options fix it.
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

    std::optional<SkyAngles> held_;  ///< the sun's direction, if it is constant
    float start_azimuth_ = 0;        ///< radians
    at::Tensor numbers_;             ///< [8], unbounded; see physical_light.cpp
    at::Tensor start_;
};

}  // namespace item3d
