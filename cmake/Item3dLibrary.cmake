# item3d_library(NAME [DEPENDS lib...] [TORCH]): one folder of src/ as one static library.
# DEPENDS is the whole list of item3d folders that this folder may include; include paths come
# only through it, so a wrong dependency does not compile.
function(item3d_library NAME)
    cmake_parse_arguments(ARG "TORCH" "" "DEPENDS;PACKAGES" ${ARGN})
    file(GLOB_RECURSE SOURCES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${NAME}/*.cpp)
    add_library(item3d_${NAME} STATIC ${SOURCES})
    add_library(item3d::${NAME} ALIAS item3d_${NAME})

    # Each folder sees its own headers as "item3d/<folder>/x.h" through a link in the build tree.
    set(VIEW ${CMAKE_BINARY_DIR}/include/${NAME})
    file(MAKE_DIRECTORY ${VIEW}/item3d)
    file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR}/${NAME} ${VIEW}/item3d/${NAME} SYMBOLIC)
    target_include_directories(item3d_${NAME} PUBLIC ${VIEW})

    foreach(DEPENDENCY ${ARG_DEPENDS})
        target_link_libraries(item3d_${NAME} PUBLIC item3d::${DEPENDENCY})
    endforeach()
    target_link_libraries(item3d_${NAME} PUBLIC ${ARG_PACKAGES} PRIVATE item3d_warnings)
    if(ARG_TORCH)
        target_link_libraries(item3d_${NAME} PUBLIC item3d_torch)
        item3d_use_torch_headers(item3d_${NAME})
    endif()
endfunction()

# Parsing LibTorch's headers takes most of a compilation; every target that uses them shares one
# precompiled header.
function(item3d_use_torch_headers TARGET)
    if(NOT TARGET item3d_torch_pch)
        file(WRITE ${CMAKE_BINARY_DIR}/torch_pch.cpp "// Owner of the precompiled LibTorch header.\n")
        add_library(item3d_torch_pch OBJECT ${CMAKE_BINARY_DIR}/torch_pch.cpp)
        target_link_libraries(item3d_torch_pch PRIVATE item3d_torch item3d_options OpenMP::OpenMP_CXX)
        target_precompile_headers(item3d_torch_pch PRIVATE <torch/torch.h>)
    endif()
    target_precompile_headers(${TARGET} REUSE_FROM item3d_torch_pch)
endfunction()
