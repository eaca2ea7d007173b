// Tests of the names of priors, of finding a prior by its name, and of checksums.
#include "item3d/core/error.h"
#include "item3d/hub/cache.h"
#include "item3d/hub/find_prior.h"
#include "tests/support/hub_server.h"

#include <cstdlib>

namespace item3d::testing {
namespace {

const std::string commit = FakeHub::commit;

TEST(HubDigest, KnownValues) {
    EXPECT_EQ(digest_of("abc", DigestKind::sha256),
              "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    // The value is that of git hash-object for an empty file.
    EXPECT_EQ(digest_of("", DigestKind::git_blob), "e69de29bb2d1d6434b8b29ae775ad8c2e48c5391");
    EXPECT_EQ(digest_of("abc", DigestKind::none), "");
    EXPECT_EQ(digest_kind(std::string(64, 'a')), DigestKind::sha256);
    EXPECT_EQ(digest_kind(std::string(40, '9')), DigestKind::git_blob);
    EXPECT_EQ(digest_kind(std::string(40, 'g')), DigestKind::none);
}

TEST(HubNames, OrganisationNameAndRevision) {
    const auto plain = RepositoryName::parse("some-one/model_2.1");
    ASSERT_TRUE(plain);
    EXPECT_EQ(plain->name, "some-one/model_2.1");
    EXPECT_EQ(plain->revision_or_main(), "main");
    const auto tagged = RepositoryName::parse("someone/model@refs/pr/3");
    ASSERT_TRUE(tagged);
    EXPECT_EQ(tagged->name, "someone/model");
    EXPECT_EQ(tagged->revision, "refs/pr/3");
    for (const char* text : {"", "model", "/model", "someone/", "a/b/c", "../b", "a/..", "./b",
                             "a/b@", "a/b@../c", "a b/c", "a--b/c", "-a/b", "a/b.", "a/b@/c"})
        EXPECT_FALSE(RepositoryName::parse(text)) << text;
}

TEST(HubNames, PathsThatStayInside) {
    for (const char* path : {"a", "a/b.json", "..a/b", "a/...b"})
        EXPECT_TRUE(stays_inside(path)) << path;
    for (const char* path : {"", "/a", "..", "../a", "a/..", "a/../b", "a//b", "a/", "./a", "a\\b"})
        EXPECT_FALSE(stays_inside(path)) << path;
    EXPECT_FALSE(stays_inside(std::string("a\0b", 3)));
}

/// Fixture: environment variables that hold for one test.
class HubFolders : public ::testing::Test {
  protected:
    void SetUp() override {
        for (const char* name : names) {
            const char* value = std::getenv(name);
            before_.emplace_back(value ? value : "");
            ::unsetenv(name);
        }
        set("HOME", folder.path / "home");
    }
    void TearDown() override {
        for (std::size_t i = 0; i < before_.size(); ++i)
            before_[i].empty() ? ::unsetenv(names[i]) : ::setenv(names[i], before_[i].c_str(), 1);
    }
    static void set(const char* name, const fs::path& value) { ::setenv(name, value.c_str(), 1); }

    /// Makes a snapshot with one file in huggingface_hub's layout.
    fs::path make_cached(const std::string& name) {
        const fs::path repository = hub_cache_folder() / name;
        for (const char* part : {"blobs", "refs", "snapshots"})
            fs::create_directories(repository / part);
        fs::create_directories(repository / "snapshots" / commit);
        std::ofstream(repository / "blobs" / "tag") << "{}";
        std::ofstream(repository / "refs" / "main") << commit;
        fs::create_symlink("../../blobs/tag",
                           repository / "snapshots" / commit / "model_index.json");
        return repository;
    }

    static constexpr const char* names[] = {"HOME",          "HF_HOME",      "HF_HUB_CACHE",
                                            "HF_TOKEN",      "HF_ENDPOINT",  "XDG_CACHE_HOME",
                                            "XDG_DATA_HOME", "ITEM3D_ASSETS"};
    Folder folder;

  private:
    std::vector<std::string> before_;
};

TEST_F(HubFolders, TheCacheIsWhereHuggingfaceHubHasIt) {
    const fs::path home = folder.path / "home";
    EXPECT_EQ(hub_cache_folder(), home / ".cache/huggingface/hub");
    set("XDG_CACHE_HOME", "/xdg");
    EXPECT_EQ(hub_cache_folder(), "/xdg/huggingface/hub");
    set("HF_HOME", "~/hf");
    EXPECT_EQ(hub_cache_folder(), home / "hf/hub");
    set("HF_HUB_CACHE", "/elsewhere");
    EXPECT_EQ(hub_cache_folder(), "/elsewhere");
    EXPECT_EQ(hub_home_folder(), home / "hf");
}

TEST_F(HubFolders, RequestsTakeTokenAndEndpointFromTheEnvironment) {
    EXPECT_EQ(PullRequest::from_environment().endpoint, "https://huggingface.co");
    EXPECT_EQ(PullRequest::from_environment().token, "");
    fs::create_directories(hub_home_folder());
    std::ofstream(hub_home_folder() / "token") << "hf_stored\n";
    EXPECT_EQ(PullRequest::from_environment().token, "hf_stored");
    set("HF_TOKEN", "hf_set");
    set("HF_ENDPOINT", "https://mirror.example/");
    EXPECT_EQ(PullRequest::from_environment().token, "hf_set");
    EXPECT_EQ(PullRequest::from_environment().endpoint, "https://mirror.example");
}

TEST_F(HubFolders, FindsPriorsByEachKindOfName) {
    set("ITEM3D_ASSETS", "/assets");
    EXPECT_EQ(find_prior(""), "/assets/prior");
    EXPECT_EQ(find_prior("embedded"), "/assets/prior");
    EXPECT_EQ(find_prior(folder.path.string()), folder.path);
    EXPECT_EQ(find_in_prior(folder.path, "clip"), "");

    const fs::path installed = installed_priors_folder() / "mine";
    EXPECT_EQ(installed, folder.path / "home/.local/share/item3d/priors/mine");
    fs::create_directories(installed);
    EXPECT_EQ(find_prior("mine"), installed);
    set("XDG_DATA_HOME", folder.path / "data");
    fs::create_directories(folder.path / "data/item3d/priors/other");
    EXPECT_EQ(find_prior("other"), folder.path / "data/item3d/priors/other");

    const fs::path repository = make_cached("models--someone--model");
    const fs::path snapshot = repository / "snapshots" / commit;
    EXPECT_EQ(find_prior("someone/model"), snapshot);
    EXPECT_EQ(find_prior("someone/model@main"), snapshot);
    EXPECT_EQ(find_prior("someone/model@" + commit), snapshot);
}

TEST_F(HubFolders, FindsTheNetworksThatAPriorBrings) {
    EXPECT_EQ(find_in_prior(folder.path, "clip"), "");
    fs::create_directories(folder.path / "clip");
    EXPECT_EQ(find_in_prior(folder.path, "clip"), "");
    std::ofstream(folder.path / "clip/config.json") << "{}";
    EXPECT_EQ(find_in_prior(folder.path, "clip"), folder.path / "clip");
}

TEST_F(HubFolders, WhatIsNotThereIsSaidWithWhatToTry) {
    const auto message = [](const std::string& name) {
        return error_of<InputError>([&] { find_prior(name); });
    };
    EXPECT_NE(message("nobody").find(installed_priors_folder().string()), std::string::npos);
    EXPECT_NE(message("/nowhere/at/all").find("no such folder"), std::string::npos);
    EXPECT_NE(message("../priors").find("no such folder"), std::string::npos);
    const std::string text = message("someone/model@v1");
    EXPECT_NE(text.find(hub_cache_folder().string()), std::string::npos) << text;
    EXPECT_NE(text.find("item3d prior pull someone/model@v1"), std::string::npos) << text;

    const fs::path repository = make_cached("models--someone--model");
    EXPECT_NE(message("someone/model@v1").find("refs/v1"), std::string::npos);
    EXPECT_NE(message("someone/model@v1").find("--revision v1"), std::string::npos);
    EXPECT_NE(message("someone/model@" + std::string(40, 'f')).find("no such snapshot"),
              std::string::npos);
    fs::remove(repository / "blobs" / "tag");
    EXPECT_NE(message("someone/model").find("model_index.json: links to a file that does not"),
              std::string::npos);
    std::ofstream(repository / "refs" / "main") << "../../..";
    EXPECT_NE(message("someone/model").find("expected a commit"), std::string::npos);
    fs::remove(repository / "refs" / "main");
    EXPECT_NE(message("someone/model").find("refs/main: is missing"), std::string::npos);
}

}  // namespace
}  // namespace item3d::testing
