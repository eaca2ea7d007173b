// Tests of atomic files, and of errors with the right exit code.
#include "item3d/core/files.h"

#include "item3d/core/error.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace item3d {
namespace {

namespace fs = std::filesystem;

class Files : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("item3d_files_" + std::to_string(::getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::size_t file_count() const {
        std::size_t count = 0;
        for (const auto& entry : fs::directory_iterator(folder_))
            count += entry.exists() ? 1 : 0;
        return count;
    }

    fs::path folder_;
};

template <typename F>
std::string message_of(ExitCode expected, const F& f) {
    try {
        f();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), expected) << error.what();
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return "";
}

/// Limit of file sizes in this process. Beyond `bytes`, write(2) fails with EFBIG, as it fails with
/// ENOSPC on a full disk.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) {
        std::signal(SIGXFSZ, SIG_IGN);
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, SIG_DFL);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

  private:
    rlimit before_{};
};

TEST_F(Files, WrittenBytesAreReadBack) {
    Bytes bytes(100'000);
    for (std::size_t i = 0; i < bytes.size(); ++i)
        bytes[i] = static_cast<std::uint8_t>(i * 31);
    write_atomically(folder_ / "a.bin", bytes);
    EXPECT_EQ(read_bytes(folder_ / "a.bin"), bytes);
    write_atomically(folder_ / "a.bin", std::string_view("short"));
    EXPECT_EQ(read_text(folder_ / "a.bin"), "short");
    EXPECT_EQ(file_count(), 1u);
}

TEST_F(Files, EmptyFilesAreFiles) {
    write_atomically(folder_ / "empty", std::string_view());
    EXPECT_TRUE(read_bytes(folder_ / "empty").empty());
}

TEST_F(Files, WriterGetsTheExtensionOfThePath) {
    write_atomically(folder_ / "picture.png", [&](const fs::path& temporary) {
        EXPECT_EQ(temporary.extension(), ".png");
        EXPECT_EQ(temporary.parent_path(), folder_);
        EXPECT_NE(temporary, folder_ / "picture.png");
        std::ofstream(temporary) << "png";
    });
    EXPECT_EQ(read_text(folder_ / "picture.png"), "png");
}

TEST_F(Files, OldFileStaysWhenTheWriterFails) {
    write_atomically(folder_ / "model.glb", std::string_view("old"));
    EXPECT_THROW(write_atomically(folder_ / "model.glb",
                                  [](const fs::path& temporary) {
                                      std::ofstream(temporary) << "half of the ne";
                                      throw InputError("x", "broke off");
                                  }),
                 InputError);
    EXPECT_EQ(read_text(folder_ / "model.glb"), "old");
    EXPECT_EQ(file_count(), 1u);
}

TEST_F(Files, FullDiskIsAResourceErrorAndLeavesTheOldFile) {
    write_atomically(folder_ / "model.glb", std::string_view("old"));
    const Bytes large(1 << 20);
    std::string message;
    {
        const FileSizeLimit limit(64 << 10);
        message = message_of(ExitCode::no_resource,
                             [&] { write_atomically(folder_ / "model.glb", large); });
    }
    EXPECT_NE(message.find("free some space"), std::string::npos) << message;
    EXPECT_EQ(read_text(folder_ / "model.glb"), "old");
    EXPECT_EQ(file_count(), 1u);
}

TEST_F(Files, MissingFileIsNamed) {
    const std::string message =
        message_of(ExitCode::bad_input, [&] { read_bytes(folder_ / "nowhere.glb"); });
    EXPECT_NE(message.find("nowhere.glb"), std::string::npos) << message;
    message_of(ExitCode::bad_input, [&] { read_bytes(folder_); });
}

TEST_F(Files, UnwritableFolderIsABadInput) {
    message_of(ExitCode::bad_input,
               [&] { write_atomically(folder_ / "no_such_folder" / "a", std::string_view("x")); });
    // A file stands where a folder must be made. Unlike missing permissions, this fails for root
    // too.
    write_atomically(folder_ / "file", std::string_view("x"));
    message_of(ExitCode::bad_input, [&] { make_output_folder(folder_ / "file"); });
    message_of(ExitCode::bad_input, [&] { make_output_folder(folder_ / "file" / "below"); });
    message_of(ExitCode::bad_input, [] { make_output_folder("/proc/item3d"); });
    if (::geteuid() != 0) {
        fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec);
        message_of(ExitCode::bad_input, [&] { make_output_folder(folder_); });
        fs::permissions(folder_, fs::perms::owner_all);
    }
}

TEST_F(Files, OutputFolderIsMadeWithItsParentsAndLeftEmpty) {
    make_output_folder(folder_ / "a" / "b");
    EXPECT_TRUE(fs::is_empty(folder_ / "a" / "b"));
    make_output_folder(folder_ / "a" / "b");
}

TEST_F(Files, AssetsFolderFollowsTheEnvironment) {
    const char* before = std::getenv("ITEM3D_ASSETS");
    const std::string saved = before ? before : "";
    ::setenv("ITEM3D_ASSETS", folder_.c_str(), 1);
    EXPECT_EQ(assets_folder(), folder_);
    if (before) {
        ::setenv("ITEM3D_ASSETS", saved.c_str(), 1);
    } else {
        ::unsetenv("ITEM3D_ASSETS");
    }
}

}  // namespace
}  // namespace item3d
