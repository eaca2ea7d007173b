// The cameras, lights and backgrounds of an edit: another draw each iteration.
#pragma once

#include "item3d/edit/settings.h"
#include "item3d/render/prefilter/environment_light.h"
#include "item3d/scene/bounding_sphere.h"
#include "item3d/scene/camera.h"
#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace item3d {

/// The cameras of one iteration: all azimuths, elevation -10 to 45 degrees, horizontal field of
/// view 25.7 to 45 degrees (ITEM3D's settings), the model filling the picture. They depend on the
/// seed and the iteration alone.
std::vector<Camera> sample_cameras(const BoundingSphere& sphere, int count, std::uint64_t seed,
                                   std::int64_t iteration);

/// Linear RGB backgrounds [count, 3]: one colour (see parse_color), or another grey each time for
/// "vary". On the CPU. Throws InputError.
at::Tensor sample_backgrounds(const std::string& background, int count, std::uint64_t seed,
                              std::int64_t iteration);

/// A light of an iteration.
struct ViewLight {
    const EnvironmentLight& light;
    float exposure = 1;  ///< factor of its radiance
};

/// The lights of an edit, each prefiltered when it is first wanted. Shading that stays the same in
/// every picture could be painted into the base colour; a light that moves cannot. variation:
///   off     the light as it is, always;
///   rotate  turned to six azimuths;
///   all     also exchanged for presets of daylight and the studio, and brighter or darker by up to
///           half a stop.
class LightRig {
  public:
    /// light: preset or file. Throws InputError.
    LightRig(const std::string& light, LightAugment variation, int cube_size, at::Device device);
    ViewLight pick(std::uint64_t seed, std::int64_t iteration);
    /// The light as it was given, for pictures.
    const EnvironmentLight& front() { return at(0); }
    const Image& image() const { return *sources_.front().image; }
    /// White whatever light was given: for pictures that stand beside what a prior draws unasked.
    const EnvironmentLight& studio();

  private:
    struct Source {
        std::string preset;
        std::optional<Image> image;  ///< once it was wanted
    };
    struct Light {
        std::size_t source;  ///< its place in sources_
        float turn;          ///< degrees
        std::optional<EnvironmentLight> prefiltered;
    };
    const EnvironmentLight& at(std::size_t index);

    std::vector<Source> sources_;
    std::vector<Light> lights_;
    std::optional<EnvironmentLight> studio_;  ///< where it is not the first, once it was wanted
    int cube_size_;
    at::Device device_;
    float exposure_range_ = 0;  ///< stops
};

}  // namespace item3d
