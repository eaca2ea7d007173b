// Tests of CSV, of text for terminals, of HTML escapes, and of the limits of JSON.
#include "item3d/core/csv.h"
#include "item3d/core/error.h"
#include "item3d/core/html_escape.h"
#include "item3d/core/one_line.h"
#include "item3d/core/parse_json.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

TEST(OneLine, EscapesControlCharacters) {
    EXPECT_EQ(one_line("a red mug: caf\xc3\xa9, \xe6\x9d\xaf"),
              "a red mug: caf\xc3\xa9, \xe6\x9d\xaf");
    EXPECT_EQ(one_line("a\r\nb\n"), "a  b ");
    EXPECT_EQ(one_line("\x1b[2J\x7f\t"), "\\x1b[2J\\x7f\\x09");
    EXPECT_EQ(one_line("\xc2\x9b"
                       "31m\xc2\xa0"),
              "\\x9b31m\xc2\xa0")
        << "U+009B begins escapes too";
    EXPECT_EQ(one_line("r\xe9\x9b"), "r\xe9\x9b");
}

TEST(Csv, ReadsQuotedFields) {
    const CsvRows rows = parse_csv("a,\"b \"\"c\"\", d\",\r\n\n\"x\ny\",,z", "table");
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0], (std::vector<std::string>{"a", "b \"c\", d", ""}));
    EXPECT_EQ(rows[1], (std::vector<std::string>{"x\ny", "", "z"}));
    EXPECT_EQ(parse_csv(csv_line(rows[0]) + csv_line(rows[1]), "table"), rows);
    EXPECT_THROW(parse_csv("a,\"b\n", "table"), InputError);
    EXPECT_EQ(csv_objects({{"name"}, {"r\xc3\xa9"}}, "table")[0]["name"], "r\xc3\xa9");
    EXPECT_THROW(csv_objects({{"name"}, {"r\xe9"}}, "table"), InputError);
    EXPECT_THROW(csv_objects({{"r\xe9"}, {"a"}}, "table"), InputError);
}

TEST(Html, EscapesWhatPagesMean) {
    EXPECT_EQ(html_escape("a < b & \"c\">"), "a &lt; b &amp; &quot;c&quot;&gt;");
}

// Copying or writing deeper JSON would overflow the stack.
TEST(JsonText, IsRefusedWhereItIsTooDeep) {
    const auto nested = [](std::size_t depth) {
        return std::string(depth, '[') + std::string(depth, ']');
    };
    EXPECT_FALSE(parse_json(nested(max_json_depth)).is_discarded());
    EXPECT_TRUE(parse_json(nested(max_json_depth + 1)).is_discarded());
    EXPECT_TRUE(parse_json(std::string(1 << 20, '[')).is_discarded());
    EXPECT_THROW(parse_json_or_throw(nested(max_json_depth + 1)), nlohmann::json::exception);
    EXPECT_THROW(parse_ordered_json_or_throw(nested(1 << 20)), nlohmann::json::exception);
    // Brackets inside of strings do not count, and lists side by side are not nested.
    EXPECT_FALSE(parse_json("\"" + std::string(1000, '[') + "\\\"[\"").is_discarded());
    std::string beside = "[[]";
    for (int i = 0; i < 1000; ++i)
        beside += ",[{}]";
    EXPECT_FALSE(parse_json(beside + "]").is_discarded());
}

TEST(JsonText, TakesWholeNumbersAlone) {
    EXPECT_EQ(int_of(parse_json("3.0")), 3);
    EXPECT_EQ(int_of(parse_json("-2147483648")), std::numeric_limits<int>::min());
    EXPECT_EQ(
        integer_of(parse_json("9007199254740993"), 0, std::numeric_limits<std::int64_t>::max()),
        9007199254740993);
    for (const char* no :
         {"2147483648", "1e39", "0.5", "18446744073709551615", "\"1\"", "null", "true", "-1e300"})
        EXPECT_THROW(int_of(parse_json(no)), nlohmann::json::exception) << no;
    EXPECT_THROW(integer_of(6, 0, 5), nlohmann::json::exception);
}

}  // namespace
}  // namespace item3d
