#include "item3d/edit/optimize/point_share.h"

namespace item3d {
namespace {

at::Tensor narrow(const at::Tensor& all, const Share& rows) {
    return all.defined() ? all.narrow(0, rows.first, rows.count) : all;
}

}  // namespace

Surface narrow(const Surface& all, const Share& points) {
    Surface part = all;
    for (at::Tensor* each :
         {&part.pixel, &part.position, &part.normal, &part.tangent, &part.uv, &part.uv_footprint,
          &part.color, &part.view, &part.material, &part.primitive, &part.triangle})
        *each = narrow(*each, points);
    for (at::Tensor& each : part.further_uvs)
        each = narrow(each, points);
    for (at::Tensor& each : part.further_uv_footprints)
        each = narrow(each, points);
    return part;
}

MaterialSample narrow(const MaterialSample& all, const Share& points) {
    return {narrow(all.base_color, points), narrow(all.orm, points), narrow(all.normal, points),
            narrow(all.emissive, points), narrow(all.alpha, points)};
}

OwnMaterial narrow(const OwnMaterial& all, const Share& points) {
    return {narrow(all.sample, points), narrow(all.edited, points)};
}

}  // namespace item3d
