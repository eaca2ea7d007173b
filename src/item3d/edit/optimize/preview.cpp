#include "item3d/edit/optimize/preview.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/edit/field_pictures.h"
#include "item3d/io/save.h"
#include "item3d/render/pictures.h"

namespace item3d {
namespace {

constexpr int picture_size = 256;

}  // namespace

Preview::Preview(std::filesystem::path path, const EditScene& scene)
    : path_(std::move(path)), scene_(scene), cameras_(field_cameras(scene, 3)) {}

void Preview::update(NeuralTexture& field, const EnvironmentLight& light) {
    if (!enabled_) return;
    const at::Tensor pictures = draw_field(scene_, field, light, cameras_, picture_size);
    try {
        save_image(path_, to_image(at::cat(pictures.unbind(0), 1)));
    } catch (const Error& error) {
        warn(std::string("no more previews: ") + error.what());
        enabled_ = false;
    }
}

}  // namespace item3d
