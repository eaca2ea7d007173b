# Debian packages and what scripts/setup.sh fetched into .deps/.
set(ITEM3D_DEPS ${CMAKE_SOURCE_DIR}/.deps CACHE PATH "Where scripts/setup.sh put what it fetched")

find_package(Threads REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(draco CONFIG REQUIRED)
find_package(meshoptimizer CONFIG REQUIRED)

# OpenMP by its flag alone: LibTorch brings a libgomp of its own, and a full path to the compiler's
# would set two of the same name against each other.
add_library(item3d_openmp INTERFACE)
target_compile_options(item3d_openmp INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-fopenmp>)
target_link_options(item3d_openmp INTERFACE -fopenmp)

add_library(item3d_options INTERFACE)
if(CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(item3d_options INTERFACE -O2)
endif()

add_library(item3d_warnings INTERFACE)
target_link_libraries(item3d_warnings INTERFACE item3d_options)
target_compile_options(item3d_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Werror
    # How vectors are passed between files; ours are inlined.
    -Wno-psabi)

if(NOT ITEM3D_LOADERS_ONLY)
    include(LibTorch)
endif()
