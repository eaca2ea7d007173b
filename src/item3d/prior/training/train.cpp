#include "item3d/prior/training/train.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/prior/data/dataset.h"
#include "item3d/prior/data/prior_folder.h"
#include "item3d/prior/evaluation/classifier.h"
#include "item3d/prior/training/export.h"
#include "item3d/prior/training/init_from.h"
#include "item3d/prior/training/replicas.h"
#include "item3d/prior/training/tokenizer_training.h"
#include "item3d/prior/training/train_autoencoder.h"
#include "item3d/prior/training/train_diffusion.h"
#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/workers.h"

#include <algorithm>
#include <atomic>
#include <mutex>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// Random streams of the seed, one for each use.
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
        throw Interrupted("completed parts are in " + settings.work.string() +
                          "; run the same command with --resume to continue");
}

ExampleSource make_source(const TrainSettings& settings, std::vector<TrainingLight> lights,
                          bool held_out) {
    std::vector<ShapeView> views =
        make_view_pool(held_out, settings.shape_variants, settings.views_each,
                       seed_of(settings, held_out ? held_out_stream : view_stream),
                       drawing_threads(settings), settings.resolution);
    stop_if_interrupted(settings);
    return ExampleSource(std::move(views), std::move(lights),
                         seed_of(settings, held_out ? held_out_stream : example_stream),
                         settings.pattern_weight);
}

ImageData draw_images(const ExampleSource& source, std::int64_t count,
                      const TrainSettings& settings) {
    ImageData data;
    const int size = settings.resolution;
    data.images = at::empty({count, size, size, 3}, at::kByte);
    data.covered = at::empty({count, size, size}, at::kByte);
    Progress progress("images", count);
    std::atomic<std::int64_t> done = 0;
    std::mutex mutex;
    run_workers(count, drawing_threads(settings), [&](std::int64_t i) {
        const Example example = source.draw(i);
        data.images[i].copy_((example.image * 255).round());
        data.covered[i].copy_((example.covered * 255).round());
        const std::lock_guard lock(mutex);
        progress.update(++done);
    });
    stop_if_interrupted(settings);
    return data;
}

/// Encodes images [S, S, 3], sRGB in [0, 1], to [N, latent_channels, 16, 16] float32, not scaled.
at::Tensor encode(AutoencoderTiny& autoencoder, const std::vector<at::Tensor>& images) {
    // [N, H, W, 3] permuted to [N, 3, H, W] is channels-last already.
    const at::Tensor values = at::stack(images).permute({0, 3, 1, 2}) * 2 - 1;
    const Autocast autocast(at::kCPU);
    return autoencoder.encode(values).to(at::kFloat);
}

LatentData draw_latents(const ExampleSource& source, AutoencoderTiny& autoencoder,
                        const ClipTokenizer& tokenizer, const TrainSettings& settings) {
    constexpr std::int64_t at_once = 32;
    const std::int64_t count = settings.data_samples / at_once * at_once;
    const bool pairs = settings.condition == image_condition;
    LatentData data;
    data.latents = at::empty({count, latent_channels, latent_size, latent_size}, at::kHalf);
    if (pairs) data.sources = at::empty_like(data.latents);
    data.cells = at::empty({count, shape_cell_channels, latent_size, latent_size}, at::kHalf);
    data.tokens = at::empty({count, text_length}, at::kShort);
    data.empty_tokens = tokenizer.encode_batch({""}, text_length)[0].to(at::kShort);
    Progress progress(pairs ? "pairs" : "examples", count);
    std::atomic<std::int64_t> done = 0;
    std::mutex mutex;
    run_workers(count / at_once, drawing_threads(settings), [&](std::int64_t job) {
        std::vector<at::Tensor> images, before, cells;
        std::vector<std::string> texts;
        for (std::int64_t i = job * at_once; i < (job + 1) * at_once; ++i) {
            if (pairs) {
                InstructionPair pair = source.draw_pair(i);
                images.push_back(std::move(pair.after));
                before.push_back(std::move(pair.before));
                cells.push_back(std::move(pair.cells));
                texts.push_back(std::move(pair.instruction));
            } else {
                Example example = source.draw(i);
                images.push_back(std::move(example.image));
                cells.push_back(std::move(example.cells));
                texts.push_back(std::move(example.caption));
            }
        }
        const auto rows = [&](at::Tensor& all) {
            return all.slice(0, job * at_once, (job + 1) * at_once);
        };
        rows(data.latents).copy_(encode(autoencoder, images) * autoencoder.scaling_factor());
        if (pairs) rows(data.sources).copy_(encode(autoencoder, before));
        rows(data.cells).copy_(at::stack(cells));
        rows(data.tokens).copy_(tokenizer.encode_batch(texts, text_length));
        const std::lock_guard lock(mutex);
        progress.update(done += at_once);
    });
    stop_if_interrupted(settings);
    return data;
}

void open_work_folder(const TrainSettings& settings) {
    make_output_folder(settings.work);
    const fs::path file = settings.work / "settings.json";
    if (settings.resume && fs::exists(file)) {
        check_settings(file, read_work_json(file), data_settings_json(settings));
        return;
    }
    for (const char* stale : {"autoencoder.safetensors", "pictures.safetensors", "data.safetensors",
                              "checkpoint.safetensors", "autoencoder.json"})
        fs::remove(settings.work / stale);
    write_atomically(file, data_settings_json(settings).dump(2) + "\n");
}

struct Prepared {
    LatentData data;
    nlohmann::json record;  ///< value of prior.json's "train"
    ClipTextConfig text;
};

Prepared read_prepared(const TrainSettings& settings, const ClipTokenizer& tokenizer) {
    const fs::path file = settings.work / "data.safetensors";
    Prepared prepared;
    prepared.data =
        LatentData::from_tensors(SafeTensors::open(file).tensors(),
                                 static_cast<std::size_t>(tokenizer.largest_id()) + 1, file);
    prepared.record = read_work_json(settings.work / "autoencoder.json");
    return prepared;
}

TrainedAutoencoder draw_and_train_autoencoder(const ExampleSource& source,
                                              const std::vector<TrainingLight>& lights,
                                              const TrainSettings& settings) {
    const fs::path images_file = settings.work / "pictures.safetensors";
    if (!settings.resume || !fs::exists(images_file)) {
        const ExampleSource held_out = make_source(settings, lights, true);
        const ImageData seen = draw_images(source, settings.autoencoder_images, settings);
        const ImageData unseen = draw_images(
            held_out, std::min<std::int64_t>(512, settings.autoencoder_images), settings);
        save_safetensors(images_file, {{"images", seen.images},
                                       {"covered", seen.covered},
                                       {"held_out_images", unseen.images},
                                       {"held_out_covered", unseen.covered}});
    }
    const SafeTensors file = SafeTensors::open(images_file);
    TrainedAutoencoder autoencoder = train_autoencoder(
        {file.tensor("images"), file.tensor("covered")},
        {file.tensor("held_out_images"), file.tensor("held_out_covered")}, settings);
    note(fmt::format(
        "autoencoder: held-out PSNR {:.2f} dB, on objects {:.2f} dB, scaling factor {:.4f}",
        autoencoder.psnr, autoencoder.object_psnr, autoencoder.model->scaling_factor()));
    return autoencoder;
}

Prepared prepare(const TrainSettings& settings, const ClipTokenizer& tokenizer) {
    const std::vector<TrainingLight> lights = make_training_lights(
        seed_of(settings, light_stream), settings.lights, drawing_threads(settings));
    stop_if_interrupted(settings);
    const ExampleSource source = make_source(settings, lights, false);
    Prepared prepared;
    std::shared_ptr<AutoencoderTiny> autoencoder;
    if (!settings.init_from.empty()) {
        autoencoder = init_from_autoencoder(settings.init_from, settings.resolution);
        prepared.record = init_from_record(settings.init_from);
    } else if (!settings.autoencoder.empty()) {
        autoencoder = init_from_autoencoder(settings.autoencoder, settings.resolution);
        prepared.record = autoencoder_record(settings.autoencoder);
    } else {
        const TrainedAutoencoder trained = draw_and_train_autoencoder(source, lights, settings);
        autoencoder = trained.model;
        prepared.record = {{"psnr", trained.psnr}, {"object_psnr", trained.object_psnr}};
    }
    export_autoencoder(settings.output, *autoencoder, tokenizer);
    write_atomically(settings.work / "autoencoder.json", prepared.record.dump(2) + "\n");
    prepared.data = draw_latents(source, *autoencoder, tokenizer, settings);
    save_safetensors(settings.work / "data.safetensors", prepared.data.tensors());
    return prepared;
}

/// Reads the tokenizer of resumed data, because the data contains its token ids.
ClipTokenizer read_tokenizer(const TrainSettings& settings) {
    const fs::path folder = settings.output / "tokenizer";
    if (!fs::exists(folder / "vocab.json"))
        throw InputError(folder.string(),
                         "is missing, but the data in " + settings.work.string() +
                             " was made with its tokenizer",
                         "use the -o of the first run, or train without --resume");
    return ClipTokenizer::load(folder);
}

/// Does process 0's work before the joint training.
Prepared prepare_or_read(const TrainSettings& settings) {
    check_init_from(settings);
    make_output_folder(settings.output);
    open_work_folder(settings);
    const std::vector<WordCount> counted = prior_words(settings);
    const bool prepared_before = settings.resume && fs::exists(settings.work / "data.safetensors");
    const ClipTokenizer tokenizer = prepared_before ? read_tokenizer(settings)
                                    : settings.init_from.empty()
                                        ? train_tokenizer(counted, text_length)
                                        : ClipTokenizer::load(settings.init_from / "tokenizer");
    if (!prepared_before) {
        std::set<std::string> words;
        for (const WordCount& word : counted)
            words.insert(word.word);
        if (!settings.init_from.empty()) words = trained_words(settings.init_from, tokenizer);
        update_prior_json(settings.output, {{"words", words}, {"resolution", settings.resolution}});
    }
    Prepared prepared =
        prepared_before ? read_prepared(settings, tokenizer) : prepare(settings, tokenizer);
    prepared.text = prior_text_config(static_cast<int>(tokenizer.size()), tokenizer.bos_id(),
                                      tokenizer.eos_id());
    return prepared;
}

/// Broadcasts the prepared data to all processes.
Prepared broadcast_prepared(const ProcessGroup& processes, Prepared prepared) {
    if (processes.size() == 1) return prepared;
    processes.wait_for_first();
    const ClipTextConfig& text = prepared.text;
    const auto numbers = nlohmann::json::parse(processes.broadcast(
        nlohmann::json{text.vocab_size, text.bos_token_id, text.eos_token_id}.dump()));
    prepared.text =
        prior_text_config(numbers[0].get<int>(), numbers[1].get<int>(), numbers[2].get<int>());
    const NamedTensors data =
        processes.broadcast(processes.first() ? prepared.data.tensors() : NamedTensors{});
    prepared.data = LatentData::from_tensors(
        data, static_cast<std::size_t>(prepared.text.vocab_size), "the data of process 0");
    return prepared;
}

/// Measures the prior in `folder` (classifier.h) on its trained words and stores the result, with
/// these words, in its prior.json. Returns the new contents.
nlohmann::json write_measurement(const fs::path& folder, int word_images, int threads) {
    const Pipeline pipeline = Pipeline::load(folder);
    MeasureOptions options;
    options.images = word_images;
    options.threads = threads;
    options.words = trained_words(folder, pipeline.tokenizer());
    const auto views = held_out_views(pipeline, options.seed, threads);
    nlohmann::json measured = measure_prior(pipeline, views, options);
    measured["words"] = options.words;
    return update_prior_json(folder, measured);
}

}  // namespace

std::vector<WordCount> prior_words(const TrainSettings& settings) {
    return caption_vocabulary(seed_of(settings, vocabulary_stream));
}

void train_prior(const TrainSettings& settings) {
    keep_freed_memory();
    const ProcessGroup& processes = settings.processes;
    check_same_settings(processes, settings_json(settings));
    const Prepared prepared =
        broadcast_prepared(processes, processes.first() ? prepare_or_read(settings) : Prepared{});
    train_diffusion(prepared.data, settings, {prior_unet_config(settings), prepared.text},
                    prepared.record);
    // Words are measured unless the network is conditioned on an image. Such a network reads
    // instructions, which do not describe the whole image.
    if (processes.first() && settings.condition != image_condition)
        write_measurement(settings.output, settings.word_images, drawing_threads(settings));
    processes.wait_for_first();
}

}  // namespace item3d
