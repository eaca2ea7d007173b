// Helpers for the tests of networks: recorded cases and temporary folders.
#pragma once

#include "item3d/tensors/safetensors.h"
#include "tests/support/difference.h"

#include <ATen/Parallel.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace item3d::testing {

/// Returns the number of threads of the tests: one, because the networks are too small for more, or
/// the value of ITEM3D_TEST_THREADS, which scripts/test_matrix.sh sets.
inline int test_threads() {
    const char* wanted = std::getenv("ITEM3D_TEST_THREADS");
    return wanted ? std::max(1, std::atoi(wanted)) : 1;
}
inline const bool threads_are_set = [] {
    at::set_num_threads(test_threads());
    return true;
}();

inline std::filesystem::path fixture(const std::string& name) {
    return std::filesystem::path(ITEM3D_TEST_DATA) / "models" / name;
}

/// Inputs and expected outputs of one recorded case.
class Golden {
  public:
    explicit Golden(const std::string& name)
        : io_(SafeTensors::open(fixture(name) / "io.safetensors")) {}
    at::Tensor in(const std::string& name) const { return io_.tensor("in." + name); }
    at::Tensor out(const std::string& name) const { return io_.tensor("out." + name); }
    bool has(const std::string& tensor) const { return io_.contains(tensor); }

    /// Expects `actual` to equal the tensor "out.NAME" within `tolerance`, which is relative to the
    /// largest expected value, or to 1 if that is larger.
    void expect(const std::string& name, const at::Tensor& actual, double tolerance = 2e-5) const {
        const at::Tensor wanted = out(name).to(at::kDouble);
        ASSERT_EQ(actual.sizes(), wanted.sizes()) << name;
        const double error = (actual.detach().to(at::kDouble) - wanted).abs().max().item<double>();
        EXPECT_LE(error, tolerance * std::max(1.0, wanted.abs().max().item<double>()))
            << name << ": " << difference(actual, wanted);
    }

  private:
    SafeTensors io_;
};

/// Temporary folder of one test, removed on destruction.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        static int count = 0;
        path_ = std::filesystem::temp_directory_path() /
                ("item3d-models-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

/// Returns the process's resident memory in bytes.
inline std::int64_t resident_bytes() {
    std::ifstream file("/proc/self/statm");
    std::int64_t size = 0, pages = 0;
    file >> size >> pages;
    return pages * ::sysconf(_SC_PAGESIZE);
}

inline void write_file(const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

/// Returns the message of the Error that `action` throws; fails the test if it throws none.
template <typename Failure, typename Action>
std::string message_of(const Action& action) {
    try {
        action();
    } catch (const Failure& failure) {
        return failure.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return "";
}

inline double largest_difference(const at::Tensor& a, const at::Tensor& b) {
    return (a.to(at::kDouble) - b.to(at::kDouble)).abs().max().item<double>();
}

}  // namespace item3d::testing
