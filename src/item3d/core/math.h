// Vectors for code that runs on the CPU and on CUDA devices: GLM's types under short names.
#pragma once

#include <glm/glm.hpp>

namespace item3d {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using Mat3 = glm::mat3;
/// A matrix in GLM's column-major order. Row-major matrices of files and tensors are transposed
/// when read.
using Mat4 = glm::mat4;

inline constexpr float pi = 3.14159265358979323846f;

/// The transfer functions of sRGB (IEC 61966-2-1) and their inverses. The formula for [0, 1] also
/// applies to values outside.
float srgb_to_linear(float value);
float linear_to_srgb(float value);

}  // namespace item3d
