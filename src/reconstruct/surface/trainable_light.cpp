#include "item3d/reconstruct/surface/trainable_light.h"

#include "item3d/render/shade.h"
#include "item3d/scene/environment.h"

#include <cmath>

namespace item3d {

TrainableLight::TrainableLight(int height, float radiance) {
    logarithm_ = torch::full({height, 2 * height, 3}, std::log(radiance), torch::kFloat32);
    logarithm_.set_requires_grad(true);
    solid_angle_ = torch::empty({height, 1, 1});
    for (int y = 0; y < height; ++y)
        solid_angle_[y][0][0] = texel_solid_angle(y, height) / (4 * static_cast<double>(pi));
}

EnvironmentLight TrainableLight::prefiltered() const {
    return prefilter(equirectangular_to_cube(radiance(), static_cast<int>(logarithm_.size(0))));
}

Image TrainableLight::to_image() const {
    return item3d::to_image(radiance().detach());
}

torch::Tensor TrainableLight::whiteness_loss() const {
    const torch::Tensor values = radiance();
    return ((values - values.mean(2, true)).abs() * solid_angle_).sum() / 3;
}

}  // namespace item3d
