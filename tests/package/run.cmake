# cmake -DBUILD=... -DSOURCE=... -DFLAGS=... -DMODEL=... -P run.cmake
#
# Installs the libraries, builds this folder's program outside of the source tree, and renders an image with it.
# FLAGS: the compiler flags of the libraries, such as those of sanitizers.
file(REMOVE_RECURSE ${BUILD}/package_test)
set(PREFIX ${BUILD}/package_test/prefix)
function(run)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE CODE OUTPUT_VARIABLE TEXT ERROR_VARIABLE TEXT)
    if(NOT CODE EQUAL 0)
        message(FATAL_ERROR "${ARGN} ended with ${CODE}\n${TEXT}")
    endif()
endfunction()
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${PREFIX} --component development)
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD}/package_test/build -G Ninja -DCMAKE_PREFIX_PATH=${PREFIX}
    -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${BUILD}/package_test/build)
run(${BUILD}/package_test/build/draw ${MODEL} ${BUILD}/package_test/picture.png)
file(SIZE ${BUILD}/package_test/picture.png BYTES)
if(BYTES LESS 10000)
    message(FATAL_ERROR "the picture has ${BYTES} bytes: too few to show a mug")
endif()
