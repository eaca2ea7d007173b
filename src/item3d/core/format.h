// fmt for files that also include LibTorch. In such files the compiler finds the fmt headers of
// LibTorch first. Their version differs from that of the system's fmt library, so fmt is used
// header-only here.
#pragma once

#ifndef FMT_HEADER_ONLY
#define FMT_HEADER_ONLY
#endif
#include <fmt/format.h>
#include <fmt/ranges.h>
