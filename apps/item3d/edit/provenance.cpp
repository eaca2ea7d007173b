// Command item3d provenance: shows a file's edits and their signature.
#include "apps/item3d/command.h"
#include "apps/item3d/edit/commands.h"
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/io/read_provenance.h"

#include <memory>
#include <string>

namespace item3d {
namespace {

struct ProvenanceCommand : CommonOptions {
    std::filesystem::path file;
    std::filesystem::path public_key;
};

/// Error for a file that was altered, or that the given key did not sign, with its exit code.
class Mismatch : public Error {
  public:
    Mismatch(ExitCode code, const std::filesystem::path& file, const std::string& problem)
        : Error(code, file.string() + ": " + problem) {}
};

void print_line(const char* title, const std::string& text) {
    if (!text.empty()) fmt::print("{:<16}{}\n", title, text);
}

std::string words_for(ContentState state) {
    return state == ContentState::same      ? "as it was written"
           : state == ContentState::changed ? "CHANGED since"
                                            : "no longer present";
}

void print_edit(const EditClaim& edit) {
    if (is_reconstruction(edit))
        print_line("computed from", edit.photographs + " photographs");
    else
        print_line("edit", fmt::format("\"{}\" -> \"{}\"", edit.from, edit.to));
    print_line("  look", edit.variant);
    print_line("  strength", edit.strength);
    print_line("  method", edit.method);
    print_line("  prior",
               edit.prior +
                   (edit.prior_hash.empty() ? "" : fmt::format(" (weights {})", edit.prior_hash)));
    print_line("  input", edit.input + (edit.input_sha256.empty()
                                            ? ""
                                            : fmt::format(" (SHA-256 {})", edit.input_sha256)));
    print_line("  begun", edit.date);
}

void print_text(const FileProvenance& provenance, bool is_by_given_key, bool has_key) {
    const PacketMetadata& metadata = provenance.metadata;
    print_line("source type", metadata.source_type);
    print_line("creator", metadata.creator);
    print_line("rights", metadata.rights);
    print_line("usage terms", metadata.usage_terms);
    print_line("copyright", provenance.copyright);
    print_line("generator", provenance.generator);
    print_line("problem", metadata.problem);
    if (!provenance.has_claim()) {
        fmt::print("no claim of item3d\n");
        return;
    }
    const std::string program = metadata.claim.value("program", nlohmann::json("?")).dump();
    print_line("written by",
               program.substr(1, program.size() - 2) + " " +
                   (metadata.claim.contains("version") && metadata.claim["version"].is_string()
                        ? metadata.claim["version"].get<std::string>()
                        : ""));
    for (const EditClaim& edit : edits_of(metadata.claim))
        print_edit(edit);
    for (const CheckedImage& checked : provenance.images)
        print_line("image", (checked.image.image.empty()
                                 ? ""
                                 : checked.image.image + " " + checked.image.name + ": ") +
                                words_for(checked.state));
    if (metadata.claim.contains("document_sha256"))
        print_line("all else", words_for(provenance.document));
    const std::string key = public_key_of(metadata.claim);
    switch (provenance.signature) {
        case SignatureState::none:
            print_line("signature", "none: the claim could come from anyone");
            break;
        case SignatureState::invalid:
            print_line("signature", "not of these claims: they were CHANGED after signing");
            break;
        case SignatureState::valid:
            print_line("signature", "of the key " + key +
                                        (!has_key          ? " (use --public-key to check whose)"
                                         : is_by_given_key ? ", the given key"
                                                           : ", NOT the given key"));
            break;
    }
}

/// Throws the error that gives the exit code, if there is one.
void judge(const ProvenanceCommand& options, const FileProvenance& provenance,
           const std::string& key) {
    const auto fail = [&](ExitCode code, const std::string& problem) {
        throw Mismatch(code, options.file, problem);
    };
    if (!key.empty() && provenance.signature == SignatureState::none)
        fail(ExitCode::not_signed, "is not signed");
    if (provenance.has_claim() && !provenance.is_unchanged())
        fail(ExitCode::altered, "was altered since it was written");
    if (!key.empty() && public_key_of(provenance.metadata.claim) != key)
        fail(ExitCode::other_signer, "is signed by another key");
}

void run_provenance(const ProvenanceCommand& options) {
    const std::string key = options.public_key.empty() ? "" : load_public_key(options.public_key);
    const FileProvenance provenance = read_provenance(options.file);
    const bool is_by_given_key = !key.empty() && provenance.signature == SignatureState::valid &&
                                 public_key_of(provenance.metadata.claim) == key;
    if (options.json) {
        nlohmann::json out = provenance_json(provenance);
        out["file"] = options.file.string();
        if (!key.empty()) out["signed_by_given_key"] = is_by_given_key;
        print_json(out);
    } else {
        print_text(provenance, is_by_given_key, !key.empty());
    }
    judge(options, provenance, key);
}

}  // namespace

void add_provenance_command(CLI::App& app) {
    auto options = std::make_shared<ProvenanceCommand>();
    CLI::App* command = add_command(app, "provenance", *options);
    command->add_option("FILE", options->file, "A .glb, .gltf, PNG, JPEG, WebP or KTX2 file")
        ->required();
    command
        ->add_option("--public-key", options->public_key,
                     "Ed25519 public key in PEM (openssl pkey -pubout) to check the signature with")
        ->type_name("FILE");
    command->footer(
        "Exit codes: 0 the claim holds, or there is no claim; 3 the file cannot be read; 5 "
        "changed\n"
        "since; with --public-key: 6 signed by another key, 7 not signed.");
    command->callback([options] {
        start_command(*options);
        run_provenance(*options);
    });
}

}  // namespace item3d
