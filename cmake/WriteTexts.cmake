# cmake -DPROGRAM=... -DHEADER=... -P WriteTexts.cmake: a C++ header with what PROGRAM prints for --help
# and --version.
foreach(OPTION help version)
    execute_process(COMMAND ${PROGRAM} --${OPTION} OUTPUT_VARIABLE TEXT COMMAND_ERROR_IS_FATAL ANY)
    set(${OPTION} "${TEXT}")
endforeach()
file(CONFIGURE OUTPUT ${HEADER} CONTENT [===[
// Written by cmake/WriteTexts.cmake.
#pragma once

inline constexpr char help_text[] = R"text(@help@)text";
inline constexpr char version_text[] = R"text(@version@)text";
]===] @ONLY)
