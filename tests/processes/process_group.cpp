// Tests of the environment variables that describe a process group.
#include "item3d/processes/process_group.h"

#include "item3d/core/error.h"
#include "item3d/processes/local_device.h"
#include "tests/support/processes.h"

#include <gtest/gtest.h>

#include <functional>
#include <list>
#include <optional>

namespace item3d {
namespace {

using testing::ScopedVariable;

/// Returns the message of the InputError, or a text that says what happened instead.
std::string input_error(const std::function<void()>& function) {
    try {
        function();
    } catch (const InputError& error) {
        return error.what();
    } catch (const std::exception& error) {
        return std::string("not an InputError: ") + error.what();
    }
    return "nothing was thrown";
}

using Variables = std::vector<std::pair<const char*, const char*>>;

/// Returns the group that an environment with only these variables describes.
ProcessGroup group_of(const Variables& variables) {
    std::list<ScopedVariable> set;
    for (const char* name : {"RANK", "WORLD_SIZE", "MASTER_ADDR", "MASTER_PORT"})
        set.emplace_back(name, std::nullopt);
    for (const auto& [name, value] : variables)
        set.emplace_back(name, value);
    return ProcessGroup::from_environment(std::chrono::seconds(1));
}

TEST(ProcessGroup, WithoutVariablesThereIsOne) {
    for (const Variables& alone : {Variables{}, Variables{{"WORLD_SIZE", "1"}},
                                   Variables{{"RANK", "0"}, {"WORLD_SIZE", "1"}}}) {
        const ProcessGroup group = group_of(alone);
        EXPECT_EQ(group.size(), 1);
        EXPECT_TRUE(group.first());
        at::Tensor ones = at::ones({3});
        group.sum(ones);
        group.barrier();
        group.wait_for_first();
        EXPECT_TRUE(at::equal(ones, at::ones({3})));
        EXPECT_EQ(group.broadcast("text"), "text");
    }
}

TEST(ProcessGroup, AnEnvironmentThatCannotBeIsAnInputError) {
    const auto expect = [](const Variables& variables, const std::string& subject,
                           const std::string& problem) {
        const std::string message = input_error([&] { group_of(variables); });
        EXPECT_EQ(message.find(subject + ": "), 0u) << message;
        EXPECT_NE(message.find(problem), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    };
    expect({{"RANK", "0"}}, "WORLD_SIZE", "not set");
    expect({{"WORLD_SIZE", "2"}}, "RANK", "not set");
    expect({{"WORLD_SIZE", "two"}, {"RANK", "0"}}, "WORLD_SIZE", "found 'two'");
    expect({{"WORLD_SIZE", "0"}, {"RANK", "0"}}, "WORLD_SIZE", "found '0'");
    expect({{"WORLD_SIZE", "2"}, {"RANK", "2"}}, "RANK", "from 0 to 1, found '2'");
    expect({{"WORLD_SIZE", "2"}, {"RANK", "-1"}}, "RANK", "found '-1'");
    expect({{"WORLD_SIZE", "1"}, {"RANK", "1"}}, "RANK", "from 0 to 0, found '1'");
    expect({{"WORLD_SIZE", "2"}, {"RANK", "0"}}, "MASTER_ADDR", "not set");
    expect({{"WORLD_SIZE", "2"}, {"RANK", "0"}, {"MASTER_ADDR", "localhost"}}, "MASTER_PORT",
           "not set");
    const auto at = [](const char* rank, const std::string& port) {
        return Variables{{"WORLD_SIZE", "2"},
                         {"RANK", rank},
                         {"MASTER_ADDR", "localhost"},
                         {"MASTER_PORT", port.c_str()}};
    };
    expect(at("0", "70000"), "MASTER_PORT", "found '70000'");
    expect(at("0", "29500x"), "MASTER_PORT", "found '29500x'");
    // Process 1 finds no listener, and process 0 waits for a process that does not join.
    const std::string port = std::to_string(testing::free_port());
    const std::string where = "MASTER_ADDR=localhost MASTER_PORT=" + port;
    expect(at("1", port), where, "cannot join");
    expect(at("0", port), where, "only 1 of 2 processes joined within 1 s");
}

TEST(LocalDevice, ProcessesOfAMachineTakeItsDevicesInTurn) {
    EXPECT_EQ(own_device(0, "", 2), "0");
    EXPECT_EQ(own_device(3, "", 2), "1");
    EXPECT_EQ(own_device(1, "4,6", 8), "6");
    EXPECT_EQ(own_device(2, "GPU-5a", 8), "GPU-5a");
    EXPECT_EQ(own_device(1, "", 0), "");
}

TEST(ProcessGroup, SharesDifferByOneRowAtMost) {
    const Share all = ProcessGroup().share(7);
    EXPECT_EQ(all.first, 0);
    EXPECT_EQ(all.count, 7);
    std::int64_t next = 0;
    for (int rank = 0; rank < 3; ++rank) {
        const Share part = share_of(rank, 3, 7);
        EXPECT_EQ(part.first, next);
        EXPECT_TRUE(part.count == 2 || part.count == 3) << part.count;
        next = part.end();
    }
    EXPECT_EQ(next, 7);
}

}  // namespace
}  // namespace item3d
