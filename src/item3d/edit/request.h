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
    std::filesystem::path prior;       ///< a folder in the diffusers layout
    std::filesystem::path output;      ///< folder, created if missing
    std::filesystem::path clip;        ///< CLIP model that scores the result; empty: no scores
    std::filesystem::path segmenter;   ///< CLIPSeg, for regions by words; loaded on demand
    std::filesystem::path captioner;   ///< BLIP or BLIP-2; loaded if the plan uses it
    std::filesystem::path inpainting;  ///< prior with 9 input channels, for the method texture
    std::filesystem::path instruct;    ///< InstructPix2Pix, for the method in2n; empty: the prior
    std::filesystem::path teacher;     ///< CLIP model for the method clip; empty: `clip`
    EditPlan plan;
    bool resume = false;
    /// A file; empty: checkpoint.safetensors in the output folder.
    std::filesystem::path checkpoint;
    std::vector<std::filesystem::path> texture_folders;  ///< see LoadOptions
    /// If true, materials whose base-colour image cannot be read are edited with their constant
    /// factors. If false, they are an error.
    bool allow_missing_textures = false;
    /// Number of iterations after which the edit stops as on an interrupt; 0: it runs to the end.
    int stop_after = 0;
    at::Device device = at::kCPU;
    std::string precision = "auto";  ///< precision of the networks: auto, fp32, bf16, fp16
    std::string memory = "auto";     ///< auto, low (less memory, more time), high
    int image_pixels = 384;          ///< side of the report's images; the turntable has 3/4 of it
    bool draws_turntable = true;
    std::filesystem::path live;  ///< folder for LiveTextures; empty: no live textures
    /// Processes that compute this edit together, each with the same request. Only process 0 writes
    /// to the output folder and reads the checkpoint.
    ProcessGroup processes = {};
    std::shared_ptr<const SigningKey> sign_key;  ///< signs written files; null: unsigned
    std::string command;                         ///< as typed, for edit.json and the resume hint
};

}  // namespace item3d
