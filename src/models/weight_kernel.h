// Weights from the types and orders that files have them in: AVX-512, compiled for it alone
// (src/CMakeLists.txt), so nothing here may be called where matrix_kernel_runs() says no.
#pragma once

#include "item3d/models/matrix_kernel.h"

namespace item3d {

/// [rows, in, 3, 3] as stored -> [rows, 3, 3, in]; in is a multiple of packed_columns. Stored
/// and Number are HalfFloat, BrainFloat or float.
template <typename Stored, typename Number>
void order_taps(const Stored* weights, std::int64_t rows, std::int64_t in_channels,
                Number* ordered);

/// HalfFloat -> BrainFloat, to the nearest.
void convert_numbers(const HalfFloat* from, std::int64_t count, BrainFloat* to);

}  // namespace item3d
