# Defines LibTorch's imported targets, because find_package(Torch) of the wheel requires a full CUDA toolkit.
# ITEM3D_TORCH_ROOT, a CMake variable or an environment variable, names another LibTorch: a folder with include/
# and lib/.
if(NOT ITEM3D_TORCH_ROOT)
    if(DEFINED ENV{ITEM3D_TORCH_ROOT})
        set(ITEM3D_TORCH_ROOT $ENV{ITEM3D_TORCH_ROOT})
    else()
        set(ITEM3D_TORCH_ROOT ${ITEM3D_DEPS}/site/torch)
    endif()
endif()
if(NOT EXISTS ${ITEM3D_TORCH_ROOT}/lib/libtorch_cpu.so)
    message(FATAL_ERROR "LibTorch is not at ${ITEM3D_TORCH_ROOT}: run scripts/setup.sh, or set ITEM3D_TORCH_ROOT")
endif()

add_library(item3d_c10 SHARED IMPORTED)
set_target_properties(item3d_c10 PROPERTIES IMPORTED_LOCATION ${ITEM3D_TORCH_ROOT}/lib/libc10.so)
add_library(item3d_torch_cpu SHARED IMPORTED)
set_target_properties(item3d_torch_cpu PROPERTIES
    IMPORTED_LOCATION ${ITEM3D_TORCH_ROOT}/lib/libtorch_cpu.so
    IMPORTED_LINK_DEPENDENT_LIBRARIES item3d_c10)

add_library(item3d_torch INTERFACE IMPORTED GLOBAL)
target_include_directories(item3d_torch SYSTEM INTERFACE
    ${ITEM3D_TORCH_ROOT}/include
    ${ITEM3D_TORCH_ROOT}/include/torch/csrc/api/include)
target_link_libraries(item3d_torch INTERFACE item3d_torch_cpu item3d_c10)
# ATen/core/Tensor.h then includes no headers of operations. item3d/tensors/tensor.h includes those that item3d uses.
target_compile_definitions(item3d_torch INTERFACE AT_PER_OPERATOR_HEADERS)
# The wheel's libtorch_cpu.so needs only two small libraries of the CUDA runtime beside it.
target_link_options(item3d_torch INTERFACE
    -Wl,-rpath-link,${ITEM3D_TORCH_ROOT}/lib
    -Wl,-rpath-link,${ITEM3D_TORCH_ROOT}/../nvidia/cu13/lib)
