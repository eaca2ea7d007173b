#include "item3d/mcp/tool_list.h"

#include "item3d/lighting/environment.h"

namespace item3d {
namespace {

using Kind = ArgumentKind;

ToolArgument model_argument() {
    return {"model", Kind::file, "A .glb, .gltf, .vrm or .obj file", true, true};
}

ToolArgument light_argument() {
    static const std::string text =
        light_presets_text() + ", or an equirectangular .hdr or .exr file";
    return {"light", Kind::light, text};
}

constexpr std::string_view selectors_text =
    "Selectors of the part: material=NAME, node=NAME, words=TEXT (\"the handle\"), named=COLOR "
    "(red, blue, ...), color=#RRGGBB, box=X0,Y0,Z0,X1,Y1,Z1, sphere=X,Y,Z,R, mask=FILE; several "
    "are united";

std::vector<Tool> make_tools() {
    const ToolArgument from{"from", Kind::text,
                            "Description of the model as it is, for example \"a red mug\""};
    const ToolArgument to{"to", Kind::text,
                          "Description of the model as it should be, for example \"a golden mug\""};
    const auto required = [](ToolArgument argument) {
        argument.is_required = true;
        return argument;
    };
    const ToolArgument region{"region", Kind::selectors, selectors_text};
    const ToolArgument exclude{"exclude", Kind::selectors, "Selectors of parts to leave out"};
    std::vector<Tool> list;
    list.push_back(
        {"describe",
         "Describe a model",
         "Lists a model's size, materials, nodes and meshes, and renders it from six sides.",
         "region",
         {model_argument()},
         {"view_0.png", "view_2.png"},
         {}});
    list.push_back({"caption",
                    "Caption a model",
                    "Describes a model or an image in a few words of the small vocabulary that the "
                    "prior knows.",
                    "caption",
                    {model_argument()},
                    {},
                    {}});
    list.push_back(
        {"render",
         "Render a model",
         "Renders images of a model from all around.",
         "render",
         {model_argument(),
          {"views", Kind::integer, "Number of views around the model (4); the first four are shown",
           false, false, "4"},
          light_argument(),
          {"exposure", Kind::number, "Exposure of the light, in stops"},
          {"size", Kind::text, "WIDTHxHEIGHT in pixels (512x512)"},
          {"channel", Kind::text, "shaded, base_color, orm, normal, depth or mask"},
          {"variant", Kind::text, "Name of the variant, for a model with several"},
          {"background", Kind::text, "A colour by name, #rrggbb, or none"}},
         {"view_000.png", "view_001.png", "view_002.png", "view_003.png"},
         {}});
    list.push_back(
        {"region",
         "Show a part of a model",
         "Shows which part of a model the selectors select, before an edit of that part.",
         "region",
         {model_argument(),
          required(region),
          exclude,
          {"feather", Kind::number, "Width of the soft border, percent of the model's size"}},
         {"region.png"},
         {}});
    list.push_back(
        {"edit",
         "Edit the look of a model",
         "Changes colour, material or pattern of a model's textures from two sentences that differ "
         "in what should change. Takes from half a minute to a few minutes and reports progress. "
         "Writes model.glb, images before and after, a report and the scores.",
         "edit",
         {model_argument(),
          required(from),
          required(to),
          region,
          exclude,
          {"feather", Kind::number, "Width of the region's soft border, percent of the size"},
          {"iterations", Kind::integer, "Maximum number of steps; default: the prior's own"},
          {"seed", Kind::integer, "Seed of all random numbers"},
          light_argument(),
          {"resume", Kind::checkpoint,
           "Folder of a cancelled edit with otherwise the same arguments, to continue from its "
           "checkpoint"},
          {"settings", Kind::settings, "Additional options of `item3d edit` by name"}},
         {"before.png", "after.png"},
         {"model.glb", "report.html", "turntable.webp", "edit.json"}});
    list.push_back({"relight",
                    "Show a model in another light",
                    "Renders a model in its old and a new light, with shadows, and writes it with "
                    "the new light.",
                    "relight",
                    {model_argument(),
                     light_argument(),
                     {"sky", Kind::number, "A clear sky at this hour, 0 to 24, instead of light"},
                     {"lit", Kind::text, "Direction of the light in words (\"from the left\")"},
                     {"exposure", Kind::number, "Exposure of the light, in stops"}},
                    {"sheet.png"},
                    {"model.glb", "light.hdr", "turntable.webp"}});
    list.push_back({"score",
                    "Score an edit",
                    "Measures with CLIP how well an edited model follows its sentences.",
                    "score",
                    {{"before", Kind::file, "The model before the edit", true, true},
                     {"after", Kind::file, "The edited model", true, true},
                     required(from),
                     required(to)},
                    {},
                    {}});
    list.push_back({"variants",
                    "Combine edits in one file",
                    "Combines several edits of one model as variants in one glTF.",
                    "variants",
                    {model_argument(),
                     {"edits", Kind::folders, "Output folders of edits of this model", true, true},
                     {"name", Kind::texts, "Names of the variants, one for each edit"}},
                    {},
                    {"variants.glb"}});
    return list;
}

}  // namespace

const std::vector<Tool>& tools() {
    static const std::vector<Tool> list = make_tools();
    return list;
}

}  // namespace item3d
