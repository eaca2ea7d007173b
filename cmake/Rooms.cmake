# A room is a folder of src/item3d that becomes a static library. item3d_room(NAME ...) defines the
# library item3d::NAME, with underscores instead of slashes. It links the rooms that cmake/layers.txt
# allows it to include (scripts/layers.py checks the #include lines).
#
#   TENSORS             the room's sources use LibTorch's tensors (item3d/tensors/tensor.h)
#   PLAIN file...       sources that do not use LibTorch
#   AUTOGRAD file...    sources that define torch::autograd functions. They are compiled as one file,
#                       because the headers for such functions take most of the time
#   MODULES file...     sources that also use torch::nn; ALL stands for all sources
#   FAST                the room computes on pixels, texels or weights, so it is compiled with -O2;
#                       other rooms are compiled with -O1
#   APART file...       sources that are compiled one by one. All others are compiled several at a time,
#                       because the templates of LibTorch, JSON and others take most of the time. Names
#                       in anonymous namespaces must therefore be unique in a room
#   EXCEPT file...      sources that the caller compiles
#   PACKAGES target...  targets of other projects; PRIVATE_PACKAGES: those that no header includes
#
# For each kind of source and each level of optimisation there is a precompiled header
# (cmake/PrecompiledHeaders.cmake).
include(PrecompiledHeaders)

# Options for all sources of the project.
add_library(item3d_options INTERFACE)
target_link_libraries(item3d_options INTERFACE item3d_openmp)
target_compile_options(item3d_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Werror
    # GCC notes changes in how vectors are passed to functions, but all such functions are inlined.
    -Wno-psabi
    # Clang also warns if a local name is that of another source of the same unit build.
    $<$<CXX_COMPILER_ID:Clang>:-Wno-shadow>)
# By default, GCC's garbage collection begins at 128 MB. A file with LibTorch's headers holds a gigabyte that
# stays in use, and compiles in an eighth less time if that memory is not scanned repeatedly.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(item3d_options INTERFACE "SHELL:--param ggc-min-heapsize=1500000")
endif()

# item3d_layers(ROOM RESULT) sets RESULT to the rooms that ROOM may include.
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

# item3d_sources(TARGET KIND LEVEL file...) adds sources of one kind to a static library. They are compiled
# with the targets in the caller's variable LINKED.
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

# Number of sources that are compiled as one file. A value of 1 suits work in which one file changes often.
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
    # Subfolders that are rooms of their own are left out.
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
    set(LINKED ${SHOWN} ${ARG_PRIVATE_PACKAGES})  # read by item3d_sources()

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

# item3d_program(NAME KIND SOURCES file... [LINK target...] [INSTALL folder] [COMPONENT name]) defines an
# executable at the top of the build folder.
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
        # LibTorch's libraries are installed beside the programs in lib/item3d. Only a LibTorch from another
        # ITEM3D_TORCH_ROOT stays in its place (cmake/Install.cmake).
        set(RPATH "$ORIGIN;$ORIGIN/../lib/item3d")
        if(NOT ITEM3D_TORCH_ROOT STREQUAL "${ITEM3D_DEPS}/site/torch")
            list(APPEND RPATH ${ITEM3D_TORCH_ROOT}/lib)
        endif()
        set_target_properties(${NAME} PROPERTIES INSTALL_RPATH "${RPATH}")
        install(TARGETS ${NAME} RUNTIME DESTINATION ${ARG_INSTALL} COMPONENT ${ARG_COMPONENT})
    endif()
endfunction()
