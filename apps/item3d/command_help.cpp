#include "apps/item3d/command_help.h"

#include <map>

namespace item3d {
namespace {

CommandHelp edit_help() {
    return {
        .first_screen = {"from", "to", "region", "light", "iterations", "texture-size", "keep",
                         "seed", "prior", "resume", "json", "quiet"},
        .examples =
            {{"edit all of a model; golden/report.html shows the result",
              "item3d edit mug.glb --from \"a red mug\" --to \"a golden mug\" -o golden"},
             {"edit the handle alone",
              "item3d edit mug.glb --from \"a red mug\" --to \"a blue mug\" --region words=handle "
              "-o handle"},
             {"continue after an interruption",
              "item3d edit mug.glb --from \"a red mug\" --to \"a golden mug\" -o golden --resume"},
             {"explain the methods of guidance", "item3d edit --guidance help"}},
        .page = "docs/method.md, docs/regions.md, docs/reference/settings.md",
        .usage = "MODEL --from TEXT --to TEXT -o FOLDER [OPTIONS]"};
}

CommandHelp reconstruct_help() {
    return {
        .first_screen = {"from-images", "masks", "background", "longest-side", "up", "mesh",
                         "triangles", "texture-size", "poses", "resume", "json", "quiet"},
        .examples = {{"a dataset with poses and masks", "item3d reconstruct photographs -o bottle"},
                     {"photographs alone; COLMAP finds the poses",
                      "item3d reconstruct --from-images photographs --background white -o bottle"},
                     {"edit the result",
                      "item3d edit bottle/model.glb --from \"a bottle\" --to \"a golden bottle\" "
                      "-o golden"}},
        .page = "docs/reconstruct.md",
        .usage = "DATASET -o FOLDER [OPTIONS]"};
}

CommandHelp render_help() {
    return {
        .first_screen = {"views", "light", "exposure", "size", "channel", "occlusion", "background",
                         "quiet"},
        .examples = {{"one picture at sunset", "item3d render mug.glb --light sunset -o mug.png"},
                     {"eight views of the base color",
                      "item3d render mug.glb --views 8 --channel base_color -o views"}},
        .page = "docs/renderer.md"};
}

CommandHelp relight_help() {
    return {.first_screen = {"light", "sky", "from", "to", "lit", "exposure", "punctual", "views",
                             "size", "resume", "json", "quiet"},
            .examples =
                {{"the evening sun", "item3d relight mug.glb --light sunset -o evening"},
                 {"a clear sky at five", "item3d relight mug.glb --sky 17 -o five"},
                 {"a light found by words",
                  "item3d relight mug.glb --from \"a mug\" --to \"a mug at sunset\" -o evening"}},
            .page = "docs/relight.md"};
}

CommandHelp light_help() {
    return {.examples = {{"describe a light", "item3d light sunset"},
                         {"turn a photographed light and look at it",
                          "item3d light room.hdr --rotate 90 -o turned.png"}},
            .page = "docs/relight.md"};
}

CommandHelp generate_help() {
    return {
        .first_screen = {"prior", "steps", "cfg", "seed", "count", "size", "like",
                         "negative-prompt"},
        .examples = {{"four vases", "item3d generate \"a golden vase\" --count 4 -o vases.png"}},
        .page = "docs/other_priors.md"};
}

CommandHelp region_help() {
    return {
        .examples = {{"list the names that can be selected", "item3d region mug.glb -o region"},
                     {"show the handle", "item3d region mug.glb --region words=handle -o region"}},
        .page = "docs/regions.md"};
}

CommandHelp batch_help() {
    return {.first_screen = {"output", "models", "from", "to", "seeds", "with", "workers", "slurm",
                             "variants", "json", "quiet"},
            .examples = {{"every model of a folder, two at a time",
                          "item3d batch --models 'shop/*.glb' --from \"a {name}\" --to \"a golden "
                          "{name}\" -o golden "
                          "--workers 2"},
                         {"the jobs of a table", "item3d batch jobs.csv -o shop"},
                         {"the state of a batch", "item3d batch status shop"}},
            .page = "docs/batch.md, docs/slurm.md",
            .usage = "JOBS -o FOLDER [OPTIONS]"};
}

CommandHelp train_help() {
    return {.first_screen = {"work", "recipe", "part", "samples", "data", "resolution", "init-from",
                             "seed", "stop-after", "resume", "quiet"},
            .examples = {{"train all parts, as the embedded prior was",
                          "item3d prior train -o my_prior"},
                         {"edit with it",
                          "item3d edit mug.glb --prior my_prior --from \"a red mug\" --to \"a "
                          "golden mug\" -o golden"}},
            .page = "docs/embedded_prior.md"};
}

using HelpTable = std::map<std::string_view, CommandHelp>;

HelpTable make_table() {
    return {
        {"edit", edit_help()},
        {"reconstruct", reconstruct_help()},
        {"render", render_help()},
        {"light", light_help()},
        {"relight", relight_help()},
        {"generate", generate_help()},
        {"caption",
         {.examples = {{"describe a model", "item3d caption mug.glb"}}, .page = "docs/scores.md"}},
        {"score",
         {.examples = {{"score an edit",
                        "item3d score mug.glb golden/model.glb --from \"a red mug\" --to \"a "
                        "golden mug\""}},
          .page = "docs/scores.md"}},
        {"region", region_help()},
        {"layers",
         {.examples =
              {{"half golden, and rusty in roughness and metallic",
                "item3d layers mug.glb golden:0.5 rusty:1:roughness,metallic -o mixed.glb"}},
          .page = "docs/variants.md"}},
        {"variants",
         {.examples = {{"three looks in one file",
                        "item3d variants mug.glb golden blue -o shop.glb"},
                       {"draw one of them",
                        "item3d render shop.glb --variant \"golden mug\" -o golden.png"}},
          .page = "docs/variants.md"}},
        {"provenance",
         {.examples =
              {{"make a key", "openssl genpkey -algorithm ed25519 -out shop.pem"},
               {"and its public half", "openssl pkey -in shop.pem -pubout -out shop.pub.pem"},
               {"sign an edit",
                "item3d edit mug.glb --from \"a red mug\" --to \"a golden mug\" -o golden "
                "--sign-key shop.pem"},
               {"check it", "item3d provenance golden/model.glb --public-key shop.pub.pem"}},
          .page = "docs/provenance.md"}},
        {"guidance", {.page = "docs/python.md"}},
        {"tensors",
         {.examples = {{"for other programs", "item3d tensors mug.glb -o mug.safetensors"}},
          .page = "docs/python.md"}},
        {"batch", batch_help()},
        {"batch work", {.page = "docs/batch.md"}},
        {"batch status", {.page = "docs/batch.md"}},
        {"compare",
         {.examples = {{"all methods on the cases of the suite", "item3d compare -o comparison"},
                       {"two methods on your own cases",
                        "item3d compare cases.csv --methods item3d,sds -o comparison"}},
          .page = "docs/compare.md"}},
        {"study", {.page = "docs/study.md"}},
        {"study make",
         {.examples = {{"a study of a comparison", "item3d study make comparison -o study"}},
          .page = "docs/study.md"}},
        {"study serve",
         {.examples = {{"33 links, on this machine", "item3d study serve study"}},
          .page = "docs/study.md"}},
        {"study analyze", {.page = "docs/study.md"}},
        {"studio",
         {.examples = {{"open a model", "item3d studio mug.glb"},
                       {"on another machine, through ssh",
                        "ssh -L 8000:localhost:8000 server item3d studio --port 8000"}},
          .page = "docs/studio.md"}},
        {"mcp", {.page = "docs/agents.md"}},
        {"prior", {.page = "docs/other_priors.md"}},
        {"prior train", train_help()},
        {"prior list", {.page = "docs/other_priors.md"}},
        {"prior info", {.page = "docs/embedded_prior.md"}},
        {"prior evaluate",
         {.examples = {{"measure a prior", "item3d prior evaluate my_prior -o evaluation"}},
          .page = "docs/embedded_prior.md"}},
        {"prior pull",
         {.examples =
              {{"fetch Stable Diffusion",
                "item3d prior pull stable-diffusion-v1-5/stable-diffusion-v1-5 --variant fp16"}},
          .page = "docs/other_priors.md"}},
        {"prior verify", {.page = "docs/other_priors.md"}},
        {"prior pictures", {.page = "docs/embedded_prior.md"}},
        {"bench", {.page = "docs/benchmarks.md"}},
    };
}

}  // namespace

CommandHelp command_help(std::string_view name) {
    static const HelpTable table = make_table();
    const auto found = table.find(name);
    return found == table.end() ? CommandHelp{} : found->second;
}

}  // namespace item3d
