#include "item3d/prior/training/segmenter_training.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/networks/vision_language/segmenter.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/prior_folder.h"
#include "item3d/prior/evaluation/part_accuracy.h"
#include "item3d/prior/training/init_from.h"
#include "item3d/prior/training/tokenizer_training.h"
#include "item3d/prior/training/train.h"
#include "item3d/prior/training/train_segmenter.h"
#include "item3d/prior/training/vision_language.h"
#include "item3d/tensors/workers.h"

#include <algorithm>

namespace item3d {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t held_out_part_images = 500;
constexpr int part_views_each = 4;
/// Maximum number of lights. More would take longer to prefilter than the images take to draw.
constexpr int part_lights = 96;
constexpr const char* part_images_name = "parts";

/// Returns the settings that the images depend on: images of other settings are not reused.
nlohmann::json part_fingerprint(const TrainSettings& s) {
    return {{"version", 3},
            {"seed", s.seed},
            {"part_samples", s.part_samples},
            {"part_variants", s.part_variants},
            {"lights", std::min(s.lights, part_lights)}};
}

/// Draws the images, or reads those of an interrupted run.
PartImages prepare_part_images(const TrainSettings& settings) {
    make_output_folder(settings.work);
    const fs::path file = settings.work / "parts_settings.json";
    const bool resumes = settings.resume && fs::exists(file);
    if (resumes) check_settings(file, read_work_json(file), part_fingerprint(settings));
    if (!resumes || !has_part_images(settings.work, part_images_name)) {
        write_atomically(file, part_fingerprint(settings).dump(2) + "\n");
        const std::uint64_t seed = mix_bits(settings.seed * 1000 + 41);
        std::vector<TrainingLight> lights = make_training_lights(
            mix_bits(seed + 1), std::min(settings.lights, part_lights), drawing_threads(settings));
        stop_here_if_interrupted(settings);
        std::vector<ShapeView> views =
            make_view_pool(false, settings.part_variants, part_views_each, mix_bits(seed + 2),
                           drawing_threads(settings), part_image_size);
        stop_here_if_interrupted(settings);
        const ExampleSource source(std::move(views), std::move(lights), mix_bits(seed + 3));
        const PartImages drawn =
            draw_part_images(source, settings.part_samples, drawing_threads(settings));
        stop_here_if_interrupted(settings);
        save_part_images(settings.work, part_images_name, drawn);
    }
    return load_part_images(settings.work, part_images_name);
}

/// Broadcasts the data to all processes.
PartImages broadcast_parts(const ProcessGroup& processes, PartImages data) {
    if (processes.size() == 1) return data;
    processes.wait_for_first();
    const std::string labels = processes.broadcast(nlohmann::json(data.labels).dump());
    const NamedTensors tensors =
        processes.broadcast(NamedTensors{{"images", data.images}, {"parts", data.parts}});
    if (!processes.first())
        data = {tensors[0].second, tensors[1].second,
                parse_json_or_throw(labels).get<std::vector<PartLabels>>()};
    return data;
}

/// Returns the folder of the initial weights; empty for none.
fs::path find_begin(const TrainSettings& settings) {
    if (const fs::path own = init_from_part(settings, segmenter_folder); !own.empty()) return own;
    const fs::path clip = settings.output / clip_folder;
    return fs::exists(clip / "config.json") ? clip : init_from_part(settings, clip_folder);
}

/// Throws InputError if the weights in `begin` are of a segmenter of another size. Runs before the
/// images are drawn.
void check_begin_size(const fs::path& begin, const ClipSegConfig& wanted) {
    if (begin.filename() != segmenter_folder) return;
    if (load_clip_seg(begin)->config().to_json() != wanted.to_json())
        throw InputError((begin / "config.json").string(),
                         "is for a network of a different size than in this training",
                         "train this part without --init-from");
}

}  // namespace

void train_segmenter_part(const TrainSettings& settings) {
    keep_freed_memory();
    const ProcessGroup& processes = settings.processes;
    check_same_settings(processes, settings_json(settings));
    // Initial weights are checked before the images are drawn, so that errors appear at once.
    const fs::path begin = find_begin(settings);
    const ClipTokenizer tokenizer = begin.empty()
                                        ? train_tokenizer(prior_words(settings), text_length)
                                        : ClipTokenizer::load(begin);
    const ClipSegConfig config = prior_segmenter_config(static_cast<int>(tokenizer.size()),
                                                        tokenizer.bos_id(), tokenizer.eos_id());
    PartImages data;
    if (processes.first()) {
        if (!begin.empty()) check_begin_size(begin, config);
        make_output_folder(settings.output);
        data = prepare_part_images(settings);
    }
    data = broadcast_parts(processes, std::move(data));
    nlohmann::json record = train_segmenter(data, settings, tokenizer, config, begin);
    if (processes.first()) {
        const PartImages held_out = draw_held_out_parts(
            mix_bits(settings.seed * 1000 + 42), held_out_part_images, drawing_threads(settings));
        const Segmenter segmenter =
            Segmenter::load(settings.output / segmenter_folder, settings.device);
        record["parts"] = part_summary(measure_parts(segmenter, held_out));
        note("segmenter: " + record["parts"].dump());
        update_prior_json(settings.output, {{"segmenter", record}});
    }
    processes.wait_for_first();
}

}  // namespace item3d
