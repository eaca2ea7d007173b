#include "item3d/core/error.h"
#include "item3d/hub/cache.h"
#include "tests/support/hub_server.h"

#include <sys/resource.h>

#include <csignal>

namespace item3d::testing {
namespace {

constexpr const char* model_index = R"({
    "_class_name": "StableDiffusionPipeline",
    "safety_checker": ["stable_diffusion", "StableDiffusionSafetyChecker"],
    "scheduler": ["diffusers", "DDIMScheduler"],
    "text_encoder": ["transformers", "CLIPTextModel"],
    "text_encoder_2": [null, null],
    "tokenizer": ["transformers", "CLIPTokenizer"],
    "unet": ["diffusers", "UNet2DConditionModel"],
    "vae": ["diffusers", "AutoencoderKL"]})";

const std::string unet = "unet/diffusion_pytorch_model.safetensors";

class HubPull : public ::testing::Test {
  protected:
    void SetUp() override {
        hub.add("model_index.json", model_index);
        for (const char* path :
             {"unet/config.json", "vae/config.json", "text_encoder/config.json",
              "scheduler/scheduler_config.json", "tokenizer/merges.txt", "tokenizer/vocab.json"})
            hub.add(path, std::string("{\"of\": \"") + path + "\"}");
        hub.add_large(unet, noise_bytes(700'001, 1));
        hub.add_large("vae/diffusion_pytorch_model.safetensors", noise_bytes(50'000, 2));
        hub.add_large("text_encoder/model.safetensors", noise_bytes(60'000, 3));
        // These files are not needed.
        for (const char* path :
             {"README.md", "v1-5-pruned.safetensors", "unet/diffusion_pytorch_model.bin",
              "unet/diffusion_pytorch_model.bin.index.json", "unet/model.onnx",
              "unet/flax_model.msgpack", "unet/openvino/config.json",
              "safety_checker/model.safetensors", "safety_checker/config.json"})
            hub.add_large(path, "not needed");
        request.repository = FakeHub::repository;
        request.endpoint = hub.url();
        request.cache = folder.path / "cache";
        request.retry = {4, 0.001};
    }

    CachedRepository cached() const { return {request.cache, request.repository}; }
    /// Checks that no incomplete file has a final name and that there is no snapshot.
    void expect_no_snapshot() const {
        EXPECT_FALSE(fs::exists(cached().folder() / "refs"));
        EXPECT_FALSE(fs::exists(cached().folder() / "snapshots"));
    }
    void expect_whole(const std::string& path) {
        EXPECT_EQ(digest_of(file_text(cached().snapshot(FakeHub::commit) / path),
                            digest_kind(hub.etag(path))),
                  hub.etag(path))
            << path;
    }
    template <typename Failure>
    void expect_failure(const std::string& part) {
        const std::string message = error_of<Failure>([&] { pull(request); });
        EXPECT_NE(message.find(part), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }

    FakeHub hub;
    Folder folder;
    PullRequest request;
};

TEST_F(HubPull, BringsWhatIsNeededAndNothingElse) {
    const PullResult result = pull(request);
    EXPECT_EQ(result.commit, FakeHub::commit);
    const std::set<std::string> files(result.files.begin(), result.files.end());
    const std::set<std::string> wanted{"model_index.json",
                                       "unet/config.json",
                                       "vae/config.json",
                                       "text_encoder/config.json",
                                       "scheduler/scheduler_config.json",
                                       "tokenizer/merges.txt",
                                       "tokenizer/vocab.json",
                                       unet,
                                       "vae/diffusion_pytorch_model.safetensors",
                                       "text_encoder/model.safetensors"};
    EXPECT_EQ(files, wanted);
    EXPECT_EQ(result.bytes, result.downloaded_bytes);
    for (const std::string& path : wanted) {
        const fs::path link = result.folder / path;
        ASSERT_TRUE(fs::is_symlink(link)) << path;
        EXPECT_TRUE(fs::read_symlink(link).is_relative());
        EXPECT_EQ(fs::read_symlink(link).filename(), hub.etag(path));
        expect_whole(path);
    }
    EXPECT_EQ(file_text(cached().ref("main")), FakeHub::commit);
    EXPECT_EQ(cached().find_snapshot("main"), result.folder);
    for (const auto& entry : fs::directory_iterator(cached().folder() / "blobs"))
        EXPECT_FALSE(entry.path().string().ends_with(".incomplete"));

    EXPECT_EQ(pull(request).downloaded_bytes, 0u);
    EXPECT_EQ(hub.downloads_of(unet), 1);
}

TEST_F(HubPull, BringsThePriorsOwnClipAndCaptioner) {
    for (const char* path : {"clip/config.json", "clip/preprocessor_config.json",
                             "captioner/config.json", "captioner/vocab.txt"})
        hub.add(path, "{}");
    hub.add_large("clip/model.safetensors", noise_bytes(3000, 4));
    hub.add_large("captioner/model.safetensors", noise_bytes(4000, 5));
    const auto fetched = [&](const char* path) { return fs::exists(pull(request).folder / path); };
    // Without prior.json, these files belong to another model.
    EXPECT_FALSE(fetched("clip/config.json"));
    fs::remove_all(request.cache);
    hub.add("prior.json", "{}");
    for (const char* path : {"clip/model.safetensors", "clip/preprocessor_config.json",
                             "captioner/model.safetensors", "captioner/vocab.txt"})
        EXPECT_TRUE(fetched(path)) << path;
}

TEST_F(HubPull, ACommitNeedsNoReference) {
    request.revision = FakeHub::commit;
    EXPECT_TRUE(fs::exists(pull(request).folder / "model_index.json"));
    EXPECT_FALSE(fs::exists(cached().folder() / "refs"));
}

TEST_F(HubPull, TheTokenGoesToTheHubAlone) {
    hub.token = "hf_secret";
    request.token = "hf_secret";
    pull(request);
    int with = 0;
    for (const FakeHub::Seen& seen : hub.seen()) {
        EXPECT_EQ(seen.authorization, seen.storage ? "" : "Bearer hf_secret") << seen.path;
        with += seen.storage ? 0 : 1;
    }
    EXPECT_GT(with, 0);
}

TEST_F(HubPull, TakesTheHalfSizedWeightsWhereAskedToOrWhereThereAreNoOthers) {
    hub.add_large("unet/diffusion_pytorch_model.fp16.safetensors", "half");
    hub.remove("vae/diffusion_pytorch_model.safetensors");
    hub.add_large("vae/diffusion_pytorch_model.fp16.safetensors", "half of the vae");
    const auto has = [](const PullResult& result, const std::string& path) {
        return std::find(result.files.begin(), result.files.end(), path) != result.files.end();
    };
    const PullResult full = pull(request);
    EXPECT_TRUE(has(full, unet));
    EXPECT_FALSE(has(full, "unet/diffusion_pytorch_model.fp16.safetensors"));
    EXPECT_TRUE(has(full, "vae/diffusion_pytorch_model.fp16.safetensors"));
    request.variant = "fp16";
    const PullResult half = pull(request);
    EXPECT_FALSE(has(half, unet));
    EXPECT_TRUE(has(half, "unet/diffusion_pytorch_model.fp16.safetensors"));
    EXPECT_TRUE(has(half, "text_encoder/model.safetensors"));
}

TEST_F(HubPull, AVariantThatNoPartHasIsSaid) {
    request.variant = "fp16";
    expect_failure<InputError>("has no fp16 variant");
}

TEST_F(HubPull, FollowsAnIndexToItsShards) {
    const std::string index = unet + ".index.json";
    hub.remove(unet);
    hub.add(index, R"({"weight_map": {"a": "d-1.safetensors", "b": "d-2.safetensors"}})");
    hub.add_large("unet/d-1.safetensors", noise_bytes(1000, 1));
    hub.add_large("unet/d-2.safetensors", noise_bytes(1000, 2));
    pull(request);
    expect_whole(index);
    expect_whole("unet/d-1.safetensors");
    expect_whole("unet/d-2.safetensors");
}

TEST_F(HubPull, RefusesAnIndexThatLeadsAstray) {
    const std::string index = unet + ".index.json";
    hub.remove(unet);
    hub.add(index, R"({"weight_map": {"a": "d-1.safetensors"}})");
    expect_failure<InputError>("lists the shard d-1.safetensors");
    hub.add(index, R"({"weight_map": {"a": "../vae/diffusion_pytorch_model.safetensors"}})");
    expect_failure<InputError>("is not a file next to the index");
    hub.add(index, "[]");
    expect_failure<InputError>(index);
    expect_no_snapshot();
}

TEST_F(HubPull, RefusesPickles) {
    hub.remove(unet);
    expect_failure<InputError>("unet has only pickled weights (unet/diffusion_pytorch_model.bin)");
    EXPECT_EQ(hub.downloads_of("unet/diffusion_pytorch_model.bin"), 0);
}

TEST_F(HubPull, RefusesOtherLayouts) {
    hub.remove("model_index.json");
    expect_failure<InputError>("not in the diffusers layout");
}

TEST_F(HubPull, RefusesPathsThatLeaveTheFolder) {
    for (const char* path :
         {"../outside", "unet/../../outside", "/etc/passwd", "a\\..\\b", "a//b"}) {
        hub.add(path, "x");
        expect_failure<InputError>("lists a file outside its folder");
        hub.remove(path);
    }
    expect_no_snapshot();
}

TEST_F(HubPull, GoesOnAfterCutConnections) {
    // Seven interruptions are more than the policy's four attempts, but received data resets their
    // count.
    hub.break_file(unet, {.times = 7, .cut = 100'000});
    pull(request);
    expect_whole(unet);
    std::vector<std::string> ranges;
    for (const FakeHub::Seen& seen : hub.seen())
        if (seen.storage && seen.path == unet) ranges.push_back(seen.range);
    ASSERT_EQ(ranges.size(), 8u);
    EXPECT_EQ(ranges[0], "");
    EXPECT_EQ(ranges[1], "bytes=100000-");
    EXPECT_EQ(ranges[7], "bytes=700000-");
}

TEST_F(HubPull, StartsAnewWhereTheServerKnowsNoRanges) {
    fs::create_directories(cached().folder() / "blobs");
    std::ofstream(cached().blob(hub.etag(unet) + ".incomplete")) << noise_bytes(1000, 1);
    hub.break_file(unet, {.no_ranges = true});
    pull(request);
    expect_whole(unet);
    EXPECT_EQ(hub.downloads_of(unet), 1);
}

TEST_F(HubPull, WhatAnInterruptedPullLeftIsUsed) {
    const std::string whole = noise_bytes(700'001, 1);
    fs::create_directories(cached().folder() / "blobs");
    const fs::path partial = cached().blob(hub.etag(unet) + ".incomplete");
    std::ofstream(partial, std::ios::binary) << whole.substr(0, 400'000);
    const PullResult result = pull(request);
    expect_whole(unet);
    EXPECT_EQ(result.downloaded_bytes, result.bytes - 400'000);

    // The partial file is complete but was not renamed, or it is too long.
    for (const std::string& bytes : {whole, whole + "more"}) {
        fs::remove(cached().blob(hub.etag(unet)));
        std::ofstream(partial, std::ios::binary) << bytes;
        pull(request);
        expect_whole(unet);
        EXPECT_FALSE(fs::exists(partial));
    }
}

TEST_F(HubPull, TriesAgainWhenTheServerIsUnwell) {
    hub.break_file("api", {.times = 2, .status = 503});
    hub.break_file("vae/config.json", {.times = 1, .status = 429});
    hub.break_file(unet, {.times = 2, .status = 500});
    pull(request);
    expect_whole(unet);
}

TEST_F(HubPull, GivesUpInTheEndAndKeepsWhatArrived) {
    hub.break_file(unet, {.times = 1, .cut = 300'000});
    hub.break_file(unet, {.times = 4, .status = 502});
    expect_failure<ResourceError>("tried 4 times");
    EXPECT_FALSE(fs::exists(cached().blob(hub.etag(unet))));
    EXPECT_EQ(fs::file_size(cached().blob(hub.etag(unet) + ".incomplete")), 300'000u);
    expect_no_snapshot();
    const std::size_t before = hub.seen().size();
    pull(request);
    expect_whole(unet);
    const auto seen = hub.seen();
    const auto rest = std::find_if(seen.begin() + static_cast<std::ptrdiff_t>(before), seen.end(),
                                   [](const auto& one) { return one.storage; });
    ASSERT_NE(rest, seen.end());
    EXPECT_EQ(rest->path, unet);
    EXPECT_EQ(rest->range, "bytes=300000-");
}

TEST_F(HubPull, WrongBytesAreDeleted) {
    hub.break_file(unet, {.times = 1, .wrong = true});
    expect_failure<InputError>("does not have the checksum");
    EXPECT_FALSE(fs::exists(cached().blob(hub.etag(unet))));
    EXPECT_FALSE(fs::exists(cached().blob(hub.etag(unet) + ".incomplete")));
    expect_no_snapshot();
    pull(request);
    expect_whole(unet);
}

TEST_F(HubPull, WrongBytesInSmallFilesAreFoundToo) {
    hub.break_file("model_index.json", {.times = 2, .wrong = true});  // the answers to HEAD and GET
    expect_failure<InputError>("model_index.json: does not have the checksum");
}

TEST_F(HubPull, RefusalsSayWhatToDo) {
    hub.token = "hf_secret";
    expect_failure<InputError>("set HF_TOKEN");
    request.token = "hf_other";
    expect_failure<InputError>("check that HF_TOKEN has read access");
    hub.token.clear();
    hub.break_file("api", {.times = 1, .status = 403, .error_code = "GatedRepo"});
    expect_failure<InputError>("accept its licence at");
    hub.break_file("api", {.times = 1, .status = 404});
    expect_failure<InputError>("not found");
    request.revision = "nowhere";
    expect_failure<InputError>("has no revision 'nowhere'");
    request.token = "two\nlines";
    expect_failure<InputError>("HF_TOKEN");
}

TEST_F(HubPull, AFullDiskIsForeseen) {
    hub.announce(unet, "1000000000000000000");
    expect_failure<ResourceError>("are free");
    EXPECT_EQ(hub.downloads_of(unet), 0);
    hub.announce(unet, "-1");
    expect_failure<InputError>("sent no size");
}

/// Limits the size of this process's files during the object's lifetime.
class FullDisk {
  public:
    explicit FullDisk(rlim_t bytes) : old_signal_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &old_limit_);
        const rlimit limit{bytes, old_limit_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FullDisk() {
        ::setrlimit(RLIMIT_FSIZE, &old_limit_);
        std::signal(SIGXFSZ, old_signal_);
    }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;

  private:
    void (*old_signal_)(int);
    rlimit old_limit_;
};

TEST_F(HubPull, WhatFittedOnADiskThatFilledUpIsUsed) {
    {
        const FullDisk disk(500'000);
        expect_failure<ResourceError>("free some space");
    }
    EXPECT_FALSE(fs::exists(cached().blob(hub.etag(unet))));
    EXPECT_EQ(fs::file_size(cached().blob(hub.etag(unet) + ".incomplete")), 500'000u);
    expect_no_snapshot();
    const PullResult result = pull(request);
    expect_whole(unet);
    EXPECT_LE(result.downloaded_bytes, result.bytes - 500'000);
}

TEST_F(HubPull, AServerThatIsNoHubIsSaid) {
    LoopbackServer other;
    other.server.Get("/(.*)", [](const auto&, auto& response) {
        response.set_content("<html>welcome</html>", "text/html");
    });
    other.start();
    request.endpoint = other.url();
    expect_failure<InputError>("does not answer as the Hugging Face hub does");
    request.endpoint = "http://127.0.0.1:1";
    expect_failure<ResourceError>("127.0.0.1:1");
    request.endpoint = "ftp://127.0.0.1";
    expect_failure<InputError>("is not an http");
}

TEST_F(HubPull, TwoAtOnceShareTheWork) {
    hub.break_file(unet, {.slow = 20'000});
    std::vector<std::thread> threads;
    std::atomic<int> whole = 0;
    for (int i = 0; i < 3; ++i)
        threads.emplace_back([&] { whole += fs::exists(pull(request).folder / unet) ? 1 : 0; });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(whole, 3);
    expect_whole(unet);
    EXPECT_EQ(hub.downloads_of(unet), 1);
}

}  // namespace
}  // namespace item3d::testing
