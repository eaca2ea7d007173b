# cmake --install BUILD --prefix PREFIX:
#   bin/item3d, bin/parity   the programs; bin/item3d-commands, which item3d becomes
#   lib/item3d/              LibTorch's libraries, found by the programs through $ORIGIN/../lib/item3d,
#                            and libitem3d_cuda.so (cmake/Cuda.cmake), opened from there
#   share/item3d/            assets: the embedded prior and the demo model
install(DIRECTORY ${CMAKE_SOURCE_DIR}/assets/ DESTINATION share/item3d)

if(ITEM3D_TORCH_ROOT STREQUAL "${ITEM3D_DEPS}/site/torch")
    # Their own run path has $ORIGIN in it, so that they find each other in one folder.
    file(GLOB LIBRARIES
        ${ITEM3D_TORCH_ROOT}/lib/libtorch_cpu.so
        ${ITEM3D_TORCH_ROOT}/lib/libc10.so
        ${ITEM3D_TORCH_ROOT}/lib/libgomp*.so*
        ${ITEM3D_DEPS}/site/nvidia/cu13/lib/*.so.*)
    install(PROGRAMS ${LIBRARIES} DESTINATION lib/item3d)
endif()
