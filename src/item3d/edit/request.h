// A request for an edit: files, plan, and execution options.
#pragma once

#include "item3d/edit/plan.h"
#include "item3d/processes/process_group.h"
#include "item3d/provenance/signing.h"
#include "item3d/tensors/tensor.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct EditRequest {
    std::filesystem::path model;
    std::filesystem::path prior;       ///< folder in the diffusers layout
    std::filesystem::path output;      ///< folder, created if missing
    std::filesystem::path clip;        ///< CLIP model for scores of the result; empty: none
    std::filesystem::path segmenter;   ///< CLIPSeg, for regions by words; loaded on demand
    std::filesystem::path captioner;   ///< BLIP or BLIP-2; loaded where the plan uses it
    std::filesystem::path inpainting;  ///< prior with 9 input channels, for method texture
    std::filesystem::path instruct;    ///< InstructPix2Pix, for in2n; empty: the prior
    std::filesystem::path teacher;     ///< CLIP model of method clip; empty: `clip`
    EditPlan plan;
    bool resume = false;
    std::filesystem::path checkpoint;  ///< file; empty: checkpoint.safetensors in the output folder
    std::vector<std::filesystem::path> texture_folders;  ///< see LoadOptions
    /// Edits materials whose base-colour image cannot be read, with their constant factors.
    bool allow_missing_textures = false;
    /// Number of iterations after which to stop as on an interrupt; 0: run to the end.
    int stop_after = 0;
    at::Device device = at::kCPU;
    std::string precision = "auto";  ///< of the networks: auto, fp32, bf16, fp16
    std::string memory = "auto";     ///< auto, low (less memory, more time), high
    int image_pixels = 384;          ///< side of the report's images; the turntable has 3/4 of it
    bool draws_turntable = true;
    std::filesystem::path live;  ///< folder of LiveTextures; empty: none
    /// Processes that compute this edit together, each with the same request. Process 0 alone
    /// writes to the output folder and reads the checkpoint.
    ProcessGroup processes = {};
    std::shared_ptr<const SigningKey> sign_key;  ///< signs written files; null: unsigned
    std::string command;                         ///< as typed, for edit.json and the resume hint
};

}  // namespace item3d
