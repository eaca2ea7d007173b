#include "item3d/prior/training/train_captioner.h"

#include "item3d/core/files.h"
#include "item3d/core/random.h"
#include "item3d/prior/data/captions.h"
#include "item3d/prior/data/prior_folder.h"
#include "item3d/prior/training/init_from.h"
#include "item3d/prior/training/replicas.h"
#include "item3d/prior/training/training_loop.h"
#include "item3d/prior/training/vision_language.h"
#include "item3d/text/bert_tokenizer.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>

namespace item3d {
namespace {

constexpr int captioner_batch = 64;
/// Captioner's learning rate as a multiple of the U-Net's maximum. Its steps have twice as many
/// images.
constexpr float captioner_rate = 2;
/// First tokens of a vocabulary; their positions are their ids.
constexpr const char* special_tokens[] = {"[PAD]", "[UNK]", "[CLS]", "[SEP]", "[MASK]"};
constexpr int pad_id = 0, begin_id = 2, end_id = 3;

/// Returns the content of the vocabulary file: one token per line.
std::string vocabulary_of(const std::vector<WordCount>& words) {
    std::string lines;
    for (const char* token : special_tokens)
        lines += std::string(token) + "\n";
    // `words` are those of CLIP's tokenizer, which splits "3d" into two words. This vocabulary has
    // "3d" in place of "d", which never occurs alone.
    for (const WordCount& word : words)
        lines += (word.word == "d" ? "3d" : word.word) + "\n";
    return lines;
}

void write_tokenizer(const std::filesystem::path& folder, const std::string& vocabulary) {
    write_atomically(folder / "vocab.txt", vocabulary);
    const nlohmann::json config{{"tokenizer_class", "BertTokenizer"},
                                {"do_lower_case", true},
                                {"model_max_length", text_length},
                                {"unk_token", "[UNK]"},
                                {"cls_token", "[CLS]"},
                                {"sep_token", "[SEP]"},
                                {"pad_token", "[PAD]"},
                                {"mask_token", "[MASK]"}};
    write_atomically(folder / "tokenizer_config.json", config.dump(2) + "\n");
}

/// Returns the tokenizer that load() gives after write_tokenizer(), for a process that may not
/// write to the output.
BertTokenizer tokenizer_without_folder(const std::string& vocabulary) {
    const auto folder =
        std::filesystem::temp_directory_path() / ("item3d_tokenizer_" + std::to_string(::getpid()));
    make_output_folder(folder);
    write_tokenizer(folder, vocabulary);
    BertTokenizer tokenizer = BertTokenizer::load(folder);
    std::filesystem::remove_all(folder);
    return tokenizer;
}

BlipModel make_captioner(const TrainSettings& settings, const BlipConfig& config) {
    at::manual_seed(static_cast<std::int64_t>(settings.seed) + 3);
    BlipModel model(config);
    const at::NoGradGuard no_grad;
    for (auto& item : model->named_parameters()) {
        const auto is = [&](const char* part) {
            return item.key().find(part) != std::string::npos;
        };
        if (is("_embedding")) item.value().normal_(0, .05);
        if (item.key() == "text_decoder.cls.predictions.bias") item.value().zero_();
    }
    return model;
}

/// Returns the cross-entropy of each next token of the caption. The caption omits a part that has
/// its own material: such a part covers few pixels of these images, and one wrong word makes a
/// whole sentence wrong.
at::Tensor caption_loss(BlipModel model, const LabeledImages& data, const BertTokenizer& tokenizer,
                        const std::vector<std::int64_t>& rows, Random random) {
    std::vector<std::vector<int>> texts;
    std::size_t longest = 0;
    for (const std::int64_t row : rows) {
        const ClaimedLabels claim = whole_claim(data.labels[static_cast<std::size_t>(row)]);
        texts.push_back(tokenizer.encode(claim.text(draw_frame(random))));
        longest = std::max(longest, texts.back().size());
    }
    constexpr std::int64_t ignored = -100;
    const auto count = static_cast<std::int64_t>(rows.size());
    const auto length = static_cast<std::int64_t>(longest) - 1;
    at::Tensor tokens = at::full({count, length}, pad_id, at::kLong);
    at::Tensor next = at::full({count, length}, ignored, at::kLong);
    for (std::size_t i = 0; i < texts.size(); ++i) {
        auto* token = tokens[static_cast<std::int64_t>(i)].data_ptr<std::int64_t>();
        auto* target = next[static_cast<std::int64_t>(i)].data_ptr<std::int64_t>();
        for (std::size_t k = 0; k + 1 < texts[i].size(); ++k) {
            token[k] = texts[i][k];
            target[k] = texts[i][k + 1];
        }
    }
    const at::Device device = model->parameters().front().device();
    tokens = tokens.to(device);
    next = next.to(device);
    at::Tensor logits;
    {
        const Autocast autocast(device);
        const at::Tensor image =
            model->image_embeds(augment(data.pixel_values(rows).to(device), random));
        // A token attends only to earlier ones, so padding after a text needs no mask.
        const at::Tensor states =
            model->decode(tokens, at::ones_like(tokens), model->read_image(image));
        logits = model->logits(states);
    }
    return at::cross_entropy_loss(logits.to(at::kFloat).flatten(0, 1), next.flatten(), {},
                                  at::Reduction::Mean, ignored);
}

}  // namespace

BlipConfig prior_captioner_config(int words) {
    BlipConfig config;
    static_cast<VisionShape&>(config.vision) = prior_vision_shape;
    config.vocab_size = words + static_cast<int>(std::size(special_tokens));
    config.hidden_size = 192;
    config.intermediate_size = 768;
    config.num_hidden_layers = 2;
    config.num_attention_heads = 6;
    config.max_position_embeddings = 64;
    config.bos_token_id = begin_id;
    config.sep_token_id = end_id;
    config.pad_token_id = pad_id;
    return config;
}

nlohmann::json train_captioner(const LabeledImages& data, const TrainSettings& settings,
                               const std::vector<WordCount>& words, BlipConfig config) {
    const auto folder = settings.output / captioner_folder;
    const auto begin = init_from_part(settings, captioner_folder);
    // A training that starts from given weights keeps their vocabulary, because token ids index the
    // rows of the embeddings.
    const std::string vocabulary =
        begin.empty() ? vocabulary_of(words) : read_text(begin / "vocab.txt");
    if (!begin.empty())
        config.vocab_size = BlipConfig::from_config(Config::read(begin / "config.json")).vocab_size;
    if (settings.processes.first()) {
        make_output_folder(folder);
        write_tokenizer(folder, vocabulary);
        write_preprocessor(folder, "BlipImageProcessor");
    }
    const BertTokenizer tokenizer = settings.processes.first()
                                        ? BertTokenizer::load(folder)
                                        : tokenizer_without_folder(vocabulary);

    std::vector<LoopReplica> replicas;
    for (int rank = 0; rank < settings.replicas; ++rank) {
        BlipModel model = make_captioner(settings, config);
        if (!begin.empty()) init_from_captioner(begin, model);
        model->to(settings.device);
        const auto stream = static_cast<std::uint64_t>(global_rank(settings, rank));
        replicas.push_back({{model.ptr()}, [&, model, stream](const auto& rows, auto step) {
                                const Random random(settings.seed, 0xb11900 + stream,
                                                    static_cast<std::uint64_t>(step) * 65536);
                                return caption_loss(model, data, tokenizer, rows, random);
                            }});
    }
    LoopOptions options =
        vision_language_loop("captioner", settings, settings.captioner_samples, data.count());
    options.batch = captioner_batch;
    options.learning_rate *= captioner_rate;
    TrainingLoop loop(options, std::move(replicas));

    const BlipModel exported = make_captioner(settings, config);
    FlatModel flat({exported.ptr()});
    nlohmann::json train;
    loop.run([&](const at::Tensor& average, const LoopRecord& record) {
        flat.values.copy_(average);
        save_blip(folder, exported);
        train = loop_summary(record, loop.parameters(), settings);
    });
    return train;
}

}  // namespace item3d
