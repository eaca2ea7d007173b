# item3d_room(NAME ...): one folder of src/item3d as one static library, item3d::NAME with slashes as
# underscores. It links the rooms that cmake/layers.txt lets it include (scripts/layers.py checks the
# includes themselves).
#
#   TENSORS             its sources use LibTorch's tensors (item3d/tensors/tensor.h)
#   PLAIN file...       but these, which do without LibTorch
#   AUTOGRAD file...    and these, which define torch::autograd functions: compiled all together, since
#                       what declares those is most of their compilation
#   MODULES file...     and these, which use torch::nn too; ALL: all of them
#   FAST                computes on pixels, texels or weights: -O2; other rooms orchestrate: -O1
#   APART file...       compiled by themselves; all others several at a time, since the templates of
#                       LibTorch, JSON and the like are most of each one's compilation: names in the
#                       anonymous namespaces of a room must differ
#   EXCEPT file...      compiled by the caller
#   PACKAGES target...  of other projects; PRIVATE_PACKAGES: those that no header shows
#
# Each kind of source has a precompiled header of its own, for each level of optimisation
# (cmake/PrecompiledHeaders.cmake).
include(PrecompiledHeaders)

# How everything of ours is compiled.
add_library(item3d_options INTERFACE)
target_link_libraries(item3d_options INTERFACE item3d_openmp)
target_compile_options(item3d_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Werror
    # How vectors are passed between files; ours are inlined.
    -Wno-psabi)
# GCC collects garbage from 128 MB on; a file with LibTorch's headers holds a gigabyte that stays, and
# compiles in an eighth less time when it is not searched again and again.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(item3d_options INTERFACE "SHELL:--param ggc-min-heapsize=1500000")
endif()

# item3d_layers(ROOM RESULT): the rooms that ROOM may include.
file(STRINGS ${CMAKE_SOURCE_DIR}/cmake/layers.txt ITEM3D_LAYERS REGEX "^[a-z]")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/cmake/layers.txt)
function(item3d_layers ROOM RESULT)
    foreach(LINE ${ITEM3D_LAYERS})
        if(LINE MATCHES "^${ROOM}:(.*)$")
            separate_arguments(ROOMS UNIX_COMMAND "${CMAKE_MATCH_1}")
            set(${RESULT} ${ROOMS} PARENT_SCOPE)
            return()
        endif()
    endforeach()
    message(FATAL_ERROR "cmake/layers.txt has no room ${ROOM}")
endfunction()

# item3d_sources(TARGET KIND LEVEL file...): adds sources of one kind to a static library, compiled
# with what the caller's LINKED names.
function(item3d_sources TARGET KIND LEVEL)
    if(NOT ARGN)
        return()
    endif()
    set(OBJECTS ${TARGET}_${KIND})
    add_library(${OBJECTS} OBJECT ${ARGN})
    target_include_directories(${OBJECTS} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
    target_link_libraries(${OBJECTS} PRIVATE item3d_options ${LINKED})
    item3d_compile(${OBJECTS} ${KIND} ${LEVEL})
    item3d_compile_together(${OBJECTS})
    target_sources(${TARGET} PRIVATE $<TARGET_OBJECTS:${OBJECTS}>)
endfunction()

# How many sources are compiled at a time; OFF for a build in which one file is changed again and again.
set(ITEM3D_BATCH 10 CACHE STRING "Sources compiled together; 1: each by itself")
function(item3d_compile_together TARGET)
    if(ITEM3D_BATCH GREATER 1)
        set_target_properties(${TARGET} PROPERTIES
            UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${ITEM3D_BATCH})
    endif()
endfunction()

function(item3d_room NAME)
    cmake_parse_arguments(ARG "TENSORS;FAST" ""
        "PLAIN;AUTOGRAD;MODULES;APART;EXCEPT;PACKAGES;PRIVATE_PACKAGES" ${ARGN})
    set(FOLDER ${CMAKE_CURRENT_SOURCE_DIR}/item3d/${NAME})
    file(GLOB_RECURSE SOURCES CONFIGURE_DEPENDS RELATIVE ${FOLDER} ${FOLDER}/*.cpp)
    file(GLOB_RECURSE HEADERS CONFIGURE_DEPENDS ${FOLDER}/*.h)
    # Folders that are rooms of their own.
    foreach(LINE ${ITEM3D_LAYERS})
        if(LINE MATCHES "^${NAME}/([a-z_/]+):")
            list(FILTER SOURCES EXCLUDE REGEX "^${CMAKE_MATCH_1}/")
            list(FILTER HEADERS EXCLUDE REGEX "^${FOLDER}/${CMAKE_MATCH_1}/")
        endif()
    endforeach()

    if(ARG_EXCEPT)
        list(REMOVE_ITEM SOURCES ${ARG_EXCEPT})
    endif()

    string(REPLACE "/" "_" TARGET item3d_${NAME})
    add_library(${TARGET} STATIC)
    string(REPLACE "/" "_" ALIAS ${NAME})
    add_library(item3d::${ALIAS} ALIAS ${TARGET})
    set_target_properties(${TARGET} PROPERTIES EXPORT_NAME ${ALIAS} LINKER_LANGUAGE CXX)
    target_sources(${TARGET} PUBLIC FILE_SET HEADERS
        BASE_DIRS ${CMAKE_CURRENT_SOURCE_DIR} FILES ${HEADERS})
    set_property(GLOBAL APPEND PROPERTY ITEM3D_ROOMS ${TARGET})

    item3d_layers(${NAME} ROOMS)
    list(TRANSFORM ROOMS REPLACE "/" "_")
    list(TRANSFORM ROOMS PREPEND item3d_)
    set(SHOWN ${ROOMS} ${ARG_PACKAGES})
    if(ARG_TENSORS OR ARG_MODULES)
        list(APPEND SHOWN item3d_torch)
    endif()
    target_link_libraries(${TARGET} PUBLIC ${SHOWN} PRIVATE ${ARG_PRIVATE_PACKAGES})
    set(LINKED ${SHOWN} ${ARG_PRIVATE_PACKAGES})  # by item3d_sources()

    set(LEVEL orchestration)
    if(ARG_FAST)
        set(LEVEL computation)
    endif()
    if("${ARG_MODULES}" STREQUAL "ALL")
        set(ARG_MODULES ${SOURCES})
        list(REMOVE_ITEM ARG_MODULES ${ARG_APART} ${ARG_PLAIN})
    endif()
    set(PLAIN ${ARG_PLAIN})
    set(TENSORS ${SOURCES})
    if(NOT ARG_TENSORS AND NOT ARG_MODULES)
        set(PLAIN ${SOURCES})
    endif()
    if(PLAIN OR ARG_AUTOGRAD OR ARG_MODULES OR ARG_APART)
        list(REMOVE_ITEM TENSORS ${PLAIN} ${ARG_AUTOGRAD} ${ARG_MODULES} ${ARG_APART})
        if(PLAIN AND ARG_APART)
            list(REMOVE_ITEM PLAIN ${ARG_APART})
        endif()
    endif()
    foreach(LIST PLAIN TENSORS ARG_AUTOGRAD ARG_MODULES ARG_APART)
        list(TRANSFORM ${LIST} PREPEND ${FOLDER}/)
    endforeach()
    item3d_sources(${TARGET} plain ${LEVEL} ${PLAIN})
    item3d_sources(${TARGET} tensors ${LEVEL} ${TENSORS})
    item3d_sources(${TARGET} tensors_autograd ${LEVEL} ${ARG_AUTOGRAD})
    if(ARG_AUTOGRAD)
        set_target_properties(${TARGET}_tensors_autograd PROPERTIES UNITY_BUILD_BATCH_SIZE 0)
    endif()
    item3d_sources(${TARGET} modules ${LEVEL} ${ARG_MODULES})
    if(ARG_APART)
        set_source_files_properties(${ARG_APART} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
        set(KIND plain)
        if(ARG_TENSORS OR ARG_MODULES)
            set(KIND tensors)
        endif()
        item3d_sources(${TARGET} ${KIND}_apart ${LEVEL} ${ARG_APART})
    endif()
endfunction()

# item3d_program(NAME KIND SOURCES file... [LINK target...] [INSTALL folder] [COMPONENT name]): one
# executable, at the top of the build folder.
function(item3d_program NAME KIND)
    cmake_parse_arguments(ARG "" "INSTALL;COMPONENT" "SOURCES;LINK" ${ARGN})
    if(NOT ARG_COMPONENT)
        set(ARG_COMPONENT programs)
    endif()
    add_executable(${NAME} ${ARG_SOURCES})
    target_include_directories(${NAME} PRIVATE ${CMAKE_SOURCE_DIR})
    target_link_libraries(${NAME} PRIVATE ${ARG_LINK} item3d_options)
    item3d_compile(${NAME} ${KIND} orchestration)
    item3d_compile_together(${NAME})
    if(ARG_INSTALL)
        # LibTorch's libraries lie beside the programs in lib/item3d; a LibTorch of the machine's own
        # stays where it is (cmake/Install.cmake).
        set(RPATH "$ORIGIN;$ORIGIN/../lib/item3d")
        if(NOT ITEM3D_TORCH_ROOT STREQUAL "${ITEM3D_DEPS}/site/torch")
            list(APPEND RPATH ${ITEM3D_TORCH_ROOT}/lib)
        endif()
        set_target_properties(${NAME} PROPERTIES INSTALL_RPATH "${RPATH}")
        install(TARGETS ${NAME} RUNTIME DESTINATION ${ARG_INSTALL} COMPONENT ${ARG_COMPONENT})
    endif()
endfunction()
