// Tests of a training's checkpoints, initial weights and outputs, on small networks.
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/diffusion/pipeline_folder.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/prior_folder.h"
#include "item3d/prior/training/init_from.h"
#include "item3d/prior/training/settings.h"
#include "item3d/prior/training/tokenizer_training.h"
#include "item3d/prior/training/train_autoencoder.h"
#include "item3d/prior/training/train_diffusion.h"
#include "item3d/tensors/safetensors.h"
#include "tests/support/processes.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <functional>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Returns the message of the InputError that `function` throws.
std::string refusal(const std::function<void()>& function) {
    try {
        function();
    } catch (const InputError& error) {
        return error.what();
    }
    return "nothing was thrown";
}

class PriorTraining : public ::testing::Test {
  protected:
    PriorTraining() {
        at::manual_seed(1);
        data_.latents = at::randn({24, latent_channels, 16, 16}).to(at::kHalf);
        data_.cells = at::randn({24, 7, 16, 16}).to(at::kHalf);
        data_.tokens = at::randint(0, 30, {24, text_length}).to(at::kShort);
        data_.empty_tokens = at::full({text_length}, 31).to(at::kShort);
        networks_.unet = prior_unet_config();
        networks_.unet.block_out_channels = {16, 16, 16};
        networks_.unet.attention_head_dim = {1, 1, 1};
        networks_.unet.cross_attention_dim.assign(3, 32);
        networks_.unet.norm_num_groups = 8;
        networks_.text = prior_text_config(32, 30, 31);
        networks_.text.hidden_size = 32;
        networks_.text.intermediate_size = 32;
        networks_.text.num_hidden_layers = 1;
        networks_.text.num_attention_heads = 1;
    }
    ~PriorTraining() override { fs::remove_all(root_); }

    TrainSettings settings(const char* name) const {
        TrainSettings result;
        result.output = root_ / name;
        result.work = root_ / name / "work";
        result.samples = 48;
        result.batch = 4;
        fs::create_directories(result.work);
        return result;
    }
    NamedTensors checkpoint(const TrainSettings& settings) const {
        return SafeTensors::open(settings.work / "checkpoint.safetensors").tensors();
    }

    /// Returns the written weights of the U-Net's first layer.
    static at::Tensor input_weight(const TrainSettings& of) {
        return SafeTensors::open(of.output / "unet/diffusion_pytorch_model.safetensors")
            .tensor("conv_in.weight")
            .to(at::kFloat);
    }

    LatentData data_;
    DiffusionConfig networks_;
    fs::path root_ = fs::temp_directory_path() / ("item3d_training_" + std::to_string(::getpid()));
};

TEST_F(PriorTraining, ResumedTrainingEndsWithTheSameWeights) {
    const TrainSettings whole = settings("whole");
    const auto summary = train_diffusion(data_, whole, networks_, {{"psnr", 30}});
    EXPECT_EQ(summary.at("samples"), 48);
    EXPECT_EQ(summary.at("psnr"), 30);

    TrainSettings parts = settings("parts");
    parts.stop_after = 16;
    EXPECT_THROW(train_diffusion(data_, parts, networks_, {}), Interrupted);
    parts.resume = true;
    parts.stop_after = 24;
    EXPECT_THROW(train_diffusion(data_, parts, networks_, {}), Interrupted);
    parts.stop_after = 0;
    train_diffusion(data_, parts, networks_, {});

    const NamedTensors expected = checkpoint(whole), found = checkpoint(parts);
    ASSERT_EQ(expected.size(), found.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (expected[i].first == "record") continue;  // holds seconds
        EXPECT_TRUE(at::equal(expected[i].second, found[i].second)) << expected[i].first;
    }
    for (const char* file : {"unet/config.json", "unet/diffusion_pytorch_model.safetensors",
                             "text_encoder/model.safetensors", "prior.json"})
        EXPECT_TRUE(fs::exists(parts.output / file)) << file;
}

/// Two processes of one replica each give the same bytes as one process of two. This also holds
/// after stopping and resuming, after a stop request to only one process, and without a shared
/// folder.
TEST_F(PriorTraining, TwoProcessesTrainAsTwoReplicas) {
    if (testing::is_process()) {
        const ProcessGroup processes = ProcessGroup::from_environment();
        root_ = testing::process_folder() / std::to_string(processes.rank());
        TrainSettings ours = settings("two");
        ours.processes = processes;
        ours.replicas = 1;
        if (!processes.first()) ours.stop_after = 24;
        EXPECT_THROW(train_diffusion(data_, ours, networks_, {}), Interrupted);
        ours.stop_after = 0;
        ours.resume = true;
        train_diffusion(data_, ours, networks_, {});
        if (processes.first()) {
            fs::rename(ours.work / "checkpoint.safetensors",
                       testing::process_folder() / "two.safetensors");
        } else {
            EXPECT_TRUE(fs::is_empty(ours.work));
            EXPECT_FALSE(fs::exists(ours.output / "unet"));
        }
        return;
    }
    const TrainSettings one = settings("one");
    train_diffusion(data_, one, networks_, {});
    for (const auto& result : testing::run_as_processes(root_))
        EXPECT_EQ(result.code, 0) << result.output;
    const NamedTensors expected = checkpoint(one);
    const SafeTensors found = SafeTensors::open(root_ / "two.safetensors");
    for (const auto& [name, tensor] : expected)
        if (name != "record") {
            EXPECT_TRUE(at::equal(tensor, found.tensor(name))) << name;
        }
    EXPECT_EQ(found.tensor("record")[0].item<double>(), 48);
}

TEST_F(PriorTraining, WhatTheCheckpointIsNotOfIsRefused) {
    TrainSettings first = settings("first");
    first.samples = 8;
    train_diffusion(data_, first, networks_, {});
    first.resume = true;
    const auto expect = [&](const TrainSettings& now, const std::string& problem) {
        const std::string message = refusal([&] { train_diffusion(data_, now, networks_, {}); });
        EXPECT_EQ(message.find((first.work / "checkpoint.safetensors").string() + ": "), 0u)
            << message;
        EXPECT_NE(message.find(problem), std::string::npos) << message;
    };
    const auto with = [&](auto member, auto value) {
        TrainSettings now = first;
        now.*member = value;
        return now;
    };
    expect(with(&TrainSettings::batch, 2), "batch: 2 instead of 4");
    expect(with(&TrainSettings::replicas, 1), "replicas: 1 instead of 2");
    expect(with(&TrainSettings::learning_rate, 2e-3f), "learning_rate: 0.002 instead of 0.001");
    expect(with(&TrainSettings::seed, std::uint64_t{2}), "seed: 2 instead of 1");
    expect(with(&TrainSettings::prediction_type, "epsilon"),
           "objective: \"epsilon\" instead of \"v_prediction\"");
    expect(with(&TrainSettings::optimizer, "adamw"), "optimizer: \"adamw\" instead of \"muon\"");
    networks_.text.vocab_size = 40;
    expect(first, "network: ");
    networks_.text.vocab_size = 32;
    // --resume may raise the number of images.
    EXPECT_EQ(train_diffusion(data_, with(&TrainSettings::samples, std::int64_t{16}), networks_,
                              {})["samples"],
              16);
}

TEST_F(PriorTraining, BeginsWithTheWeightsOfAnotherPrior) {
    const TrainSettings first = settings("first");
    train_diffusion(data_, first, networks_, {});
    TrainSettings second = settings("second");
    second.init_from = first.output;
    second.seed = 2;
    second.learning_rate = 1e-9f;
    train_diffusion(data_, second, networks_, {});
    for (const char* file :
         {"unet/diffusion_pytorch_model.safetensors", "text_encoder/model.safetensors"}) {
        const SafeTensors expected = SafeTensors::open(first.output / file);
        const SafeTensors found = SafeTensors::open(second.output / file);
        for (const auto& [name, tensor] : expected.tensors())
            EXPECT_TRUE(
                at::allclose(tensor.to(at::kFloat), found.tensor(name).to(at::kFloat), 2e-3, 1e-6))
                << name;
    }
    const nlohmann::json record = init_from_record(first.output);
    EXPECT_EQ(record["begun_with"]["samples"], 48);

    // A mismatch is reported before any training image is drawn.
    const std::string early = refusal([&] { check_init_from(second); });
    EXPECT_EQ(early.find((first.output / "unet/config.json").string() + ": "), 0u) << early;
    second.output = first.output;
    EXPECT_NE(refusal([&] { check_init_from(second); }).find("-o"), std::string::npos);
    second.output = root_ / "second";

    networks_.unet.block_out_channels = {16, 32, 16};
    networks_.unet.attention_head_dim = {1, 2, 1};
    const std::string message = refusal([&] { train_diffusion(data_, second, networks_, {}); });
    EXPECT_EQ(message.find((first.output / "unet").string() + ": "), 0u) << message;
    EXPECT_NE(message.find("--widths"), std::string::npos) << message;
    EXPECT_NE(refusal([&] { init_from_autoencoder(first.output, prior_image_size); }).find("vae"),
              std::string::npos);
}

TEST_F(PriorTraining, TakesTheAutoencoderOfAnotherPrior) {
    AutoencoderTiny trained(prior_autoencoder_config(prior_image_size));
    const TrainSettings first = settings("first");
    std::filesystem::create_directories(first.output / "vae");
    save_autoencoder(first.output / "vae", trained, at::kFloat);
    write_atomically(first.output / "prior.json",
                     R"({"train": {"psnr": 31.0, "object_psnr": 27.0, "samples": 9}})");
    TrainSettings second = settings("second");
    second.autoencoder = first.output;
    check_init_from(second);
    EXPECT_EQ(autoencoder_record(first.output),
              nlohmann::json({{"psnr", 31.0}, {"object_psnr", 27.0}}));
    // The size of the U-Net may differ, but not that of the images.
    second.widths = {16, 32, 32};
    check_init_from(second);
    second.resolution = 128;
    EXPECT_NE(refusal([&] { check_init_from(second); }).find("vae"), std::string::npos);
    second.resolution = prior_image_size;
    second.init_from = first.output;
    EXPECT_NE(refusal([&] { check_init_from(second); }).find("--autoencoder"), std::string::npos);
    second.init_from.clear();
    second.output = first.output;
    EXPECT_NE(refusal([&] { check_init_from(second); }).find("-o"), std::string::npos);
}

TEST_F(PriorTraining, AUNetThatIsToldMoreBeginsAsItWas) {
    TrainSettings first = settings("first");
    first.condition = "depth";
    networks_.unet.in_channels = prior_unet_config(first).in_channels;
    train_diffusion(data_, first, networks_, {});
    TrainSettings second = settings("second");
    second.init_from = first.output;
    second.learning_rate = 1e-9f;
    networks_.unet.in_channels = prior_unet_config(second).in_channels;
    train_diffusion(data_, second, networks_, {});
    const at::Tensor was = input_weight(first), is = input_weight(second);
    EXPECT_EQ(was.size(1), latent_channels + 1);
    EXPECT_EQ(is.size(1), latent_channels + surface_condition_channels);
    EXPECT_TRUE(at::allclose(is.slice(1, 0, was.size(1)), was, 2e-3, 1e-6));
    EXPECT_LT(is.slice(1, was.size(1)).abs().max().item<float>(), 1e-6);
    // The other way round, the weights do not fit.
    first.init_from = second.output;
    first.output = root_ / "third";
    networks_.unet.in_channels = latent_channels + 1;
    EXPECT_NE(refusal([&] { train_diffusion(data_, first, networks_, {}); }).find("--condition"),
              std::string::npos);
}

TEST_F(PriorTraining, AnInstructorBeginsWithAPriorAndNothingOfItsShapes) {
    TrainSettings first = settings("shapes");
    first.samples = 8;
    train_diffusion(data_, first, networks_, {});
    TrainSettings second = settings("instructions");
    second.samples = 8;
    second.condition = image_condition;
    second.init_from = first.output;
    second.learning_rate = 1e-9f;
    data_.sources = at::randn({24, latent_channels, 16, 16}).to(at::kHalf);
    networks_.unet.in_channels = prior_unet_config(second).in_channels;
    EXPECT_EQ(networks_.unet.in_channels, 2 * latent_channels);
    train_diffusion(data_, second, networks_, {});
    const at::Tensor was = input_weight(first), is = input_weight(second);
    EXPECT_GT(was.slice(1, latent_channels).abs().max().item<float>(), 0.01);
    EXPECT_TRUE(at::allclose(is.slice(1, 0, latent_channels), was.slice(1, 0, latent_channels),
                             2e-3, 1e-6));
    EXPECT_LT(is.slice(1, latent_channels).abs().max().item<float>(), 1e-6);
    // Data with source images is read completely, or refused.
    const LatentData read = LatentData::from_tensors(data_.tensors(), 32, "data.safetensors");
    EXPECT_TRUE(read.sources.equal(data_.sources));
    data_.sources = data_.sources.narrow(0, 0, 8);
    EXPECT_NE(refusal([&] {
                  LatentData::from_tensors(data_.tensors(), 32, "data.safetensors");
              }).find("shapes"),
              std::string::npos);
}

TEST_F(PriorTraining, WhatItPredictsAndIsToldIsWrittenBesideTheWeights) {
    TrainSettings noise = settings("noise");
    noise.samples = 8;
    noise.prediction_type = "epsilon";
    noise.condition = "none";
    networks_.unet.in_channels = prior_unet_config(noise).in_channels;
    EXPECT_EQ(networks_.unet.in_channels, latent_channels);
    const double loss = train_diffusion(data_, noise, networks_, {})["loss"];
    const auto json = [&](const char* file) {
        return nlohmann::json::parse(read_text(noise.output / file));
    };
    EXPECT_EQ(json("scheduler/scheduler_config.json")["prediction_type"], "epsilon");
    EXPECT_EQ(json("unet/config.json")["in_channels"], latent_channels);
    // The same training predicts the velocity.
    TrainSettings velocity = noise;
    velocity.output = root_ / "velocity";
    velocity.work = root_;
    velocity.prediction_type = "v_prediction";
    EXPECT_NE(train_diffusion(data_, velocity, networks_, {})["loss"].get<double>(), loss);
    EXPECT_EQ(nlohmann::json::parse(read_text(
                  velocity.output / "scheduler/scheduler_config.json"))["prediction_type"],
              "v_prediction");
}

TEST_F(PriorTraining, ABrokenCheckpointIsRefused) {
    TrainSettings first = settings("first");
    first.samples = 8;
    train_diffusion(data_, first, networks_, {});
    first.resume = true;
    const fs::path file = first.work / "checkpoint.safetensors";
    const NamedTensors good = checkpoint(first);
    const auto expect_refused = [&](const std::string& problem) {
        const std::string message = refusal([&] { train_diffusion(data_, first, networks_, {}); });
        EXPECT_EQ(message.find(file.string() + ": "), 0u) << message;
        EXPECT_NE(message.find(problem), std::string::npos) << message;
    };
    const auto changed = [&](const std::string& name, const auto& change) {
        NamedTensors tensors = good;
        for (auto& entry : tensors)
            if (entry.first == name) change(entry);
        save_safetensors(file, tensors);
    };
    changed("average", [](auto& entry) { entry.first = "mean"; });
    expect_refused("tensor 'average' is missing");
    changed("values", [](auto& entry) { entry.second = entry.second.slice(0, 1); });
    expect_refused("is for another network: 'values' has ");
    changed("steps", [](auto& entry) { entry.second = entry.second.to(at::kFloat); });
    expect_refused("'steps'");
    save_safetensors(file, good, {{"settings", "{"}});
    expect_refused("does not record its settings");
    save_safetensors(file, good);
    fs::resize_file(file, fs::file_size(file) - 100);
    expect_refused("damaged");
    fs::resize_file(file, 5);
    expect_refused("at least 8 bytes");
    save_safetensors(file, good);  // has no settings, as older programs wrote it
    EXPECT_EQ(train_diffusion(data_, first, networks_, {})["samples"], 8);
}

TEST_F(PriorTraining, AFullDiskLeavesTheOldCheckpoint) {
    TrainSettings first = settings("first");
    first.stop_after = 16;
    EXPECT_THROW(train_diffusion(data_, first, networks_, {}), Interrupted);
    const Bytes before = read_bytes(first.work / "checkpoint.safetensors");
    first.resume = true;
    first.stop_after = 0;
    {
        // Files may have 64 kB, which acts like a nearly full disk.
        const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
        rlimit limit{};
        ::getrlimit(RLIMIT_FSIZE, &limit);
        const rlimit small{1 << 16, limit.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &small);
        EXPECT_THROW(train_diffusion(data_, first, networks_, {}), ResourceError);
        ::setrlimit(RLIMIT_FSIZE, &limit);
        std::signal(SIGXFSZ, ignored);
    }
    EXPECT_EQ(read_bytes(first.work / "checkpoint.safetensors"), before);
    EXPECT_EQ(std::distance(fs::directory_iterator(first.work), fs::directory_iterator()), 1);
    EXPECT_EQ(train_diffusion(data_, first, networks_, {})["samples"], 48);
}

TEST_F(PriorTraining, DataThatDoesNotBelongIsRefused) {
    const auto refused = [&](const NamedTensors& tensors, std::size_t vocabulary) {
        return refusal([&] { LatentData::from_tensors(tensors, vocabulary, "data.safetensors"); });
    };
    const NamedTensors good = data_.tensors();
    EXPECT_EQ(refused(good, 32), "nothing was thrown");
    EXPECT_NE(refused(good, 31).find("data.safetensors: has tokens from "), std::string::npos);
    NamedTensors other = good;
    other[1].second = other[1].second.slice(0, 1);
    EXPECT_NE(refused(other, 32).find("shapes"), std::string::npos);
    other = good;
    other[2].second = other[2].second.to(at::kLong);
    EXPECT_NE(refused(other, 32).find("no 'tokens' of the right type"), std::string::npos);
    other = good;
    other[0].first = "latent";
    EXPECT_NE(refused(other, 32).find("no 'latents'"), std::string::npos);
}

TEST(PriorTraining128, TheAutoencoderShrinksLargerImagesMore) {
    for (const int resolution : {64, 128}) {
        AutoencoderTiny model(prior_autoencoder_config(resolution));
        EXPECT_EQ(model.downscale() * latent_size, resolution);
        const at::Tensor latents = model.encode(at::rand({1, 3, resolution, resolution}));
        EXPECT_EQ(latents.sizes(), at::IntArrayRef({1, latent_channels, latent_size, latent_size}));
        EXPECT_EQ(model.decode(latents).sizes(), at::IntArrayRef({1, 3, resolution, resolution}));
        // The config that is written can be read.
        EXPECT_NO_THROW(AutoencoderTinyConfig::from_config(Config(model.config_json(), "")));
    }
}

TEST(PriorWords, APriorKnowsItsOwnWordsAlone) {
    const fs::path prior = fs::path(ITEM3D_TEST_DATA) / "../../assets/prior";
    const auto words = trained_words(prior, ClipTokenizer::load(prior / "tokenizer"));
    EXPECT_TRUE(words.count("wooden"));
    EXPECT_EQ(words.count("xylophone"), 0u);
    // If there is no list of words, the tokenizer decides: an older tokenizer splits newer words
    // into several tokens.
    const ClipTokenizer older = train_tokenizer({{"a", 9}, {"wooden", 5}, {"mug", 4}}, text_length);
    const auto guessed = trained_words(prior / "vae", older);
    EXPECT_TRUE(guessed.count("wooden"));
    EXPECT_EQ(guessed.count("tartan"), 0u);
}

}  // namespace
}  // namespace item3d
