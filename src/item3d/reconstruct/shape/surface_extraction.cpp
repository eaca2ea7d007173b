#include "item3d/reconstruct/shape/surface_extraction.h"

#include "item3d/core/error.h"
#include "item3d/reconstruct/shape/flexicubes.h"
#include "item3d/reconstruct/shape/marching_tetrahedra.h"

namespace item3d {

std::unique_ptr<SurfaceExtraction> make_extraction(const std::string& name,
                                                   const Lattice& lattice) {
    if (name == "flexicubes") return std::make_unique<FlexiCubes>(lattice);
    ITEM3D_CHECK(name == "tetrahedra", "a name of extraction_names()");
    return std::make_unique<MarchingTetrahedra>(lattice);
}

std::vector<std::string> extraction_names() {
    return {"flexicubes", "tetrahedra"};
}

at::Tensor sign_change_loss(const at::Tensor& edges, const at::Tensor& values) {
    const at::Tensor inner = values.index_select(0, edges.select(1, 0));
    const at::Tensor outer = values.index_select(0, edges.select(1, 1));
    return at::softplus(outer).mean() + at::softplus(-inner).mean();
}

}  // namespace item3d
