// Commands of item3d-edit.
#pragma once

#include <CLI/CLI.hpp>

namespace item3d {

void add_edit_command(CLI::App& app);
void add_render_command(CLI::App& app);
void add_light_command(CLI::App& app);
void add_relight_command(CLI::App& app);
void add_generate_command(CLI::App& app);
void add_caption_command(CLI::App& app);
void add_score_command(CLI::App& app);
void add_region_command(CLI::App& app);
void add_layers_command(CLI::App& app);
void add_variants_command(CLI::App& app);
void add_provenance_command(CLI::App& app);
void add_batch_command(CLI::App& app);
void add_guidance_command(CLI::App& app);
void add_tensors_command(CLI::App& app);

}  // namespace item3d
