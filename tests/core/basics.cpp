// Tests of errors, colours, loops and durations.
#include "item3d/core/error.h"
#include "item3d/core/math.h"
#include "item3d/core/parallel.h"
#include "item3d/core/progress.h"
#include "item3d/core/words.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace item3d {
namespace {

TEST(Error, EachKindHasItsExitCode) {
    EXPECT_EQ(InputError("a", "b").code(), ExitCode::bad_input);
    EXPECT_EQ(UsageError("a").code(), ExitCode::usage);
    EXPECT_EQ(ResourceError("a").code(), ExitCode::no_resource);
    EXPECT_EQ(Interrupted("a").code(), ExitCode::interrupted);
    EXPECT_EQ(static_cast<int>(ExitCode::bad_input), 3);
    EXPECT_EQ(static_cast<int>(ExitCode::interrupted), 130);
}

TEST(Error, InputErrorReadsSubjectProblemHint) {
    EXPECT_STREQ(InputError("a.glb", "is empty", "export it again").what(),
                 "a.glb: is empty; export it again");
    EXPECT_STREQ(InputError("a.glb", "is empty").what(), "a.glb: is empty");
}

TEST(Error, CheckThrowsWithExpressionAndDetail) {
    const int size = 3;
    EXPECT_NO_THROW(ITEM3D_CHECK(size == 3, "unused"));
    try {
        ITEM3D_CHECK(size == 4, "size " + std::to_string(size));
        FAIL() << "the check passed";
    } catch (const std::logic_error& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("size == 4"), std::string::npos) << message;
        EXPECT_NE(message.find("size 3"), std::string::npos) << message;
        EXPECT_NE(message.find("basics.cpp:"), std::string::npos) << message;
    }
}

TEST(Colour, TransferFunctionsAreInverseAndKnown) {
    EXPECT_NEAR(srgb_to_linear(0.5f), 0.21404f, 1e-5f);
    EXPECT_NEAR(linear_to_srgb(0.18f), 0.46136f, 1e-5f);
    EXPECT_FLOAT_EQ(srgb_to_linear(0.0f), 0.0f);
    EXPECT_NEAR(srgb_to_linear(1.0f), 1.0f, 1e-6f);
    for (int i = 0; i <= 255; ++i) {
        const float value = static_cast<float>(i) / 255.0f;
        EXPECT_NEAR(linear_to_srgb(srgb_to_linear(value)), value, 2e-6f);
    }
}

class ParallelFor : public ::testing::TestWithParam<int> {};

TEST_P(ParallelFor, VisitsEachIndexOnce) {
    const int threads_before = omp_get_max_threads();
    omp_set_num_threads(GetParam());
    for (const std::int64_t count : {0, 1, 255, 256, 257, 10'001}) {
        for (const std::int64_t grain : {1, 7, 256}) {
            std::vector<std::atomic<int>> visits(static_cast<std::size_t>(count));
            parallel_for(
                "test", count, [&](std::int64_t i) { ++visits[static_cast<std::size_t>(i)]; },
                grain);
            for (const auto& visit : visits)
                ASSERT_EQ(visit.load(), 1);
        }
    }
    omp_set_num_threads(threads_before);
}

INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, ::testing::Values(1, 2, 5));

TEST(ParallelFor, NestedLoopsRunOnTheThreadThatCallsThem) {
    std::vector<std::atomic<int>> visits(600 * 600);
    parallel_for("outer", 600, [&](std::int64_t i) {
        parallel_for("inner", 600,
                     [&](std::int64_t j) { ++visits[static_cast<std::size_t>(i * 600 + j)]; });
    });
    for (const auto& visit : visits)
        ASSERT_EQ(visit.load(), 1);
}

#if defined(__SANITIZE_THREAD__)
TEST(ParallelForDeathTest, SanitizerFindsBlocksThatWriteTheSameValue) {
    constexpr int exit_code_of_reports = 66;
    const auto race = [] {
        omp_set_num_threads(2);
        double sum = 0;
        parallel_for("race", 1024, [&](std::int64_t i) { sum += static_cast<double>(i); });
        std::exit(sum > 0 ? 0 : 1);
    };
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(race(), ::testing::ExitedWithCode(exit_code_of_reports), "data race");
}
#endif

TEST(Words, AreRunsOfLettersAndOfDigits) {
    EXPECT_EQ(prompt_words("A 3d-render!"), (std::vector<std::string>{"a", "3", "d", "render"}));
    EXPECT_TRUE(prompt_words(" .,").empty());
}

/// Exits with 0 if a signal sets the interrupted state, or if it was ignored and does not set it.
void expect_interrupted_by(int signal, bool ignored) {
    std::signal(signal, ignored ? SIG_IGN : SIG_DFL);
    install_interrupt_handler();
    std::raise(signal);
    std::_Exit(interrupted() == ignored ? 1 : 0);
}

TEST(Interrupt, ASignalIsAWishToStop) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
        EXPECT_EXIT(expect_interrupted_by(signal, false), ::testing::ExitedWithCode(0), "");
    // nohup makes a program ignore SIGHUP.
    EXPECT_EXIT(expect_interrupted_by(SIGHUP, true), ::testing::ExitedWithCode(0), "");
}

TEST(Progress, DurationsAreRoundedBeforeTheyAreSplit) {
    EXPECT_EQ(format_duration(0), "0 s");
    EXPECT_EQ(format_duration(2.6), "3 s");
    EXPECT_EQ(format_duration(59.4), "59 s");
    EXPECT_EQ(format_duration(59.6), "1 min 00 s");
    EXPECT_EQ(format_duration(125), "2 min 05 s");
    EXPECT_EQ(format_duration(3599.7), "1 h 00 min");
    EXPECT_EQ(format_duration(4200), "1 h 10 min");
}

TEST(CollectedWarnings, LiveAndEndInAnyOrder) {
    auto first = std::make_unique<CollectedWarnings>();
    CollectedWarnings second;
    warn("one");
    warn("one");
    EXPECT_EQ(first->lines(), std::vector<std::string>{"one"});
    first.reset();
    warn("two");
    EXPECT_EQ(second.lines(), (std::vector<std::string>{"one", "two"}));
}

TEST(Progress, SpeaksOnStderrAloneAndNotWhenQuiet) {
    ::testing::internal::CaptureStderr();
    ::testing::internal::CaptureStdout();
    set_verbosity(Verbosity::normal);
    note("a note");
    {
        Progress progress("edit", 10);
        progress.update(10, "loss 0.1");
    }
    const std::string loud = ::testing::internal::GetCapturedStderr();
    EXPECT_NE(loud.find("a note"), std::string::npos);
    EXPECT_NE(loud.find("10/10"), std::string::npos) << loud;
    EXPECT_NE(loud.find("loss 0.1"), std::string::npos) << loud;

    ::testing::internal::CaptureStderr();
    set_verbosity(Verbosity::quiet);
    note("a note");
    {
        Progress progress("edit", 10);
        progress.update(10);
    }
    warn("still said");
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "warning: still said\n");
    set_verbosity(Verbosity::normal);
    EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace item3d
