// Tests of item3d prior pull, verify and list, and of priors by name.
#include "tests/support/hub_server.h"
#include "tests/support/program.h"

#include <map>

namespace item3d::testing {
namespace {

const fs::path small_prior = ITEM3D_TEST_DATA "/models/pipeline_sd";
const std::string unet = "unet/diffusion_pytorch_model.safetensors";

class PriorProgram : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        for (const auto& entry : fs::recursive_directory_iterator(small_prior)) {
            const std::string path = fs::relative(entry.path(), small_prior).string();
            if (!entry.is_regular_file()) continue;
            if (entry.path().extension() == ".safetensors")
                hub.add_large(path, read_file(entry.path()));
            else
                hub.add(path, read_file(entry.path()));
        }
    }
    /// Returns environment variables that name the test's hub and caches.
    std::string environment() const {
        return "HF_ENDPOINT=" + hub.url() + " HF_HOME=" + quoted(folder_ / "hf") +
               " XDG_DATA_HOME=" + quoted(folder_ / "data") + " ";
    }
    /// Returns a copy of the small prior that a test may damage.
    fs::path copy() const {
        const fs::path prior = folder_ / "prior";
        fs::remove_all(prior);
        fs::copy(small_prior, prior, fs::copy_options::recursive);
        return prior;
    }

    FakeHub hub;
};

TEST_F(PriorProgram, PulledPriorsAreFoundByName) {
    expect_error("prior verify someone/model", 3, "item3d prior pull someone/model", environment());
    const Result pulled = run("prior pull someone/model --json", environment());
    ASSERT_EQ(pulled.code, 0) << pulled.error;
    const nlohmann::json result = nlohmann::json::parse(pulled.out);
    EXPECT_EQ(result["commit"], FakeHub::commit);
    EXPECT_EQ(result["bytes"], result["downloaded_bytes"]);

    const Result verified = run("prior verify someone/model --json", environment());
    EXPECT_EQ(verified.code, 0) << verified.error;
    EXPECT_EQ(nlohmann::json::parse(verified.out)["folder"], result["folder"]);
    const Result drawn = run("generate \"a cat\" --prior someone/model@main --steps 1 --quiet -o " +
                                 quoted(folder_ / "cat.png"),
                             environment());
    EXPECT_EQ(drawn.code, 0) << drawn.error;
}

TEST_F(PriorProgram, InstalledPriorsAreFoundByName) {
    fs::create_directories(folder_ / "data/item3d/priors");
    fs::copy(small_prior, folder_ / "data/item3d/priors/small", fs::copy_options::recursive);
    EXPECT_EQ(run("prior verify small", environment()).code, 0);
    EXPECT_EQ(run("prior verify embedded", environment()).code, 0);
    expect_error("prior verify large", 3, "data/item3d/priors", environment());
}

TEST_F(PriorProgram, ListNamesEveryPriorAndWhatIsWrongWithIt) {
    ASSERT_EQ(run("prior pull someone/model", environment()).code, 0);
    const fs::path installed = folder_ / "data/item3d/priors";
    fs::create_directories(installed / "empty");
    fs::copy(small_prior, installed / "odd", fs::copy_options::recursive);
    std::ofstream(installed / "odd" / "prior.json")
        << R"({"vocabulary": {"colors": [{}]}, "accuracy": "high"})";
    const Result listed = run("prior list --json", environment());
    ASSERT_EQ(listed.code, 0) << listed.error;
    std::map<std::string, std::string> remarks;
    const nlohmann::json found = nlohmann::json::parse(listed.out);
    for (const auto& prior : found["priors"])
        remarks[prior["name"]] = prior["remark"];
    EXPECT_EQ(remarks.size(), 4u) << listed.out;
    EXPECT_NE(remarks["embedded"].find("accuracy"), std::string::npos);
    EXPECT_EQ(remarks["empty"], "incomplete: no model_index.json");
    EXPECT_EQ(remarks["odd"], "prior.json is broken");
    EXPECT_EQ(remarks["someone/model"], "open vocabulary");
    EXPECT_EQ(run("prior list", environment()).code, 0);
}

TEST_F(PriorProgram, AnInterruptedPullGoesOnWhereItStopped) {
    const std::string whole = read_file(small_prior / unet);
    // The download is slow enough to be running when the interrupt comes, whatever the start-up
    // time.
    hub.break_file(unet, {.times = 1, .slow = whole.size() / 20000});
    // timeout may signal twice. A second signal ends the program at once, without its message.
    const Result stopped =
        run("prior pull someone/model", environment() + "timeout -s INT --preserve-status 3 ");
    EXPECT_EQ(stopped.code, 130) << stopped.error;
    const fs::path blobs = folder_ / "hf/hub/models--someone--model/blobs";
    const fs::path partial = blobs / (hub.etag(unet) + ".incomplete");
    ASSERT_TRUE(fs::exists(partial));
    const auto kept = fs::file_size(partial);
    EXPECT_GT(kept, 0u);
    EXPECT_FALSE(fs::exists(blobs.parent_path() / "snapshots"));

    ASSERT_EQ(run("prior pull someone/model", environment()).code, 0);
    EXPECT_EQ(read_file(blobs / hub.etag(unet)), whole);
    for (const FakeHub::Seen& seen : hub.seen())
        if (seen.storage && seen.path == unet && !seen.range.empty()) {
            EXPECT_EQ(seen.range, "bytes=" + std::to_string(kept) + "-");
        }
}

TEST_F(PriorProgram, PullSaysInOneLineWhatIsWrong) {
    EXPECT_EQ(run("prior pull model").code, 2);
    EXPECT_EQ(run("prior pull a/b@v1 --revision v2").code, 2);
    EXPECT_EQ(run("prior pull a/b --revision ../c").code, 2);
    EXPECT_EQ(run("prior pull a/b --variant int8").code, 2);
    expect_error("prior pull someone/else", 3, "someone/else", environment());
    expect_error("prior pull someone/model@v9", 3, "no revision 'v9'", environment());
    hub.token = "hf_secret";
    expect_error("prior pull someone/model", 3, "HF_TOKEN", environment());
    EXPECT_EQ(run("prior pull someone/model", "HF_TOKEN=hf_secret " + environment()).code, 0);
}

TEST_F(PriorProgram, VerifyTellsEachProblemInALine) {
    const Result good = run("prior verify " + quoted(small_prior) + " --json");
    ASSERT_EQ(good.code, 0) << good.error;
    const nlohmann::json report = nlohmann::json::parse(good.out);
    EXPECT_TRUE(report["usable"]);
    EXPECT_EQ(report["parts"]["unet"]["class"], "UNet2DConditionModel");
    EXPECT_GT(report["parts"]["unet"]["parameters"], 0);
    EXPECT_EQ(report["parts"]["unet"]["stored_as"], "fp32");
    EXPECT_EQ(report["parts"]["unet"]["file_bytes"],
              4 * report["parts"]["unet"]["parameters"].get<std::int64_t>());
    EXPECT_LT(report["memory"]["bf16"]["weights"], report["memory"]["fp32"]["weights"]);
    EXPECT_LT(report["memory"]["fp32"]["weights"], report["memory"]["fp32"]["edit_peak_estimate"]);

    const fs::path prior = copy();
    fs::resize_file(prior / unet, fs::file_size(prior / unet) - 4);
    fs::remove(prior / "vae/config.json");
    fs::remove_all(prior / "scheduler");
    const Result bad = run("prior verify " + quoted(prior));
    EXPECT_EQ(bad.code, 3);
    int problems = 0;
    std::istringstream lines(bad.out);
    for (std::string line; std::getline(lines, line);)
        problems += line.starts_with("problem: ") ? 1 : 0;
    EXPECT_EQ(problems, 3) << bad.out;
    for (const char* named :
         {"diffusion_pytorch_model.safetensors", "vae/config.json", "scheduler"})
        EXPECT_NE(bad.out.find(named), std::string::npos) << bad.out;
    EXPECT_NE(bad.error.find("3 problems"), std::string::npos) << bad.error;
}

}  // namespace
}  // namespace item3d::testing
