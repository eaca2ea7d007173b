#include "item3d/report/report.h"

#include "item3d/io/image/png.h"
#include "item3d/report/html_chart.h"

#include <gtest/gtest.h>

#include <limits>
#include <regex>

namespace item3d {
namespace {

std::size_t occurrences(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

/// Returns the first unbalanced element of the HTML. The function knows the few void elements in
/// use.
std::string unbalanced(const std::string& html) {
    std::vector<std::string> open;
    static const std::regex tag("<(/?)([a-zA-Z][a-zA-Z0-9]*)[^>]*?(/?)>");
    const std::string body = std::regex_replace(html.substr(html.find("<body>")),
                                                std::regex("<script>[^]*</script>"), "");
    for (auto it = std::sregex_iterator(body.begin(), body.end(), tag);
         it != std::sregex_iterator(); ++it) {
        const std::string name = (*it)[2];
        if (name == "img" || name == "input" || (*it)[3] == "/") continue;
        if ((*it)[1] != "/") {
            open.push_back(name);
        } else if (open.empty() || open.back() != name) {
            return "unexpected </" + name + ">";
        } else {
            open.pop_back();
        }
    }
    // <body> and <html>: the latter was opened before the part that was read.
    return open.empty() ? "" : "unclosed <" + open.back() + ">";
}

EditReport example() {
    const Bytes image = encode_png(Image(4, 4, 3, 0.5f), 8);
    EditReport report;
    report.model = "mug & co.glb";
    report.from = "a <red> mug";
    report.to = "a \"golden\" mug";
    report.before = {{"front", image}, {"side", image}};
    report.after = {{"front", image}, {"side", image}};
    report.turntable = ReportImage{"turntable", image};
    report.textures = {{"Base colour", image, image}, {"Normal", {}, image}};
    report.scores = {{"Metallic", "0.91", "was 0.00"}};
    report.timeline = {{"start", {"", image}, "a <red> mug", {{"angle", "0"}}},
                       {"25", {"", image}, "", {}}};
    report.charts = {{"Direction", "iteration", {{"length", {1.0, 0.5, 0.25}}}, true}};
    report.settings = {{"guidance", "rdl"}, {"seed", "0"}};
    report.seconds = {{"fit", 4.0}, {"optimize", 61.0}};
    report.warnings = {"the prior does not know 'teal'"};
    report.files = {{"model.glb", "model.glb"}, {"textures", "my textures/a:b.png"}};
    report.command = "item3d edit 'mug & co.glb' --from '<x>'";
    report.version = "0.1.0";
    return report;
}

TEST(HtmlEscape, LeavesNoMarkup) {
    EXPECT_EQ(html_escape("<a href='x'>\"&\"</a>"),
              "&lt;a href=&#39;x&#39;&gt;&quot;&amp;&quot;&lt;/a&gt;");
    EXPECT_EQ(html_escape("gr\xc3\xbcn"), "gr\xc3\xbcn");
}

TEST(DataUri, IsBase64WithTheRightType) {
    EXPECT_EQ(data_uri({}), "data:application/octet-stream;base64,");
    EXPECT_EQ(data_uri({'f'}), "data:application/octet-stream;base64,Zg==");
    EXPECT_EQ(data_uri({'f', 'o'}), "data:application/octet-stream;base64,Zm8=");
    EXPECT_EQ(data_uri({'f', 'o', 'o'}), "data:application/octet-stream;base64,Zm9v");
    EXPECT_EQ(data_uri({0xff, 0xd8, 0xff, 0xe0}), "data:image/jpeg;base64,/9j/4A==");
    EXPECT_EQ(data_uri(encode_png(Image(1, 1, 3), 8)).rfind("data:image/png;base64,iVBOR", 0), 0u);
}

TEST(EditReport, IsWholeSelfContainedAndEscaped) {
    const std::string html = edit_report_html(example());
    EXPECT_EQ(html.rfind("<!DOCTYPE html>", 0), 0u);
    EXPECT_EQ(unbalanced(html), "unexpected </html>");  // opened before the part that was read
    EXPECT_EQ(html.find("<red>"), std::string::npos);
    EXPECT_NE(html.find("a &lt;red&gt; mug"), std::string::npos);
    EXPECT_NE(html.find("a &quot;golden&quot; mug"), std::string::npos);
    // The page fetches nothing: all sources are data, and no link leads to the network.
    EXPECT_EQ(html.find("http"), std::string::npos);
    EXPECT_EQ(html.find("@import"), std::string::npos);
    EXPECT_EQ(occurrences(html, "<img "), occurrences(html, "<img src=\"data:"));
    EXPECT_EQ(occurrences(html, "<img "), 2u * 2 + 1 + 3 + 2);
    EXPECT_EQ(occurrences(html, "<q>"), 1u);
    EXPECT_NE(html.find("<q>a &lt;red&gt; mug</q>"), std::string::npos);
    EXPECT_NE(html.find("href=\"my%20textures/a%3Ab.png\""), std::string::npos);
    EXPECT_EQ(html, edit_report_html(example()));
}

TEST(EditReport, LeavesOutWhatItHasNot) {
    EditReport report;
    report.from = "a";
    report.to = "b";
    const std::string html = edit_report_html(report);
    EXPECT_EQ(html.find("<section"), std::string::npos);
    EXPECT_EQ(unbalanced(html), "unexpected </html>");
}

TEST(HtmlChart, SurvivesEveryKindOfValue) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    for (const std::vector<double>& values :
         std::vector<std::vector<double>>{{},
                                          {1},
                                          {nan, nan},
                                          {0, 0, 0},
                                          {1e-30, 1e30, -1e30},
                                          {1, nan, 2, infinity, 3},
                                          std::vector<double>(10000, 2.5)}) {
        const std::string html = html_chart({"t", "x", {{"c", values}}, true});
        EXPECT_EQ(html.find("nan"), std::string::npos);
        EXPECT_EQ(html.find("inf"), std::string::npos);
        EXPECT_LT(html.size(), 40000u);
    }
    EXPECT_NE(html_chart({"t", "x", {}, false}).find("No values"), std::string::npos);
}

TEST(HtmlChart, PutsHigherValuesHigher) {
    const std::string html = html_chart({"t", "x", {{"c", {0, 10}}}, false});
    std::smatch found;
    ASSERT_TRUE(std::regex_search(html, found,
                                  std::regex("d=\"M([0-9.]+) ([0-9.]+)L([0-9.]+) ([0-9.]+)\"")));
    EXPECT_LT(std::stod(found[1]), std::stod(found[3]));
    EXPECT_GT(std::stod(found[2]), std::stod(found[4]));
}

}  // namespace
}  // namespace item3d
