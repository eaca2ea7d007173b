# cmake --install BUILD --prefix PREFIX [--component programs|parity|development]
#
# programs:
#   bin/item3d               the program that people start
#   lib/item3d/              the programs that item3d executes (item3d-edit, ...), LibTorch's libraries, which they
#                            find through $ORIGIN, and the modules that they open: libitem3d_cuda.so
#                            (cmake/Cuda.cmake) and libitem3d_ktx2.so (cmake/Ktx2.cmake)
#   share/item3d/            assets: the embedded prior and the demo model; web/: the studio's page,
#                            with three.js in web/three/
# parity:
#   bin/parity               compares networks with reference numbers
# development: the rooms (cmake/Rooms.cmake) as libraries for find_package(item3d). Programs that use them need
# LibTorch's headers, from ITEM3D_TORCH_ROOT
#   include/item3d/, lib/libitem3d_*.a, lib/cmake/item3d/
install(DIRECTORY ${CMAKE_SOURCE_DIR}/assets/ DESTINATION share/item3d COMPONENT programs)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/web/ DESTINATION share/item3d/web COMPONENT programs)
install(DIRECTORY ${ITEM3D_DEPS}/three/ DESTINATION share/item3d/web/three COMPONENT programs
    PATTERN .pins EXCLUDE)
if(ITEM3D_TORCH_ROOT STREQUAL "${ITEM3D_DEPS}/site/torch")
    # The libraries' run paths contain $ORIGIN, so that they find each other in one folder.
    file(GLOB LIBRARIES
        ${ITEM3D_TORCH_ROOT}/lib/libtorch_cpu.so
        ${ITEM3D_TORCH_ROOT}/lib/libc10.so
        ${ITEM3D_TORCH_ROOT}/lib/libgomp*.so*
        ${ITEM3D_DEPS}/site/nvidia/cu13/lib/*.so.*)
    install(PROGRAMS ${LIBRARIES} DESTINATION lib/item3d COMPONENT programs)
endif()

include(CMakePackageConfigHelpers)
get_property(ROOMS GLOBAL PROPERTY ITEM3D_ROOMS)
install(TARGETS ${ROOMS} item3d_basis_universal item3d_xatlas EXPORT item3d
    ARCHIVE DESTINATION lib COMPONENT development
    FILE_SET HEADERS DESTINATION include COMPONENT development)
install(EXPORT item3d NAMESPACE item3d:: FILE item3d-targets.cmake
    DESTINATION lib/cmake/item3d COMPONENT development)
configure_package_config_file(${CMAKE_SOURCE_DIR}/cmake/item3d-config.cmake.in
    ${CMAKE_BINARY_DIR}/item3d-config.cmake INSTALL_DESTINATION lib/cmake/item3d)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/item3d-config-version.cmake
    COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/item3d-config.cmake ${CMAKE_BINARY_DIR}/item3d-config-version.cmake
    cmake/Dependencies.cmake cmake/LibTorch.cmake
    DESTINATION lib/cmake/item3d COMPONENT development)
