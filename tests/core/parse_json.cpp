#include "item3d/core/parse_json.h"

#include "item3d/core/error.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

std::string problem_of(const std::string& text) {
    try {
        parse_json_text(text, "a.json");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(ParseJson, NamesTheLineAndWhatToLookFor) {
    EXPECT_EQ(parse_json_text("{\"a\": [1, 2]}", "a.json")["a"][1], 2);
    EXPECT_EQ(problem_of("{\n  \"a\": [1, 2,]\n}"),
              "a.json: is not valid JSON, see line 2; look for a missing or extra comma, quotation "
              "mark or bracket");
    EXPECT_NE(
        problem_of("[\n\n[1, NaN]]").find("see line 3; NaN and Infinity are not valid in JSON"),
        std::string::npos);
    EXPECT_NE(problem_of("[-Infinity]").find("NaN and Infinity"), std::string::npos);
    EXPECT_NE(problem_of("[1e999]").find("too large"), std::string::npos);
    EXPECT_NE(problem_of(std::string("\xff\xfe{\0}\0", 6)).find("UTF-8"), std::string::npos);
    EXPECT_NE(problem_of("").find("line 1"), std::string::npos);
}

}  // namespace
}  // namespace item3d
