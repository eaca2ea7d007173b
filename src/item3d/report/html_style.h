// Style of the pages, and the script of the comparison's handle. Only html.cpp uses this file.
#pragma once

#include <string_view>

namespace item3d {

extern const std::string_view html_style;
extern const std::string_view html_script;

}  // namespace item3d
