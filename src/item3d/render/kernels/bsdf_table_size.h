// Of the table that the build computes (tools/write_bsdf_table.cpp).
#pragma once

namespace item3d {

inline constexpr int bsdf_table_size = 256;  ///< steps of n.v, and of roughness

}  // namespace item3d
