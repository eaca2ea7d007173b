// Helpers for multi-process tests. The test program starts itself again, once for each process.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace item3d::testing {

/// Sets an environment variable, or unsets it (nullopt), during the lifetime of the object.
class ScopedVariable {
  public:
    ScopedVariable(std::string name, const std::optional<std::string>& value)
        : name_(std::move(name)) {
        if (const char* before = std::getenv(name_.c_str())) before_ = before;
        set(value);
    }
    ~ScopedVariable() { set(before_); }
    ScopedVariable(const ScopedVariable&) = delete;
    ScopedVariable& operator=(const ScopedVariable&) = delete;

  private:
    void set(const std::optional<std::string>& value) const {
        if (value)
            ::setenv(name_.c_str(), value->c_str(), 1);
        else
            ::unsetenv(name_.c_str());
    }
    std::string name_;
    std::optional<std::string> before_;
};

/// Returns a free TCP port of this machine; another process could still take it.
inline int free_port() {
    const int listener = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* where = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(listener, where, size), 0);
    EXPECT_EQ(::getsockname(listener, where, &size), 0);
    ::close(listener);
    return ntohs(address.sin_port);
}

/// Returns true in a process that run_as_processes() started.
inline bool is_process() {
    return std::getenv("ITEM3D_TEST_FOLDER") != nullptr;
}
inline std::filesystem::path process_folder() {
    return std::getenv("ITEM3D_TEST_FOLDER");
}

struct ProcessResult {
    int code = -1;  ///< 124 on timeout after a minute
    std::string output;
};

/// Runs the current test again in `count` processes. RANK, WORLD_SIZE, MASTER_ADDR and MASTER_PORT
/// are set in each. `folder` is created, and process_folder() returns it in each process.
inline std::vector<ProcessResult> run_as_processes(const std::filesystem::path& folder,
                                                   int count = 2) {
    std::filesystem::create_directories(folder);
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    const std::string filter = std::string(test->test_suite_name()) + "." + test->name();
    const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
    const std::string port = std::to_string(free_port());
    const auto base = [&](int rank) {
        return (folder / ("process" + std::to_string(rank))).string();
    };
    std::string command;
    for (int rank = 0; rank < count; ++rank)
        command += "(RANK=" + std::to_string(rank) + " WORLD_SIZE=" + std::to_string(count) +
                   " MASTER_ADDR=localhost MASTER_PORT=" + port + " ITEM3D_TEST_FOLDER='" +
                   folder.string() + "' timeout 60 '" + program + "' --gtest_filter=" + filter +
                   " >'" + base(rank) + ".out' 2>&1; echo $? >'" + base(rank) + ".code') & ";
    EXPECT_EQ(std::system((command + "wait").c_str()), 0);
    std::vector<ProcessResult> results(static_cast<std::size_t>(count));
    for (int rank = 0; rank < count; ++rank) {
        ProcessResult& result = results[static_cast<std::size_t>(rank)];
        std::ifstream(base(rank) + ".code") >> result.code;
        std::ostringstream text;
        text << std::ifstream(base(rank) + ".out").rdbuf();
        result.output = text.str();
    }
    return results;
}

}  // namespace item3d::testing
