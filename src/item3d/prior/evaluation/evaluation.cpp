#include "item3d/prior/evaluation/evaluation.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/format.h"
#include "item3d/core/parse_json.h"
#include "item3d/core/progress.h"
#include "item3d/io/save.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/diffusion/shape_condition.h"
#include "item3d/prior/data/prior_folder.h"
#include "item3d/prior/evaluation/classifier.h"
#include "item3d/prior/evaluation/evaluation_images.h"
#include "item3d/prior/evaluation/part_accuracy.h"
#include "item3d/prior/evaluation/vision_language_accuracy.h"
#include "item3d/report/animation.h"
#include "item3d/report/contact_sheet.h"
#include "item3d/report/display_image.h"
#include "item3d/report/html.h"

#include <algorithm>
#include <map>
#include <optional>

namespace item3d {
namespace {

namespace fs = std::filesystem;

constexpr int shown_edge = 128;
constexpr int one_a_row = 900;  ///< minimum width of a sheet, in pixels of the page
constexpr int model_views = 4;  ///< views for a model's caption, as in `item3d caption`

Image sample_sheet(const SampleGrid& grid) {
    std::vector<Tile> tiles;
    for (std::size_t i = 0; i < grid.images.size(); ++i)
        tiles.push_back({resize(grid.images[i], shown_edge, shown_edge), grid.prompts[i]});
    ContactSheetOptions options;
    options.columns = static_cast<int>(grid.objects.size());
    return contact_sheet(tiles, options);
}

Image reconstruction_sheet(const ReconstructionMeasure& measure) {
    std::vector<Tile> tiles;
    for (const auto* row : {&measure.images, &measure.reconstructions})
        for (const Image& image : *row)
            tiles.push_back({resize(image, shown_edge, shown_edge), ""});
    ContactSheetOptions options;
    options.columns = static_cast<int>(measure.images.size());
    return contact_sheet(tiles, options);
}

void stop_if_asked() {
    if (interrupted()) throw Interrupted("nothing was written");
}

/// Measures the prior's own segmenter on held-out images.
nlohmann::json measure_segmenter(const fs::path& folder, const EvaluationOptions& options) {
    const Segmenter segmenter = Segmenter::load(folder / segmenter_folder);
    return measure_parts(segmenter, draw_held_out_parts(mix_bits(options.seed + 8),
                                                        options.part_images, options.threads));
}

/// Measures the prior's own CLIP, captioner and segmenter on held-out images.
nlohmann::json measure_readers(const fs::path& folder, const std::optional<Clip>& clip,
                               const EvaluationOptions& options) {
    nlohmann::json measured = nlohmann::json::object();
    if (fs::exists(folder / segmenter_folder / "config.json"))
        measured["parts"] = measure_segmenter(folder, options);
    const bool captioner = fs::exists(folder / captioner_folder / "config.json");
    if (!clip && !captioner) return measured;
    const LabeledImages images =
        draw_held_out(mix_bits(options.seed + 5), options.labeled_images, 4, 64, options.threads);
    stop_if_asked();
    if (clip) measured["retrieval"] = measure_retrieval(*clip, images);
    if (captioner) {
        const auto model = load_captioner(folder / captioner_folder);
        measured["captions"] = measure_captions(*model, images, options.threads);
        measured["model_captions"] = measure_model_captions(
            *model,
            draw_held_out_models(mix_bits(options.seed + 6), options.labeled_models, model_views,
                                 options.threads),
            options.threads);
        measured["model_captions"]["views"] = model_views;
    }
    return measured;
}

/// Returns prior.json's records of CLIP, captioner and segmenter, with the accuracies in `readers`.
nlohmann::json readers_record(const fs::path& folder, const nlohmann::json& readers) {
    const nlohmann::json prior = read_prior_json(folder);
    nlohmann::json record = nlohmann::json::object();
    for (const auto& [part, reached] :
         {std::pair{"clip", "retrieval"}, std::pair{"captioner", "captions"},
          std::pair{"captioner", "model_captions"}, std::pair{"segmenter", "parts"}}) {
        if (!readers.contains(reached)) continue;
        if (!record.contains(part)) record[part] = prior.value(part, nlohmann::json::object());
        record[part][reached] =
            reached == std::string("parts") ? part_summary(readers[reached]) : readers[reached];
    }
    return record;
}

/// Returns the measurements of words in the prior's prior.json.
nlohmann::json earlier_measurement(const fs::path& folder) {
    const fs::path file = folder / "prior.json";
    nlohmann::json prior;
    if (fs::exists(file)) prior = parse_json(read_text(file));
    nlohmann::json measured = nlohmann::json::object();
    for (const char* member : {"accuracy", "kinds", "vocabulary"}) {
        if (!prior.is_object() || !prior.contains(member))
            throw InputError(file.string(), "does not contain the accuracy of words",
                             "use --word-images with at least 1");
        measured[member] = prior[member];
    }
    return measured;
}

std::string percent(const nlohmann::json& value) {
    return fmt::format("{:.0f} %", 100 * value.get<double>());
}

/// Returns bars of a kind's words, least accurate first.
std::string word_bars(const nlohmann::json& words) {
    std::vector<ReportPart> parts;
    for (const nlohmann::json& word : words)
        parts.push_back({word.at("word"), word.at("accuracy"),
                         word.contains("most_confused_with")
                             ? "taken for " + word["most_confused_with"].get<std::string>()
                             : ""});
    std::stable_sort(parts.begin(), parts.end(),
                     [](const auto& a, const auto& b) { return a.value < b.value; });
    return html_parts(parts);
}

/// Returns bars of parts by name, least accurate first.
std::string part_bars(const nlohmann::json& worst_first) {
    std::vector<ReportPart> parts;
    for (const nlohmann::json& part : worst_first)
        parts.push_back({part.at(0), part.at(1), ""});
    return html_parts(parts);
}

TableRows summary_rows(const nlohmann::json& evaluation) {
    TableRows rows;
    for (const auto& [kind, summary] : evaluation.at("kinds").items()) {
        std::string text = percent(summary.at("accuracy")) +
                           fmt::format(" of {} words' images", summary.at("words").get<int>());
        if (summary.contains("on_new_classes"))
            text +=
                ", " + percent(summary["on_new_classes"]) + " on classes that were not trained on";
        rows.emplace_back(kind, text);
    }
    const nlohmann::json& autoencoder = evaluation.at("autoencoder");
    rows.emplace_back("autoencoder", fmt::format("{:.1f} dB, on objects {:.1f} dB",
                                                 autoencoder.at("psnr").get<double>(),
                                                 autoencoder.at("object_psnr").get<double>()));
    for (const char* kind : {"samples", "samples_in_shape"}) {
        if (!evaluation.contains(kind)) continue;
        const nlohmann::json& samples = evaluation[kind];
        rows.emplace_back(
            kind == std::string("samples") ? "samples from text" : "samples in given shapes",
            fmt::format(
                "CLIP recognizes the object in {}, the material in {}, both in {} ({} images)",
                percent(samples.at("object_right")), percent(samples.at("material_right")),
                percent(samples.at("right")), samples.at("pictures").get<int>()));
    }
    const nlohmann::json& readers = evaluation.at("readers");
    if (readers.contains("retrieval"))
        rows.emplace_back(
            "CLIP", "finds the right one of " + readers["retrieval"].at("candidates").dump() +
                        " captions for " + percent(readers["retrieval"].at("picture_to_caption")));
    for (const auto& [member, what] :
         {std::pair{"captions", "captioner, an image in any light"},
          std::pair{"model_captions", "captioner, a model from four sides in a studio"}}) {
        if (!readers.contains(member)) continue;
        const nlohmann::json& named = readers[member];
        rows.emplace_back(what, "recognizes the object in " + percent(named.at("object")) +
                                    ", the material in " + percent(named.at("material")) +
                                    ", both in " + percent(named.at("both")) +
                                    "; object and name of the material in " +
                                    percent(named.at("object_and_name")));
    }
    if (readers.contains("parts")) {
        const nlohmann::json& found = readers["parts"];
        rows.emplace_back(
            "segmenter",
            fmt::format("intersection over union {:.2f} of named parts, {:.2f} on classes that "
                        "were not trained on, {:.2f} of the object",
                        found.at("part_iou").get<double>(), found.at("new_class_iou").get<double>(),
                        found.at("object_iou").get<double>()));
    }
    if (!evaluation.contains("edits")) return rows;
    for (const auto& [group, total] : evaluation["edits"].at("groups").items())
        rows.emplace_back(
            "edits: " + group,
            fmt::format("{}{}, {:.0f} s each, detail kept {:.2f}",
                        total.contains("right") ? total["right"].dump() + " right of " : "",
                        total.at("edits").dump(), total.at("seconds").get<double>(),
                        total.at("kept").get<double>()));
    return rows;
}

}  // namespace

std::string evaluation_page(const nlohmann::json& evaluation,
                            const std::vector<std::pair<std::string, Bytes>>& sheets) {
    const auto prior = evaluation.at("prior").get<std::string>();
    std::string body = html_header("item3d prior evaluate", prior);
    body += html_section("Summary", html_table(summary_rows(evaluation)));
    std::vector<std::string> images;
    for (const auto& [caption, bytes] : sheets)
        images.push_back(html_figure({caption, bytes}));
    body += html_section("Images", html_gallery(images, one_a_row));
    for (const auto& [kind, words] : evaluation.at("vocabulary").items())
        body += html_section("Words: " + kind, word_bars(words));
    if (evaluation.at("readers").contains("parts"))
        body += html_section("Parts, by intersection over union",
                             part_bars(evaluation["readers"]["parts"].at("worst")));
    return html_page("What " + prior + " knows", body);
}

nlohmann::json evaluate_segmenter(const fs::path& folder, const EvaluationOptions& options) {
    const nlohmann::json measured{{"parts", measure_segmenter(folder, options)}};
    update_prior_json(folder, readers_record(folder, measured));
    return measured["parts"];
}

nlohmann::json evaluate_prior(const fs::path& folder, const fs::path& output,
                              const EvaluationOptions& options) {
    nlohmann::json measured;
    if (options.word_images == 0) measured = earlier_measurement(folder);
    make_output_folder(output);
    const Pipeline pipeline = Pipeline::load(folder);
    MeasureOptions measure;
    measure.images = options.word_images;
    measure.words = trained_words(folder, pipeline.tokenizer());
    measure.seed = options.seed;
    measure.threads = options.threads;
    const std::vector<ShapeView> views = held_out_views(pipeline, options.seed, options.threads);
    stop_if_asked();
    const ReconstructionMeasure autoencoder =
        measure_autoencoder(pipeline, views, options.images, options.seed);
    stop_if_asked();
    std::optional<Clip> clip;
    if (fs::exists(folder / clip_folder / "config.json")) clip = Clip::load(folder / clip_folder);
    std::vector<std::pair<std::string, Image>> sheets;
    nlohmann::json evaluation{{"prior", folder.string()}, {"seed", options.seed}};
    for (const bool with_shape : {false, true}) {
        if (with_shape && !takes_shape(pipeline)) continue;
        const SampleGrid grid =
            draw_samples(folder, pipeline, measure.words, 8, with_shape, options.seed);
        const std::string name = with_shape ? "samples_in_shape" : "samples";
        if (clip) evaluation[name] = score_samples(*clip, grid);
        sheets.emplace_back(name, sample_sheet(grid));
    }
    sheets.emplace_back("autoencoder", reconstruction_sheet(autoencoder));
    evaluation["autoencoder"] = {{"psnr", autoencoder.psnr},
                                 {"object_psnr", autoencoder.object_psnr},
                                 {"pictures", options.images}};
    evaluation["readers"] = measure_readers(folder, clip, options);
    if (options.word_images > 0) measured = measure_prior(pipeline, views, measure);
    evaluation.update(measured);

    measured["words"] = measure.words;
    measured.update(readers_record(folder, evaluation["readers"]));
    update_prior_json(folder, measured);
    static const std::map<std::string, std::string> captions{
        {"samples", "Generated from the prompts alone"},
        {"samples_in_shape", "Generated in the shape of unseen objects"},
        {"autoencoder", "Held-out images, and below them the output of the autoencoder"}};
    std::vector<std::pair<std::string, Bytes>> encoded;
    for (const auto& [name, image] : sheets) {
        save_image(output / (name + ".png"), image);
        encoded.emplace_back(captions.at(name), encode_webp(image));
    }
    const auto write = [&] {
        write_atomically(output / "evaluate.json", evaluation.dump(2) + "\n");
        write_atomically(output / "evaluate.html", evaluation_page(evaluation, encoded));
    };
    write();  // written before the edits, which may take an hour
    if (options.edits) {
        evaluation["edits"] = options.edits();
        write();
    }
    return evaluation;
}

}  // namespace item3d
