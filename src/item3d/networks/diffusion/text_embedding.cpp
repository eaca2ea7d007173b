#include "item3d/networks/diffusion/text_embedding.h"

#include "item3d/core/error.h"

namespace item3d {

TextEmbedding TextEmbedding::row(std::int64_t i) const {
    return {states.narrow(0, i, 1), pooled.defined() ? pooled.narrow(0, i, 1) : pooled};
}

TextEmbedding TextEmbedding::expand(std::int64_t rows) const {
    ITEM3D_CHECK(this->rows() == 1 || this->rows() == rows, "only a single row can be expanded");
    return {states.expand({rows, -1, -1}), pooled.defined() ? pooled.expand({rows, -1}) : pooled};
}

TextEmbedding TextEmbedding::join(const TextEmbedding& first, const TextEmbedding& second) {
    ITEM3D_CHECK(first.pooled.defined() == second.pooled.defined(), "texts of different models");
    return {at::cat({first.states, second.states}),
            first.pooled.defined() ? at::cat({first.pooled, second.pooled}) : at::Tensor()};
}

}  // namespace item3d
