// Tests of server-sent events: replay, replaced events, and events of an earlier server.
#include "item3d/studio/events.h"

#include <gtest/gtest.h>

#include <thread>

namespace item3d::testing {
namespace {

constexpr auto no_time = std::chrono::milliseconds(1);

TEST(StudioEvents, AreSentAgainToThoseWhoMissedThem) {
    StudioEvents events;
    std::int64_t first = events.last(), second = first;
    events.send("result", {{"id", 1}});
    const std::string text = events.wait(first, no_time);
    EXPECT_NE(text.find("event: result\ndata: {\"id\":1}\n\n"), std::string::npos) << text;
    EXPECT_EQ(text.find("id: " + std::to_string(first)), 0u);
    EXPECT_EQ(events.wait(first, no_time).front(), ':') << "nothing new: a comment";
    EXPECT_EQ(events.wait(second, no_time), text);
}

TEST(StudioEvents, KeepTheLastOfEachKey) {
    StudioEvents events;
    std::int64_t after = events.last();
    events.send("result", {{"done", 1}}, "result 1");
    events.send("result", {{"done", 5}}, "result 2");
    events.send("result", {{"done", 2}}, "result 1");
    const std::string text = events.wait(after, no_time);
    EXPECT_EQ(text.find("{\"done\":1}"), std::string::npos);
    EXPECT_LT(text.find("{\"done\":5}"), text.find("{\"done\":2}"));
}

TEST(StudioEvents, SayWhenSomeWereLost) {
    StudioEvents events;
    std::int64_t old = 7;  // id of an earlier server's event
    EXPECT_NE(events.wait(old, no_time).find("event: reset"), std::string::npos);
    EXPECT_EQ(old, events.last());
    std::int64_t behind = events.last();
    for (int i = 0; i < 1500; ++i)
        events.send("result", i);
    EXPECT_NE(events.wait(behind, no_time).find("event: reset"), std::string::npos);
}

TEST(StudioEvents, WakeThoseWhoWait) {
    StudioEvents events;
    std::int64_t after = events.last();
    std::thread sender([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        events.send("project", {});
    });
    EXPECT_NE(events.wait(after, std::chrono::seconds(20)).find("event: project"),
              std::string::npos);
    sender.join();
    events.close();
    EXPECT_EQ(events.wait(after, std::chrono::seconds(20)).front(), ':') << "at once";
}

}  // namespace
}  // namespace item3d::testing
