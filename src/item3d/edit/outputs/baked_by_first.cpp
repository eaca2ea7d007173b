#include "item3d/edit/outputs/baked_by_first.h"

#include "item3d/core/files.h"
#include "item3d/io/load.h"
#include "item3d/scene/far_origin.h"

#include <unistd.h>

#include <string_view>

namespace item3d {
namespace {

namespace fs = std::filesystem;

/// A temporary folder, removed with its content by the destructor.
class TemporaryFolder {
  public:
    TemporaryFolder()
        : path_(fs::temp_directory_path() / ("item3d-model-" + std::to_string(::getpid()))) {
        make_output_folder(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

/// Reads a model from bytes onto the scene's device.
Model read_model(const EditRequest& request, const EditScene& scene, std::string_view bytes) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / model_file_name(request.model);
    write_atomically(path, bytes);
    Model model = load_model(path, {.variant = request.plan.variant});
    move_origin(model, scene.model.origin);
    return model;
}

}  // namespace

EditedModel bake_by_first(const EditRequest& request, const EditScene& scene, EditState& state) {
    const ProcessGroup& processes = request.processes;
    EditedModel edited;
    if (processes.first()) edited = bake_and_save(request, scene, state);
    if (!processes.several()) return edited;
    if (!request.plan.edits_texture) {
        if (!processes.first()) edited.model = scene.model;
    } else {
        const std::string bytes = processes.broadcast(
            processes.first() ? read_text(request.output / model_file_name(request.model)) : "");
        if (!processes.first()) edited.model = read_model(request, scene, bytes);
    }
    if (state.light && !processes.first()) edited.light = new_light(*state.light);
    return edited;
}

}  // namespace item3d
