# libitem3d_cuda.so: every kernel, compiled for CUDA devices by the nvcc that scripts/setup.sh fetched.
# The program opens this module at run time if there is a device (src/item3d/render/cuda/module.h), so nothing links
# it. nvcc is called directly, because CMake's CUDA language requires a whole toolkit.
option(ITEM3D_CUDA "Compile the kernels for CUDA as well (needs no device)" OFF)
if(NOT ITEM3D_CUDA)
    return()
endif()

set(CUDA_ROOT ${ITEM3D_DEPS}/cuda)
set(NVCC ${CUDA_ROOT}/bin/nvcc)
if(NOT EXISTS ${NVCC})
    message(FATAL_ERROR "The CUDA compiler is not at ${NVCC}: run `scripts/setup.sh cuda`, or set -DITEM3D_CUDA=OFF")
endif()

# Machine code for Ampere and Hopper, and PTX, from which newer devices compile their own code.
set(NVCC_OPTIONS
    -std=c++20 -O3 --extended-lambda --expt-relaxed-constexpr
    -gencode arch=compute_80,code=sm_80
    -gencode arch=compute_90,code=[sm_90,compute_90]
    -ccbin ${CMAKE_CXX_COMPILER}
    -Xcompiler=-fPIC,-fvisibility=hidden,-Wall,-Wextra,-Wshadow
    -Werror all-warnings
    # Warning 20012: GLM adds device attributes to functions that the compiler generates.
    -diag-suppress 20012
    -I ${CMAKE_SOURCE_DIR}/src)

# item3d_cuda_object(FILE [OPTION...]): compiles src/item3d/FILE.cu and appends the object to CUDA_OBJECTS.
set(CUDA_OBJECTS)
function(item3d_cuda_object FILE)
    set(SOURCE ${CMAKE_SOURCE_DIR}/src/item3d/${FILE}.cu)
    string(REPLACE "/" "_" NAME ${FILE})
    set(OBJECT ${CMAKE_BINARY_DIR}/cuda/${NAME}.o)
    add_custom_command(OUTPUT ${OBJECT}
        COMMAND ${NVCC} ${NVCC_OPTIONS} ${ARGN} -MD -MF ${OBJECT}.d -c ${SOURCE} -o ${OBJECT}
        DEPENDS ${SOURCE} ${NVCC}
        DEPFILE ${OBJECT}.d
        COMMENT "Compiling ${FILE}.cu for CUDA"
        VERBATIM)
    set(CUDA_OBJECTS ${CUDA_OBJECTS} ${OBJECT} PARENT_SCOPE)
endfunction()
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/cuda)
item3d_cuda_object(render/cuda/exact -fmad=false)
item3d_cuda_object(render/cuda/light)
item3d_cuda_object(render/cuda/operators)
item3d_cuda_object(render/cuda/surface)
item3d_cuda_object(render/cuda/texture)
item3d_cuda_object(field/cuda/field)

add_library(item3d_cuda MODULE ${CUDA_OBJECTS})
set_target_properties(item3d_cuda PROPERTIES
    LINKER_LANGUAGE CXX
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}
    INSTALL_RPATH $ORIGIN)
file(GLOB CUDA_RUNTIME ${CUDA_ROOT}/lib/libcudart.so.*)
target_link_libraries(item3d_cuda PRIVATE ${CUDA_RUNTIME} -Wl,--no-undefined)
install(TARGETS item3d_cuda LIBRARY DESTINATION lib/item3d COMPONENT programs)
