# libitem3d_ktx2.so: the encoder of Basis Universal, a module that item3d opens in order to write KTX2. The encoder
# takes longer to compile than the decoder, so the programs that the demo needs do not contain it.
file(GLOB ENCODER ${ITEM3D_DEPS}/basis_universal/encoder/*.cpp)
add_library(item3d_ktx2 MODULE ${CMAKE_SOURCE_DIR}/src/item3d/io/image/ktx2_module.cpp ${ENCODER}
    ${ITEM3D_DEPS}/basis_universal/transcoder/basisu_transcoder.cpp)
set_target_properties(item3d_ktx2 PROPERTIES
    CXX_VISIBILITY_PRESET hidden
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
target_include_directories(item3d_ktx2 PRIVATE ${CMAKE_SOURCE_DIR}/src)
target_include_directories(item3d_ktx2 SYSTEM PRIVATE ${ITEM3D_DEPS}/basis_universal)
target_link_libraries(item3d_ktx2 PRIVATE PkgConfig::ZSTD Threads::Threads)
target_compile_definitions(item3d_ktx2 PRIVATE
    NDEBUG BASISD_SUPPORT_KTX2_ZSTD=1 BASISU_SUPPORT_SSE=0 BASISU_SUPPORT_OPENCL=0)
target_compile_options(item3d_ktx2 PRIVATE -w -fno-strict-aliasing -fno-sanitize=undefined)
item3d_compile(item3d_ktx2 plain computation)
install(TARGETS item3d_ktx2 LIBRARY DESTINATION lib/item3d COMPONENT programs)
