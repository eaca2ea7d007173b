#include "item3d/reconstruct/surface/rigid_motion.h"

namespace item3d {

namespace {

/// Returns the matrix K for which K v is the cross product of `axis` and v. The exponential of K
/// rotates by the length of `axis`.
at::Tensor rotation_matrix(const at::Tensor& axis) {
    const at::Tensor zero = at::zeros({});
    const at::Tensor x = axis[0], y = axis[1], z = axis[2];
    return at::stack({zero, -z, y, z, zero, -x, -y, x, zero}).reshape({3, 3}).matrix_exp();
}

}  // namespace

at::Tensor RigidMotion::moved(const at::Tensor& positions) const {
    return (positions - centre).matmul(rotation.t()) + (centre + translation);
}

Geometry RigidMotion::moved(Geometry geometry) const {
    geometry.positions = moved(geometry.positions);
    geometry.normals = geometry.normals.matmul(rotation.t());
    return geometry;
}

void RigidMotion::move_back(Surface& surface) const {
    surface.position = (surface.position - (centre + translation)).matmul(rotation) + centre;
    surface.normal = surface.normal.matmul(rotation);
    surface.view = surface.view.matmul(rotation);
}

Camera RigidMotion::seen_from(const Camera& camera) const {
    Mat4 back(1.0f);
    const at::Tensor r = rotation.detach(), c = centre, t = translation.detach();
    const at::Tensor offset = c - (c + t).matmul(r);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            back[column][row] = r[column][row].item<float>();
        back[3][row] = offset[row].item<float>();
    }
    Camera moved = camera;
    moved.camera_to_world = back * camera.camera_to_world;
    return moved;
}

RigidMotion RigidMotion::detached() const {
    if (!rotation.defined()) return {};
    return {rotation.detach(), translation.detach(), centre};
}

RigidMotion rigid_motion(const SmallMotion& motion, const at::Tensor& centre, float radius) {
    return {rotation_matrix(motion.rotation), radius * motion.translation, centre};
}

}  // namespace item3d
