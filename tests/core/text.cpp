// Tests of texts of tables and pages.
#include "item3d/core/csv.h"
#include "item3d/core/error.h"
#include "item3d/core/html_escape.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

TEST(Csv, ReadsQuotedFields) {
    const CsvRows rows = parse_csv("a,\"b \"\"c\"\", d\",\r\n\n\"x\ny\",,z", "table");
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0], (std::vector<std::string>{"a", "b \"c\", d", ""}));
    EXPECT_EQ(rows[1], (std::vector<std::string>{"x\ny", "", "z"}));
    EXPECT_EQ(parse_csv(csv_line(rows[0]) + csv_line(rows[1]), "table"), rows);
    EXPECT_THROW(parse_csv("a,\"b\n", "table"), InputError);
}

TEST(Html, EscapesWhatPagesMean) {
    EXPECT_EQ(html_escape("a < b & \"c\">"), "a &lt; b &amp; &quot;c&quot;&gt;");
}

}  // namespace
}  // namespace item3d
