#include "item3d/prior/training/vision_language.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/prior_folder.h"
#include "item3d/prior/evaluation/vision_language_accuracy.h"
#include "item3d/prior/training/init_from.h"
#include "item3d/prior/training/tokenizer_training.h"
#include "item3d/prior/training/train.h"
#include "item3d/prior/training/train_captioner.h"
#include "item3d/prior/training/train_clip.h"
#include "item3d/tensors/workers.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace item3d {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t held_out_images = 2000;
constexpr int held_out_lights = 64;
constexpr const char* seen_name = "labeled";
constexpr const char* held_out_name = "labeled_held_out";

/// Returns the settings that the images depend on: images of other settings are not reused.
nlohmann::json labeled_fingerprint(const TrainSettings& s) {
    return {{"version", 6},
            {"seed", s.seed},
            {"labeled_samples", s.labeled_samples},
            {"shape_variants", s.labeled_variants},
            {"views_each", s.views_each},
            {"lights", s.lights}};
}

/// Draws the images, or keeps those of an interrupted run.
void prepare_labeled(const TrainSettings& settings) {
    make_output_folder(settings.work);
    const fs::path file = settings.work / "labeled_settings.json";
    const bool resumes = settings.resume && fs::exists(file);
    if (resumes) check_settings(file, read_work_json(file), labeled_fingerprint(settings));
    if (resumes && has_labeled(settings.work, seen_name) &&
        has_labeled(settings.work, held_out_name))
        return;
    write_atomically(file, labeled_fingerprint(settings).dump(2) + "\n");
    const std::uint64_t seed = mix_bits(settings.seed * 1000 + 31);
    save_labeled(
        settings.work, held_out_name,
        draw_held_out(seed, held_out_images, settings.views_each,
                      std::min(settings.lights, held_out_lights), drawing_threads(settings)));
    std::vector<TrainingLight> lights =
        make_training_lights(mix_bits(seed + 11), settings.lights, drawing_threads(settings));
    stop_here_if_interrupted(settings);
    std::vector<ShapeView> views =
        make_view_pool(false, settings.labeled_variants, settings.views_each, mix_bits(seed + 12),
                       drawing_threads(settings));
    stop_here_if_interrupted(settings);
    const ExampleSource source(std::move(views), std::move(lights), mix_bits(seed + 13));
    const LabeledImages seen =
        draw_labeled(source, settings.labeled_samples, drawing_threads(settings));
    stop_here_if_interrupted(settings);
    save_labeled(settings.work, seen_name, seen);
}

/// Broadcasts the images to all processes.
LabeledImages broadcast_labeled(const ProcessGroup& processes, LabeledImages data) {
    if (processes.size() == 1) return data;
    processes.wait_for_first();
    const std::string labels = processes.broadcast(nlohmann::json(data.labels).dump());
    const NamedTensors images = processes.broadcast(NamedTensors{{"images", data.images}});
    if (!processes.first())
        data = {images[0].second, parse_json_or_throw(labels).get<std::vector<ImageLabels>>()};
    return data;
}

/// Adds the training record of the network whose weights the training started from.
void note_begin(const TrainSettings& settings, const char* folder, const char* member,
                nlohmann::json& record) {
    if (init_from_part(settings, folder).empty()) return;
    const nlohmann::json begun_with = read_prior_json(settings.init_from);
    if (begun_with.contains(member)) record["begun_with"] = begun_with[member];
}

}  // namespace

void stop_here_if_interrupted(const TrainSettings& settings) {
    if (interrupted())
        throw Interrupted("completed parts are in " + settings.work.string() +
                          "; run the same command with --resume to continue");
}

at::Tensor read_sentences(const ClipTokenizer& tokenizer, const std::vector<std::string>& texts) {
    std::size_t longest = 0;
    for (const std::string& text : texts)
        longest = std::max(longest, tokenizer.encode(text).size());
    const auto length = std::min<std::int64_t>(static_cast<std::int64_t>(longest), text_length);
    return tokenizer.encode_batch(texts, static_cast<int>(length));
}

at::Tensor augment(const at::Tensor& pixel_values, Random& random) {
    std::vector<std::uint8_t> mirrored;
    for (std::int64_t i = 0; i < pixel_values.size(0); ++i)
        mirrored.push_back(random.chance(.5));
    const at::Tensor chosen =
        at::tensor(mirrored).to(pixel_values.device(), at::kBool).view({-1, 1, 1, 1});
    const at::Tensor turned = at::where(chosen, pixel_values.flip(3), pixel_values);
    if (random.chance(.5)) {
        constexpr std::array<std::int64_t, 2> size{read_size, read_size};
        return at::_upsample_bicubic2d_aa(turned, size, false).clamp(-1, 1);
    }
    constexpr std::int64_t places = prior_image_size - read_size + 1;
    const std::int64_t top = random.index(places), left = random.index(places);
    return turned.narrow(2, top, read_size).narrow(3, left, read_size);
}

LoopOptions vision_language_loop(const std::string& name, const TrainSettings& settings,
                                 std::int64_t samples, std::int64_t rows) {
    LoopOptions options = loop_options(settings, name, name + "_checkpoint.safetensors");
    options.samples = samples;
    options.rows = rows;
    options.rise = std::min(30000.0, static_cast<double>(samples) / 8);
    options.orthogonal = settings.optimizer == "muon";
    return options;
}

nlohmann::json loop_summary(const LoopRecord& record, std::int64_t parameters,
                            const TrainSettings& settings) {
    return {{"samples", record.seen},
            {"seconds", std::round(record.seconds)},
            {"loss", record.loss},
            {"seed", settings.seed},
            {"parameters", parameters}};
}

void write_preprocessor(const fs::path& folder, const std::string& processor_class, int size) {
    const nlohmann::json config{
        {"image_processor_type", processor_class},
        {"do_convert_rgb", true},
        {"do_resize", true},
        {"size", {{"height", size}, {"width", size}}},
        {"resample", 3},
        {"do_center_crop", false},
        {"do_rescale", true},
        {"rescale_factor", 1.0 / 255},
        {"do_normalize", true},
        {"image_mean", {.5, .5, .5}},
        {"image_std", {.5, .5, .5}},
    };
    write_atomically(folder / "preprocessor_config.json", config.dump(2) + "\n");
}

void train_vision_language(const TrainSettings& settings, bool clip, bool captioner) {
    keep_freed_memory();
    const ProcessGroup& processes = settings.processes;
    check_same_settings(processes, settings_json(settings));
    LabeledImages data, held_out;
    if (processes.first()) {
        check_init_from_readers(settings, clip, captioner);
        make_output_folder(settings.output);
        prepare_labeled(settings);
        data = load_labeled(settings.work, seen_name);
        held_out = load_labeled(settings.work, held_out_name);
    }
    data = broadcast_labeled(processes, std::move(data));
    const std::vector<WordCount> words = prior_words(settings);
    // CLIP's vision transformer starts from the captioner's.
    if (captioner) {
        nlohmann::json record = train_captioner(
            data, settings, words, prior_captioner_config(static_cast<int>(words.size())));
        if (processes.first()) {
            note_begin(settings, captioner_folder, "captioner", record);
            record["captions"] =
                measure_captions(*load_captioner(settings.output / captioner_folder), held_out,
                                 drawing_threads(settings));
            note("captioner: " + record["captions"].dump());
            update_prior_json(settings.output, {{"captioner", record}});
        }
        processes.wait_for_first();
    }
    if (clip) {
        const auto begin = init_from_part(settings, clip_folder);
        const ClipTokenizer tokenizer =
            begin.empty() ? train_tokenizer(words, text_length) : ClipTokenizer::load(begin);
        nlohmann::json record =
            train_clip(data, settings, tokenizer,
                       prior_clip_config(static_cast<int>(tokenizer.size()), tokenizer.bos_id(),
                                         tokenizer.eos_id()));
        if (processes.first()) {
            note_begin(settings, clip_folder, "clip", record);
            record["retrieval"] =
                measure_retrieval(Clip::load(settings.output / clip_folder), held_out);
            note("clip: " + record["retrieval"].dump());
            update_prior_json(settings.output, {{"clip", record}});
        }
    }
}

}  // namespace item3d
