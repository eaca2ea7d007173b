// Muon, an optimizer with orthogonalized steps of matrices (Jordan et al. 2024, "Muon: An optimizer
// for hidden layers in neural networks").
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns the approximately nearest matrix with orthonormal rows or columns: singular values
/// between 0.7 and 1.2, by five Newton-Schulz iterations of fifth order. They run in bfloat16 if
/// the CPU supports it. matrix: [rows, columns] float32. A matrix of zeros stays one.
at::Tensor newton_schulz(const at::Tensor& matrix);

/// Returns the factor that makes an orthogonalized step as large as one of Adam's, so that one
/// learning rate fits both (Liu et al. 2025, "Muon is Scalable for LLM Training", section 2.2).
float orthogonal_step_scale(std::int64_t rows, std::int64_t columns);

}  // namespace item3d
