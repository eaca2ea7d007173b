#include "item3d/core/latex_escape.h"

#include <string_view>

namespace item3d {

std::string latex_escape(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (std::string_view("&%$#_{}").find(c) != std::string_view::npos)
            result += std::string("\\") + c;
        else if (c == '\\')
            result += "\\textbackslash{}";
        else if (c == '~')
            result += "\\textasciitilde{}";
        else if (c == '^')
            result += "\\textasciicircum{}";
        else
            result += c;
    }
    return result;
}

}  // namespace item3d
