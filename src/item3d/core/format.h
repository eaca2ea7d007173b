// fmt for files that also see LibTorch. LibTorch brings headers of another version of fmt than the
// system's library, and the compiler finds those first: their code must then come from the headers.
#pragma once

#ifndef FMT_HEADER_ONLY
#define FMT_HEADER_ONLY
#endif
#include <fmt/format.h>
#include <fmt/ranges.h>
