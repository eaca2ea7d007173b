// Attributes of functions that run on the CPU and, when compiled by nvcc, on CUDA devices.
#pragma once

#if defined(__CUDACC__)
#define ITEM3D_HOST_DEVICE __host__ __device__
#else
#define ITEM3D_HOST_DEVICE
#endif

/// Attribute of functions that must be inlined so that they use the vector instructions of their
/// caller.
#if defined(__GNUC__)
#define ITEM3D_ALWAYS_INLINE __attribute__((always_inline))
#else
#define ITEM3D_ALWAYS_INLINE
#endif
