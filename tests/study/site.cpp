// Test of a participant from the first page to the last, over HTTP.
#include "item3d/study/site.h"

#include "item3d/core/error.h"
#include "item3d/serve/http_listener.h"
#include "item3d/study/page_order.h"
#include "item3d/study/server.h"
#include "tests/support/study.h"

#include <httplib.h>

#include <memory>

namespace item3d::testing {
namespace {

class StudyPagesServed : public StudyFolder {
  protected:
    void SetUp() override {
        StudyFolder::SetUp();
        open();
    }
    void TearDown() override {
        close();
        StudyFolder::TearDown();
    }
    void open() {
        answers_ = std::make_unique<AnswerStore>(folder_, study_);
        answers_->add_participants(2);
        site_ = std::make_unique<StudySite>(study_, *answers_, folder_);
        server_ = std::make_unique<StudyServer>(*site_, "127.0.0.1", 0);
        client_ = std::make_unique<httplib::Client>("127.0.0.1", server_->port());
        home_ = participant_path(answers_->participants().at(0));
    }
    void close() {
        client_.reset();
        server_.reset();
        site_.reset();
        answers_.reset();
    }

    httplib::Response get(const std::string& path) {
        const auto result = client_->Get(path);
        EXPECT_TRUE(result) << path;
        return result ? *result : httplib::Response();
    }
    httplib::Response post(const std::string& path, const std::string& body) {
        const auto result = client_->Post(path, body, "application/x-www-form-urlencoded");
        EXPECT_TRUE(result) << path;
        return result ? *result : httplib::Response();
    }
    /// Returns the status and the location of a redirect.
    static std::string goes_to(const httplib::Response& response) {
        return fmt::format("{} {}", response.status, response.get_header_value("Location"));
    }
    std::string page(int number) const { return fmt::format("{}/{}", home_, number); }
    static bool has(const httplib::Response& response, const std::string& text) {
        return response.body.find(text) != std::string::npos;
    }

    std::unique_ptr<AnswerStore> answers_;
    std::unique_ptr<StudySite> site_;
    std::unique_ptr<StudyServer> server_;
    std::unique_ptr<httplib::Client> client_;
    std::string home_;
};

constexpr const char* good = "photorealism=4&text_consistency=2";

TEST_F(StudyPagesServed, FromTheFirstToTheLast) {
    const auto consent = get(home_);
    EXPECT_TRUE(has(consent, "First &amp; foremost.") && has(consent, "Edited &lt;objects&gt;"));
    EXPECT_TRUE(has(consent, "There are 8 pages, about 4 minutes"));
    EXPECT_EQ(goes_to(get(page(1))), "303 " + home_) << "no page before the consent";
    EXPECT_EQ(goes_to(post(page(1), good)), "303 " + home_);
    EXPECT_TRUE(answers_->answers(1).empty());
    EXPECT_EQ(goes_to(post(home_ + "/agree", "")), "303 " + home_);
    EXPECT_EQ(goes_to(get(home_)), "303 " + page(1));

    const auto pages = pages_of(study_, 1);
    for (int number = 1; number <= 8; ++number) {
        const StudyPage& shown = pages[static_cast<std::size_t>(number - 1)];
        const auto response = get(page(number));
        EXPECT_EQ(response.status, 200);
        EXPECT_TRUE(has(response, fmt::format("Page {} of 8", number)));
        EXPECT_LT(response.body.find(shown.edited_first ? shown.item->after : shown.item->before),
                  response.body.find(shown.edited_first ? shown.item->before : shown.item->after));
        EXPECT_TRUE(has(response, shown.item->turntable));
        EXPECT_FALSE(has(response, "checked>"));
        for (const std::string& method : study_.methods)
            EXPECT_FALSE(has(response, method)) << "the page names a method";
        EXPECT_EQ(has(response, "<b>2</b> for the first question and <b>5</b> for the second"),
                  shown.item->kind == StudyItemKind::attention);
        EXPECT_EQ(get("/pictures/" + shown.item->after).body, shown.item->after);
        EXPECT_EQ(goes_to(post(page(number), good)),
                  number < 8 ? "303 " + page(number + 1) : "303 " + home_);
    }
    EXPECT_TRUE(has(get(home_), "Thank you"));
    EXPECT_EQ(answers_->answers(1).size(), 8u);
    for (const auto& [item, answer] : answers_->answers(1))
        EXPECT_EQ(answer, (StudyAnswer{4, 2}));
    EXPECT_TRUE(answers_->answers(2).empty());
}

TEST_F(StudyPagesServed, GoOnAfterAClosedTabAndAnotherStart) {
    post(home_ + "/agree", "");
    post(page(1), good);
    post(page(2), good);
    close();
    open();
    EXPECT_EQ(goes_to(get(home_)), "303 " + page(3));
    EXPECT_EQ(goes_to(get(page(7))), "303 " + home_) << "a page that comes later";
    EXPECT_EQ(goes_to(post(page(7), good)), "303 " + home_);
    // One page is sent twice, and one is changed later.
    post(page(2), good);
    EXPECT_TRUE(has(get(page(2)), "value=\"4\" required checked>"));
    post(page(2), "photorealism=1&text_consistency=1");
    EXPECT_EQ(answers_->answers(1).size(), 2u);
    EXPECT_EQ(answers_->answers(1).at(pages_of(study_, 1)[1].item->id), (StudyAnswer{1, 1}));
    EXPECT_EQ(goes_to(get(home_)), "303 " + page(3));
}

TEST_F(StudyPagesServed, RefuseWhatIsOutOfRange) {
    post(home_ + "/agree", "");
    for (const char* bad :
         {"photorealism=6&text_consistency=2", "photorealism=0&text_consistency=2",
          "photorealism=-1&text_consistency=2", "photorealism=4",
          "photorealism=4.5&text_consistency=2", "",
          "photorealism=99999999999999999999999&text_consistency=2",
          "photorealism=4x&text_consistency=2"}) {
        const auto response = post(page(1), bad);
        EXPECT_EQ(response.status, 400) << bad;
        EXPECT_TRUE(has(response, "choose a number from 1 to 5")) << bad;
    }
    EXPECT_TRUE(has(post(page(1), "photorealism=3"), "value=\"3\" required checked>"))
        << "what was chosen stays chosen";
    EXPECT_TRUE(answers_->answers(1).empty());
    for (const char* bad : {"/", "/p/", "/p/0000", "/pictures/../study.json",
                            "/pictures/%2e%2e%2fanswers.sqlite", "/pictures/", "/answers.sqlite"})
        EXPECT_EQ(get(bad).status, 404) << bad;
    for (const char* bad : {"/0", "/9", "/x", "/1x", "/-1"})
        EXPECT_EQ(get(home_ + bad).status, 404) << bad;
    EXPECT_EQ(post(page(1), std::string(100000, 'a')).status, 413);
    EXPECT_EQ(get(home_).status, 303);
}

TEST_F(StudyPagesServed, SayWhatBrowsersMayDo) {
    const auto response = get(home_);
    EXPECT_NE(response.get_header_value("Content-Security-Policy").find("default-src 'none'"),
              std::string::npos);
    EXPECT_EQ(response.get_header_value("Referrer-Policy"), "no-referrer");
    EXPECT_EQ(response.get_header_value("Cache-Control"), "no-store");
    EXPECT_EQ(get("/pictures/" + study_.items[0].turntable).get_header_value("Content-Type"),
              "image/webp");
    EXPECT_EQ(get("/style.css").get_header_value("Content-Type"), "text/css; charset=utf-8");
}

TEST_F(StudyPagesServed, ShareNoPort) {
    EXPECT_THROW(StudyServer(*site_, "127.0.0.1", server_->port()), ResourceError);
    EXPECT_THROW(StudyServer(*site_, "no.such.host.invalid", 0), InputError);
    EXPECT_EQ(server_address("0.0.0.0", 80).find("0.0.0.0"), std::string::npos);
    EXPECT_EQ(server_address("::1", 80), "http://[::1]:80");
}

}  // namespace
}  // namespace item3d::testing
