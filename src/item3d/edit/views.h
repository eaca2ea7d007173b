// The random cameras, lights and backgrounds of an edit's iterations.
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

/// Returns the random cameras of one iteration. The azimuth is any, the elevation -10 to 45
/// degrees, and the horizontal field of view 25.7 to 45 degrees, as in ITEM3D. The model fills the
/// image. Deterministic in the seed and the iteration.
std::vector<Camera> sample_cameras(const BoundingSphere& sphere, int count, std::uint64_t seed,
                                   std::int64_t iteration);

/// Returns linear RGB backgrounds [count, 3] on the CPU. background: a colour for all of them
/// (parse_color()), or "vary" for random greys. Throws InputError.
at::Tensor sample_backgrounds(const std::string& background, int count, std::uint64_t seed,
                              std::int64_t iteration);

/// The light of an iteration.
struct ViewLight {
    const EnvironmentLight& light;
    float exposure = 1;  ///< factor of the radiance
};

/// The lights of an edit, each of which is prefiltered on first use. Shading that is the same in
/// every image would be painted into the base colour, and a moving light prevents that. The light
/// of an iteration depends on the variation:
///   off     unmodified in every iteration;
///   rotate  turned to six azimuths;
///   all     also exchanged for presets of daylight and the studio, and brighter or darker by up to
///           half a stop.
class LightRig {
  public:
    /// light: a preset or a file. Throws InputError.
    LightRig(const std::string& light, LightAugment variation, int cube_size, at::Device device);
    ViewLight pick(std::uint64_t seed, std::int64_t iteration);
    /// Returns the unmodified light.
    const EnvironmentLight& front() { return at(0); }
    const Image& image() const { return *sources_.front().image; }
    /// Returns a white studio light, independent of the constructor's light. The detail stage uses
    /// it for renders that are combined with the prior's samples.
    const EnvironmentLight& studio();

  private:
    struct Source {
        std::string preset;
        std::optional<Image> image;  ///< loaded on first use
    };
    struct Light {
        std::size_t source;  ///< index of the source in sources_
        float turn;          ///< azimuth, degrees
        std::optional<EnvironmentLight> prefiltered;
    };
    const EnvironmentLight& at(std::size_t index);

    std::vector<Source> sources_;
    std::vector<Light> lights_;
    /// Loaded on first use; unused if it is the first light.
    std::optional<EnvironmentLight> studio_;
    int cube_size_;
    at::Device device_;
    float exposure_range_ = 0;  ///< stops
};

}  // namespace item3d
