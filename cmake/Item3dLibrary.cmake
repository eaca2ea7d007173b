# item3d_library(NAME [TORCH] [DEPENDS lib...] [PACKAGES target...] [COMPILED_APART file...]): one
# folder of src/item3d/ as one static library, but for the files that the caller compiles. DEPENDS is the whole list of item3d folders that this folder may include; include
# paths come only through it, so a wrong dependency does not compile. PACKAGES are imported targets
# of other projects; TORCH links LibTorch and uses its precompiled header. Several files are compiled
# at a time, because the templates of LibTorch, JSON and the like are most of each one's compilation:
# names in their anonymous namespaces must differ.
function(item3d_library NAME)
    cmake_parse_arguments(ARG "TORCH" "" "DEPENDS;PACKAGES;COMPILED_APART" ${ARGN})
    file(GLOB_RECURSE SOURCES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/item3d/${NAME}/*.cpp)
    if(ARG_COMPILED_APART)
        list(REMOVE_ITEM SOURCES ${ARG_COMPILED_APART})
    endif()
    set(TARGET item3d_${NAME})
    if(SOURCES)
        add_library(${TARGET} STATIC ${SOURCES})
        set(SCOPE PUBLIC)
        target_link_libraries(${TARGET} PRIVATE item3d_warnings)
        item3d_compile_together(${TARGET})
    else()
        # A folder of headers alone.
        add_library(${TARGET} INTERFACE)
        set(SCOPE INTERFACE)
    endif()
    add_library(item3d::${NAME} ALIAS ${TARGET})

    target_include_directories(${TARGET} ${SCOPE} ${CMAKE_SOURCE_DIR}/src)

    foreach(DEPENDENCY ${ARG_DEPENDS})
        target_link_libraries(${TARGET} ${SCOPE} item3d::${DEPENDENCY})
    endforeach()
    target_link_libraries(${TARGET} ${SCOPE} ${ARG_PACKAGES})
    if(ARG_TORCH)
        target_link_libraries(${TARGET} ${SCOPE} item3d_torch)
        if(SOURCES)
            item3d_use_torch_headers(${TARGET})
        endif()
    endif()
endfunction()

function(item3d_compile_together TARGET)
    set_target_properties(${TARGET} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
endfunction()

# item3d_program(NAME SOURCES file... [LINK target...] [INSTALL]): one executable, at the top of the
# build folder, that uses LibTorch.
function(item3d_program NAME)
    cmake_parse_arguments(ARG "INSTALL" "" "SOURCES;LINK" ${ARGN})
    add_executable(${NAME} ${ARG_SOURCES})
    target_link_libraries(${NAME} PRIVATE ${ARG_LINK} item3d_warnings)
    item3d_use_torch_headers(${NAME})
    if(ARG_INSTALL)
        # A LibTorch of the machine's own stays where it is (cmake/Install.cmake).
        set(RPATH "$ORIGIN/../lib/item3d")
        if(NOT ITEM3D_TORCH_ROOT STREQUAL "${ITEM3D_DEPS}/site/torch")
            list(APPEND RPATH ${ITEM3D_TORCH_ROOT}/lib)
        endif()
        set_target_properties(${NAME} PROPERTIES INSTALL_RPATH "${RPATH}")
        install(TARGETS ${NAME} RUNTIME DESTINATION bin)
    endif()
endfunction()

# Parsing LibTorch's headers takes most of a compilation; every target that uses them shares one
# precompiled header. A target that reuses it must be compiled with the options of its owner: the warnings
# (-Wpedantic changes what is predefined), OpenMP (which all get through core), and nothing else that
# changes how code is generated.
function(item3d_use_torch_headers TARGET)
    if(NOT TARGET item3d_torch_pch)
        file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/torch_pch.cpp
             CONTENT "// Owner of the precompiled LibTorch header.\n")
        add_library(item3d_torch_pch OBJECT ${CMAKE_BINARY_DIR}/torch_pch.cpp)
        target_link_libraries(item3d_torch_pch PRIVATE item3d_torch item3d_warnings item3d_openmp)
        target_precompile_headers(item3d_torch_pch PRIVATE
            <torch/types.h> <torch/csrc/autograd/custom_function.h>
            <torch/nn/module.h> <torch/nn/pimpl.h> <torch/nn/modules/container/modulelist.h>
            <torch/nn/modules/conv.h> <torch/nn/modules/linear.h>
            <torch/nn/modules/normalization.h> <nlohmann/json.hpp>)
    endif()
    target_precompile_headers(${TARGET} REUSE_FROM item3d_torch_pch)
endfunction()
