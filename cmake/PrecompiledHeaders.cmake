# item3d_compile(TARGET KIND LEVEL) sets how the sources of a target are compiled.
#
#   KIND   plain: no precompiled header
#          tensors: a precompiled item3d/tensors/tensor.h
#          modules: torch::nn and torch::autograd as well
#          A suffix after an underscore (tensors_apart) has no effect.
#   LEVEL  computation: -O2
#          orchestration: -O1, for sources that call kernels and LibTorch
#
# LibTorch's declarations cost time in every file that includes them, even if they are precompiled: an
# empty file takes 2 s with the header of kind tensors and 5 s with that of kind modules.
#
# Targets of one kind and level share a precompiled header, and must be compiled with its options.

function(item3d_precompiled_header OWNER KIND LEVEL)
    if(TARGET ${OWNER})
        return()
    endif()
    file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/${OWNER}.cpp
         CONTENT "// Owner of a precompiled header.\n")
    add_library(${OWNER} OBJECT ${CMAKE_BINARY_DIR}/${OWNER}.cpp)
    target_include_directories(${OWNER} PRIVATE ${CMAKE_SOURCE_DIR}/src)
    target_link_libraries(${OWNER} PRIVATE item3d_options item3d_fmt item3d_torch nlohmann_json::nlohmann_json)
    target_compile_options(${OWNER} PRIVATE ${ITEM3D_${LEVEL}})
    set(HEADERS <fmt/format.h> <fmt/ranges.h> <nlohmann/json.hpp> "item3d/tensors/tensor.h")
    if(KIND STREQUAL "modules")
        list(APPEND HEADERS <torch/csrc/autograd/custom_function.h>
            <torch/nn/modules/container/modulelist.h> <torch/nn/modules/conv.h>
            <torch/nn/modules/embedding.h> <torch/nn/modules/linear.h>
            <torch/nn/modules/normalization.h>)
    endif()
    target_precompile_headers(${OWNER} PRIVATE ${HEADERS})
endfunction()

set(ITEM3D_orchestration)
set(ITEM3D_computation)
if(CMAKE_BUILD_TYPE STREQUAL "Release")
    # item3d_compile() sets the optimisation of each target.
    string(REGEX REPLACE "-O[0-3s]" "" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")
    set(ITEM3D_orchestration -O1)
    set(ITEM3D_computation -O2)
endif()

function(item3d_compile TARGET KIND LEVEL)
    target_compile_options(${TARGET} PRIVATE ${ITEM3D_${LEVEL}})
    string(REGEX REPLACE "_.*" "" KIND ${KIND})
    if(KIND STREQUAL "plain")
        return()
    endif()
    set(OWNER item3d_pch_${KIND}_${LEVEL})
    item3d_precompiled_header(${OWNER} ${KIND} ${LEVEL})
    target_precompile_headers(${TARGET} REUSE_FROM ${OWNER})
endfunction()
