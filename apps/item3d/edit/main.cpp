// Program item3d-edit: edits, renders, relights, generates, captions and scores.
#include "apps/item3d/edit/commands.h"
#include "apps/item3d/run.h"

int main(int argc, char** argv) {
    item3d::run_program(
        argc, argv,
        {item3d::add_edit_command, item3d::add_render_command, item3d::add_light_command,
         item3d::add_relight_command, item3d::add_generate_command, item3d::add_caption_command,
         item3d::add_score_command, item3d::add_region_command, item3d::add_layers_command,
         item3d::add_variants_command, item3d::add_provenance_command, item3d::add_batch_command,
         item3d::add_guidance_command, item3d::add_tensors_command});
}
