#include "item3d/prior/train.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/models/safetensors.h"
#include "item3d/prior/classifier.h"
#include "item3d/prior/export.h"
#include "item3d/prior/replicas.h"
#include "item3d/prior/tokenizer_training.h"
#include "item3d/prior/training_loop.h"
#include "item3d/prior/workers.h"

#include <algorithm>
#include <atomic>
#include <mutex>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Streams of the seed for each use.
enum Stream : std::uint64_t {
    vocabulary_stream = 11,
    light_stream,
    view_stream,
    example_stream,
    held_out_stream
};

std::uint64_t seed_of(const TrainSettings& settings, Stream stream) {
    return mix_bits(settings.seed * 1000 + stream);
}

void stop_if_interrupted(const TrainSettings& settings) {
    if (interrupted())
        throw Interrupted("what was finished is in " + settings.work.string() +
                          "; the same command with --resume goes on");
}

ExampleSource make_source(const TrainSettings& settings, std::vector<TrainingLight> lights,
                          bool held_out) {
    std::vector<ShapeView> views =
        make_view_pool(held_out, settings.shape_variants, settings.views_each,
                       seed_of(settings, held_out ? held_out_stream : view_stream),
                       settings.replicas, settings.resolution);
    stop_if_interrupted(settings);
    return ExampleSource(std::move(views), std::move(lights),
                         seed_of(settings, held_out ? held_out_stream : example_stream));
}

PictureData draw_pictures(const ExampleSource& source, std::int64_t count,
                          const TrainSettings& settings) {
    PictureData data;
    const int size = settings.resolution;
    data.images = torch::empty({count, size, size, 3}, torch::kUInt8);
    data.covered = torch::empty({count, size, size}, torch::kUInt8);
    Progress progress("pictures", count);
    std::atomic<std::int64_t> done = 0;
    std::mutex mutex;
    run_workers(count, settings.replicas, [&](std::int64_t i) {
        const Example example = source.draw(i);
        data.images[i].copy_((example.image * 255).round());
        data.covered[i].copy_((example.covered * 255).round());
        const std::lock_guard lock(mutex);
        progress.update(++done);
    });
    stop_if_interrupted(settings);
    return data;
}

LatentData draw_latents(const ExampleSource& source, AutoencoderTiny& autoencoder,
                        const ClipTokenizer& tokenizer, const TrainSettings& settings) {
    constexpr std::int64_t at_once = 32;
    const std::int64_t count = settings.data_samples / at_once * at_once;
    LatentData data;
    data.latents = torch::empty({count, 4, latent_size, latent_size}, torch::kHalf);
    data.depth = torch::empty({count, 1, latent_size, latent_size}, torch::kHalf);
    data.tokens = torch::empty({count, text_length}, torch::kInt16);
    data.empty_tokens = tokenizer.encode_batch({""}, text_length)[0].to(torch::kInt16);
    Progress progress("examples", count);
    std::atomic<std::int64_t> done = 0;
    std::mutex mutex;
    run_workers(count / at_once, settings.replicas, [&](std::int64_t job) {
        std::vector<torch::Tensor> images, depths;
        std::vector<std::string> captions;
        for (std::int64_t i = job * at_once; i < (job + 1) * at_once; ++i) {
            Example example = source.draw(i);
            images.push_back(std::move(example.image));
            depths.push_back(std::move(example.depth));
            captions.push_back(std::move(example.caption));
        }
        // [N, H, W, 3] seen as [N, 3, H, W] is channels-last already.
        const torch::Tensor pictures = torch::stack(images).permute({0, 3, 1, 2}) * 2 - 1;
        torch::Tensor latents;
        {
            const Autocast autocast;
            latents = autoencoder.encode(pictures);
        }
        latents = latents.to(torch::kFloat32) * autoencoder.scaling_factor();
        const auto rows = [&](torch::Tensor& all) {
            return all.slice(0, job * at_once, (job + 1) * at_once);
        };
        rows(data.latents).copy_(latents);
        rows(data.depth).copy_(torch::stack(depths));
        rows(data.tokens).copy_(tokenizer.encode_batch(captions, text_length));
        const std::lock_guard lock(mutex);
        progress.update(done += at_once);
    });
    stop_if_interrupted(settings);
    return data;
}

/// What the data depends on: a work folder made with other settings is not gone on with.
nlohmann::json fingerprint(const TrainSettings& s) {
    return {{"version", 2},
            {"seed", s.seed},
            {"resolution", s.resolution},
            {"data_samples", s.data_samples},
            {"autoencoder_samples", s.autoencoder_samples},
            {"autoencoder_pictures", s.autoencoder_pictures},
            {"shape_variants", s.shape_variants},
            {"views_each", s.views_each},
            {"lights", s.lights},
            {"replicas", s.replicas},
            {"batch", s.batch}};
}

void open_work_folder(const TrainSettings& settings) {
    make_output_folder(settings.work);
    const fs::path file = settings.work / "settings.json";
    if (settings.resume && fs::exists(file)) {
        const auto before = nlohmann::json::parse(read_text(file), nullptr, false);
        if (before != fingerprint(settings))
            throw InputError(file.string(),
                             "the work folder was made with other settings: " + before.dump(),
                             "give the same ones, or train without --resume");
        return;
    }
    for (const char* stale : {"autoencoder.safetensors", "pictures.safetensors", "data.safetensors",
                              "checkpoint.safetensors", "autoencoder.json"})
        fs::remove(settings.work / stale);
    write_atomically(file, fingerprint(settings).dump(2) + "\n");
}

struct Prepared {
    LatentData data;
    nlohmann::json record;  ///< for prior.json's "train"
};

Prepared read_prepared(const TrainSettings& settings) {
    const SafeTensors file = SafeTensors::open(settings.work / "data.safetensors");
    Prepared prepared;
    prepared.data = {file.tensor("latents"), file.tensor("depth"), file.tensor("tokens"),
                     file.tensor("empty_tokens")};
    prepared.record = nlohmann::json::parse(read_text(settings.work / "autoencoder.json"));
    return prepared;
}

Prepared prepare(const TrainSettings& settings, const ClipTokenizer& tokenizer) {
    const std::vector<TrainingLight> lights =
        make_training_lights(seed_of(settings, light_stream), settings.lights, settings.replicas);
    stop_if_interrupted(settings);
    const ExampleSource source = make_source(settings, lights, false);
    const fs::path pictures_file = settings.work / "pictures.safetensors";
    if (!settings.resume || !fs::exists(pictures_file)) {
        const ExampleSource held_out = make_source(settings, lights, true);
        const PictureData seen = draw_pictures(source, settings.autoencoder_pictures, settings);
        const PictureData unseen = draw_pictures(
            held_out, std::min<std::int64_t>(512, settings.autoencoder_pictures), settings);
        save_safetensors(pictures_file, {{"images", seen.images},
                                         {"covered", seen.covered},
                                         {"held_out_images", unseen.images},
                                         {"held_out_covered", unseen.covered}});
    }
    const SafeTensors file = SafeTensors::open(pictures_file);
    const TrainedAutoencoder autoencoder = train_autoencoder(
        {file.tensor("images"), file.tensor("covered")},
        {file.tensor("held_out_images"), file.tensor("held_out_covered")}, settings);
    note(fmt::format(
        "autoencoder: held-out PSNR {:.2f} dB, on objects {:.2f} dB, scaling factor {:.4f}",
        autoencoder.psnr, autoencoder.object_psnr, autoencoder.model->scaling_factor()));
    export_autoencoder(settings.output, *autoencoder.model, tokenizer);
    Prepared prepared;
    prepared.record = {{"psnr", autoencoder.psnr}, {"object_psnr", autoencoder.object_psnr}};
    write_atomically(settings.work / "autoencoder.json", prepared.record.dump(2) + "\n");
    prepared.data = draw_latents(source, *autoencoder.model, tokenizer, settings);
    save_safetensors(settings.work / "data.safetensors",
                     {{"latents", prepared.data.latents},
                      {"depth", prepared.data.depth},
                      {"tokens", prepared.data.tokens},
                      {"empty_tokens", prepared.data.empty_tokens}});
    return prepared;
}

}  // namespace

LoopOptions loop_options(const TrainSettings& settings, const std::string& label,
                         const std::string& checkpoint) {
    LoopOptions options;
    options.label = label;
    options.checkpoint = settings.work / checkpoint;
    options.learning_rate = settings.learning_rate;
    options.seed = settings.seed;
    options.resume = settings.resume;
    options.stop_after = settings.stop_after;
    options.checkpoint_seconds = settings.checkpoint_seconds;
    options.export_seconds = settings.export_seconds;
    return options;
}

std::vector<WordCount> prior_words(const TrainSettings& settings) {
    return caption_vocabulary(seed_of(settings, vocabulary_stream));
}

void train_prior(const TrainSettings& settings) {
    keep_freed_memory();
    make_output_folder(settings.output);
    open_work_folder(settings);
    // Token numbers are rows of the text encoder: what is gone on with keeps them.
    const fs::path tokens = settings.output / "tokenizer";
    const ClipTokenizer tokenizer = settings.resume && fs::exists(tokens / "vocab.json")
                                        ? ClipTokenizer::load(tokens)
                                        : train_tokenizer(prior_words(settings), text_length);
    std::set<std::string> words;
    for (const WordCount& word : prior_words(settings))
        words.insert(word.word);
    update_prior_json(settings.output, {{"words", words}, {"resolution", settings.resolution}});
    const bool prepared_before = settings.resume && fs::exists(settings.work / "data.safetensors");
    const Prepared prepared =
        prepared_before ? read_prepared(settings) : prepare(settings, tokenizer);
    const ClipTextConfig text = prior_text_config(static_cast<int>(tokenizer.size()),
                                                  tokenizer.bos_id(), tokenizer.eos_id());
    train_diffusion(prepared.data, settings, {prior_unet_config(settings.widths), text},
                    prepared.record);
    write_measurement(settings.output, settings.replicas);
}

std::set<std::string> trained_words(const fs::path& folder, const ClipTokenizer& tokenizer) {
    std::set<std::string> words;
    const fs::path file = folder / "prior.json";
    if (fs::exists(file)) {
        const auto json = nlohmann::json::parse(read_text(file), nullptr, false);
        if (json.is_object() && json.contains("words"))
            words = json["words"].get<std::set<std::string>>();
    }
    if (!words.empty()) return words;
    for (const WordCount& word : caption_vocabulary(1))
        if (tokenizer.encode(word.word).size() == 3) words.insert(word.word);
    return words;
}

nlohmann::json write_measurement(const fs::path& folder, int threads) {
    const Pipeline pipeline = Pipeline::load(folder);
    MeasureOptions options;
    options.threads = threads;
    options.words = trained_words(folder, *pipeline.tokenizer);
    const auto views = held_out_views(pipeline, options.seed, threads);
    nlohmann::json measured = measure_prior(pipeline, views, options);
    measured["words"] = options.words;
    return update_prior_json(folder, measured);
}

}  // namespace item3d
