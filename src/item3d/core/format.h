// fmt for files that also include LibTorch. LibTorch has headers of another version of fmt than the
// system's library, which the compiler finds first: the code must then come from these headers.
#pragma once

#ifndef FMT_HEADER_ONLY
#define FMT_HEADER_ONLY
#endif
#include <fmt/format.h>
#include <fmt/ranges.h>
