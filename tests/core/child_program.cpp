// Tests of child processes.
#include "item3d/core/child_program.h"

#include "item3d/core/interrupt.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <optional>
#include <thread>

namespace item3d {
namespace {

/// Returns the signal that ended the child; 0 if it still runs after ten seconds.
int signal_of_end(ChildProgram& child) {
    using std::chrono::steady_clock;
    const auto end = steady_clock::now() + std::chrono::seconds(10);
    while (steady_clock::now() < end) {
        if (const std::optional<int> status = child.status())
            return WIFSIGNALED(*status) ? WTERMSIG(*status) : -1;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return 0;
}

// This program handles SIGTERM. A child that is asked to end before it has become its own program
// must not handle the request as this program does.
TEST(ChildProgram, EndsOnARequestRightAfterItsStart) {
    install_interrupt_handler();
    constexpr int times = 100;
    for (int i = 0; i < times; ++i) {
        ChildProgram child({"/bin/sleep", "60"}, "/dev/null");
        child.ask_to_end();
        ASSERT_EQ(signal_of_end(child), SIGTERM) << i;
    }
}

TEST(ChildProgram, KeepsSignalsThatThisProgramIgnores) {
    const auto before = std::signal(SIGTERM, SIG_IGN);
    ChildProgram child({"/bin/sleep", "0.2"}, "/dev/null");
    child.ask_to_end();
    EXPECT_EQ(signal_of_end(child), -1);
    std::signal(SIGTERM, before);
}

}  // namespace
}  // namespace item3d
