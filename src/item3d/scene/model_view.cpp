#include "item3d/scene/model_view.h"

#include <vector>

namespace item3d {

Camera view_from(const Model& model, float azimuth, float elevation, float aspect) {
    std::vector<Vec3> points;
    for (const Primitive& primitive : model.primitives)
        points.insert(points.end(), primitive.positions.begin(), primitive.positions.end());
    return framing_camera(points, azimuth, elevation, default_field_of_view, aspect);
}

Camera default_view(const Model& model, float aspect) {
    return view_from(model, default_azimuth, default_elevation, aspect);
}

}  // namespace item3d
