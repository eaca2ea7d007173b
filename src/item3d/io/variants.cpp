#include "item3d/io/variants.h"

#include "item3d/core/digest.h"
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/io/edit_folder.h"
#include "item3d/io/gltf/claims.h"
#include "item3d/io/gltf/make.h"
#include "item3d/io/gltf/merge_variants.h"
#include "item3d/io/gltf/texture_source.h"
#include "item3d/io/gltf/variants.h"
#include "item3d/io/gltf/write.h"
#include "item3d/io/load.h"
#include "item3d/io/overwrite.h"
#include "item3d/io/text.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace item3d {
namespace {

namespace fs = std::filesystem;

std::string without_article(const std::string& sentence) {
    const std::string lower = to_lower(sentence);
    for (const char* article : {"a ", "an ", "the "})
        if (lower.starts_with(article)) return sentence.substr(std::string(article).size());
    return sentence;
}

bool is_among(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

std::string unused_name(const std::string& wanted, const std::vector<std::string>& taken) {
    std::string name = wanted;
    for (int number = 2; is_among(taken, name); ++number)
        name = wanted + " " + std::to_string(number);
    return name;
}

void require_own(const VariantsRequest& request, const EditFolder& edit, const std::string& hash) {
    if (edit.inputs.empty())
        throw InputError(edit.folder.string(),
                         "does not record its source model, because an older item3d wrote it",
                         "make the edit again");
    if (is_among(edit.inputs, hash)) return;
    throw InputError(edit.folder.string(),
                     "is an edit of a different model than " + request.model.string(),
                     "choose edits of the current version of this model");
}

std::vector<EditFolder> read_edits(const VariantsRequest& request) {
    const std::string hash = sha256(read_bytes(request.model));
    std::vector<EditFolder> edits;
    for (const fs::path& folder : request.edits) {
        edits.push_back(read_edit_folder(folder));
        require_own(request, edits.back(), hash);
    }
    return edits;
}

std::shared_ptr<const SourceDocument> document_of(const VariantsRequest& request) {
    const Model model = load_model(request.model, {.texture_folders = request.texture_folders});
    auto document = model.source ? model.source : make_gltf(model, {});
    for (const char* avatar : {"VRM", "VRMC_vrm"})
        if (document->json.contains("extensions") && document->json["extensions"].contains(avatar))
            throw InputError(request.model.string(),
                             "is an avatar (VRM), which cannot have variants",
                             "keep each edit in a separate file");
    return document;
}

std::vector<std::string> checked_names(const VariantsRequest& request,
                                       const std::vector<EditFolder>& edits,
                                       std::vector<std::string> taken) {
    if (request.names.empty()) {
        std::vector<std::string> sentences;
        for (const EditFolder& edit : edits)
            sentences.push_back(edit.to);
        return variant_names_of(sentences, std::move(taken));
    }
    if (request.names.size() != edits.size())
        throw InputError("--name",
                         "is given " + std::to_string(request.names.size()) + " times, for " +
                             std::to_string(edits.size()) + " edits",
                         "give --name once for each folder, in the same order");
    for (const std::string& name : request.names) {
        if (name.empty()) throw InputError("--name", "is empty", "give each variant a name");
        if (is_among(taken, name))
            throw InputError("--name " + name, "is already the name of another variant",
                             "choose another");
        taken.push_back(name);
    }
    return request.names;
}

/// Returns the claims of all edits, each with the name of its variant.
std::vector<EditClaim> claims_of(const SourceDocument& source,
                                 const std::vector<EditedDocument>& edited) {
    const std::vector<EditClaim> earlier = edits_of(read_asset_packet(source.json).claim);
    std::vector<EditClaim> claims;
    for (const EditedDocument& edit : edited)
        for (EditClaim claim : edits_of(read_asset_packet(edit.document->json).claim)) {
            if (std::find(earlier.begin(), earlier.end(), claim) != earlier.end()) continue;
            claim.variant = edit.name;
            claims.push_back(std::move(claim));
        }
    return claims;
}

void write_merged(const VariantsRequest& request, const SourceDocument& document,
                  const std::vector<EditedDocument>& edited, const std::string& original) {
    const auto patch = [&](GltfBuilder& builder) {
        merge_variants(document, edited, original, builder);
        list_texture_extensions(builder.json());
    };
    Provenance provenance;
    if (request.says_provenance) provenance = {claims_of(document, edited), request.sign_key};
    write_patched(request.output, document, patch, provenance);
}

}  // namespace

std::vector<std::string> variant_names_of(const std::vector<std::string>& sentences,
                                          std::vector<std::string> taken) {
    std::vector<std::string> names;
    for (const std::string& sentence : sentences) {
        names.push_back(unused_name(without_article(sentence), taken));
        taken.push_back(names.back());
    }
    return names;
}

nlohmann::json write_variants(const VariantsRequest& request) {
    const std::string extension = to_lower(request.output.extension().string());
    if (extension != ".glb" && extension != ".gltf")
        throw InputError(request.output.string(),
                         "only glTF files have variants: expected .glb or .gltf",
                         "use one of these extensions");
    check_not_replaced(request.model, request.output);
    const std::vector<EditFolder> edits = read_edits(request);
    const std::shared_ptr<const SourceDocument> document = document_of(request);

    std::vector<std::string> taken = variant_names(*document);
    std::string original = request.original;
    if (taken.empty() && original.empty()) original = "original";
    if (is_among(taken, original))
        throw InputError("--original " + original, "is already the name of another variant",
                         "choose another");
    if (!original.empty()) taken.push_back(original);
    const std::vector<std::string> names = checked_names(request, edits, taken);

    std::vector<std::shared_ptr<const SourceDocument>> documents;
    std::vector<EditedDocument> edited;
    nlohmann::json variants = nlohmann::json::array();
    if (!original.empty())
        variants.push_back({{"name", original}, {"folder", nullptr}, {"to", nullptr}});
    for (std::size_t i = 0; i < edits.size(); ++i) {
        documents.push_back(parse_gltf(edits[i].model, read_bytes(edits[i].model)));
        edited.push_back({documents.back().get(), names[i], edits[i].variant});
        variants.push_back({{"name", names[i]},
                            {"folder", edits[i].folder.string()},
                            {"from", edits[i].from},
                            {"to", edits[i].to}});
    }
    make_folder_of(request.output);
    try {
        write_merged(request, *document, edited, original);
    } catch (const nlohmann::json::exception&) {
        throw InputError(request.output.string(), "an edited model is damaged",
                         "make the edit again");
    } catch (const std::out_of_range&) {
        throw InputError(request.output.string(), "an edited model is damaged",
                         "make the edit again");
    }
    return {{"model", request.model.string()},
            {"output", request.output.string()},
            {"variants", std::move(variants)}};
}

}  // namespace item3d
