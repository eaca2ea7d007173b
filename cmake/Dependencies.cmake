# Debian packages and what scripts/setup.sh fetched into .deps/.
set(ITEM3D_DEPS ${CMAKE_SOURCE_DIR}/.deps CACHE PATH "Where scripts/setup.sh put what it fetched")

find_package(Threads REQUIRED)
find_package(OpenMP REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PkgConfig REQUIRED)

add_library(item3d_options INTERFACE)
if(CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(item3d_options INTERFACE -O2)
endif()

add_library(item3d_warnings INTERFACE)
target_link_libraries(item3d_warnings INTERFACE item3d_options)
target_compile_options(item3d_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Werror)

if(NOT ITEM3D_LOADERS_ONLY)
    include(LibTorch)
endif()
