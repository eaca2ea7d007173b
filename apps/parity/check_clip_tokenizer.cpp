#include "apps/parity/parity.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/text/clip_tokenizer.h"

namespace item3d::parity {
namespace {

namespace fs = std::filesystem;

at::Tensor int32(const std::vector<int>& values) {
    return at::tensor(values, at::kInt);
}

/// Compares ids that are padded to the full length, and a mask that ends where the text ends.
void compare_padded(Case& golden, const std::string& variant, const ClipTokenizer& tokenizer,
                    const std::vector<std::string>& texts) {
    const std::string name = variant + ".input_ids";
    if (!golden.has("out." + name)) return;
    const int length = static_cast<int>(golden.expected(name).size(-1));
    const at::Tensor ids = tokenizer.encode_batch(texts, length);
    golden.compare(name, ids, within::exact);

    at::Tensor mask = at::zeros_like(ids);
    for (std::size_t i = 0; i < texts.size(); ++i)
        mask[static_cast<std::int64_t>(i)]
            .slice(0, 0, static_cast<std::int64_t>(tokenizer.encode(texts[i]).size()))
            .fill_(1);
    golden.compare(variant + ".attention_mask", mask, within::exact);
}

void compare_full(Case& golden, const std::string& variant, const ClipTokenizer& tokenizer,
                  const std::vector<std::string>& texts) {
    std::vector<int> all, offsets{0};
    for (const std::string& text : texts) {
        const std::vector<int> ids = tokenizer.encode(text);
        all.insert(all.end(), ids.begin(), ids.end());
        offsets.push_back(static_cast<int>(all.size()));
    }
    golden.compare(variant + ".full_ids", int32(all), within::exact);
    golden.compare(variant + ".full_offsets", int32(offsets), within::exact);
    golden.compare(variant + ".specials",
                   int32({tokenizer.bos_id(), tokenizer.eos_id(), tokenizer.pad_id(),
                          tokenizer.unk_id(), static_cast<int>(tokenizer.size())}),
                   within::exact);
}

/// Compares tokens.json, which has the same ids in readable form, and the text decoded by the first
/// tokenizer.
void compare_listed(Case& golden, const std::string& variant, const ClipTokenizer& tokenizer,
                    bool decodes) {
    const fs::path path = golden.folder() / "tokens.json";
    if (!fs::exists(path)) return;
    const nlohmann::json rows = nlohmann::json::parse(read_text(path), nullptr, false);
    if (!rows.is_array()) throw InputError(path.string(), "expected a list");
    std::int64_t count = 0, different_ids = 0, different_texts = 0;
    for (const auto& row : rows) {
        if (!row.is_object() || !row.contains("text") || !row.contains(variant)) continue;
        const auto ids = row.at(variant).get<std::vector<int>>();
        ++count;
        different_ids += tokenizer.encode(row.at("text").get<std::string>()) != ids;
        if (decodes && row.contains("decoded"))
            different_texts += tokenizer.decode(ids) != row.at("decoded").get<std::string>();
    }
    golden.compare_texts("tokens.json " + variant + " ids", count, different_ids);
    if (decodes)
        golden.compare_texts("tokens.json " + variant + " decoded", count, different_texts);
}

}  // namespace

void check_clip_tokenizer(Case& golden) {
    const auto texts = golden.meta().texts("texts", {});
    // One folder has the vocabulary for all variants.
    std::vector<fs::path> folders;
    fs::path vocabulary;
    for (const auto& entry : fs::directory_iterator(golden.folder())) {
        if (!fs::exists(entry.path() / "tokenizer_config.json")) continue;
        folders.push_back(entry.path());
        if (fs::exists(entry.path() / "vocab.json")) vocabulary = entry.path();
    }
    if (vocabulary.empty())
        throw InputError(golden.folder().string(), "no folder has a vocab.json");
    for (const fs::path& folder : folders) {
        const bool own = fs::exists(folder / "vocab.json");
        const std::string variant = folder.filename().string();
        const ClipTokenizer tokenizer = ClipTokenizer::load(folder, own ? folder : vocabulary);
        compare_padded(golden, variant, tokenizer, texts);
        compare_full(golden, variant, tokenizer, texts);
        compare_listed(golden, variant, tokenizer, own);
    }
}

}  // namespace item3d::parity
