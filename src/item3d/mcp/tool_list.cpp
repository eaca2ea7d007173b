#include "item3d/mcp/tool_list.h"

namespace item3d {
namespace {

using Kind = ArgumentKind;

ToolArgument model_argument() {
    return {"model", Kind::file, "A .glb, .gltf or .obj file", true, true};
}

ToolArgument light_argument() {
    return {"light", Kind::light,
            "studio, noon, sunset, overcast, night, or an equirectangular .hdr or .exr file"};
}

constexpr std::string_view selectors_text =
    "Selectors of the part: material=NAME, node=NAME, words=TEXT (\"the handle\"), named=COLOR "
    "(red, blue, ...), color=#RRGGBB, box=X0,Y0,Z0,X1,Y1,Z1, sphere=X,Y,Z,R, mask=FILE; their "
    "union";

std::vector<Tool> make_tools() {
    const ToolArgument from{"from", Kind::text, "What the model looks like, as \"a red mug\""};
    const ToolArgument to{"to", Kind::text, "What it shall look like, as \"a golden mug\""};
    const auto required = [](ToolArgument argument) {
        argument.is_required = true;
        return argument;
    };
    const ToolArgument region{"region", Kind::selectors, selectors_text};
    const ToolArgument exclude{"exclude", Kind::selectors, "Selectors of what to leave out"};
    std::vector<Tool> list;
    list.push_back(
        {"describe",
         "Describe a model",
         "Lists a model's size, materials, nodes and meshes, and draws it from six sides.",
         "region",
         {model_argument()},
         {"view_0.png", "view_2.png"},
         {}});
    list.push_back({"caption",
                    "Say what a model shows",
                    "Describes a model or picture in a few words of the small vocabulary that the "
                    "prior knows.",
                    "caption",
                    {model_argument()},
                    {},
                    {}});
    list.push_back(
        {"render",
         "Draw a model",
         "Draws pictures of a model from around it.",
         "render",
         {model_argument(),
          {"views", Kind::integer, "Pictures around the model (4); the first four are shown", false,
           false, "4"},
          light_argument(),
          {"exposure", Kind::number, "Stops by which the light is brighter"},
          {"size", Kind::text, "WIDTHxHEIGHT in pixels (512x512)"},
          {"channel", Kind::text, "shaded, base_color, orm, normal, depth or mask"},
          {"variant", Kind::text, "The look of this name, of a model that offers several"},
          {"background", Kind::text, "A colour by name, #rrggbb, or none"}},
         {"view_000.png", "view_001.png", "view_002.png", "view_003.png"},
         {}});
    list.push_back(
        {"region",
         "Show a part of a model",
         "Shows which part of a model selectors take, before an edit of that part.",
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
         "in what shall change. Takes half a minute to some minutes; progress is reported. Writes "
         "model.glb, pictures before and after, a report and the scores.",
         "edit",
         {model_argument(),
          required(from),
          required(to),
          region,
          exclude,
          {"feather", Kind::number, "Width of the region's soft border, percent of the size"},
          {"iterations", Kind::integer, "Steps at most; the prior's own number without it"},
          {"seed", Kind::integer, "Another seed, another result"},
          light_argument(),
          {"resume", Kind::checkpoint,
           "The folder of an edit that was cancelled, with the same other "
           "arguments: goes on from its checkpoint"},
          {"settings", Kind::settings, "Further options of `item3d edit` by their names"}},
         {"before.png", "after.png"},
         {"model.glb", "report.html", "turntable.webp", "edit.json"}});
    list.push_back(
        {"relight",
         "Show a model in another light",
         "Draws a model in its old and a new light, with shadows, and writes it with "
         "that light.",
         "relight",
         {model_argument(),
          light_argument(),
          {"sky", Kind::number, "A clear sky at this hour, 0 to 24, in place of light"},
          {"lit", Kind::text, "Where the light comes from, in words (\"from the left\")"},
          {"exposure", Kind::number, "Stops by which the light is brighter"}},
         {"sheet.png"},
         {"model.glb", "light.hdr", "turntable.webp"}});
    list.push_back({"score",
                    "Score an edit",
                    "Measures by CLIP how well an edited model follows its sentences.",
                    "score",
                    {{"before", Kind::file, "The model as it was", true, true},
                     {"after", Kind::file, "The edited model", true, true},
                     required(from),
                     required(to)},
                    {},
                    {}});
    list.push_back({"variants",
                    "Put edits into one file",
                    "Puts several edits of one model into a glTF that offers them as looks.",
                    "variants",
                    {model_argument(),
                     {"edits", Kind::folders, "Folders that edit wrote, of this model", true, true},
                     {"name", Kind::texts, "Names of the looks, one for each edit"}},
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
