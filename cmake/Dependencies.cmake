# Finds Debian packages, and what scripts/setup.sh fetched into .deps/. The installed package (Install.cmake)
# includes this file too. Dependencies are therefore imported targets, and PUBLIC requirements use their names.
set(ITEM3D_DEPS ${CMAKE_SOURCE_DIR}/.deps CACHE PATH "Where scripts/setup.sh put what it fetched")

find_package(Threads REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(OpenEXR REQUIRED)
find_package(PNG REQUIRED)
find_package(pugixml REQUIRED)
find_package(ZLIB REQUIRED)
find_package(JPEG REQUIRED)
find_package(TIFF REQUIRED)
pkg_check_modules(WEBP REQUIRED IMPORTED_TARGET libwebp libwebpmux libwebpdemux)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
find_package(CURL REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(ICU REQUIRED COMPONENTS uc)
find_package(draco CONFIG REQUIRED)
find_package(meshoptimizer CONFIG REQUIRED)
pkg_check_modules(HTTPLIB REQUIRED IMPORTED_TARGET cpp-httplib)
pkg_check_modules(EXIF REQUIRED IMPORTED_TARGET libexif)
pkg_check_modules(LIBZIP REQUIRED IMPORTED_TARGET libzip)
find_package(SQLite3 REQUIRED)

# LibTorch contains the headers of another version of fmt. The system's headers must be found first, because
# the system has a compiled library, while LibTorch's headers would be compiled in every file.
get_target_property(FMT_INCLUDE fmt::fmt INTERFACE_INCLUDE_DIRECTORIES)
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/fmt)
file(CREATE_LINK ${FMT_INCLUDE}/fmt ${CMAKE_BINARY_DIR}/fmt/fmt SYMBOLIC)
add_library(item3d_fmt INTERFACE IMPORTED GLOBAL)
target_include_directories(item3d_fmt SYSTEM BEFORE INTERFACE ${CMAKE_BINARY_DIR}/fmt)
target_link_libraries(item3d_fmt INTERFACE fmt::fmt)

# OpenMP is linked by its flag only. LibTorch contains its own libgomp, and a full path to the compiler's
# libgomp would load two libraries of the same name.
add_library(item3d_openmp INTERFACE IMPORTED GLOBAL)
target_compile_options(item3d_openmp INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-fopenmp>)
target_link_options(item3d_openmp INTERFACE -fopenmp)

if(NOT ITEM3D_LOADERS_ONLY)
    include(${CMAKE_CURRENT_LIST_DIR}/LibTorch.cmake)
    find_package(embree 3 REQUIRED)
endif()
